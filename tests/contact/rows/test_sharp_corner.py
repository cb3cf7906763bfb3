"""A sharp corner that meets a plate whose nodes have the rows: their gaps are means around the nodes, and do not see it as it is.

A square of 0.2 m stands on its corner 2 mm above the plate, and falls at 10 m/s. Where its faces are at 45 degrees and the corner is above the middle of a face of the
plate, the nodes beside, half a face h away, meet them once the corner is h / 2 deep, and their rows, which are means, a little before. The square's own row for its
corner is closed in time.
"""

import pytest
from setups import box, material

GAP, SPEED, STEP, HALF_DIAGONAL = 0.002, 10, 1e-5, 0.1 * 2**0.5
FACES = 53
SQUARE = f"{box('a', (4, 4), (-0.1, -0.1), (0.1, 0.1), '-a_dm_plex_simplex 0')} -a_rotate 45 -a_translate 0,{GAP + HALF_DIAGONAL!r} -a_initial_velocity 0,-{SPEED}"
PLATE = box("b", (FACES, 10), (-0.5, -0.2), (0.5, 0), "-b_dm_plex_simplex 0")
BODIES = " ".join(f"{material(name, e=1e8, rho=1000)} -{name}_ts_type centraldifference" for name in "ab")
CASE = f"-bodies a,b {SQUARE} {PLATE} {BODIES} -contact_facing false -time_step {STEP} -time_end 1.1e-3"


def warned(run):
    return [text for text in run.summary["warnings"] if "between nodes before any touched" in text]


@pytest.mark.parametrize(("pairs", "ranks"), [("auto", 1), ("b:a", 2)])
def test_corner_between_two_nodes(impakt, pairs, ranks):
    """The run says how deep the corner was inside the plate when the nodes beside it touched, which is how far it had come by then."""
    run = impakt(f"{CASE} -contact_pairs {pairs}", ranks)
    deepest = run.summary["contact"]["overlap_unfelt"]
    travelled = SPEED * (run.summary["contact"]["first_contact_time"] - STEP) - GAP  # until the last step without contact
    assert deepest == pytest.approx(travelled, rel=1e-3)  # nothing else moves before
    assert 0.3 <= deepest * FACES <= 0.5  # of a face of the plate
    assert len(warned(run)) == 1
    assert f"{deepest:.3g} m" in warned(run)[0]


def test_corner_that_has_a_row(impakt):
    run = impakt(f"{CASE} -contact_pairs a:b")
    assert run.summary["contact"]["overlap_unfelt"] <= 1e-12
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
    assert run.summary["contact"]["overlap_unfelt"] == pytest.approx(SPEED * end - GAP, rel=1e-6)
    assert len(warned(run)) == 1


def test_flat_bodies_that_bounce_say_nothing(impakt):
    """A square that falls flat on a plate whose faces do not match."""
    flat = SQUARE.replace("-a_rotate 45", "-a_rotate 0").replace(repr(GAP + HALF_DIAGONAL), repr(GAP + 0.1))
    run = impakt(f"{CASE.replace(SQUARE, flat)} -contact_pairs auto -time_end 6e-3")
    assert run.summary["contact"]["steps_in_contact"] > 10
    assert run.summary["contact"]["overlap_unfelt"] * FACES <= 0.05  # of a face
    assert not warned(run)
