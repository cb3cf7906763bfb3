"""Which nodes are tied: those that lie on the partner at the start, by mesh, placement and initial displacement."""

import pytest
from cases import long
from setups import box, material, words

STEPS = "-contact_law tied -time_step 1e-5 -time_end 1e-4"


def cube(name, dim, low, faces=4, shift=None):
    """A bar, square or cube with edges of 1 m; its faces have edges of 1/faces m."""
    sides = (0,) * (dim - 1)
    more = "" if shift is None else f"-{name}_initial_displacement {words((shift, *sides))}"
    return box(name, (faces,) * dim, (low, *sides), (low + 1, *(1,) * (dim - 1)), f"{material(name, 1e9, 0, 1000)} {more}")


def two(dim, gap, shift=None, more=""):
    return f"-bodies a,b -contact_pairs a:b {STEPS} {cube('a', dim, 0)} {cube('b', dim, 1 + gap, shift=shift)} {more}"


# What keeps b from being tied to a, whose faces are 0.25 m: option words, and what the error must name
REFUSED = {
    "gap": (0.1, None, "", ["have a gap to it", "0.1 m", "0.4 of its face", "-contact_tie_distance"]),
    "overlap": (-0.1, None, "", ["overlap", "0.1 m", "0.4 of its face"]),
    "just-beyond": (0.00251, None, "", ["have a gap to it", "0.00251 m", "0.01 of its face"]),
    "far": (0.5, None, "", ["ties nothing", "0.5 m", "2 of its face"]),
    "moved-apart": (0, 0.5, "", ["ties nothing", "0.5 m"]),
    "moved-inside": (0, -0.01, "", ["overlap", "0.01 m"]),
    "wider": (0.1, None, "-contact_tie_distance 0.3", ["have a gap to it", "0.1 m", "now 0.3 of a face"]),
    "beside": (0, None, "-b_initial_displacement 0,5", ["ties nothing", "no node of body 'a' lies opposite"]),
    # the surfaces meet at one end and are 0.8 of a face apart at the other: with gaps of 0.2 and 0.4 of a face the nodes between would be tied or not by chance
    "partly-apart": (0, None, "-b_initial_displacement 0.2*y,0", ["2 of 5 nodes", "have a gap to it", "0.1 m", "0.4 of its face"]),
}


@pytest.mark.parametrize(("case", "dim"), list(zip(REFUSED, (1, 2, 3, 1, 2, 3, 2, 2, 2), strict=True)))
def test_refused(case, dim, impakt):
    gap, shift, more, words = REFUSED[case]
    run = impakt(two(dim, gap, shift, more), expect_failure=True)
    for word in ["-contact_pairs a:b", "'a'", *words]:
        assert word in run.stderr, run.stderr


def test_distance_out_of_range(impakt):
    run = impakt(two(2, 0, more="-contact_tie_distance 0"), expect_failure=True)
    assert "-contact_tie_distance" in run.stderr and "positive" in run.stderr


# Within the tie distance, or moved there: mesh gap, initial displacement, options
TIED = {
    "touching": (0, None, ""),
    "within": (0.002, None, ""),
    "overlaps-within": (-0.002, None, ""),
    "moved-there": (0.5, -0.5, ""),
    "pushed-out": (-0.5, 0.5, ""),
    "wide": (0.1, None, "-contact_tie_distance 0.5"),
}


@pytest.mark.parametrize(("case", "dim"), list(zip(TIED, (1, 2, 3, 3, 1, 2), strict=True)))
def test_stays_as_it_lies(case, dim, shared_run):
    """Two bodies at rest stay at rest: a tie holds the gap that there is, it does not close it."""
    gap, shift, more = TIED[case]
    run = shared_run(two(dim, gap, shift, more))
    assert run.summary["pairs"]["a:b"]["active_max"] == 5 ** (dim - 1)
    # to close a gap of 2 mm would take 1e3 J; a round-off of 1e-16 m on 4e9 N/m has 4e-23 J
    assert max(run.history[f"body/{body}/{energy}"][-1] for body in "ab" for energy in ("kinetic", "potential")) <= 1e-18


def test_ties_where_displacements_put_them(shared_run):
    """The upper half of b comes to lie on the lower half of a: three of five nodes are tied."""
    run = shared_run(two(2, 0, more="-b_initial_displacement 0,-0.5"))
    assert run.summary["pairs"]["a:b"]["active_max"] == 3


CHAIN = f"-bodies a,b,c {STEPS} {cube('a', 2, 0)} {cube('b', 2, 1)}"


def test_all_pairs(shared_run):
    """Of all pairs of a chain the one of its ends ties nothing, which is as it should be."""
    run = shared_run(f"{CHAIN} -contact_pairs auto {cube('c', 2, 2)}")
    assert sorted(pair["active_max"] for pair in run.summary["pairs"].values()) == [0, 5, 5]


def test_all_pairs_left_over(impakt):
    """A body that no pair ties would fly through the others."""
    run = impakt(f"{CHAIN} -contact_pairs auto {cube('c', 2, 2.5)}", expect_failure=True)
    assert "b:c" in run.stderr and "ties nothing" in run.stderr and "0.5 m" in run.stderr


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_many_rows_of_flat_elements(ranks, impakt):
    """321 nodes of an implicit body, in two directions, are tied to an explicit one. Elements are 80 times as long as high, so that the compliance of the rows is
    badly conditioned."""
    lost = {}
    for high in (320, 100):
        body = f"-{{0}}_dm_plex_dim 2 -{{0}}_dm_plex_box_faces 4,{high} -{{0}}_density 1000 -{{0}}_youngs_modulus 1e9 -{{0}}_poissons_ratio 0.3"
        words = ["-bodies a,b -contact_pairs a:b -contact_law tied", *(body.format(name) for name in "ab"), "-a_initial_velocity 10,0 -a_ts_type alpha2"]
        words.append("-b_dm_plex_box_lower 1,0 -b_dm_plex_box_upper 2,1 -b_ts_type centraldifference -time_step 5e-7 -time_end 5e-6")
        run = impakt(" ".join(words), ranks=ranks)
        assert abs(run.summary["system"]["energy_error_max"]) <= 1e-12  # measured: 8e-15
        kinetic = run.history["body/a/kinetic"]
        lost[high] = kinetic[0] - kinetic[-1]
    assert lost[320] == pytest.approx(lost[100], rel=1e-3)  # strips across the tie that move alike, but for their free ends
