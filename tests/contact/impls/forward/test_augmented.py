"""The augmented Lagrangian at high speed: the penalty parameter is a matter of cost alone."""

import pytest
from cases import (
    DEFAULTS,
    PAIRINGS,
    force_scatter,
    joined,
    long,
    never_tensile,
    worst_energy_error,
)

AUGMENTED = f"{DEFAULTS} -contact_type augmented_lagrangian"
NAME = "contact/left:right/force"


@pytest.mark.parametrize("integrators", ["", *long(PAIRINGS["EE"])], ids=["II", "EE"])
def test_stiff(integrators, shared_run):
    """tau W = 1e9 N/m times 2.5e-6 m/N: each round makes the gap 2500 times smaller."""
    run = shared_run(joined(AUGMENTED, "-contact_penalty 1e9", integrators))
    assert run.summary["schwarz"]["max"] == 2  # rounds solve the law of rows again, and advance no body
    assert run.summary["contact"]["onsets"] == 1
    assert run.summary["contact"]["max_penetration"] <= 1e-10  # -contact_augmentation_tolerance
    assert force_scatter(run.summary) <= 1.8e-5  # measured: 1.34e-5, half the factor on the masses left
    assert worst_energy_error(run.summary) <= 4e-6
    assert run.summary["errors"]["kinetic"] <= 1.3e-3
    assert run.summary["system"]["penalty_energy_max"] == 0
    assert never_tensile(run)


@pytest.mark.parametrize("penalty", ["7.5e4", *long("1e12")])
def test_any_penalty(penalty, shared_run):
    """The same forces with the paper's parameter, whose rounds were 70 if springs stayed as soft, and with one that is far too stiff for
    the penalty method; within the tolerance of 1e-10 m over a compliance of 2.5e-6 m/N, times two for both runs."""
    run = shared_run(f"{AUGMENTED} -contact_penalty {penalty}")
    stiff = shared_run(f"{AUGMENTED} -contact_penalty 1e9")
    assert run.summary["schwarz"]["max"] == 2
    assert abs(run.history[NAME][()] - stiff.history[NAME][()]).max() <= 1e-4
    assert run.summary["contact"]["max_penetration"] <= 1e-10


@pytest.mark.long
def test_tolerance(shared_run):
    """With 1e-14 m it is the Lagrange multiplier, to 1e-9 of the force. A node out of contact may lie as deep as does not count as
    penetration, 3e-12 of the extent of 0.27 m."""
    run = shared_run(f"{AUGMENTED} -contact_penalty 1e9 -contact_augmentation_tolerance 1e-14")
    lagrange = shared_run(f"{DEFAULTS} -contact_type lagrange")
    assert run.summary["contact"]["max_penetration"] <= 3e-12 * 0.27
    assert abs(run.history[NAME][()] - lagrange.history[NAME][()]).max() <= 3e-8  # measured: 8.6e-9


def test_unconverged(impakt):
    """With mass on the contact nodes a hundredth of the paper's parameter is far too soft: tau W = 6e-6 (W = dt^2/4 over half of 6.25e-7 kg), so that springs which
    are ten times as stiff in each round take five rounds to be as stiff as the bodies."""
    massive = "-left_mass_type lumped -right_mass_type lumped -left_mass_redistribute false -right_mass_redistribute false"
    run = impakt(f"{AUGMENTED} -contact_penalty 7.5e2 {massive} -contact_augmentation_max_it 4 -controller_step_cuts 0", expect_failure=True)
    for words in ("augmented Lagrangian did not converge", "time 1e-07 s", "4 augmentations", "-contact_penalty"):
        assert words in run.stderr
