"""Massless contact layers with lumped mass: any pairing of integrators and substeps, without chatter."""

import pytest
from cases import (
    FRAMES,
    LUMPED,
    PAIRINGS,
    force_scatter,
    joined,
    long,
    never_tensile,
    worst_energy_error,
)


@pytest.mark.parametrize(("pairing", "frame"), [("EE", "moving-inside"), ("IE", "as-is"), ("EI", "moving-inside"), ("IE7", "as-is"), *long(("EE", "as-is"), ("IE", "moving-inside"))])
def test_redistributed(pairing, frame, shared_run):
    """The ratio of substeps is that of the time steps asked for, in the sweeps of contact as well."""
    run = shared_run(joined(LUMPED, PAIRINGS[pairing], FRAMES[frame]))
    # one evaluation to start with, one Newton step, and one more for the interior levels of the substeps
    assert run.summary["schwarz"]["mean_contact_steps"] <= 3.2
    assert run.summary["schwarz"]["unconverged_steps"] == 0
    assert force_scatter(run.summary) <= 2.3e-5  # measured: 1.8e-5
    assert worst_energy_error(run.summary) <= 5.3e-6  # measured: 4.1e-6
    assert run.summary["errors"]["kinetic"] <= 6e-3  # dispersion of lumped mass; measured: 5.0e-3
    assert run.summary["contact"]["onsets"] == 1
    assert never_tensile(run)
    left, right = {"EE": (1, 1), "IE": (1, 10), "EI": (10, 1), "IE7": (1, 7)}[pairing]
    bodies = run.summary["bodies"]
    assert bodies["left"]["substeps"] * right == bodies["right"]["substeps"] * left
    assert bodies["left"]["substeps"] >= 10000 * left


