"""Friction on interfaces with more rows than matrices are made for: forces from GMRES, by products with the compliance, against those of LU factors."""

import numpy as np
import pytest
from cases import joined, long, worst_energy_error
from setups import box, material

PRODUCTS, MATRIX = (f"-contact_friction_dense_limit {n}" for n in (0, 100000))
LOWER, UPPER = (f"-{body}_ts_type centraldifference" for body in ("lower", "upper"))
NEO_HOOKEAN = "-lower_material_type neo_hookean -upper_material_type neo_hookean"
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


# A case, what forces and energies differ by at most, in parts of the largest, and the bodies and pair. The solvers leave 10^-12 of a force; bodies that are not
# linear, and those with substeps, whose products are of one substep, are repeated until gaps are told to 4 10^-12 of the size.
CASES = {
    "plates, II": (plates(8, 12), 1e-9),
    "plates, EE": (plates(8, 40, f"{LOWER} {UPPER}"), 1e-9),
    "plates, IE": (plates(8, 20, UPPER), 1e-9),
    "plates, static": (plates(6, 6, "-lower_ts_type static -upper_ts_type static -lower_boundary_displacement xmax -lower_boundary_displacement_xmax 0,0,0", 0.8), 1e-9),
    "plates, penalty": (plates(8, 12, "-contact_type penalty"), 1e-9),
    "plates, neo-Hookean, EE": (plates(8, 40, f"{NEO_HOOKEAN} {LOWER} {UPPER}"), 1e-7),
    "plates, substeps": (plates(8, 20, f"{UPPER} -upper_ts_time_step {0.15 / 8}"), 1e-7),
    "disc": ("-options_file options/oblique-disc.opts", 1e-9),
}


def forces(run):
    (name,) = run.history["contact"]
    return run.history[f"contact/{name}/force_vector"][()]


QUICK = "plates, EE"


@pytest.mark.parametrize("name", [QUICK, *long(*(name for name in CASES if name != QUICK))])
def test_same_forces(name, shared_run):
    case, tolerance = CASES[name]
    matrix, products = (shared_run(joined(case, "-contact_type lagrange", way)) for way in (MATRIX, PRODUCTS))
    if name in ("plates, II", "plates, EE", "plates, IE"):
        assert matrix.summary["schwarz"]["inner_iterations"] == 0 < products.summary["schwarz"]["inner_iterations"]
    reference = forces(matrix)
    np.testing.assert_allclose(forces(products), reference, rtol=0, atol=tolerance * np.abs(reference).max())
    loss, expected = (run.summary["contact"]["friction_loss"] for run in (products, matrix))
    assert loss == pytest.approx(expected, rel=max(10 * tolerance, 1e-8), abs=1e-15)
    assert products.summary["contact"]["friction_residual"] <= 1e-9  # [m]; a run ends with an error at 4e-10 of the size
    assert products.stderr == matrix.stderr


@pytest.mark.parametrize(("ranks", "integrators"), [(3, f"{LOWER} {UPPER}"), *long((2, ""))])
def test_on_ranks(ranks, integrators, shared_run):
    first, other = (shared_run(joined(plates(8, 12, integrators), "-contact_type lagrange", PRODUCTS), n) for n in (1, ranks))
    reference = forces(first)
    np.testing.assert_allclose(forces(other), reference, rtol=0, atol=1e-10 * np.abs(reference).max())


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
