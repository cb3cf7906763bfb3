"""A nearly incompressible block pressed between bonded plates, against mixed elements of an independent program, and that program against theory."""

import numpy as np
import pytest
from cases import long, worst_energy_error
from impakt_results import read
from rubber_block import Block

CASE = "-options_file options/rubber-block.opts"
E, NU = 3e6, 0.4999
MODULI = {"mu": E / 2 / (1 + NU), "kappa": E / 3 / (1 - 2 * NU)}
# Force on the quarter [N/m] by the mixed elements: 8704.95, 8699.01, 8695.55, 8691.35 on 8 x 4, 12 x 6, 16 x 8 and 24 x 12 equal ones, and 8687.1 on 16 x 8 that are
# finer (power 1.5) at the free corner of the bond, where stress is singular. The second is what the first come to, errors being in proportion to element size, to 0.1 %
REFERENCE = 8687.1


def force(run):
    return -read(run.folder / "history.h5").reactions["rubber.ymax"]["force"][-1][1]


def test_mixed_elements():
    """The reference on a mesh of a quarter of a second, against its finest: 0.25 %, measured 0.20 %."""
    assert -Block(8, 4, **MODULI).pressed(0.05) == pytest.approx(REFERENCE, rel=2.5e-3)


@pytest.mark.parametrize(("width", "bound"), [(10, 0.025), (20, 0.015)])
def test_thin_layer(width, bound):
    """Thin bonded layers: apparent modulus 4 mu (1 + S^2), S = width / height of the quarter over 2 (A. N. Gent, P. B. Lindley, The compression of bonded rubber blocks,
    1959), which has no regard to the layer of the height of the block at the free edge: measured -2.3 % and -1.1 %, in proportion to height over width."""
    found = -Block(20, 4, width=float(width), height=1.0, mu=1.0, kappa=1e7).pressed(1e-4, steps=1)
    assert found == pytest.approx(1e-4 * width * 4 * (1 + (width / 2) ** 2), rel=bound)


@pytest.mark.long
def test_converges(shared_run):
    """Three meshes, extrapolated (Aitken): 0.3 % from the reference, of which 0.1 % is the reference's; measured 0.17 %. Errors fall in proportion to the size of
    elements (order 1.1), since the corner is singular."""
    forces = [force(shared_run(f"{CASE} -rubber_dm_plex_box_faces {2 * n},{n}")) for n in (4, 8, 16)]
    first, second = -np.diff(forces)
    assert 1.8 < first / second < 2.5
    assert forces[-1] - second / (first / second - 1) == pytest.approx(REFERENCE, rel=3e-3)


@pytest.mark.long
def test_force(impakt):
    """1 % on the mesh of the options file; measured 0.72 %. Work of the plate is the energy of the rubber to what ten trapezoids leave (measured 2.9e-4)."""
    run = impakt(CASE)
    assert force(run) == pytest.approx(REFERENCE, rel=1e-2)
    assert worst_energy_error(run.summary) <= 4e-4


def test_mooney_rivlin(shared_run):
    """Plane strain makes I1 and I2 alike where nothing changes its volume: the share of the second constant does not matter. Measured: 6e-4, from the changes of volume within elements."""
    coarse = f"{CASE} -rubber_dm_plex_box_faces 16,8"
    assert force(shared_run(f"{coarse} -rubber_mooney_rivlin_share 0.3")) == pytest.approx(force(shared_run(coarse)), rel=1e-3)


@pytest.mark.parametrize("step", [0.5, *long(0.2)])
def test_large_steps(shared_run, step):
    """What the plate does is carried into the block before Newton's method begins: steps of 0.1 and 0.25 mm, 40 % of an element's height, go through whole and end where
    ten of 0.05 mm do. With the plate's nodes alone moved, those of 0.1 mm failed."""
    case = f"{CASE} -rubber_dm_plex_box_faces 32,16 -controller_step_cuts 0"
    assert force(shared_run(f"{case} -time_step {step}")) == pytest.approx(force(shared_run(case)), rel=1e-9)


def test_locking(impakt):
    """Full integration is told to lock, and is 3.6 times as stiff on 16 x 8 elements."""
    run = impakt(f"{CASE} -rubber_dm_plex_box_faces 16,8 -rubber_element_formulation full")
    assert "fully integrated elements lock" in run.stderr
    assert force(run) > 3 * REFERENCE
