"""Bodies that are balls have the mass of balls, or the program says what they lack."""

import numpy as np
import pytest
from cases import long

BODY = "-bodies a -a_dm_plex_shape ball -a_dm_plex_dim {} -a_density 1000 -a_youngs_modulus 1e9 -a_initial_velocity {} -time_step 1e-6 -time_end 1e-6"

CURVED = "-a_dm_plex_simplex true -a_element_formulation composite"  # nodes in the middle of edges, off the chords


def mass(run):
    return run.history["body"]["a"]["momentum"][0, 0]


@pytest.mark.parametrize(
    ("dim", "mesh"),
    [(2, ""), (3, ""), (2, "-a_ball_part half -a_ball_grading 8"), (3, "-a_dm_plex_simplex true -a_ball_grading 8"), (2, f"{CURVED} -a_ball_grading 8"), (3, f"{CURVED} -a_ball_part half")],
)
def test_mass(dim, mesh, shared_run):
    """To round-off, by the integration of the elements themselves. Measured: 5.1e-14 at most."""
    run = shared_run(f"{BODY.format(dim, '1,0,0'[: 2 * dim - 1])} {mesh}")
    exact = 1000 * (np.pi if dim == 2 else 4 / 3 * np.pi) / (2 if "half" in mesh else 1)
    assert mass(run) == pytest.approx(exact, rel=1e-12)
    assert "warning" not in run.stderr


def test_too_coarse(shared_run):
    """One element behind the ball spans so much of it that its corners would have to move beyond half the radius: they stay on the sphere, and the
    program says how much volume that leaves out."""
    run = shared_run(f"{BODY.format(3, '1,0,0')} -a_ball_divisions 4 -a_ball_grading 256")
    missing = 1 - mass(run) / (4000 / 3 * np.pi)
    assert 0.85 < missing < 0.95  # measured: 0.89
    assert f"body 'a' has {100 * missing:.2g} % less volume" in run.stderr
    assert "-a_ball_divisions" in run.stderr


def test_nodes_at_the_radius(shared_run):
    """If the volume is not to be kept: a polygon of 16 edges then has 2.6 % less area, which is said, but is no warning."""
    run = shared_run(f"{BODY.format(2, '1,0')} -a_ball_keep_volume false")
    area = 8 * np.sin(np.pi / 8)
    assert mass(run) == pytest.approx(1000 * area, rel=1e-12)
    assert f"body 'a' has {100 * (1 - area / np.pi):.2g} % less volume" in run.stdout
    assert "warning" not in run.stderr


@pytest.mark.parametrize("more", ["", *long("-a_element_formulation composite")])
def test_head_on(more, impakt):
    """A ball of tetrahedra that hits a plane goes back as it came: its cells are mirror images of each other, across x = 0 and y = 0. Momentum across and
    spin, measured: 3e-17 and 5e-17 of what it came with, and of that times the radius; with all cells cut the same way 3e-15, and a spin of 6e-3 and 1.3e-3."""
    run = impakt(
        f"{BODY.format(3, '0,0,-5')} {more} -a_dm_plex_simplex true -a_ball_radius 0.1 -a_ball_centre 0,0,0.1025 -a_density 1000 -a_youngs_modulus 1e7 -a_poissons_ratio 0.3 -a_material_type neo_hookean "
        "-a_ts_type centraldifference -a_mass_type lumped -obstacles wall -wall_obstacle_type plane -wall_point 0,0,0 -wall_normal 0,0,1 -contact_pairs a.surface:wall -time_step 2e-5 -time_end 6e-3 -schwarz_snes_rtol 1e-14"
    )
    momentum, spin = (run.history["body"]["a"][name][:] for name in ("momentum", "angular_momentum"))
    assert momentum[-1, 2] > -0.5 * momentum[0, 2] > 0
    assert np.abs(momentum[:, :2]).max() <= 1e-13 * abs(momentum[0, 2])
    assert np.abs(spin).max() <= 1e-13 * 0.1 * abs(momentum[0, 2])
