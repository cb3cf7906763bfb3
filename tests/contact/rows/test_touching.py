"""Discs whose poles just touch at the start. The dual mortar gap of the pole is a little below zero there, by what the partner's nodes lie behind its vertex;
the row of the pole was dropped for that, so that discs of 64 edges touched 5e-5 s late, and discs of 16 edges went through each other."""

import pytest
from cases import joined

TOUCH = (
    "-options_file options/discs.opts -a_ball_centre -0.01,0 -b_ball_centre 0.01,0 -a_initial_velocity 1,0 -b_initial_velocity -1,0 "
    "-a_ball_keep_volume false -b_ball_keep_volume false -time_end 3e-5"
)


@pytest.mark.parametrize(("divisions", "pair"), [((16, 12), "b:a"), ((16, 16), "a:b"), ((4, 4), "b:a")])
def test_poles(divisions, pair, shared_run):
    """Contact from the first step on, and no blow: energy measured to 1e-5 (5.9e-6), which is what contact costs in a whole collision."""
    a, b = divisions
    run = shared_run(f"{TOUCH} -a_ball_divisions {a} -b_ball_divisions {b} -contact_pairs {pair}")
    system = run.summary["system"]
    assert run.summary["contact"]["onset_time"] == 0
    assert run.summary["contact"]["onsets"] == 1
    assert -2e-5 <= system["energy_error_min"] <= system["energy_error_max"] <= 2e-5


def test_overlap_is_refused(impakt):
    """A tenth of a face deep is no touch. Nodes that lie outside the radius are named, where that is what overlaps: moved to it they only touch."""
    assert "overlap by" in impakt(f"{TOUCH} -b_ball_centre 0.0099,0", expect_failure=True).stderr
    kept = [f"-{body}_ball_keep_volume" for body in "ab"]
    coarse = f"{TOUCH} -a_ball_divisions 4 -b_ball_divisions 4 -contact_pairs b:a"
    refused = impakt(joined(coarse, " ".join(f"{option} true" for option in kept)), expect_failure=True).stderr
    assert all(f"nodes of '{body}' lie outside its radius" in refused and f"with {option} false they lie at it" in refused for body, option in zip("ab", kept, strict=True))
    assert "outside" not in impakt(f"{TOUCH} -b_ball_centre 0.0099,0", expect_failure=True).stderr
    floor = "-obstacles floor -floor_obstacle_type plane -floor_point 0,-0.01 -floor_normal 0,1 -contact_pairs b:floor"
    assert "with -b_ball_keep_volume false they lie at it" in impakt(joined(coarse, f"-bodies b {floor} -b_ball_keep_volume true"), expect_failure=True).stderr
