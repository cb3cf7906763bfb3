"""Lagrange multipliers at the end of the step, at high speed: with massless contact nodes they are the converged Schwarz solution."""

import numpy as np
import pytest
from cases import (
    DEFAULTS,
    FRAMES,
    PAIRINGS,
    force_scatter,
    joined,
    long,
    never_tensile,
    worst_energy_error,
)

LAGRANGE = f"{DEFAULTS} -contact_type lagrange"
UNSTABLE = "-contact_allow_unstable true -contact_energy_cap false -energy_guard 0"
LUMPED = "-left_mass_type lumped -right_mass_type lumped -left_mass_redistribute false -right_mass_redistribute false"
EQUAL_STEPS = {"II": "", "EE": PAIRINGS["EE"], "IE": "-right_ts_type centraldifference"}
SERIES = ["contact/left:right/force", "body/left/contact_position", "body/right/contact_position", "body/left/kinetic", "body/right/potential"]


@pytest.mark.parametrize("pairing", ["II", "IE", *long("EE")])
def test_agrees_with_the_alternation(pairing, shared_run):
    """To 1e-9 of the largest value, the tolerances being 1e-15 m: over a compliance of 2.5e-6 m/N that is 4e-12 of the force of
    100 N in each step, and 5000 steps add to it. Seen: 5e-11."""
    options = joined(EQUAL_STEPS[pairing], FRAMES["moving-inside"])
    schwarz = shared_run(f"{DEFAULTS} {options} -contact_type alternation -schwarz_snes_atol 1e-15")
    lagrange = shared_run(f"{LAGRANGE} {options}")
    assert np.array_equal(schwarz.history["contact/left:right/active"][()], lagrange.history["contact/left:right/active"][()])
    for name in SERIES:
        a, b = schwarz.history[name][()], lagrange.history[name][()]
        assert abs(a - b).max() <= 1e-9 * abs(a).max(), name
    assert lagrange.summary["contact"]["max_penetration"] <= 1e-12
    assert never_tensile(lagrange)


def test_substeps(shared_run):
    """Ten substeps of a massless explicit bar: the force is linear over them, and the gap closed at their end."""
    run = shared_run(joined(LAGRANGE, PAIRINGS["IE"]))
    assert run.summary["contact"]["onsets"] == 1
    assert run.summary["contact"]["max_penetration"] <= 1e-12
    assert force_scatter(run.summary) <= 1.8e-5  # measured: 1.34e-5, half the factor on the masses left
    assert worst_energy_error(run.summary) <= 4e-6  # measured: 2.4e-6
    assert never_tensile(run)


@pytest.mark.long
def test_trapezoidal_rule_chatters(shared_run):
    """With mass on the contact nodes each change of the force by the constraint is undone by the trapezoidal rule in the next step:
    well known, and the reason for redistribution, stabilisation, and the other constraints. The energy comes to be six times what it was."""
    run = shared_run(f"{LAGRANGE} {LUMPED} {UNSTABLE}")
    assert run.summary["contact"]["onsets"] > 50  # measured: 118
    assert max(run.history["energy/change"]) > 2 * sum(run.history[f"body/{b}/kinetic"][0] for b in ("left", "right"))  # measured: 5.0 times
    assert run.summary["contact"]["max_penetration"] <= 1e-12
    assert never_tensile(run)


@pytest.mark.long
def test_three_bars(shared_run):
    """Two pairs with one body in common, on two ranks: the impulses of Schwarz."""
    bars = "-options_file options/three-bars.opts"
    schwarz, lagrange = shared_run(bars).summary, shared_run(f"{bars} -contact_type lagrange", ranks=2).summary
    for pair in ("a:b", "b:c"):
        assert lagrange["pairs"][pair]["onsets"] == 1
        assert lagrange["pairs"][pair]["impulse"] == pytest.approx(schwarz["pairs"][pair]["impulse"], rel=1e-11)  # measured: 4e-13
    assert lagrange["schwarz"]["max"] == 2
    assert abs(lagrange["system"]["energy_error_final"]) <= 4e-6
