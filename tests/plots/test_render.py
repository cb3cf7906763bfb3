"""plots/render.py: colours that peaks of a few elements do not spoil, bodies that fill the picture, and the scale beside them."""

import subprocess
import sys

import h5py
import numpy as np
import pytest
from cases import long
from conftest import IMPAKT, ROOT
from PIL import Image

RENDER = [sys.executable, ROOT / "plots/render.py"]
BODIES = {
    "plane": "-b_dm_plex_dim 2 -b_dm_plex_box_faces 30,10 -b_dm_plex_box_upper 3,1",
    "tall": "-b_dm_plex_dim 2 -b_dm_plex_box_faces 10,30 -b_dm_plex_box_upper 1,3",
    "solid": "-b_dm_plex_dim 3 -b_dm_plex_box_faces 20,5,5 -b_dm_plex_box_upper 4,1,1",
}


@pytest.fixture(scope="module")
def fields(tmp_path_factory):
    """Fields of a plate with a von Mises stress that rises from 0 to 1 MPa along x, but for one element of 10 GPa; of others as they are."""
    folder = tmp_path_factory.mktemp("render")
    for name, body in BODIES.items():
        command = f"-bodies b -b_density 1 -b_youngs_modulus 1e6 {body} -time_step 1e-3 -time_end 1e-3 -output_fields {folder}/{name}.h5"
        subprocess.run([IMPAKT, *command.split()], check=True, cwd=folder, capture_output=True, timeout=60)
    with h5py.File(folder / "plane.h5", "r+") as file:
        centres = file["mesh/positions"][()][file["mesh/cells"][()]].mean(axis=1)
        for frame in file["von_mises"]:
            file[f"von_mises/{frame}"][...] = 1e6 * centres[:, 0] / 3
            file[f"von_mises/{frame}"][150] = 1e10
    return folder


def draw(fields, name, tmp_path, *more):
    picture = tmp_path / "picture.png"
    subprocess.run([*RENDER, fields / f"{name}.xdmf", picture, *more], check=True, capture_output=True, timeout=100)
    return np.asarray(Image.open(picture).convert("RGB")).astype(int)


def drawn(pixels):
    """Where there is anything but white, left of the scale and below the title: first and last row and column, as parts of the picture."""
    height, width, _ = pixels.shape
    title = int(0.085 * height)
    ink = (pixels.min(axis=2) < 250)[title:, : int(0.822 * width)]
    rows, columns = np.flatnonzero(ink.any(axis=1)) + title, np.flatnonzero(ink.any(axis=0))
    return rows[0] / height, rows[-1] / height, columns[0] / width, columns[-1] / width


def greens(fields, tmp_path, *words):
    return draw(fields, "plane", tmp_path, "--size", "700x500", *words)[200:330, 30:560, 1]


def test_peak_of_one_element(fields, tmp_path):
    """Colours are spread over the other elements, where they all were dark with the peak as the end of the scale. Viridis begins at (68, 1, 84)
    and ends at (253, 231, 37)."""
    assert np.ptp(np.percentile(greens(fields, tmp_path), (10, 90))) > 100


@pytest.mark.long
def test_percentile(fields, tmp_path):
    assert np.percentile(greens(fields, tmp_path, "--percentile", "100"), 90) < 60


@pytest.mark.parametrize(("name", "size"), [("solid", "700x500"), *long(("plane", "500x700"), ("tall", "700x500"))])
def test_bodies_fill_the_picture(name, size, fields, tmp_path):
    """They reach from one end of their part of the picture to the other, across or upward; nothing lies under the scale."""
    top, bottom, left, right = drawn(draw(fields, name, tmp_path, "--size", size))
    assert max((bottom - top) / 0.89, (right - left) / 0.8) == pytest.approx(1, abs=0.03)
    assert left > 0.01
    assert right < 0.821
    assert bottom < 0.99


@pytest.mark.parametrize("percentile", ["101", *long("0", "x")])
def test_bad_percentile(percentile, fields, tmp_path):
    run = subprocess.run([*RENDER, fields / "plane.xdmf", tmp_path / "p.png", "--percentile", percentile], check=False, capture_output=True, text=True, timeout=60)
    assert run.returncode > 0
    assert "Traceback" not in run.stderr
