"""Meshes that do not match, and time steps at whose end the bars just touch."""

import pytest
from cases import (
    DEFAULTS,
    FRAMES,
    LUMPED,
    MOVING,
    PAIRINGS,
    force_scatter,
    joined,
    long,
    never_tensile,
    worst_energy_error,
)


@pytest.mark.parametrize("frame", ["moving-inside", *long("as-is")])
def test_unequal_meshes(frame, shared_run):
    """137 against 73 elements."""
    faces = "-left_dm_plex_box_faces 137 -right_dm_plex_box_faces 73"
    run = shared_run(joined(DEFAULTS, faces, FRAMES[frame]))
    assert run.summary["schwarz"]["mean_contact_steps"] <= 2.5
    assert worst_energy_error(run.summary) <= 2.4e-6  # measured: 1.8e-6
    assert force_scatter(run.summary) <= 8.5e-5  # measured: 6.5e-5, half the factor on the masses of 73 elements
    assert run.summary["contact"]["onsets"] == 1
    assert {name: body["dofs"] for name, body in run.summary["bodies"].items()} == {"left": 138, "right": 74}
    assert never_tensile(run)


@pytest.mark.parametrize(
    "options",
    [DEFAULTS, f"{DEFAULTS} {MOVING}", f"{LUMPED} {PAIRINGS['EE']}", f"{LUMPED} -right_ts_type centraldifference -right_ts_time_step 1e-7"],
    ids=["newtonls", "moving", "EE", "IE"],
)
def test_touching_at_the_end_of_a_step(options, shared_run):
    """With 1e-6 s the gap is exactly 0 at t = 0; the active set must not alternate."""
    run = shared_run(f"{options} -time_step 1e-6")
    assert run.summary["contact"]["onsets"] == 1
    assert worst_energy_error(run.summary) <= 1.8e-4  # measured: 1.35e-4
    assert run.summary["schwarz"]["unconverged_steps"] == 0
    assert abs(run.summary["contact"]["first_contact_time"]) <= 1e-6 * (1 + 1e-9)
    assert never_tensile(run)
