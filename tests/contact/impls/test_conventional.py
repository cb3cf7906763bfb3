"""The methods that Schwarz is compared with: penalty (implicit and explicit) and Lagrange multipliers, at high speed."""

import pytest
from cases import PAIRINGS, never_tensile, worst_energy_error

PENALTY = "-options_file options/impact-penalty.opts"
LAGRANGE = "-options_file options/impact-lagrange.opts"


@pytest.mark.parametrize("options", [PENALTY, f"{PENALTY} {PAIRINGS['EE']}"], ids=["implicit", "explicit"])
def test_penalty(options, shared_run):
    """tau = 7.5e4 N/m is too soft to be exact, and how much too soft is known."""
    run = shared_run(options)
    errors = run.summary["errors"]
    assert errors["kinetic"] == pytest.approx(0.0256, rel=0.02)
    assert errors["peak_potential"] == pytest.approx(-100**2 / 2 / 7.5e4 / 2.5, rel=0.02)  # the springs hold the rest
    assert errors["release_time"] == pytest.approx(0.0238, rel=0.05)
    assert never_tensile(run)
    assert run.summary["contact"]["onsets"] == 1
    # energy is missing only while the springs hold it; F^2 / (2 tau) of the 2 x 1.25 J
    assert abs(run.summary["system"]["energy_error_final"]) <= 2e-6  # measured: 9.4e-7
    assert run.summary["system"]["penalty_energy_max"] == pytest.approx(100**2 / 2 / 7.5e4, rel=0.01)
    assert run.summary["system"]["energy_error_min"] == pytest.approx(-(100**2) / 2 / 7.5e4 / 2.5, rel=0.01)
    assert run.summary["system"]["momentum_error_max"] <= 1e-11  # opposite forces; measured: 1.5e-12


@pytest.mark.parametrize("integrators", ["implicit", "explicit"])
def test_overclosure_of_penalty(integrators, shared_run):
    """v0 sqrt(E rho) A / tau = 100 N / 7.5e4 N/m on average while the force is constant."""
    run = shared_run(PENALTY if integrators == "implicit" else f"{PENALTY} {PAIRINGS['EE']}")
    time, gap = run.history["time"][()], run.history["contact/left:right/gap"][()]
    assert -gap[(time > 1e-4) & (time < 4e-4)].mean() == pytest.approx(100 / 7.5e4, rel=1e-3)
    assert run.summary["contact"]["max_penetration"] == pytest.approx(100 / 7.5e4, rel=0.01)


def test_lagrange(shared_run):
    """The contact nodes, 1/400 of the mass, are stopped at once: that much of the energy is lost."""
    run = shared_run(LAGRANGE)
    assert run.summary["errors"]["kinetic"] <= 7e-3  # measured: 6.6e-3
    assert run.summary["system"]["energy_error_min"] == pytest.approx(-1 / 400, rel=1e-9)
    assert worst_energy_error(run.summary) == -run.summary["system"]["energy_error_min"]  # none is gained
    assert run.summary["contact"]["max_penetration"] <= 1e-12
    assert never_tensile(run)
    assert run.summary["contact"]["onsets"] == 1
    assert run.summary["system"]["momentum_error_max"] <= 1e-12  # measured: 1e-15
    assert 0 <= run.summary["errors"]["release_time"] <= 5e-3  # measured: 3.8e-3
    assert run.summary["contact"]["force_mean"] == pytest.approx(100, rel=1e-6)  # measured: 1.3e-7
