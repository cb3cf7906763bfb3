"""A bar of hexahedra, implicit, against one of tetrahedra of another size, explicit with a step of its own (options/bars-3d.opts)."""

import numpy as np
import pytest
from cases import long, never_tensile, worst_energy_error

BARS = "-options_file options/bars-3d.opts"
# as the options file has it; explicit with four substeps; other pairings
CASES = {"step of its own": "", "substeps": "-right_ts_time_step 2.5e-7", "both explicit": "-left_ts_type centraldifference -left_ts_time_step auto", "both implicit": "-right_ts_type alpha2"}
STEADY = (1e-4, 3.5e-4)  # from the passage of the first waves to before the release [s]


@pytest.mark.parametrize("case", ["step of its own", "both explicit", *long("substeps", "both implicit")])
def test_impact(case, shared_run):
    """No chatter: one onset, no tension, and a force that changes from step to step as waves of the mesh make it, by less than 1 %."""
    run = shared_run(f"{BARS} {CASES[case]}")
    assert run.summary["contact"]["onsets"] == 1
    (pair,) = run.history["contact"]  # named by the sides that were chosen
    assert never_tensile(run, pair)
    assert worst_energy_error(run.summary) <= (4e-5 if case == "substeps" else 1.5e-5)  # measured: 3.1e-5, else 1e-5
    assert run.summary["system"]["momentum_error_max"] <= 1e-12  # measured: 4e-14
    assert run.summary["schwarz"]["mean_contact_steps"] <= 2.5  # measured: 2.0
    time, force = run.history["time"][()], run.history[f"contact/{pair}/force"][()]
    force = force[(time >= STEADY[0]) & (time <= STEADY[1])]
    assert np.abs(np.diff(force)).mean() <= 0.01 * force.mean()  # measured: 8.5e-3, 6.2e-3 with 10 x 10 x 100 elements
    # a plane wave of bars: rho c v A, with the bars' speed of waves; lateral inertia moves it about that by a few per cent
    assert force.mean() == pytest.approx(1000 * (1e9 / 1000) ** 0.5 * 100 * 0.025**2, rel=0.006)  # measured: 0.5 %


@pytest.mark.parametrize("ranks", [2, *long(3)])
def test_ranks(ranks, shared_run):
    one, more = (shared_run(f"{BARS} {CASES['substeps']} -time_end 1e-4", n) for n in (1, ranks))
    np.testing.assert_array_equal(one.history["contact/left:right/active"], more.history["contact/left:right/active"])
    for name in ("contact/left:right/force", "body/left/kinetic", "body/right/potential"):
        values = one.history[name][()]
        np.testing.assert_allclose(more.history[name][()], values, rtol=0, atol=1e-10 * values.max(), err_msg=name)  # measured: 4e-14
