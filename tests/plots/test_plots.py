"""plots/impact.py and plots/history.py make a figure of a history, or say why not. That they are commands is seen in tests/test_readme.py, which runs them."""

import history
import impact
import numpy as np
import pytest
from cases import DEFAULTS, long
from figures import command_line
from PIL import Image

FIGURES = {
    "schwarz": DEFAULTS,
    "penalty": "-options_file options/impact-penalty.opts",
    "characteristics": "-options_file options/two-materials.opts",
    "three": "-options_file options/three-bars.opts",
    # held at one end, damped, and without contact
    "held": "-bodies b -b_dm_plex_dim 1 -b_dm_plex_box_faces 20 -b_density 1000 -b_youngs_modulus 1e9 -b_boundary_displacement xmin "
    "-b_boundary_displacement_xmin 0 -b_boundary_traction xmax -b_boundary_traction_xmax 1e6 -b_damping_mass 1000 -time_end 5e-3 -time_step 1e-5",
}
pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture
def draw(monkeypatch, capsys):
    """draw(program, *words) -> exit code, stdout, stderr of a program of plots/"""

    def run(program, *words):
        monkeypatch.setattr("sys.argv", [f"plots/{program.__name__}.py", *map(str, words)])
        return command_line("history.h5 figure.png", program.draw), *capsys.readouterr()

    return run


@pytest.mark.parametrize("name", ["three", *long("penalty", "characteristics")])
def test_figure(name, shared_run, draw, tmp_path):
    figure = tmp_path / "new/figure.png"
    code, _, told = draw(impact, shared_run(FIGURES[name]).folder / "history.h5", figure)
    assert code == 0 and not told
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert figure.stat().st_size > 10_000


@pytest.mark.parametrize("name", ["schwarz", "held", *long("three", "characteristics")])
def test_history_figure(name, shared_run, draw, tmp_path):
    """Four panels, in colours of the lines that there must be: of the force, and of the energy's error."""
    figure = tmp_path / "new/figure.png"
    code, printed, told = draw(history, shared_run(FIGURES[name]).folder / "history.h5", figure)
    assert code == 0 and not told
    assert printed.strip() == str(figure)
    pixels = np.asarray(Image.open(figure).convert("RGB")).reshape(-1, 3)
    for colour in ((0x00, 0x72, 0xB2), (0x00, 0x9E, 0x73)):
        assert (pixels == colour).all(axis=1).sum() > 300  # a line across a panel 600 pixels wide


@pytest.mark.parametrize("program", [impact, history])
def test_what_cannot_be_drawn(program, shared_run, draw, tmp_path):
    """No file, no HDF5, a run without pairs, which has no contact to draw, and words that are missing."""
    (tmp_path / "text.h5").write_text("not HDF5\n")
    run = shared_run("-bodies b -b_dm_plex_dim 1 -b_dm_plex_box_faces 2 -b_density 1 -b_youngs_modulus 1 -time_step 1e-3 -time_end 3e-3")
    for file, words in (
        (tmp_path / "nowhere.h5", "nowhere.h5"),
        (tmp_path / "text.h5", "text.h5"),
        (run.folder / "history.h5", "not the history of an Impakt run with contact"),
    ):
        code, _, told = draw(program, file, tmp_path / "figure.png")
        assert code > 0 and words in told
        assert not (tmp_path / "figure.png").exists()
    code, _, told = draw(program)
    assert code > 0 and "usage" in told
