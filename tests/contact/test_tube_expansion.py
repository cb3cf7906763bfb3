"""A tube that is pressed into another one from within: contact pressure under load, and what is left of it, against Lame's and Hill's closed solutions."""

import os
import sys

import numpy as np
import pytest
import tube_expansion
from cases import worst_energy_error
from conftest import ROOT
from impakt_results import read

CASE = "-options_file options/tube-expansion.opts"
SIDES = {"liner first": "", "shell first": "-contact_pairs shell.xmin:liner.xmax"}
COARSE = "-liner_dm_plex_box_faces 15,4 -shell_dm_plex_box_faces 17,6 -time_step 0.2"
PRESSURE = 150e6


def both(run):
    """Tubes, time and contact pressure; the solution's at these times."""
    result = read(run.folder / "history.h5")
    tubes, pressure = tube_expansion.Tubes.of_run(result), tube_expansion.pressures(result, PRESSURE)
    return tubes, result.time, tube_expansion.contact_pressure(result), tube_expansion.expected(tubes, result.time, pressure, PRESSURE)


@pytest.mark.parametrize(("side", "mesh"), [("liner first", ""), ("shell first", COARSE)], ids=["liner first", "shell first"])
def test_expansion(shared_run, side, mesh):
    """At all times to 0.2 % of the largest pressure, and at the end to 1 %: nu = 0.499 instead of 1/2 and strains of 0.1 % are of this order.
    Measured: 0.08 % and 0.46 %, on a mesh twice as fine and in steps from 0.02 to 1 too. The liner flows through, and the clearance is open up to 25 MPa."""
    run = shared_run(f"{CASE} {SIDES[side]} {mesh}".strip())
    tubes, time, found, exact = both(run)
    assert tubes.radius(tubes.loaded(PRESSURE)) == tubes.b
    assert np.abs(found - exact).max() <= 2e-3 * exact.max()
    assert exact[-1] > 15e6
    assert found[-1] == pytest.approx(exact[-1], rel=1e-2)
    assert not found[time * PRESSURE < 20e6].any()
    assert run.summary["bodies"]["liner"]["plastic_work"] > 0
    if not mesh:  # work of the pressure is elastic energy and plastic work, to what steps of first order leave: measured 0.22 % of the work
        assert worst_energy_error(run.summary) <= 2.8e-3


def lame(inner, outer, modulus, ratio):
    """What pressures of 1 Pa inside and outside do to the radius at inner and outer radius [m/Pa], plane strain: S. Timoshenko, J. N. Goodier, Theory of
    elasticity, 3rd ed. (1970), section 28."""

    def widening(r, within, around):
        uniform, inverse = within * inner**2 - around * outer**2, (within - around) * (inner * outer) ** 2
        return (1 + ratio) / modulus / (outer**2 - inner**2) * ((1 - 2 * ratio) * uniform * r + inverse / r)

    return widening


@pytest.mark.parametrize(
    ("side", "unlike"),
    [
        ("liner first", "-liner_youngs_modulus 70e9 -liner_poissons_ratio 0.33 -shell_poissons_ratio 0.3"),
        ("shell first", "-shell_youngs_modulus 1000e9 -liner_poissons_ratio 0.2 -shell_poissons_ratio 0.4"),
    ],
    ids=["liner first", "shell first"],
)
def test_elastic(impakt, side, unlike):
    """No flow, unlike materials: Lame's compound tube with a clearance, to 0.1 %: that much do strains of 0.05 % change radii. Measured: 0.005 % and 0.013 %."""
    run = impakt(f"{CASE} {SIDES[side]} {unlike} -liner_yield_stress 1e9 -time_end 1")
    result = read(run.folder / "history.h5")
    tubes = tube_expansion.Tubes.of_run(result)
    number = result.number
    liner, shell = (lame(*radii, number(f"-{b}_youngs_modulus"), number(f"-{b}_poissons_ratio")) for b, radii in (("liner", (tubes.a, tubes.b)), ("shell", (tubes.inner, tubes.d))))
    clearance = tubes.inner - tubes.b
    exact = (PRESSURE * liner(tubes.b, 1, 0) - clearance) / (shell(tubes.inner, 1, 0) - liner(tubes.b, 0, 1))
    assert tube_expansion.contact_pressure(result)[-1] == pytest.approx(exact, rel=1e-3)
    assert run.summary["bodies"]["liner"]["plastic_work"] == 0


def test_ranks(shared_run):
    """To 1e-6 of the largest pressure: the alternation of the deck ends where forces are steady to that. Measured 4.5e-7."""
    one, more = (both(shared_run(f"{CASE} -time_step 0.2", n))[2] for n in (1, 3))
    assert np.abs(one - more).max() <= 1e-6 * one.max()


@pytest.mark.long
def test_figure(shared_run, launch, tmp_path):
    figure = tmp_path / "figure.png"
    run = launch([sys.executable, ROOT / "plots/tube_expansion.py", shared_run(CASE).folder / "history.h5", figure], env={**os.environ, "MPLBACKEND": "Agg"})
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    run = launch([sys.executable, ROOT / "plots/tube_expansion.py", tmp_path / "nowhere.h5", figure])
    assert run.returncode > 0
    assert "nowhere.h5" in run.stderr
    assert "Traceback" not in run.stderr
