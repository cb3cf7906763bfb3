"""A sharp corner that meets a plate whose nodes have the rows: their gaps are means around the nodes, and do not see it as it is.

A square of 0.2 m stands on its corner 2 mm above the plate, and falls at 10 m/s. Where its faces are at 45 degrees and the corner is above the middle of a face of the
plate, the nodes beside, half a face h away, meet them once the corner is h / 2 deep, and their rows, which are means, a little before. The square's own row for its
corner is closed in time.
"""

import re

import overlap
import pytest
from cases import long
from setups import box, material

GAP, SPEED, STEP, HALF_DIAGONAL = 0.002, 10, 1e-5, 0.1 * 2**0.5
FACES = 53
SQUARE = f"{box('a', (4, 4), (-0.1, -0.1), (0.1, 0.1), '-a_dm_plex_simplex 0')} -a_rotate 45 -a_translate 0,{GAP + HALF_DIAGONAL!r} -a_initial_velocity 0,-{SPEED}"
PLATE = box("b", (FACES, 10), (-0.5, -0.2), (0.5, 0), "-b_dm_plex_simplex 0")
BODIES = " ".join(f"{material(name, e=1e8, rho=1000)} -{name}_ts_type centraldifference" for name in "ab")
CASE = f"-bodies a,b {SQUARE} {PLATE} {BODIES} -contact_facing false -time_step {STEP} -time_end 1.1e-3"


def warned(run):
    """Depth, place and time of the overlap that a run warns of."""
    found = [re.search(r"were (\S+) m inside each other, (\S+) % of an element, at \((.*)\) and (\S+) s", text) for text in run.summary["warnings"]]
    return [(float(match[1]), [float(x) for x in match[3].split(",")], float(match[4])) for match in found if match]


@pytest.mark.parametrize(("pairs", "ranks"), [("auto", 1), ("b:a", 3)])
def test_corner_between_two_nodes(impakt, pairs, ranks):
    """Before the nodes beside it touch, nothing but the flight moves it: the run says how deep it ends."""
    end = 5e-4
    run = impakt(f"{CASE} -contact_pairs {pairs} -time_end {end}", ranks)
    deepest = SPEED * end - GAP
    assert run.summary["contact"]["steps_in_contact"] == 0
    assert run.summary["contact"]["overlap"]["depth"] == pytest.approx(deepest, rel=1e-9)
    assert run.summary["contact"]["overlap"]["part"] == pytest.approx(deepest * FACES, rel=1e-9)
    assert len(warned(run)) == 1
    depth, place, time = warned(run)[0]
    assert depth == pytest.approx(deepest, rel=1e-2)  # three digits are printed
    assert place == pytest.approx([0, -deepest, 0], abs=1e-6)
    assert time == end


def test_deepest_of_a_run(impakt):
    """Of a field frame in the course of the run: by plots/overlap.py."""
    run = impakt(f"{CASE} -contact_pairs b:a -output_fields fields.h5 -output_fields_interval 3 -output_fields_precision double")
    deepest = max(overlap.overlaps(overlap.Bodies(run.folder / "fields.h5")), key=lambda each: each.depth)
    assert run.summary["contact"]["overlap"]["depth"] == pytest.approx(deepest.depth, rel=1e-9)
    assert run.summary["contact"]["overlap"]["time"] == pytest.approx(deepest.time, rel=1e-9)
    assert 0.3 <= run.summary["contact"]["overlap"]["part"] <= 0.5  # measured: 0.375; half a face where the nodes beside it meet the faces
    assert warned(run)[0][2] == pytest.approx(deepest.time, rel=1e-3)


def test_corner_that_has_a_row(impakt):
    run = impakt(f"{CASE} -contact_pairs a:b")
    assert run.summary["contact"]["overlap"]["part"] <= 0.03  # measured: 0.019, as faces beside the corner meet nodes of the plate
    assert not warned(run)
    # the step in which the corner arrives, at the end of which it may just not touch
    assert GAP / SPEED - STEP <= run.summary["contact"]["first_contact_time"] <= GAP / SPEED + 2 * STEP


def test_corner_of_a_cube(impakt):
    """On its corner above the middle of a face of a plate of hexahedra, which has the rows: by the end of the run it is 8 mm deep, and nothing has touched."""
    end = 1e-3
    cube = f"{box('a', (3, 3, 3), (-0.1,) * 3, (0.1,) * 3)} -a_rotate 1,-1,0,54.735610317 -a_translate 0.003,0.002,{GAP + 0.1 * 3**0.5!r} -a_initial_velocity 0,0,-{SPEED}"
    plate = box("b", (17, 17, 3), (-0.3, -0.3, -0.1), (0.3, 0.3, 0))
    run = impakt(f"-bodies a,b {cube} {plate} {BODIES} -contact_facing false -contact_pairs b:a -time_step {STEP} -time_end {end}", 3)
    assert run.summary["contact"]["steps_in_contact"] == 0
    assert run.summary["contact"]["overlap"]["depth"] == pytest.approx(SPEED * end - GAP, rel=1e-6)
    assert len(warned(run)) == 1


@pytest.mark.parametrize("ranks", [1, *long(3)])
def test_edge_on_edge_without_rows(ranks, impakt):
    """Bars that cross with their edges on each other, between nodes of both; none of their faces that meet is in a pair. The edge is h / 2^0.5 from the faces of the other."""
    end, half = 1e-3, 0.1 * 2**0.5
    bars = (
        f"{box('a', (2, 2, 9), (-0.1, -0.1, -0.45), (0.1, 0.1, 0.45))} -a_rotate 0,0,1,45",
        f"{box('b', (2, 9, 2), (-0.1, -0.45, -0.1), (0.1, 0.45, 0.1))} -b_rotate 0,1,0,45 -b_translate {2 * half + GAP!r},0.01,0.02 -b_initial_velocity -{SPEED},0,0",
    )
    run = impakt(f"-bodies a,b {' '.join(bars)} {BODIES} -contact_facing false -contact_pairs a.zmax:b.ymax -time_step {STEP} -time_end {end}", ranks)
    assert run.summary["contact"]["overlap"]["depth"] == pytest.approx((SPEED * end - GAP) / 2**0.5, rel=1e-3)  # of the middle of what is inside
    assert run.summary["contact"]["overlap"]["bodies"] == ["a", "b"]
    assert len(warned(run)) == 1


def test_small_obstacle(impakt):
    """A cylinder below the middle of a face is between two nodes, and they have the rows."""
    end, radius = 5e-4, 0.01
    cylinder = f"-obstacles o -o_obstacle_type cylinder -o_radius {radius} -o_point 0,{-radius},0 -o_axis 0,0,1"
    square = f"{box('a', (5, 5), (-0.1, GAP), (0.1, 0.2 + GAP))} -a_initial_velocity 0,-{SPEED} {material('a', e=1e8, rho=1000)}"
    run = impakt(f"-bodies a {square} {cylinder} -contact_pairs a:o -contact_facing false -time_step {STEP} -time_end {end}", 2)
    assert run.summary["contact"]["overlap"]["depth"] == pytest.approx(SPEED * end - GAP, rel=1e-9)
    assert run.summary["contact"]["overlap"]["bodies"] == ["a", "o"]
    assert len(warned(run)) == 1


def test_flat_bodies_that_bounce_say_nothing(impakt):
    """A square that falls flat on a plate whose faces do not match."""
    flat = SQUARE.replace("-a_rotate 45", "-a_rotate 0").replace(repr(GAP + HALF_DIAGONAL), repr(GAP + 0.1))
    run = impakt(f"{CASE.replace(SQUARE, flat)} -contact_pairs auto -time_end 6e-3")
    assert run.summary["contact"]["steps_in_contact"] > 10
    assert run.summary["contact"]["overlap"]["part"] <= 0.05
    assert not warned(run)
