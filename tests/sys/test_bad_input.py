"""Bad input: a message that names what and where, an exit code that is not 0, and nothing half-written."""

import math
import os
import re

import pytest
from cases import PAIRINGS, long
from conftest import IMPAKT, ROOT
from messages import check_message

BASE = "-options_file options/impact-high-speed.opts"
PENALTY = "-options_file options/impact-penalty.opts"
EXPLICIT = PAIRINGS["EE"]

# 2 / omega of an inner element of averaged mass: E A / h (1, -1; -1, 1) against rho A h (5, 1; 1, 5) / 12
TOTAL = "-left_mass_moments total -right_mass_moments total"
STABLE_STEP = 2 / math.sqrt(6 * 1e9 / (1000 * 1.25e-3**2))

# What is given, and what must be told of it
CASES = {
    "nothing": ("", ["-bodies"]),
    "options-file": ("-options_file options/nowhere.opts", ["options/nowhere.opts"]),
    "misspelt": (f"{BASE} -schwarz_snes_tpye anderson", ["-schwarz_snes_tpye", "-schwarz_snes_type"]),
    "misspelt-of-body": (f"{BASE} -left_denstiy 3", ["-left_denstiy", "-left_density"]),
    "misspelt-body": (f"{BASE} -lfet_density 3", ["-lfet_density", "-left_density"]),
    "unknown-option": (f"{BASE} -frobnicate", ["-frobnicate", "nearest"]),
    "not-for-this-method": (f"{BASE} -contact_penalty 7.5e4", ["-contact_penalty", "without effect"]),
    "contact-type": (f"{BASE} -contact_type glue", ["-contact_type", "glue", "schwarz", "penalty", "lagrange", "augmented_lagrangian"]),
    "snes-type": (f"{BASE} -schwarz_snes_type guess", ["-schwarz_snes_type", "guess", "nrichardson", "anderson"]),
    "missing-body": (f"{BASE} -bodies left,right,middle -contact_pairs left:right", ["middle", "-bodies", "-middle_dm_plex_"]),
    "body-twice": (f"{BASE} -bodies left,left", ["-bodies", "left", "twice"]),
    "indivisible": (f"{BASE} -left_ts_time_step 3e-8", ["-left_ts_time_step", "3e-08", "-time_step", "1e-07"]),
    "substep-too-long": (f"{BASE} -right_ts_time_step 2e-7", ["-right_ts_time_step", "2e-07", "-time_step", "1e-07"]),
    "unstable": (f"{BASE} {EXPLICIT} -left_ts_time_step 2e-6 -time_step 2e-6", ["left", "2e-06", "stable", "auto"]),
    "unstable-penalty": (f"{PENALTY} {EXPLICIT} -contact_penalty 1e12", ["-contact_penalty", "1e+12", "stiff"]),
    "negative-density": (f"{BASE} -left_density -1000", ["-left_density", "-1000", "positive"]),
    "no-density": ("-bodies a -a_dm_plex_dim 1 -a_youngs_modulus 1", ["-a_density"]),
    "negative-modulus": (f"{BASE} -right_youngs_modulus -1e9", ["-right_youngs_modulus", "-1e+09", "positive"]),
    "no-section": (f"{BASE} -left_cross_section 0", ["-left_cross_section", "positive"]),
    "overlapping": (f"{BASE} -right_dm_plex_box_lower -0.05", ["left", "right", "overlap", "0.03 m", "-left_dm_plex_box_lower", "-right_dm_plex_box_lower"]),
    "overlapping-translated": (f"{BASE} -right_translate -0.05", ["overlap", "-left_dm_plex_box_lower", "-right_translate, -right_initial_displacement"]),
    "overlapping-file": (
        "-options_file options/peer-bars.opts -right_initial_displacement -1e-3,0,0",
        ["overlap", "-left_translate, -left_initial_displacement", "-right_translate, -right_initial_displacement"],
    ),
    "overlapping-ball": (
        "-options_file options/oblique-impact-balls.opts -other_ball_centre 0,0,-2e-3 -ball_ball_divisions 4 -other_ball_divisions 4",
        ["overlap", "-ball_ball_centre, -ball_initial_displacement", "-other_ball_centre, -other_initial_displacement"],
    ),
    "inside-obstacle": ("-options_file options/hertz-impact.opts -ball_ball_centre 0,0,0.9", ["inside the obstacle", "-ball_ball_centre, -ball_initial_displacement"]),
    "displaced-into": (f"{BASE} -left_initial_displacement 0.1", ["left", "right", "overlap", "0.06 m"]),
    "pair-body": (f"{BASE} -contact_pairs left:rihgt", ["-contact_pairs", "rihgt", "left, right"]),
    "pair-surface": (f"{BASE} -contact_pairs left.xmax:right.top", ["right", "top"]),
    "pair-of-one": (f"{BASE} -contact_pairs left", ["-contact_pairs", "left"]),
    "pair-with-itself": (f"{BASE} -contact_pairs left:left", ["-contact_pairs", "itself"]),
    "three-without-pairs": ("-options_file options/three-bars.opts -contact_pairs", ["-contact_pairs"]),
    "penalty-scale": ("-options_file options/bars-high-speed.opts -contact_type penalty -contact_penalty_scale -1", ["-contact_penalty_scale -1", "positive"]),
    "penalty-negative": (f"{PENALTY} -contact_penalty -1", ["-contact_penalty", "positive"]),
    "lagrange-substeps": ("-options_file options/impact-lagrange.opts -left_ts_time_step 1e-8", ["lagrange", "left:right", "-left_mass_redistribute true", "-<body>_ts_time_step"]),
    "augmented-explicit": (
        "-options_file options/impact-lagrange.opts -contact_type augmented_lagrangian -contact_penalty 1e8",
        ["augmented_lagrangian", "left", "right", "-left_mass_redistribute true", "-left_ts_type alpha2"],
    ),
    "augmented-rate": (f"{BASE} -contact_type augmented_lagrangian -contact_constraint gap_rate", ["-contact_constraint gap_rate", "augmented_lagrangian"]),
    "static-unheld": ("-options_file options/blocks.opts -left_ts_type static -contact_pairs none", ["'left'", "static", "-left_boundary_displacement", "contact", "move along x, y and turn about z"]),
    "obstacle-body": (f"{BASE} -obstacles left", ["-obstacles", "'left'", "body"]),
    "both-massless": (f"{BASE} -contact_type lagrange -contact_constraint both", ["-contact_constraint both", "left", "right", "-left_mass_redistribute false"]),
    "damping-missing": (f"{PENALTY} -contact_constraint both", ["-contact_penalty_damping"]),
    "damping-negative": (f"{PENALTY} -contact_constraint both -contact_penalty_damping -1", ["-contact_penalty_damping", "positive"]),
    "damping-unstable": (f"{PENALTY} {EXPLICIT} -contact_constraint both -contact_penalty_damping 10", ["-contact_penalty_damping", "unstable"]),
    "naive-massless": (f"{BASE} -contact_stabilization naive", ["-contact_stabilization naive", "massless", "-<body>_mass_redistribute false"]),
    "stabilized-schwarz": ("-options_file options/paper/high-speed/ii.opts -contact_stabilization contact_stabilized", ["contact_stabilized", "-contact_type lagrange", "alternation"]),
    "stabilized-explicit": ("-options_file options/impact-lagrange.opts -contact_stabilization contact_stabilized", ["contact_stabilized", "explicit", "alpha2"]),
    "time-step": (f"{BASE} -time_step 0", ["-time_step", "positive"]),
    "time-end": (f"{BASE} -time_end -1", ["-time_end", "-time_start"]),
    "components": (f"{BASE} -left_initial_velocity 1,2", ["-left_initial_velocity", "2", "left"]),
}
ON_TWO_RANKS = ["misspelt-of-body", "unstable", "overlapping", "static-unheld"]  # options, a body, a pair, what bodies and contact are together


def check_no_files(run):
    left = sorted(path.name for path in run.folder.iterdir() if not path.is_symlink())
    assert not left


@pytest.mark.parametrize(("case", "ranks"), [*((case, 1) for case in CASES), *((case, 2) for case in ON_TWO_RANKS)])
def test_bad_input(case, ranks, impakt):
    options, words = CASES[case]
    run = impakt(options, ranks, expect_failure=True, timeout=60)
    check_message(run, words)
    check_no_files(run)


def test_stable_step_is_named(impakt):
    """The message gives the limit, and what is just below it is taken; with masses of a mesh alone, which no factor changes by 4e-5.
    Where no substep is given, a controller step just above the limit makes two of it."""
    run = impakt(f"{BASE} {EXPLICIT} {TOTAL} -left_ts_time_step 2e-6 -time_step 2e-6", expect_failure=True)
    check_message(run, ["2e-06 s", "left", "stable step"])
    limit = float(re.search(r"stable step, (\S+) s", run.stderr)[1])
    assert limit == pytest.approx(STABLE_STEP, rel=1e-5)  # six digits are printed
    for part, substeps in ((1 - 1e-6, 1), (1 + 1e-6, 2)):
        step = STABLE_STEP * part
        run = impakt(f"{BASE} {EXPLICIT} {TOTAL} -time_step {step!r} -time_end {-2e-4 + 10 * step!r} -exact none")
        assert {body["substeps"] for body in run.summary["bodies"].values()} == {10 * substeps}
    given = " ".join(f"-{body}_ts_time_step {step!r}" for body in ("left", "right"))
    impakt(f"{BASE} {EXPLICIT} {TOTAL} -time_step {step!r} {given}", expect_failure=True)


def test_automatic_step(impakt):
    """0.9 of the stable step, rounded to divide the controller step: six substeps to 5e-6 s."""
    run = impakt(f"{BASE} -exact none -right_ts_type centraldifference -right_ts_time_step auto -time_step 5e-6 -time_end -1e-4")
    assert math.ceil(5e-6 / (0.9 * STABLE_STEP)) == 6
    assert {name: body["substeps"] for name, body in run.summary["bodies"].items()} == {"left": 20, "right": 120}


@pytest.mark.parametrize("ranks", [1, *long(2)])
@pytest.mark.parametrize("option", ["-output_history", "-output_summary"])
@pytest.mark.parametrize("where", ["folder", "below-a-file", "proc", *(["locked"] if os.geteuid() else [])])  # nothing is locked to root
def test_output_that_cannot_be_written(where, option, ranks, launch, tmp_path):
    """Found out before there is a first step."""
    (tmp_path / "options").symlink_to(ROOT / "options")
    (tmp_path / "file").write_text("mine\n")
    (tmp_path / "locked").mkdir(mode=0o500)
    paths = {"folder": tmp_path, "below-a-file": tmp_path / "file/out", "proc": "/proc/no-such-place/out", "locked": tmp_path / "locked/out"}
    other = {"-output_history": "-output_summary", "-output_summary": "-output_history"}[option]
    words = ["-options_file", "options/impact-high-speed.opts", "-monitor_interval", "1", option, paths[where], other, tmp_path / "other"]
    run = launch([IMPAKT, *words], ranks, timeout=60, cwd=tmp_path)
    assert run.returncode > 0
    assert not re.search("^step ", run.stdout, re.MULTILINE)
    check_message(run, [option, str(paths[where]), "cannot be written"])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "locked", "options"]
    assert (tmp_path / "file").read_text() == "mine\n"


def test_older_files_stay(launch, tmp_path):
    """A run that does not come to its first step leaves what stood at the paths of its output."""
    (tmp_path / "options").symlink_to(ROOT / "options")
    for name in ("old.h5", "old.json"):
        (tmp_path / name).write_text("mine\n")
    words = ["-options_file", "options/impact-high-speed.opts", "-output_history", "old.h5", "-output_summary", "old.json", "-left_density", "-1"]
    assert launch([IMPAKT, *words], cwd=tmp_path).returncode > 0
    assert [(tmp_path / name).read_text() for name in ("old.h5", "old.json")] == ["mine\n", "mine\n"]


@pytest.mark.parametrize(("integrators", "ranks"), [("II", 2), ("EE", 1), ("penalty", 1), ("lagrange", 1), ("augmented", 1)])
def test_not_a_number(integrators, ranks, impakt):
    """Names the body, the time and the step: tractions near the largest double, by which the first step goes beyond it."""
    options = {
        "II": BASE,
        "EE": f"{BASE} {EXPLICIT}",
        "penalty": PENALTY,
        "lagrange": "-options_file options/impact-lagrange.opts",
        "augmented": f"{BASE} -contact_type augmented_lagrangian -contact_penalty 1e8",
    }[integrators]
    late = "1e308*min(1,1e9*max(0,t+1.9999e-4))"  # from the end of the first step on
    loads = f"-left_boundary_traction xmin -left_boundary_traction_xmin {late} -right_boundary_traction xmax -right_boundary_traction_xmax -{late}"
    run = impakt(f"{options} -exact none {loads}", ranks, expect_failure=True, timeout=60)
    check_message(run, ["body '", "not a number", "time", "-0.00019", "step"])
    assert not (run.folder / "summary.json").exists()


def test_unconverged(impakt):
    """Between two massless layers plain alternation only alternates: names time, iterations and residual (issue, section 3)."""
    options = f"{BASE} -left_initial_velocity 150 -right_initial_velocity -50 -schwarz_predictor last -schwarz_snes_type nrichardson -schwarz_snes_max_it 7 -controller_step_cuts 0"
    run = impakt(options, expect_failure=True)
    check_message(run, ["converge", "time 1e-07 s", "8 sweeps", "1e-05 m", "-schwarz_unconverged accept"])
    assert not (run.folder / "summary.json").exists()
    accepted = impakt(f"{options} -schwarz_unconverged accept -time_end 2e-6")
    assert accepted.summary["schwarz"]["unconverged_steps"] > 0
