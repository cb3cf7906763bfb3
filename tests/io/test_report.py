"""The lines of -monitor_interval and the table that a run ends with."""

import re

import pytest

# A block of 2 m^3 and 2000 kg that falls for 0.1 s: its energy is the work of its weight, 2000 kg x 13^2 m^2/s^4 x t^2 / 2
FALL = (
    "-bodies block -block_dm_plex_dim 3 -block_dm_plex_simplex 0 -block_dm_plex_box_faces 2,1,1 -block_dm_plex_box_upper 2,1,1 -block_density 1000 "
    "-block_youngs_modulus 1e9 -time_end 0.1 -time_step 1e-3"
)
PULLED = (
    "-bodies bar -bar_dm_plex_dim 2 -bar_dm_plex_simplex 0 -bar_dm_plex_box_faces 4,2 -bar_dm_plex_box_upper 2,1 -bar_density 1000 -bar_youngs_modulus 1e9 "
    "-bar_plane_stress -bar_ts_type static -bar_boundary_displacement xmin -bar_boundary_displacement_xmin 0,0 -bar_boundary_traction xmax "
    "-bar_boundary_traction_xmax 1e6,0"
)


def energy_errors(run):
    return [float(text) for text in re.findall(r"^step .*energy error +(\S+)", run.stdout, re.MULTILINE)]


def value(run, name):
    return float(re.search(rf"^ +{re.escape(name)} +(\S+)", run.stdout, re.MULTILINE).group(1))


@pytest.mark.parametrize("start", ["", "-block_initial_velocity 1,0,0"])
def test_monitor_counts_the_work_of_loads(start, impakt):
    """From rest and from 1 m/s: the block gains as much as its weight does work, up to the round-off of 100 steps, and the line says what the summary has."""
    run = impakt(f"{FALL} {start} -block_gravity 3,4,-12 -monitor_interval 50")
    errors = energy_errors(run)
    assert len(errors) == 3
    assert max(map(abs, errors)) <= 1e-11
    assert errors[-1] == pytest.approx(run.summary["system"]["energy_error_final"], rel=1e-3, abs=1e-300)


@pytest.mark.parametrize("step", [0.25, 1])
def test_sudden_load_of_a_static_body(step, impakt):
    """The load that is there from t = 0 on does half of its force times way, as much as the body stores. It did all of it in the first step before, which
    was an error of -33 %."""
    run = impakt(f"{PULLED} -time_end 1 -time_step {step}")
    body = run.summary["bodies"]["bar"]
    assert body["external_work"] == pytest.approx(body["potential"], rel=1e-12)
    assert abs(run.summary["system"]["energy_error_min"]) <= 1e-12
    assert not run.stderr


def test_momenta_in_the_table(impakt):
    """Two blocks that hit each other: both momenta; bars have no angular momentum."""
    run = impakt("-options_file options/blocks.opts -time_end 1e-4")
    assert value(run, "angular momentum error, worst") == pytest.approx(100 * run.summary["system"]["angular_momentum_error_max"], rel=1e-5)
    assert value(run, "momentum error, worst") == pytest.approx(100 * run.summary["system"]["momentum_error_max"], rel=1e-5)
    bars = impakt("-options_file options/impact-high-speed.opts -time_end -1.9e-4")
    assert "angular momentum" not in bars.stdout


def test_tension_and_nodes_of_ties(impakt):
    """A bar of two tied blocks is pulled with 1 MPa x 1 m^2 at rest: the middle node of the three of the interface has half of it. Three nodes with two
    rows each are three nodes."""
    half = "-dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 2,2 -density 1000 -youngs_modulus 1e9 -ts_type static"
    left = f"-prefix_push left_ {half} -dm_plex_box_upper 1,1 -boundary_displacement xmin -boundary_displacement_xmin 0,0 -prefix_pop"
    right = f"-prefix_push right_ {half} -dm_plex_box_lower 1,0 -dm_plex_box_upper 2,1 -boundary_traction xmax -boundary_traction_xmax 1e6,0 -prefix_pop"
    run = impakt(f"-bodies left,right {left} {right} -contact_pairs left.xmax:right.xmin -contact_law tied -time_end 1 -time_step 1")
    assert ", 3 contact nodes" in run.stdout
    pair = run.summary["pairs"]["left.xmax:right.xmin"]
    assert pair["tension_max"] == pytest.approx(5e5, rel=1e-9)  # no shear, by symmetry, at the middle, and nu = 0 elsewhere
    assert value(run, "tension of a node, peak") == pytest.approx(pair["tension_max"], rel=1e-5)
    assert not re.search(r"^ +impulse", run.stdout, re.MULTILINE)  # nothing has inertia
