"""What users get who choose nothing: redistributed averaged mass, newtonls, both bars implicit; and other outer iterations."""

import numpy as np
import pytest
from cases import (
    ANDERSON,
    DEFAULTS,
    FRAMES,
    MOVING,
    UNLIKE,
    force_scatter,
    joined,
    never_tensile,
    worst_energy_error,
)


@pytest.mark.parametrize("frame", list(FRAMES))
@pytest.mark.parametrize("snes", ["newtonls", "anderson"])
def test_default(snes, frame, shared_run):
    run = shared_run(joined(DEFAULTS, ANDERSON if snes == "anderson" else "", FRAMES[frame]))
    contact, errors, schwarz = (run.summary[key] for key in ("contact", "errors", "schwarz"))
    assert schwarz["mean_contact_steps"] <= 2.2  # Newton with the exact compliance: one evaluation before, one after
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


@pytest.mark.parametrize("frame", list(FRAMES))
def test_agrees_with_closed_form(frame, shared_run):
    """Force v0 sqrt(E rho) A = 100 N, and impulse 2 m v0 less the momentum that stays in ringing (eqs. 4.3, 4.4)."""
    contact = shared_run(joined(DEFAULTS, FRAMES[frame])).summary["contact"]
    assert contact["force_mean"] == pytest.approx(100, rel=1e-7)  # measured: 3.6e-9
    assert contact["impulse"] == pytest.approx(2 * 2.5e-4 * 100 * (1 - 9.1e-4), rel=1e-4)


@pytest.mark.parametrize("snes", ["nrichardson -schwarz_snes_linesearch_damping 0.5", "nrichardson -schwarz_relaxation aitken", "ngmres", "qn"])
def test_outer_iterations_agree(snes, shared_run):
    """The outer iteration changes how the solution is found, not the solution. Unlike bars: of equal ones the first guess is the solution already."""
    reference, run = (shared_run(f"{DEFAULTS} {MOVING} {UNLIKE} -schwarz_snes_type {each}") for each in ("newtonls", snes))
    assert run.summary["schwarz"]["unconverged_steps"] == 0
    assert run.summary["schwarz"]["mean_contact_steps"] >= 2
    for key in ("first_contact_time", "release_time", "onsets", "steps_in_contact"):
        assert run.summary["contact"][key] == reference.summary["contact"][key], key
    # each step is converged to 1e-12 m, 8e-8 of the compression of an element by 100 N, and so of the force; measured: PUT
    forces = [each.history["contact/left:right/force"][()] for each in (run, reference)]
    np.testing.assert_allclose(*forces, rtol=0, atol=1e-4)
