"""The options files of thin bodies, whose contact nodes keep their mass; and their meshes, which are what the writers of tests/support write."""

import hollows
import numpy as np
import pytest
from cases import joined, validate
from conftest import ROOT
from contactstep import energy
from thinbodies import bracket

SHORT = {"bracket-drop": "-time_end 1e-4", "sheet-stack": "-time_end 2e-5", "tube-crush": "-time_end 3e-4"}


@pytest.mark.parametrize(("deck", "end"), [*SHORT.items(), *validate(*((deck, "") for deck in SHORT))])
def test_deck(deck, end, impakt):
    """Energy, with what friction takes, is not above its start but for the account of explicit bodies, and of what leads the plate (measured: 3e-4)."""
    run = impakt(joined(f"-options_file options/{deck}.opts", end))
    assert run.summary["contact"]["steps_in_contact"] > 10
    assert energy(run).max() <= 1e-3
    assert run.summary["contact"]["friction_loss"] > 0
    if not end and deck == "bracket-drop":
        assert run.summary["contact"]["onsets"] == 2  # one corner, and the next
    if not end and deck == "tube-crush":  # it does not buckle: the force grows to the end
        force = run.history["contact/tube:plate/force"][()]
        assert force[-1] == pytest.approx(force.max(), rel=0.1)


def test_meshes(tmp_path):
    files = {"bracket": bracket(tmp_path / "bracket.msh", 2e-3), "tube": hollows.ring(tmp_path / "tube.msh", 0.0195, 0.0205, 48, 1, 0.02)}
    for name, file in files.items():
        found, kept = (np.array(" ".join(line for line in path.read_text().splitlines() if line[0] != "$").split(), float) for path in (file, ROOT / f"tests/meshes/thin/{name}.msh"))
        np.testing.assert_allclose(found, kept, rtol=0, atol=1e-15)
