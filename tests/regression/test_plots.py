"""plots/impact.py makes a figure of a history, or says why not."""

import os
import sys

import pytest
from cases import DEFAULTS
from conftest import ROOT

pytest_plugins = "shared_runs"

COMMAND = [sys.executable, ROOT / "plots/impact.py"]
FIGURES = {
    "schwarz": DEFAULTS,
    "penalty": "-options_file options/impact-penalty.opts",
    "characteristics": "-options_file options/two-materials.opts",
    "three": "-options_file options/three-bars.opts",
}
ENVIRONMENT = {**os.environ, "MPLBACKEND": "Agg"}


@pytest.mark.parametrize("name", list(FIGURES))
def test_figure(name, shared_run, launch, tmp_path):
    history = shared_run(FIGURES[name]).folder / "history.h5"
    figure = tmp_path / "new/figure.png"
    run = launch([*COMMAND, history, figure], env=ENVIRONMENT)
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert figure.stat().st_size > 10_000


def test_missing_history(launch, tmp_path):
    run = launch([*COMMAND, tmp_path / "nowhere.h5", tmp_path / "figure.png"], env=ENVIRONMENT)
    assert run.returncode > 0
    assert "nowhere.h5" in run.stderr
    assert "Traceback" not in run.stderr
    assert not (tmp_path / "figure.png").exists()


def test_not_a_history(launch, tmp_path):
    (tmp_path / "text.h5").write_text("not HDF5\n")
    run = launch([*COMMAND, tmp_path / "text.h5", tmp_path / "figure.png"], env=ENVIRONMENT)
    assert run.returncode > 0
    assert "text.h5" in run.stderr
    assert "Traceback" not in run.stderr


def test_usage(launch):
    run = launch(COMMAND, env=ENVIRONMENT)
    assert run.returncode > 0
    assert "usage" in run.stderr
