"""Implicit bodies with more contact rows than dense matrices are made for: conjugate gradients, preconditioned by what both sides answer with near the surface."""

import re

import pytest
from cases import same
from setups import box, material

ITERATIVE = "-schwarz_dense_limit 0 -schwarz_interface_ksp_converged_reason"


def blocks(moduli=(1, 1), more="", meshes=(9, 7), step=0.3, pair="a:b", across=0):
    """Two cubes that meet with 100 and 64 nodes, at a step in which waves cross about three elements of the stiffer one."""
    n, m = meshes
    step /= max(moduli) ** 0.5
    parts = [
        box("a", (n, n, n), (0, 0, 0), (1, 1, 1), f"-a_initial_velocity {across},0,-0.01"),
        material("a", e=moduli[0]),
        box("b", (m, m, m), (0, 0, -1), (1, 1, 0), ""),
        material("b", e=moduli[1]),
    ]
    return " ".join((*parts, f"-bodies a,b -contact_pairs {pair} -time_step {step} -time_end {5 * step} -controller_step_cuts 0 {more}"))


# Each with the iterations of its Newton steps, and the most without a preconditioner; the latter go with the iterations, the former hardly with anything
CASES = {
    "alike": ({}, [3, 3, 3, 3, 3]),
    "soft on stiff": ({"moduli": (1, 50)}, [3, 3, 2, 2, 2]),
    "stiff on soft": ({"moduli": (50, 1)}, [3, 3, 3, 3, 3]),
    "sides swapped": ({"pair": "b:a"}, [3, 3, 3, 3, 3]),
    "coarse under fine": ({"meshes": (9, 3)}, [3, 3, 3, 3, 3]),
    "fine under coarse": ({"meshes": (3, 9)}, [3, 3, 3, 3, 3]),
    "tenth of the step": ({"step": 0.03}, [3, 3, 3, 3, 3]),
    "ten times the step": ({"step": 3}, [4, 4]),
    "slides": ({"across": 0.1}, [3, 3, 3, 3, 4]),  # rows are built again in each step
}


def iterations(run):
    counts = [int(n) for n in re.findall(r"Linear schwarz_interface_ solve converged .* iterations (\d+)", run.stdout)]
    assert sum(counts) == run.summary["schwarz"]["inner_iterations"]
    return counts


@pytest.mark.parametrize(("options", "expected"), CASES.values(), ids=CASES)
def test_preconditioned(options, expected, shared_run):
    """Forces are those of dense matrices, and conjugate gradients take at most six iterations for a step of Newton's method, of which there is one in a
    controller step."""
    dense, run = (shared_run(blocks(**options, more=more)) for more in ("", ITERATIVE))
    same(dense, run, 1e-9, "ab", (options.get("pair", "a:b"),))
    assert dense.summary["schwarz"]["inner_iterations"] == 0
    assert iterations(run) == pytest.approx(expected, abs=1)  # round-off may be on either side of the tolerance
    assert max(iterations(run)) <= 6
    assert run.summary["schwarz"]["mean_contact_steps"] == 2


def test_in_part(shared_run):
    """The face of the one body lies on that of the other for a half, and the other half of its nodes has no partner."""
    case = f"{blocks()} -a_translate 0.5,0,0"
    dense, run, plain = (shared_run(f"{case} {more}") for more in ("", ITERATIVE, f"{ITERATIVE} -schwarz_interface_pc_type none"))
    for other in (run, plain):
        same(dense, other, 1e-9, "ab", ("a:b",))
    assert max(iterations(run)) <= 6
    assert min(iterations(plain)) >= 12


@pytest.mark.parametrize("step", [0.3, 1, 5])
def test_tilted(step, shared_run):
    """One cube stands on an edge of the other, so that rows join and leave from one step of Newton's method to the next."""
    case = f"{blocks(step=step)} -b_rotate 0,1,0,4"
    dense, run, other = (shared_run(f"{case} {more}", n) for more, n in (("", 1), (ITERATIVE, 1), (ITERATIVE, 3)))
    same(dense, run, 1e-9, "ab", ("a:b",))
    same(run, other, 1e-9, "ab", ("a:b",))
    assert run.summary["schwarz"]["mean_contact_steps"] > 2
    assert max(iterations(run)) <= 6
    assert iterations(other) == pytest.approx(iterations(run), abs=1)


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("name", ["alike", "slides"])
def test_on_ranks(name, n, shared_run):
    """The preconditioner is one of all ranks."""
    options, _ = CASES[name]
    first, other = (shared_run(blocks(**options, more=ITERATIVE), k) for k in (1, n))
    same(first, other, 1e-9, "ab", ("a:b",))
    assert iterations(other) == iterations(first)


def test_options_are_read(impakt):
    """They are those of a solver that is needed in the time loop only."""
    impakt(blocks(more=f"{ITERATIVE} -schwarz_interface_ksp_max_it 500 -time_end 0.3"))
