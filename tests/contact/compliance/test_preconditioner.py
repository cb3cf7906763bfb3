"""Implicit bodies with more contact rows than dense matrices are made for: conjugate gradients, preconditioned by what the Dirichlet sides answer with."""

import pytest
from cases import same
from setups import box, material

ITERATIVE = "-schwarz_dense_limit 0"
UNLIKE = {"alike": (1, 1), "soft on stiff": (1, 50), "stiff on soft": (50, 1)}


def plates(moduli=(1, 1), more=""):
    """Two plates that meet with 100 and 64 nodes, at a step in which waves cross about three elements."""
    parts = [
        box("a", (9, 9, 4), (0, 0, 0), (1, 1, 0.4), "-a_initial_velocity 0,0,-0.01"),
        material("a", e=moduli[0]),
        box("b", (7, 7, 4), (0, 0, -0.5), (1, 1, 0), ""),
        material("b", e=moduli[1]),
    ]
    return " ".join((*parts, f"-bodies a,b -contact_pairs a:b -time_step {0.3 / max(moduli) ** 0.5} -time_end {1.5 / max(moduli) ** 0.5} -controller_step_cuts 0 {more}"))


def iterations(run):
    return run.summary["schwarz"]["inner_iterations"]


@pytest.mark.parametrize("moduli", UNLIKE.values(), ids=UNLIKE)
def test_preconditioned(moduli, shared_run):
    dense = shared_run(plates(moduli))
    runs = [shared_run(plates(moduli, f"{ITERATIVE} {more}")) for more in ("", "-schwarz_interface_pc_type none")]
    for run in runs:
        same(dense, run, 1e-8, "ab", ("a:b",))  # conjugate gradients leave 1e-9 of a gap, closed by the next sweep
    assert iterations(dense) == 0
    assert iterations(runs[0]) <= 0.7 * iterations(runs[1])  # measured: 60 of 95, 35 of 71, 64 of 103


@pytest.mark.parametrize("n", [2, 3])
def test_on_ranks(n, shared_run):
    """The preconditioner is one of all ranks."""
    first, other = (shared_run(plates(more=ITERATIVE), k) for k in (1, n))
    same(first, other, 1e-8, "ab", ("a:b",))
    assert iterations(other) == iterations(first) == 60  # what preconditions does not hang on ranks


def test_options_are_read(impakt):
    """They are those of a solver that is needed in the time loop only."""
    impakt(plates(more=f"{ITERATIVE} -schwarz_interface_ksp_max_it 500 -time_end 0.3"))
