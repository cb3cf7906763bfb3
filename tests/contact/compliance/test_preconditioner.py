"""Implicit bodies with more contact rows than dense matrices are made for: conjugate gradients, preconditioned by what both sides answer with near the surface."""

import re

import pytest
from cases import same
from setups import box, material

ITERATIVE = "-schwarz_dense_limit 0 -schwarz_interface_ksp_converged_reason"


def blocks(modulus, across):
    """Two cubes that meet with 100 and 64 nodes, at a step in which waves cross about three elements of the stiffer one."""
    step = 0.3 / modulus**0.5
    upper = f"{box('a', (9, 9, 9), (0, 0, 0), (1, 1, 1), f'-a_initial_velocity {across},0,-0.01')} {material('a')}"
    lower = f"{box('b', (7, 7, 7), (0, 0, -1), (1, 1, 0))} {material('b', e=modulus)}"
    return f"{upper} {lower} -bodies a,b -contact_pairs a:b -time_step {step} -time_end {5 * step} -controller_step_cuts 0 -contact_type alternation"


# Sliding, for which rows are built again in each step; the upper cube on an edge of the lower one, so that rows join and leave between steps of Newton's method
@pytest.mark.parametrize(("case", "ranks"), [(blocks(50, 0.1), 1), (f"{blocks(1, 0)} -b_rotate 0,1,0,4", 2)], ids=["slides", "tilted"])
def test_preconditioned(case, ranks, shared_run):
    """Forces are those of dense matrices, and conjugate gradients take at most six iterations for a step of Newton's method: without a preconditioner 12 at least."""
    dense, run = shared_run(case), shared_run(f"{case} {ITERATIVE}", ranks)
    same(dense, run, 1e-9, "ab", ("a:b",))
    iterations = [int(n) for n in re.findall(r"Linear schwarz_interface_ solve converged .* iterations (\d+)", run.stdout)]
    assert sum(iterations) == run.summary["schwarz"]["inner_iterations"] > 0
    assert max(iterations) <= 6
