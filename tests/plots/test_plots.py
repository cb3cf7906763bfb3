"""plots/impact.py and plots/history.py make a figure of a history, or say why not."""

import os
import sys

import numpy as np
import pytest
from cases import DEFAULTS, long
from conftest import ROOT
from PIL import Image

COMMAND = [sys.executable, ROOT / "plots/impact.py"]
HISTORY = [sys.executable, ROOT / "plots/history.py"]
FIGURES = {
    "schwarz": DEFAULTS,
    "penalty": "-options_file options/impact-penalty.opts",
    "characteristics": "-options_file options/two-materials.opts",
    "three": "-options_file options/three-bars.opts",
    # held at one end, damped, and without contact
    "held": "-bodies b -b_dm_plex_dim 1 -b_dm_plex_box_faces 20 -b_density 1000 -b_youngs_modulus 1e9 -b_boundary_displacement xmin "
    "-b_boundary_displacement_xmin 0 -b_boundary_traction xmax -b_boundary_traction_xmax 1e6 -b_damping_mass 1000 -time_end 5e-3 -time_step 1e-5",
}
ENVIRONMENT = {**os.environ, "MPLBACKEND": "Agg"}


@pytest.mark.parametrize("name", ["schwarz", "three", *long("penalty", "characteristics")])
def test_figure(name, shared_run, launch, tmp_path):
    history = shared_run(FIGURES[name]).folder / "history.h5"
    figure = tmp_path / "new/figure.png"
    run = launch([*COMMAND, history, figure], env=ENVIRONMENT)
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert figure.stat().st_size > 10_000


@pytest.mark.parametrize("name", ["schwarz", "three", "held", *long("penalty", "characteristics")])
def test_history_figure(name, shared_run, launch, tmp_path):
    """Four panels, in colours of the lines that there must be: of the force, and of the energy's error."""
    history = shared_run(FIGURES[name]).folder / "history.h5"
    figure = tmp_path / "new/figure.png"
    run = launch([*HISTORY, history, figure], env=ENVIRONMENT)
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert run.stdout.strip() == str(figure)
    pixels = np.asarray(Image.open(figure).convert("RGB")).reshape(-1, 3)
    for colour in ((0x00, 0x72, 0xB2), (0x00, 0x9E, 0x73)):
        assert (pixels == colour).all(axis=1).sum() > 300  # a line across a panel 600 pixels wide


@pytest.mark.parametrize("command", [COMMAND, HISTORY], ids=["impact", "history"])
def test_missing_history(command, launch, tmp_path):
    run = launch([*command, tmp_path / "nowhere.h5", tmp_path / "figure.png"], env=ENVIRONMENT)
    assert run.returncode > 0
    assert "nowhere.h5" in run.stderr
    assert "Traceback" not in run.stderr
    assert not (tmp_path / "figure.png").exists()


@pytest.mark.parametrize("command", [COMMAND, HISTORY], ids=["impact", "history"])
def test_not_a_history(command, launch, tmp_path):
    (tmp_path / "text.h5").write_text("not HDF5\n")
    run = launch([*command, tmp_path / "text.h5", tmp_path / "figure.png"], env=ENVIRONMENT)
    assert run.returncode > 0
    assert "text.h5" in run.stderr
    assert "Traceback" not in run.stderr


def test_no_contact(impakt, launch, tmp_path):
    """A run without pairs has no contact to draw."""
    run = impakt("-bodies b -b_dm_plex_dim 1 -b_dm_plex_box_faces 2 -b_density 1 -b_youngs_modulus 1 -time_step 1e-3 -time_end 3e-3")
    drawn = launch([*HISTORY, run.folder / "history.h5", tmp_path / "figure.png"], env=ENVIRONMENT)
    assert drawn.returncode > 0
    assert "not the history of an Impakt run with contact" in drawn.stderr
    assert "Traceback" not in drawn.stderr


@pytest.mark.parametrize("command", [COMMAND, HISTORY], ids=["impact", "history"])
def test_usage(command, launch):
    run = launch(command, env=ENVIRONMENT)
    assert run.returncode > 0
    assert "usage" in run.stderr
