"""Friction by penalty springs and by the augmented Lagrangian: what the Schwarz method finds, but for what springs give; energy with that in springs."""

import numpy as np
import pytest
from cases import joined, long, worst_energy_error

PULSE = "-options_file options/shear-pulse.opts"
SLOPE = "-options_file options/slope.opts"
BLOCKS = "-options_file options/blocks.opts -left_initial_velocity 100,30 -contact_law coulomb -contact_friction 0.3"
AUGMENTED, PENALTY = (f"-contact_type {name}" for name in ("augmented_lagrangian", "penalty"))
EXPLICIT = "-upper_ts_type centraldifference -lower_ts_type centraldifference"


def drift(run):
    """Least and largest change of all energy, with what springs hold and friction has taken, in parts of the largest."""
    bodies, history = run.history["body"], run.history
    energy = sum(body["kinetic"][()] + body["potential"][()] - body["external_work"][()] for body in bodies.values())
    whole = energy + sum(pair["friction_loss"][()] - pair["obstacle_work"][()] for pair in history["contact"].values())
    if "penalty_energy" in history:
        whole = whole + history["penalty_energy"][()]
    change = (whole - whole[0]) / np.abs(energy).max()
    return change.min(), change.max()


SOFT = "-contact_penalty_scale 1"


@pytest.mark.parametrize(("more", "integrators"), [("", EXPLICIT), (f"-contact_friction 3 {SOFT}", EXPLICIT), *long((SOFT, ""))], ids=["slides", "sticks", "soft"])
def test_energy_of_springs(more, integrators, shared_run):
    """Springs along and across the normals, which stick, slide and swing: measured 3e-15 of the energy."""
    run = shared_run(joined(PULSE, PENALTY, more, integrators))
    low, high = drift(run)
    assert -1e-12 <= low <= high <= 1e-12
    assert run.history["penalty_energy"][()].max() == pytest.approx(run.summary["system"]["penalty_energy_max"], rel=1e-12)
    assert run.summary["contact"]["friction_least"] >= -1e-12
    assert run.summary["schwarz"]["max"] == 2
    if "-contact_friction 3" in more:
        assert run.summary["contact"]["friction_loss"] <= 1e-12  # nothing slides, though springs give


@pytest.mark.parametrize("method", [PENALTY, *long(AUGMENTED)])
def test_slope(method, shared_run):
    """tan 30 is above 0.3: the block slides by g (sin 30 - 0.3 cos 30); and below 0.6: it stays, the springs stretched by its weight."""
    run, reference = (shared_run(joined(SLOPE, each)) for each in (method, ""))
    time, v = run.history["time"][()], run.history["body/block/mean_velocity"][()][:, 0]
    late = time >= 0.06  # gravity has come
    assert np.polyfit(time[late], v[late], 1)[0] == pytest.approx(9.81 * (0.5 - 0.3 * np.cos(np.radians(30))), rel=1e-3)
    assert run.summary["contact"]["friction_loss"] == pytest.approx(reference.summary["contact"]["friction_loss"], rel=1e-4)  # 4e-5 of springs
    still = shared_run(joined(SLOPE, method, "-contact_friction 0.6"))
    v = still.history["body/block/mean_velocity"][()][:, 0]
    assert np.abs(v[time >= 0.15]).max() <= 1e-6  # augmented: 1.8e-7, what its tolerance of 3e-10 m is in a step of 1e-3 s
    if method == PENALTY:
        # its weight across and along the slope, F^2 / 2 k of springs that the pressure loads evenly but for the ends
        stiffness = float(still.stdout.split("penalty parameter of block.ymin:base.ymax ")[1].split()[0]) * 0.4
        weight = 40 * 9.81
        assert still.history["penalty_energy"][-1] == pytest.approx(0.5 * weight**2 / stiffness, rel=0.25)


@pytest.mark.parametrize(
    ("method", "more", "view"),
    [
        (AUGMENTED, "-time_step 1e-4 -controller_step_cuts 0", "augmented until gaps and slips are within"),
        (PENALTY, "-time_step 1e-3 -controller_step_cuts 4", "along the normals and across them"),
    ],
)
def test_long_steps(method, more, view, shared_run):
    """Energy with what springs hold does not grow, at any step."""
    run = shared_run(joined(BLOCKS, method, more))
    assert view in run.stdout
    assert drift(run)[1] <= 1e-3
    energy = sum(body["kinetic"] + body["potential"] for body in run.summary["bodies"].values())
    assert run.summary["contact"]["friction_least"] >= -1e-7 * energy


def test_one_force(shared_run):
    """Sliding blocks: the augmented Lagrangian has the forces of the Schwarz method."""
    pair = "left:right"
    one, other = (shared_run(joined(BLOCKS, more, "-time_end 2e-4")).history[f"contact/{pair}/force_vector"][()] for more in ("", AUGMENTED))
    assert np.abs(other - one).max() <= 1e-3 * np.abs(one).max()


@pytest.mark.parametrize(("method", "ranks"), [(AUGMENTED, 3), *long((PENALTY, 2))])
def test_ranks(method, ranks, shared_run):
    one, more = (shared_run(joined(SLOPE, method, "-time_end 0.1"), n) for n in (1, ranks))
    assert more.summary["contact"]["friction_loss"] == pytest.approx(one.summary["contact"]["friction_loss"], rel=1e-10)
    assert worst_energy_error(more.summary) <= 1e-4


