"""The report of `make bench`, and what it says got slower since another one, from made-up figures."""

import json
import subprocess
import sys

import pytest
from benchreport import relative, verdict
from conftest import IMPAKT, ROOT

PROGRAM = ROOT / "tests/scaling/benchreport.py"


def figure(values, yardstick=(), name="f"):
    return {"name": name, "unit": "s", "values": values, "yardstick": list(yardstick), "beside": "a loop" if yardstick else ""}


def test_relative():
    assert relative(figure([2, 6], [1, 2])) == [2, 3]
    assert relative(figure([2, 6], [4])) == [0.5, 1.5]
    assert relative(figure([2])) is None


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        (figure([1, 1.1]), figure([1.3, 1.2]), "slower"),
        (figure([1, 1.1, 1.6]), figure([1.3, 1.2, 1.25]), "same"),  # repeats overlap
        (figure([1, 1]), figure([1.04, 1.04]), "same"),  # below 5 %
        (figure([1, 1.1]), figure([0.7, 0.8]), "faster"),
        (figure([1, 1], [1, 1]), figure([2, 2], [2, 2]), "same"),  # a machine half as fast
        (figure([1, 1], [1, 1]), figure([1, 1], [0.5, 0.5]), "slower"),
        (figure([0]), figure([1]), "slower"),
    ],
)
def test_verdict(old, new, word):
    assert verdict(old, new)[0] == word


def report(*words):
    return subprocess.run([sys.executable, PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)


def test_report_and_comparison(tmp_path):
    """Three figures in two files make one report; beside an earlier one the slower figure comes first."""
    before, after, first, second = (tmp_path / name for name in ("before", "after", "first.json", "second.json"))
    for out, factor in ((before, 1), (after, 3)):
        out.mkdir()
        first.write_text(json.dumps([figure([5, 5.1], [2.5, 2.5], "kept")]))
        second.write_text(json.dumps([figure([4, 4.2], name="quicker")] if factor > 1 else [figure([9, 9.2], name="quicker")]))
        third = tmp_path / "third.json"
        third.write_text(json.dumps([figure([factor * 2.0, factor * 2.1], [1, 1], "worse")]))
        done = report("--program", IMPAKT, "--out", out, first, second, third)
        assert done.returncode == 0, done.stderr
    text = (before / "report.md").read_text()
    assert "| kept | s | 5.05 [5 5.1] | 2.5 [2.5 2.5] | 2.02 [2 2.04] | a loop |" in text
    assert "processor" in text and "Impakt" in text and (before / "report.png").stat().st_size > 1000
    done = report("--compare", before / "report.json", "--out", after)
    assert done.returncode == 0, done.stderr
    rows = [line.split(" | ") for line in done.stdout.splitlines() if line.startswith(("| slower", "| same", "| faster"))]
    assert [(row[0], row[2]) for row in rows] == [("| slower", "worse"), ("| same", "kept"), ("| faster", "quicker")]
    assert rows[0][1] == "3"
    assert "1 of 3 figures got slower" in done.stdout


def test_wrong_files(tmp_path):
    (tmp_path / "report.json").write_text("{")
    done = report("--compare", tmp_path / "report.json", "--out", tmp_path)
    assert done.returncode != 0 and "report.json" in done.stderr and "Traceback" not in done.stderr
    assert "--program" in report("--out", tmp_path).stderr
