"""What users get who choose nothing: redistributed averaged mass, the contact step, both bars implicit; and other outer iterations."""

import pytest
from cases import (
    ANDERSON,
    DEFAULTS,
    FRAMES,
    force_scatter,
    joined,
    long,
    never_tensile,
    worst_energy_error,
)


@pytest.mark.parametrize(("snes", "frame"), [("", "as-is"), ("", "moving-inside"), *long(("", "inside"), ("", "moving"), (ANDERSON, "moving-inside"))])
def test_default(snes, frame, shared_run):
    run = shared_run(joined(DEFAULTS, snes, FRAMES[frame]))
    contact, errors, schwarz = (run.summary[key] for key in ("contact", "errors", "schwarz"))
    assert schwarz["mean_contact_steps"] <= 2.2  # S is exact: a pass before the law of rows is solved, one after
    assert schwarz["unconverged_steps"] == 0
    assert force_scatter(run.summary) <= 1.8e-5  # no inertia in the contact layer, so no chatter; measured: 1.34e-5, half the factor on the masses left
    assert worst_energy_error(run.summary) <= 6e-6  # measured: 4.8e-6
    assert errors["kinetic"] <= 1.5e-3  # measured: 1.24e-3, a quarter of what lumped mass gives: averaged mass has fourth-order dispersion
    assert errors["contact_position"] <= 3e-3  # measured: 2.4e-3
    assert abs(errors["release_time"]) <= 2.5e-3  # 12 controller steps, or the way of the wave through one element
    assert contact["onsets"] == 1
    assert contact["max_penetration"] <= 2e-12  # where the outer iteration stops is 1e-12 m
    assert contact["force_peak"] <= 1.4 * contact["force_mean"]  # no spike at first contact; Gibbs' overshoot remains
    assert never_tensile(run)


@pytest.mark.parametrize("frame", ["as-is", "moving-inside", *long("inside", "moving")])
def test_agrees_with_closed_form(frame, shared_run):
    """Force v0 sqrt(E rho) A = 100 N, and impulse 2 m v0 less the momentum that stays in ringing (eqs. 4.3, 4.4)."""
    contact = shared_run(joined(DEFAULTS, FRAMES[frame])).summary["contact"]
    assert contact["force_mean"] == pytest.approx(100, rel=1e-7)  # measured: 3.6e-9
    assert contact["impulse"] == pytest.approx(2 * 2.5e-4 * 100 * (1 - 9.1e-4), rel=1e-4)
