"""-contact_monitor, and what contact has taken of the energy."""

import re

import numpy as np
import pytest
from contactstep import sheet_and_block

PASS = re.compile(
    r"step that ends at (\S+) s, group of '\w+', pass (\d+): rows off by (\S+) m, \S+ of the way that forces make; (\d+) nodes may touch, (\d+) push \((\d+) stick, (\d+) slide\); "
    r"law solved in (\d+) iterations(?:, node by node too)?(?:; compliance corrected)?"
)
END = re.compile(r"step that ends at (\S+) s: CONVERGED_FNORM_RELATIVE in (\d+) passes; (\d+) rows joined, (\d+) left")
BLOCKS = "-options_file options/blocks.opts -contact_type force -left_mass_redistribute false -right_mass_redistribute false -time_end 1e-4"


@pytest.mark.parametrize("ranks", [1, 3])
def test_lines_and_bits(ranks, impakt):
    """A line for each pass and one at the end of each step, of linear bodies two passes, the second with nothing left; all numbers stay the same to the last bit. What
    contact has taken is what the energy lacks, to the round-off of the energies."""
    with_it, without = impakt(f"{BLOCKS} -contact_monitor", ranks), impakt(BLOCKS, ranks)
    passes, ends = PASS.findall(with_it.stdout), END.findall(with_it.stdout)
    assert ends and len(passes) == sum(int(end[1]) for end in ends)
    assert {int(end[1]) for end in ends} <= {1, 2}
    assert all(float(off) < 1e-15 for _, number, off, *_ in passes if number == "2")
    assert sum(int(end[2]) for end in ends) > 0

    def compare(name, item):
        if hasattr(item, "shape"):
            np.testing.assert_array_equal(item[()], without.history[name][()], err_msg=name)

    with_it.history.visititems(compare)
    loss, change = with_it.summary["contact"]["contact_loss"], with_it.history["energy/change"][-1]
    taken = with_it.history["contact_loss"][()]  # so far; never given back, but for the round-off of the sum
    assert taken[0] == 0 and taken[-1] == loss > 0
    assert np.diff(taken).min() >= -1e-14 * with_it.history["energy/scale"][-1]
    assert loss == pytest.approx(-change, abs=1e-9 * with_it.history["energy/scale"][-1])


def test_into_a_file(impakt):
    run = impakt(f"{BLOCKS} -contact_monitor ascii:passes.txt")
    assert PASS.search((run.folder / "passes.txt").read_text())
    assert not PASS.search(run.stdout)


def test_no_loss_by_the_rule_linear(impakt):
    """Massless contact nodes lose nothing by it, and the history has no such record."""
    assert "contact_loss" not in impakt(f"{BLOCKS} -left_mass_redistribute true -right_mass_redistribute true").history


NUMBER = r"[-+.\de]+"
RUBS = "-contact_law coulomb -contact_friction 0.3 -left_initial_velocity 20,15 -time_end 5e-5"
EXPLICIT = "-left_dm_plex_box_faces 10,70 -right_dm_plex_box_faces 10,60 -left_ts_type centraldifference -right_ts_type centraldifference -time_step 2e-7 -time_end 2e-6"
INFO = {
    "step": (BLOCKS, r"S assembled: dense, \d+ rows of \d+ nodes"),
    "step, sparse": (f"{BLOCKS} {EXPLICIT}", "S assembled: sparse, 71 rows of 71 nodes"),
    "bodies": (BLOCKS, r"\d+ new columns of the compliance of nodes of body 'left', each a solution with its own matrix"),
    "rules, impulse": (BLOCKS, rf"closed rows take {NUMBER} J in the step"),
    "rules, linear": ("-options_file options/stack-static.opts -contact_type force", r"rule linear: rows of \S+ that end inside their partner join"),
    "laws": (f"{BLOCKS} {RUBS}", rf"friction of left\S*:right\S* takes {NUMBER} J in the step"),
    "solve": (f"{sheet_and_block(mu=0.6, step=5e-6, end=2e-4)} -law_snes_max_it 1", r"law of \d+ rows: DIVERGED_MAX_IT after 1 iterations, now 5 sweeps node by node"),
}


@pytest.mark.parametrize("name", INFO)
def test_info(name, impakt):
    options, line = INFO[name]
    run = impakt(f"{options} -info :contact,body,snes")
    assert re.search(line, run.stdout), run.stdout[-2000:]
