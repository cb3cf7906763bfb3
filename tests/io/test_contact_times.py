"""When contact begins and ends, told inside controller steps by interpolation, against the closed form of the impact of two bars."""

import re

import numpy as np
import pytest
from cases import DEFAULTS, PAIRINGS, long, validate

ELEMENT = 1.25e-6  # s, the way of a wave through one element: by so much is the end of contact late on this mesh, whatever the step
RELEASE = 5e-4  # s after impact: the way of a wave there and back
# With this velocity the bars meet inside a step, whatever its length: after 0.04 m at 207 m/s
INSIDE = "-left_initial_velocity 107"
ROUND_OFF = 1e-14  # s, of positions of 0.27 m over 20 000 steps, by 200 m/s
IMPACT = -2e-4 + 0.04 / 207


def times(run):
    contact = run.summary["contact"]
    assert {key: value for key, value in contact.items() if key not in ("type", "overlap")} == {key: value for key, value in run.summary["pairs"]["left:right"].items() if key not in ("impulse_vector", "resultant")}
    return contact["onset_time"], contact["separation_time"], contact


@pytest.mark.parametrize("step", [*validate(1e-8), *long(1e-7), 1e-6, 1e-5])
@pytest.mark.parametrize("more", ["", INSIDE], ids=["at its end", "inside a step"])
def test_steps(step, more, shared_run):
    """First contact to round-off: bars that fly freely close the gap at a constant rate. Release within an element's transit and 1.5 steps, as the front of the
    wave that ends it is as wide as elements and steps make it: measured 0.86, 0.91, 2.4 and 9.8 us late at 1e-8, 1e-7, 1e-6 and 1e-5 s, and 13.8 us at
    worst. The ends of steps, which other figures tell, are up to a step off at first contact."""
    impact = IMPACT if more else 0
    onset, separation, contact = times(shared_run(f"{DEFAULTS} {more} -time_step {step}"))
    assert abs(onset - impact) <= ROUND_OFF
    assert contact["first_contact_time"] - step - 1e-15 <= onset <= contact["first_contact_time"]
    assert contact["release_time"] - 1e-15 <= separation <= contact["release_time"] + step + 1e-15
    assert 0 < separation - impact - RELEASE <= ELEMENT + 1.5 * step
    assert not contact["in_contact_at_end"]


@pytest.mark.parametrize("case", ["EE", "IE", "EI"])
def test_pairings(case, shared_run):
    """Explicit bars, and substeps: the same times, within what their other masses make of the wave (0.3 us measured)."""
    step = 1e-7
    onset, separation, _ = times(shared_run(f"{DEFAULTS} {INSIDE} {PAIRINGS[case]}"))
    _, implicit, _ = times(shared_run(f"{DEFAULTS} {INSIDE} -time_step {step}"))
    assert abs(onset - IMPACT) <= ROUND_OFF
    assert abs(separation - implicit) <= 5 * step


@pytest.mark.parametrize("method", ["penalty -contact_penalty 7.5e4", "lagrange", "augmented_lagrangian -contact_penalty 1e9"])
def test_methods(method, shared_run):
    """Penalty springs, too, are pressed from the moment of impact on, and by 4 % of the time in contact longer."""
    onset, separation, _ = times(shared_run(f"{DEFAULTS} {INSIDE} -time_step 1e-6 -contact_type {method}"))
    assert abs(onset - IMPACT) <= ROUND_OFF
    assert 0 < separation - IMPACT - RELEASE <= (0.05 * RELEASE if "penalty 7" in method else ELEMENT + 1.5e-6)


@pytest.mark.parametrize("part", [0, 0.9])
def test_first_step(part, shared_run):
    """No step tells the rate of the gap then, but the velocities at the start do."""
    start = -part * 1e-6
    run = shared_run(f"{DEFAULTS} -left_dm_plex_box_lower {start * 100 - 0.25!r} -left_dm_plex_box_upper {start * 100!r} -right_dm_plex_box_lower {-start * 100!r} -right_dm_plex_box_upper {0.25 - start * 100!r} -time_start 0 -time_step 1e-6 -time_end 1e-5")
    onset, separation, contact = times(run)
    assert abs(onset + start) <= ROUND_OFF
    assert separation is None
    assert contact["in_contact_at_end"]
    assert "still in contact" in run.stdout


def test_contact_that_lasts(shared_run):
    onset, separation, contact = times(shared_run(f"{DEFAULTS} {INSIDE} -time_step 1e-6 -time_end 3e-4"))
    assert abs(onset - IMPACT) <= ROUND_OFF
    assert separation is None
    assert contact["in_contact_at_end"]
    assert contact["release_time"] == pytest.approx(3e-4)  # as before, the end of the last step in contact


def test_pairs(shared_run):
    """Together pairs touch first and part last when one of them does; bars that are not hit yet have no times."""
    summary = shared_run("-options_file options/three-bars.opts -time_step 1e-6 -time_end 2e-4").summary
    assert summary["contact"]["onset_time"] == summary["pairs"]["a:b"]["onset_time"] == pytest.approx(1e-5, abs=1e-15)
    assert summary["pairs"]["b:c"]["onset_time"] is None
    assert not summary["pairs"]["b:c"]["in_contact_at_end"]
    assert summary["contact"]["in_contact_at_end"] and summary["pairs"]["a:b"]["in_contact_at_end"]
    summary = shared_run("-options_file options/three-bars.opts -time_step 1e-6").summary
    assert summary["contact"]["separation_time"] == np.max([pair["separation_time"] for pair in summary["pairs"].values()])


def test_table(shared_run):
    """What the program prints at the end."""
    run = shared_run(f"{DEFAULTS} -time_step 1e-6")
    assert re.search(r"^  first contact +0 s +exact 0$", run.stdout, re.MULTILINE)
    assert re.search(rf"^  release +{run.summary['contact']['separation_time']:.6g} s +exact 0.0005$", run.stdout, re.MULTILINE)


FALL = """-bodies a -a_dm_plex_dim 2 -a_dm_plex_box_faces 4,4 -a_dm_plex_box_lower 0,0.02 -a_dm_plex_box_upper 0.2,0.22 -a_density 1000 -a_youngs_modulus 1e7
    -a_gravity 0,-9.81 -obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1 -contact_pairs a.ymin:floor -time_end 0.09"""


@pytest.mark.parametrize(("step", "more"), [(1e-4, ""), (1e-2, ""), (1e-3, "-a_ts_type centraldifference -a_ts_time_step auto"), (1e-2, "-a_ts_type centraldifference -a_ts_time_step auto")])
def test_fall(step, more, shared_run):
    """A gap that closes ever faster: extrapolated from the step before, it closes late by less than g step^2 / v, v being
    0.63 m/s: measured 0.31 to 0.81 of that. In the longest steps, which are cut, contact of 4 ms begins and ends inside one."""
    summary = shared_run(f"{FALL} -time_step {step} {more}").summary
    exact = np.sqrt(2 * 0.02 / 9.81)
    assert -1e-12 <= summary["contact"]["onset_time"] - exact <= 9.81 * step**2 / (9.81 * exact)
    assert summary["contact"]["first_contact_time"] - step - 1e-12 <= summary["contact"]["onset_time"] <= summary["contact"]["first_contact_time"]
    assert summary["contact"]["onset_time"] < summary["contact"]["separation_time"] <= summary["contact"]["release_time"] + step
    assert summary["contact"]["onsets"] == 1 and not summary["contact"]["in_contact_at_end"]


def test_tied(shared_run):
    """What is tied stays so: no release, and the onset is the start if nothing lies between."""
    left, right = (f"-{b}_dm_plex_dim 1 -{b}_dm_plex_box_lower {low} -{b}_dm_plex_box_upper {low + 1} -{b}_density 1 -{b}_youngs_modulus 1 -{b}_initial_velocity {v}" for b, low, v in (("l", -1, 0.1), ("r", 0, 0)))
    contact = shared_run(f"-bodies l,r -contact_pairs l:r -contact_law tied {left} {right} -time_step 0.01 -time_end 0.1").summary["contact"]
    assert contact["onset_time"] == 0
    assert contact["separation_time"] is None
    assert contact["in_contact_at_end"]
