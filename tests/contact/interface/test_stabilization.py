"""-contact_stabilization at high speed, with mass on the contact nodes."""

import pytest
from cases import (
    DEFAULTS,
    FRAMES,
    force_scatter,
    joined,
    long,
    never_tensile,
    worst_energy_error,
)

MASSIVE = "-left_mass_redistribute false -right_mass_redistribute false"
LUMPED = f"{MASSIVE} -left_mass_type lumped -right_mass_type lumped"
LAGRANGE = f"{DEFAULTS} -contact_type lagrange"


@pytest.mark.parametrize(("mass", "frame"), [(LUMPED, "moving-inside"), *long((MASSIVE, "as-is"))], ids=["lumped", "averaged"])
def test_contact_stabilized(mass, frame, shared_run):
    """No chatter and no energy gained. The velocity of the nodes in contact stays what it was at impact, since the prediction is
    put back without a force: their 1/400 of the mass keeps its energy until release, when it is lost (as much, in the moving frame,
    as 1/400 of the energy of the relative motion). Contact velocities are therefore wrong in contact."""
    run = shared_run(joined(LAGRANGE, mass, "-contact_stabilization contact_stabilized", FRAMES[frame]))
    assert run.summary["contact"]["onsets"] == 1
    assert force_scatter(run.summary) <= 2e-4
    assert run.summary["contact"]["force_peak"] <= 115  # measured: 109
    assert run.summary["system"]["energy_error_max"] <= 5e-9  # measured: 2e-9
    assert -2.6e-3 <= run.summary["system"]["energy_error_final"] <= -1.6e-3
    assert run.summary["contact"]["max_penetration"] <= 1e-12
    assert run.summary["errors"]["contact_velocity"] > 0.5
    assert run.summary["system"]["momentum_error_max"] <= 1e-10
    assert never_tensile(run)


def test_naive_with_both_constraints(shared_run):
    """Velocity update and acceleration zero: nothing is left that could swing. 1/400 of the mass is stopped at once, as with forward
    increments: that much of the energy is lost (of that of the relative motion)."""
    run = shared_run(joined(LAGRANGE, LUMPED, "-contact_constraint both -contact_stabilization naive", FRAMES["moving-inside"]))
    assert run.summary["contact"]["onsets"] == 1
    assert force_scatter(run.summary) <= 2e-4
    assert -2.6e-3 <= run.summary["system"]["energy_error_min"] <= -1.9e-3
    assert run.summary["system"]["energy_error_max"] <= 1e-10
    assert run.summary["system"]["momentum_error_max"] <= 1e-10
    assert never_tensile(run)


def test_naive_for_schwarz(shared_run):
    """The scatter of the contact force, 0.27 without it, falls to a tenth of that or less, and so does the loss of energy."""
    options = "-options_file options/paper/high-speed/ee.opts"
    plain, run = shared_run(options), shared_run(f"{options} -contact_stabilization naive")
    assert force_scatter(plain.summary) > 0.2
    assert force_scatter(run.summary) <= 0.15 * force_scatter(plain.summary)
    assert worst_energy_error(run.summary) <= 0.5 * worst_energy_error(plain.summary)


def test_naive_for_penalty(shared_run):
    """The scatter of the force, a thousandth without it, falls to a millionth; a little energy is gained at release."""
    run = shared_run("-options_file options/impact-penalty.opts -contact_stabilization naive")
    assert force_scatter(run.summary) <= 2e-6  # measured: 1.1e-6
    assert 0 < run.summary["system"]["energy_error_final"] <= 8e-4  # measured: 7.2e-4
    assert run.summary["contact"]["onsets"] == 1
    assert never_tensile(run)
