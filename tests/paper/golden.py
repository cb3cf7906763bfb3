"""All golden figures of the report's tables, on what `make paper` has run. Only `make paper` and `make validate` name this file, which pytest does not
find by itself; tests/plots/test_golden.py runs a few again."""

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
