"""The golden figures of the report's tables: what our runs gave when they were recorded, with a tolerance for each. Published
values have no part in it.

`make paper` checks all of them on what it has run (this file, which `make test` does not collect);
tests/regression/test_golden.py runs the cheap ones again. In golden.json an experiment has, for each quantity, its value, the
tolerance and the reason for it, which is written out under "reasons". record.py writes the file.
"""

import json
import os
from pathlib import Path

import pytest
from paper.experiments import ROOT, find
from paper.results import Results, figure
from paper.running import Runner

FILE = Path(__file__).resolve().parent / "golden.json"
GOLDEN = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {"figures": {}, "cheap": [], "reasons": {}}


def differences(name, summary):
    """Figures of a summary that are not what they were, as texts."""
    found = []
    for quantity, (value, tolerance, reason) in GOLDEN["figures"][name].items():
        now = figure(summary, quantity)
        if now is None or not abs(now - value) <= tolerance:
            found.append(f"{quantity}: {now!r} instead of {value!r} within {tolerance!r} ({GOLDEN['reasons'][reason]})")
    return found


@pytest.fixture(scope="module")
def results():
    return Results(
        Runner(os.environ.get("IMPAKT", ROOT / "build/impakt"), os.environ.get("PAPER", ROOT / "out/paper") / Path("runs")),
        find(),
    )


@pytest.mark.parametrize("name", list(GOLDEN["figures"]))
def test_golden(name, results):
    assert not differences(name, results[name].summary)


def test_nothing_is_left_out(results):
    """Every experiment has golden figures, and the other way round."""
    assert set(results.experiments) == set(GOLDEN["figures"])
