"""Friction on interfaces with many rows."""

import numpy as np
import pytest
from cases import joined, long, worst_energy_error
from setups import box, material

LOWER, UPPER = (f"-{body}_ts_type centraldifference" for body in ("lower", "upper"))
MU, PRESSURE = 0.3, 1e-3


def plates(n, steps, more="", part=2.5):
    """Two plates of n and n - 2 elements along each edge, pressed together by 10^-3 of their modulus; the upper one is pushed from one end by this part of what
    friction bears in all, and slides from there on."""
    h = 1 / n
    step = (0.3 if "centraldifference" in more else 1) * h
    push = part * MU * PRESSURE / (3 * h)
    parts = [
        box("lower", (n - 2, n - 2, 3), (0, 0, -3 * h), (1, 1, 0), "-lower_initial_displacement 0,0,-1e-3*z -lower_boundary_traction zmin -lower_boundary_traction_zmin 0,0,1e-3"),
        box("upper", (n, n, 3), (0, 0, 0), (1, 1, 3 * h), "-upper_initial_displacement 0,0,-1e-3*z -upper_boundary_traction zmax,xmin -upper_boundary_traction_zmax 0,0,-1e-3"),
        f"-upper_boundary_traction_xmin {push}*min(1,t/{10 * step}),0,0",
        material("lower", nu=0.3),
        material("upper", nu=0.3),
        "-bodies lower,upper -contact_pairs upper.zmin:lower.zmax -contact_law coulomb",
        f"-contact_friction {MU} -time_step {step} -time_end {steps * step}",
    ]
    return joined(*parts, more)


@pytest.mark.parametrize(("ranks", "integrators"), [(3, f"{LOWER} {UPPER}"), *long((2, ""))])
def test_on_ranks(ranks, integrators, shared_run):
    first, other = (shared_run(plates(8, 12, integrators), n) for n in (1, ranks))
    reference, on_ranks = (next(iter(run.history["contact"].values()))["force_vector"][()] for run in (first, other))
    np.testing.assert_allclose(on_ranks, reference, rtol=0, atol=1e-10 * np.abs(reference).max())


@pytest.mark.long
def test_more_rows_than_a_matrix_has(impakt):
    """4563 rows of explicit plates: they slide from the end that is pushed, and stick beyond; the law holds to round-off, and energy with what friction takes closes."""
    run = impakt(plates(38, 16, f"{LOWER} {UPPER}"))
    contact = run.summary["contact"]
    assert contact["active_max"] == 39 * 39
    assert 39 <= contact["sliding_max"] < 39 * 39
    assert contact["friction_loss"] > 0
    assert contact["friction_residual"] <= 1e-12  # [m], of plates of 1 m
    assert worst_energy_error(run.summary) <= 1e-3
