"""A small block of fine elements hits a large one of elements 10 times as long, and makes 10 substeps to each of its steps by itself (options/striker.opts)."""

import numpy as np
import pytest
from cases import long, never_tensile, worst_energy_error

STRIKER = "-options_file options/striker.opts"
COMMON = f"{STRIKER} -time_step 1.6e-7"
ELEMENTS = {"target": 160 * 160, "striker": 40 * 40}


def work(run):
    """Elements that were gone through in all substeps, those of steps made again in halves too."""
    return sum(ELEMENTS[name] * body["substeps"] for name, body in run.summary["bodies"].items())


def test_own_substeps(shared_run):
    """As with one common step, which is 10 times as short. What half the element size changes is 0.7 % of the impulse (1.3524 N s), so that the steps
    do not matter beside the mesh."""
    own, common = shared_run(STRIKER), shared_run(COMMON)
    assert "striker: 3362 degrees of freedom" in own.stdout and "10 substeps of 1.6e-07 s" in own.stdout
    assert "target:striker (sides chosen: fewer substeps first)" in own.stdout
    assert own.summary["contact"]["onsets"] == common.summary["contact"]["onsets"] == 1
    assert never_tensile(own, "target:striker")
    assert own.summary["contact"]["impulse"] == pytest.approx(common.summary["contact"]["impulse"], rel=1.5e-3)  # measured: 6e-4
    assert own.summary["contact"]["separation_time"] == pytest.approx(common.summary["contact"]["separation_time"], abs=1.6e-6)  # a step; measured: 2.8e-7
    for name in ELEMENTS:
        u, v = (np.array(run.history[f"body/{name}/momentum"])[-1, 0] for run in (own, common))
        assert u == pytest.approx(v, abs=2e-3)  # 1.5e-3 of the impulse; measured: 9e-4
    for run in (own, common):
        assert run.summary["system"]["momentum_error_max"] <= 1e-12  # measured: 2e-14
        assert run.summary["system"]["angular_momentum_error_max"] <= 1e-12
    assert worst_energy_error(own.summary) <= 5e-3  # measured: 3.2e-3, at onset and release, which fall within steps
    assert worst_energy_error(common.summary) <= 2e-5  # measured: 5.4e-6
    # 26 of 27 parts of the common steps' work is saved but for the short ones of the small block, which is one part: 27 * 10 / (26 + 10) at best
    assert work(common) / work(own) >= 5  # measured: 5.9


@pytest.mark.parametrize(("step", "sides"), [("auto", ""), *long(("8e-7", "-contact_pairs striker:target"), ("1.9e-6", ""), ("4e-6", "-contact_pairs striker:target"))])
def test_other_steps(step, sides, shared_run):
    """The program's own choice, and steps in between and beyond, with substeps of both: nothing grows, and no momentum is lost."""
    run = shared_run(f"{STRIKER} -time_step {step} {sides}")
    assert run.summary["bodies"]["striker"]["substeps"] > run.summary["bodies"]["target"]["substeps"]
    assert run.summary["system"]["momentum_error_max"] <= 1e-12
    assert run.summary["system"]["energy_error_max"] <= 2e-3
    # from 1.9e-6 s on the first step would gain energy, and others after it, which then begin with as little less force as is needed; measured: 1 to 11
    # of them, 0.4 % of the impulse at most, and 0.82 % of the energy
    assert run.summary["schwarz"]["limited_steps"] <= 12
    assert run.summary["schwarz"]["unlimited_steps"] == 0
    assert worst_energy_error(run.summary) <= 0.01
    assert run.summary["contact"]["impulse"] == pytest.approx(1.361, rel=0.01)
