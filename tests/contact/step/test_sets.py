"""Two sets of bodies in one run, which no pair connects: each has its rule, and meets as in a run of its own."""

import numpy as np
import pytest
from cases import SAME, joined
from contactstep import STEEL, kept_error, sheet_and_block
from messages import check_message
from setups import box, material

END = 2e-4  # s, with three hits of the sheet
CAP = 1e-3  # of the energy, what contact without mass may bring in a run
SQUARES = "-bodies l,r -contact_pairs l:r"
SHEET = "-bodies block,sheet -contact_pairs block:sheet"
BOTH = "-bodies block,sheet,l,r -contact_pairs block:sheet,l:r"


def squares(more=""):
    """1 m from the sheet; 20 mm, 6 x 6 elements, 10 um apart, at 5 m/s each."""
    bodies = [box(n, (6, 6), (x, 0), (x + 0.02, 0.02), f"{material(n, *STEEL)} -{n}_initial_velocity {v},0") for n, x, v in (("l", 1, 5), ("r", 1.02001, -5))]
    return joined(*bodies, more)


# Squares without inertia, pressed on each other by what is led at their far sides
STATIC = squares(
    "-l_ts_type static -r_ts_type static -l_initial_velocity 0,0 -r_initial_velocity 0,0 -l_boundary_displacement xmin -l_boundary_displacement_xmin 0,0 "
    f"-r_boundary_displacement xmax -r_boundary_displacement_xmax {-2e-5 / END:.17g}*t,0"
)


def sheet(bodies=SHEET, more=""):
    return joined(sheet_and_block("II", 0, end=END), bodies, more)


def test_two_rules(shared_run):
    """Impulses are those of runs of their own; measured: 8.5e-3 of the sheet's, since the step in which the squares part is made in sixteenths for all, and 1e-4."""
    both = shared_run(sheet(BOTH, f"{squares()} -contact_view"))
    own = {"block:sheet": shared_run(sheet()), "l:r": shared_run(joined(f"{SQUARES} -contact_type force -time_step 1e-6 -time_end {END}", squares()))}
    assert both.summary["step_control"]["step_cuts"] > 0
    for name, rule in (("block", "impulse"), ("sheet", "impulse"), ("l", "linear"), ("r", "linear")):
        assert f"\n  rule of body '{name}' and what it may touch: {rule}\n" in both.stdout
    assert "  rule as bodies need, tolerance 1e-09 of" in both.stdout
    for pair, run in own.items():
        found, expected = (r.history[f"contact/{pair}/impulse"][-1] for r in (both, run))
        assert np.abs(expected).max() > 1  # N s
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-2 * np.abs(expected).max())
    # the sheet loses energy at its hits, the squares may gain some within the cap
    change, scale = both.history["energy/change"][()], both.history["energy/scale"][()].max()
    assert change.max() <= CAP * scale
    taken = both.history["contact_loss"][()]
    assert np.diff(taken).min() >= -1e-13 * scale and taken[-1] > 0.01 * scale
    of_squares = sum(both.history[f"body/{name}/{kind}"][()] for name in "lr" for kind in ("kinetic", "potential"))
    assert np.abs(of_squares - of_squares[0]).max() <= CAP * scale
    assert kept_error(both, "momentum", "lr") <= 1e-12  # measured 2e-14


def test_two_rules_on_ranks(shared_run):
    one, three = (shared_run(sheet(BOTH, f"{squares()} -contact_view"), ranks) for ranks in (1, 3))
    for pair in ("block:sheet", "l:r"):
        a, b = (run.history[f"contact/{pair}/force_vector"][()] for run in (one, three))
        np.testing.assert_allclose(a, b, rtol=0, atol=SAME * np.abs(a).max())


def test_static_beside_impulse(shared_run):
    """Bodies without inertia make a set of the rule `linear`, beside one with mass on its contact nodes, which meets as in a run of its own to the last digits."""
    run, alone = shared_run(sheet(BOTH, f"{STATIC} -contact_view")), shared_run(sheet())
    for name, rule in (("sheet", "impulse"), ("l", "linear"), ("r", "linear")):
        assert f"\n  rule of body '{name}' and what it may touch: {rule}\n" in run.stdout
    force = run.history["contact/l:r/force"][()]
    assert force[50] == 0 and force[-1] > 1e5  # N; they touch after half of the time
    assert (np.diff(force[101:]) > 0).all()
    a, b = (r.history["contact/block:sheet/force_vector"][()] for r in (run, alone))
    np.testing.assert_allclose(a, b, rtol=0, atol=SAME * np.abs(b).max())


@pytest.mark.parametrize("ranks", [1, 3])
@pytest.mark.parametrize(
    ("options", "words"),
    [
        # one of the static squares meets one with mass
        (f"{STATIC} -r_ts_type alpha2 -r_mass_redistribute false", ["-contact_rule impulse", "'l'", "static", "-l_ts_type alpha2", "-<body>_mass_redistribute true"]),
        # the rule of all sets, for those that have no velocities
        (f"{STATIC} -contact_rule impulse", ["-contact_rule impulse", "'l'", "static", "-l_ts_type alpha2"]),
        # and for those with mass
        (f"{squares()} -contact_rule linear", ["-contact_rule linear", "impulse", "-<body>_mass_redistribute true", "-contact_allow_unstable"]),
    ],
)
def test_refused(options, words, ranks, impakt):
    check_message(impakt(sheet(BOTH, options), ranks, expect_failure=True), words)
