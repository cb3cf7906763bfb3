"""Steps that do not converge: the message names the controller step, its time, and the pair or body."""

import pytest
from conftest import ROOT
from messages import check_message

BLOCKS = f"-options_file {ROOT}/options/blocks.opts"
NEVER = {
    "schwarz": ("-schwarz_snes_max_it 0", "left:right"),
    "penalty": ("-contact_type penalty -schwarz_snes_max_it 0", "left:right"),
    "lagrange": ("-contact_type lagrange -schwarz_snes_max_it 0", "left:right"),
    "augmented": ("-contact_type augmented_lagrangian -contact_augmentation_max_it 1", "left:right"),
    "newton": ("-left_material_type neo_hookean -left_snes_max_it 1 -left_snes_rtol 1e-14 -left_snes_atol 1e-30 -left_snes_stol 0", "'left'"),
}


@pytest.mark.parametrize(("method", "cuts"), [("schwarz", 0), *((method, 2) for method in NEVER)])
def test_step_time_and_pair(method, cuts, impakt):
    options, who = NEVER[method]
    run = impakt(f"{BLOCKS} {options} -controller_step_cuts {cuts}", expect_failure=True)
    assert run.returncode > 0
    check_message(run, ["in controller step ", " time ", who, *(["cut in halves 2 times"] if cuts else [])])


def test_pairs_in_contact_of_many(impakt):
    """A row of balls: only those that touch are named."""
    run = impakt(f"-options_file {ROOT}/options/cradle-3.opts -schwarz_snes_max_it 0", expect_failure=True)
    assert run.returncode > 0
    check_message(run, ["in controller step ", "in contact: "])


@pytest.mark.parametrize(("method", "search"), [("-contact_type penalty", "bt"), ("", "nleqerr")])
def test_line_searches_that_want_slopes(impakt, method, search):
    """They multiply with the Jacobian, which is there only to be divided by."""
    run = impakt(f"-options_file {ROOT}/options/impact-high-speed.opts {method} -schwarz_snes_linesearch_type {search}", expect_failure=True)
    check_message(run, [f"snes_linesearch_type {search}", "secant"])
