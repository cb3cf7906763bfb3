"""The first state of massless nodes is the balanced one: the first step loses nothing, and the first record of the history has its forces."""

import numpy as np
import pytest

EXPLICIT = "-{b}_ts_type centraldifference"
KINDS = {"II": "", "EE": EXPLICIT, "IE": EXPLICIT.format(b="right"), "EI": EXPLICIT.format(b="left")}
STRAIN, MODULUS, DENSITY, AREA = 1e-4, 2e9, 1000.0, 1e-4
STEP = 2e-7  # [s]; a wave crosses an element of 2 mm in 1.4e-6 s


def bars(kind, more="", start=f"-{{b}}_initial_displacement {-STRAIN}*x"):
    """Two bars that touch at x = 0, both compressed as a whole by `start`, and let go."""
    words = "-{b}_dm_plex_dim 1 -{b}_dm_plex_box_faces 25 -{b}_density 1000 -{b}_youngs_modulus 2e9 -{b}_cross_section 1e-4 " + start + " " + KINDS[kind]
    return f"-bodies left,right -contact_pairs left:right -left_dm_plex_box_lower -0.05 -left_dm_plex_box_upper 0 -right_dm_plex_box_lower 0 -right_dm_plex_box_upper 0.05 " \
           f"-time_step {STEP} -time_end {40 * STEP} {' '.join(words.format(b=body) for body in ('left', 'right'))} {more}"  # fmt: skip


def energies(run):
    """What the bodies and penalty springs have at each record, less the work of loads."""
    bodies = run.history["body"]
    return sum(bodies[name]["kinetic"][()] + bodies[name]["potential"][()] - bodies[name]["external_work"][()] for name in bodies)


def worst(run):
    energy = energies(run)
    return np.abs(energy / energy[0] - 1).max()


@pytest.mark.parametrize(
    ("kind", "method"), [("II", "schwarz"), ("EE", "schwarz"), ("IE", "schwarz"), ("EI", "lagrange"), ("II", "lagrange"), ("IE", "augmented_lagrangian")]
)
def test_pressed_bars_start_with_their_force(kind, method, shared_run):
    """E strain A, from the first record on until waves from the free ends arrive after 125 steps. Measured: 1e-13 of the force,
    4e-16 of energy; the augmented Lagrangian leaves gaps of 1e-10 m, which are
    6e-6 of the force and 5e-7 of the energy."""
    run = shared_run(bars(kind, f"-contact_type {method}"))
    pair = run.history["contact/left:right"]
    assert pair["active"][0] == 1
    np.testing.assert_allclose(pair["force"][:], MODULUS * STRAIN * AREA, rtol=2e-5 if method == "augmented_lagrangian" else 1e-11)
    assert worst(run) <= (1e-6 if method == "augmented_lagrangian" else 1e-13)


def test_springs_are_in_balance_too(shared_run):
    """A penalty spring k between two layers of stiffness c = E A / h each: both give way, and the force is what is left."""
    run = shared_run(bars("II", "-contact_type penalty -contact_penalty 1e9"))
    c, k = MODULUS * AREA / 0.002, 1e9
    force = MODULUS * STRAIN * AREA * (2 / c) / (2 / c + 1 / k)
    assert run.history["contact/left:right/force"][0] == pytest.approx(force, rel=1e-12)
    assert run.summary["system"]["penalty_energy_max"] >= 0.5 * force**2 / k * (1 - 1e-9)


@pytest.mark.parametrize("kind", ["II", "EE"])
def test_stretched_bars_let_go(kind, shared_run):
    """No row may pull: the surfaces relax, and the energy is that of the state from then on."""
    run = shared_run(bars(kind, start=f"-{{b}}_initial_displacement {STRAIN}*x -{{b}}_initial_velocity 0"))
    pair = run.history["contact/left:right"]
    assert not pair["active"][0] and pair["force"][0] == 0 and pair["gap"][0] > 0.9 * 2 * STRAIN * 0.002
    assert worst(run) <= 1e-12


@pytest.mark.parametrize("kind", ["IE", "EI"])
def test_load_on_the_contact_surface(kind, shared_run):
    """A traction that is there from the start: its nodes have given way, so that it does no work in the first step but on what moves."""
    run = shared_run(bars(kind, "-left_dm_plex_box_upper -0.001 -left_dm_plex_box_lower -0.051 -left_boundary_traction xmax -left_boundary_traction_xmax 1e5", start=""))
    energy = energies(run)
    stored = 0.5 * (1e5 * AREA) ** 2 / (MODULUS * AREA / 0.002)  # of the last element under the load, whose other node has not moved
    assert energy[0] == pytest.approx(stored, rel=1e-9 if kind == "IE" else 0.5)
    assert np.abs(energy - energy[0]).max() <= 1e-12 * energy[0] + 1e-12 * run.history["body/left/external_work"][-1]


BLOCKS = """-bodies low,high -contact_pairs high.ymin:low.ymax -time_step 1e-6 -time_end 2e-5
    -low_dm_plex_dim 2 -low_dm_plex_box_upper 0.04,0.02 -low_dm_plex_box_faces 12,6 -low_density 1000 -low_youngs_modulus 1e9 -low_poissons_ratio 0.3
    -high_dm_plex_dim 2 -high_dm_plex_box_lower 0.005,0.02 -high_dm_plex_box_upper 0.035,0.04 -high_dm_plex_box_faces 11,5 -high_density 2000 -high_youngs_modulus 3e9
    -low_initial_displacement 0.001*x,-0.001*y -high_initial_displacement 0.002*x*x,-0.001*y-0.02*(y-0.02)*(0.04-y)
    -low_boundary_displacement ymin -low_boundary_displacement_ymin 0,0"""


@pytest.mark.parametrize(("law", "ranks"), [("frictionless", 3), ("tied", 1)])
def test_surfaces_that_do_not_match(law, ranks, shared_run):
    """Part of the rows is closed at the start, or all are tied. What contact takes in the first step is what it takes in the second."""
    run = shared_run(f"{BLOCKS} -contact_law {law} -high_mass_redistribute true -low_mass_redistribute true", ranks)
    pair = run.history["contact/high.ymin:low.ymax"]
    assert 0 < pair["active"][0] <= 12 and pair["force"][0] > 0
    assert pair["gap"][0] >= -1e-14
    one = shared_run(f"{BLOCKS} -contact_law {law} -high_mass_redistribute true -low_mass_redistribute true")
    np.testing.assert_allclose(pair["force"][:], one.history["contact/high.ymin:low.ymax/force"][:], rtol=1e-8)
    if law == "tied":
        assert worst(run) <= 1e-12
    else:
        assert abs(energies(run)[1] / energies(run)[0] - 1) <= 1e-4


def test_what_it_saves(shared_run):
    """The same from the displacements as they are loses energy in its first step."""
    options = f"{BLOCKS} -contact_law tied -high_mass_redistribute true -low_mass_redistribute true -contact_balanced_start false"
    energy = energies(shared_run(options))
    assert energy[1] / energy[0] - 1 < -1e-3
    assert shared_run(options).history["contact/high.ymin:low.ymax/force"][0] == 0


@pytest.mark.parametrize("kind", ["", "-low_ts_type centraldifference -high_ts_type centraldifference"])
def test_nonlinear_bodies(kind, shared_run):
    """Newton's method finds the balance: the force of the first record is what the steps after it go on from."""
    run = shared_run(f"{BLOCKS} -contact_law tied -time_step 2e-7 -time_end 4e-6 -low_material_type neo_hookean -high_material_type neo_hookean -high_mass_redistribute true -low_mass_redistribute true {kind}")
    force = run.history["contact/high.ymin:low.ymax/force_vector"][:, 1]
    assert abs(force[0] - 2 * force[1] + force[2]) <= 5e-3 * abs(force[0])
    assert worst(run) <= 1e-6


def test_placing_a_body_changes_nothing(shared_run):
    """A displacement of the body as a whole strains nothing: bits are those of a start that is left alone."""
    options = "-options_file options/blocks.opts -left_initial_displacement 1e-5,0 -time_end 1e-5"
    runs = [shared_run(f"{options} -contact_balanced_start {word}") for word in ("true", "false")]
    assert np.array_equal(runs[0].history["body/left/kinetic"][:], runs[1].history["body/left/kinetic"][:])
    assert np.array_equal(runs[0].history["body/left/potential"][:], runs[1].history["body/left/potential"][:])
