"""Bodies in hollows of others, and bodies that interlock: they start, and touch when the way between them is used up; overlaps of the start are the true ones."""

import re

import hollows
import numpy as np
import overlap
import pytest
from cases import long
from setups import FIELDS, box, material

CM = "-{0}_dm_plex_dim 2 -{0}_dm_plex_filename {1}"
SOFT = " ".join(material(name, e=1e8, rho=1000, more=f"-{name}_material_type neo_hookean") for name in "ab")
INNER, EDGES = 0.046, 24
RADIUS = 0.02 * np.sqrt(2 * np.pi / EDGES / np.sin(2 * np.pi / EDGES))  # of the nodes of a polygon with the area of the disc


def inside(run):
    return [text for text in run.summary["warnings"] if "inside each other" in text]


def disc_in_ring(path, centre, more=""):
    """A disc of 24 edges in a ring of 64."""
    hollows.ring(path / "ring.msh", INNER, 0.05, 64, 4)
    disc = f"-b_dm_plex_dim 2 -b_dm_plex_shape ball -b_ball_radius 0.02 -b_ball_divisions 6 -b_ball_centre {centre},0"
    return f"-bodies a,b -contact_facing false {SOFT} {CM.format('a', path / 'ring.msh')} {disc} {more}"


def test_disc_in_ring(tmp_path, impakt):
    """2 m/s over 25.9 mm, until the circles through the nodes touch."""
    run = impakt(disc_in_ring(tmp_path, 0, f"-b_initial_velocity -2,0 -time_step 1e-4 -time_end 0.02 {FIELDS}"))
    contact, system = run.summary["contact"], run.summary["system"]
    assert contact["onset_time"] == pytest.approx((INNER - RADIUS) / 2, rel=0.002)  # measured: 0.0008
    momentum = run.history["body/b/momentum"][:, 0]
    flies = run.history["time"][()] < 0.99 * contact["onset_time"]
    assert momentum[flies] == pytest.approx(momentum[0], rel=1e-12)
    assert run.history["body/a/momentum"][-1, 0] + momentum[-1] == pytest.approx(momentum[0], rel=1e-9)
    assert abs(system["energy_error_final"]) <= 0.005  # of the kinetic energy about the common centre, half of all; measured: 0.0038
    assert contact["overlap"]["part"] <= 0.05
    assert contact["overlap"]["depth"] >= overlap.largest(run.folder / "fields.h5")


@pytest.mark.parametrize("ranks", [1, *long(3)])
def test_disc_that_starts_in_the_wall(ranks, tmp_path, impakt):
    """A node of the disc is 1 mm beyond a node of the ring, from which the edges of the ring lead away."""
    refused = impakt(disc_in_ring(tmp_path, INNER - RADIUS + 0.001, "-time_step 1e-4 -time_end 1e-4"), ranks, expect_failure=True).stderr
    depth, at = re.search(r"overlap by (\S+) m at the start, at \(([^)]*)\)", refused).groups()
    assert float(depth) == pytest.approx(0.001, abs=1e-8)  # six digits are printed, and 12 in the mesh
    assert [float(x) for x in at.split(",")] == pytest.approx([INNER + 0.001, 0, 0], abs=1e-6)


def test_block_that_starts_in_a_block(impakt):
    """Wholly: no face is near a face of the other."""
    refused = impakt(f"-bodies a,b {SOFT} {box('a', (3, 3, 3), (0,) * 3, (1,) * 3)} {box('b', (3, 3, 3), (0.3,) * 3, (0.6,) * 3)} -time_step 1e-4 -time_end 1e-4", expect_failure=True)
    assert "overlap by 0.4 m" in refused.stderr


def comb(teeth, back, tooth, pitch, width, down):
    """`teeth` of height `tooth` and width `width`, `pitch` apart, on a back of height `back`, all in elements."""
    solid = np.zeros((pitch * (teeth - 1) + width, back + tooth), bool)
    solid[:, :back] = True
    for k in range(teeth):
        solid[pitch * k : pitch * k + width] = True
    return solid[:, ::-1] if down else solid


@pytest.mark.parametrize("ranks", [1, *long(3)])
def test_combs(ranks, tmp_path, impakt):
    """Two combs whose teeth are 1 mm apart on all sides: one flies at 1 m/s, and meets the other after 1 ms."""
    hollows.grid(tmp_path / "a.msh", comb(4, 3, 7, 8, 3, False), 1e-3, (0, 0))
    hollows.grid(tmp_path / "b.msh", comb(3, 3, 7, 8, 3, True), 1e-3, (0.004, 0.004))
    bodies = " ".join(CM.format(name, tmp_path / f"{name}.msh") for name in "ab")
    run = impakt(f"-bodies a,b -contact_facing false {SOFT} {bodies} -b_initial_velocity 1,0 -time_step 1e-5 -time_end 1.2e-3 {FIELDS}", ranks)
    assert run.summary["contact"]["onset_time"] == pytest.approx(1e-3, rel=1e-6)
    assert sum(run.history[f"body/{name}/momentum"][-1, 0] for name in "ab") == pytest.approx(run.history["body/b/momentum"][0, 0], rel=1e-9)
    assert abs(run.summary["system"]["energy_error_final"]) <= 0.002  # measured: 0.00105
    assert not inside(run)
    assert run.summary["contact"]["overlap"]["depth"] >= (1 - 1e-12) * overlap.largest(run.folder / "fields.h5")


def walls(n, dim):
    """A cup `n` elements wide: walls of two elements round a hollow that is open at the end of the last axis."""
    solid = np.ones((n,) * dim, bool)
    solid[(slice(2, -2),) * (dim - 1) + (slice(2, None),)] = False
    return solid


def cup(path):
    hollows.grid(path / "a.msh", walls(12, 2), 0.01, (0, 0))
    return box("b", (5, 5), (0.045, 0.05), (0.085, 0.09), "-b_initial_velocity 0,-2"), 0.03 / 2


def cup_in_space(path):
    hollows.grid(path / "a.msh", walls(8, 3), 0.02, (0, 0, 0))
    return box("b", (3, 3, 3), (0.06, 0.06, 0.065), (0.1, 0.1, 0.105), "-b_initial_velocity 0,0,-2"), 0.025 / 2


def tube(path):
    """The block meets one of 32 plane faces of the tube, which is wider."""
    hollows.ring(path / "a.msh", INNER, 0.054, 32, 2, 0.06)
    return box("b", (3, 3, 3), (-0.02, -0.004, 0.02), (0.02, 0.004, 0.04), "-b_initial_velocity 2,0,0 -a_rotate 0,0,1,5.625"), (INNER * np.cos(np.pi / 32) - 0.02) / 2


def gears(path):
    """Teeth in the gaps of the other gear: flanks come closest first, when is found by moving the outlines."""
    outlines = []
    for gear, sign in (("a", 1), ("b", -1)):
        hollows.ring(path / f"{gear}.msh", 0.02, lambda angle, sign=sign: 0.05 + 0.004 * sign * np.cos(16 * angle), 256, 4)
        angle = 2 * np.pi * np.arange(256) / 256
        outlines.append((0.05 + 0.004 * sign * np.cos(16 * angle)) * np.array([np.cos(angle), np.sin(angle)]))
    a, b = outlines[0].T, outlines[1].T + [0.101, 0]
    low, high = 0, 0.002
    for _ in range(30):
        way = (low + high) / 2
        moved = b - [way, 0]
        meets = max(overlap.depths(p, q, np.roll(q, -1, axis=0))[0].max() for p, q in ((a, moved), (moved, a))) > 0
        low, high = (low, way) if meets else (way, high)
    return f"{CM.format('b', path / 'b.msh')} -b_translate 0.101,0 -b_initial_velocity -1,0", low


@pytest.mark.parametrize("hollow", [cup, cup_in_space, gears, *long(tube)])
def test_starts(hollow, tmp_path, impakt):
    bodies, time = hollow(tmp_path)
    bodies = f"{CM.format('a', tmp_path / 'a.msh')} {bodies}"
    bodies = bodies.replace("-a_dm_plex_dim 2", f"-a_dm_plex_dim {3 if hollow in (tube, cup_in_space) else 2}")
    run = impakt(f"-bodies a,b -contact_facing false {SOFT} {bodies} -all_mass_redistribute true -time_step {time / 40} -time_end {1.05 * time}")
    assert run.summary["contact"]["onset_time"] == pytest.approx(time, rel=0.03 if hollow is gears else 1e-6)  # measured: 0.023, as rows are means over flanks that meet at an angle; 0
    assert not inside(run)
