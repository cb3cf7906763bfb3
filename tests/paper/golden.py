"""All golden figures of the report's tables, on what `make paper` has run. pytest does not find this file by itself: `make paper` names it, `make validate`
gives its name as one of `python_files`, since pytest 9 drops a file that is named beside its folder. tests/plots/test_golden.py runs a few again."""

import os
from pathlib import Path

import pytest
from goldenfigures import GOLDEN, differences
from paper.experiments import ROOT, find
from paper.results import Results
from paper.running import Runner

pytestmark = pytest.mark.validate


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
