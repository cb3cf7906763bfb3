"""The contact step: what it refuses, and leaves to the alternation, with the cure; what it says of the energy that it takes; options of its two solvers."""

import pytest
from cases import DEFAULTS, joined
from messages import check_message

# Two squares of 1 m whose meshes do not match, 5 mm apart, at 20 m/s
TWO = (
    "-bodies left,right -all_density 1000 -all_youngs_modulus 1e9 -left_dm_plex_box_faces 8,4 -right_dm_plex_box_faces 6,3 -right_translate 1.005,0 "
    "-left_initial_velocity 20,0 -time_step 2e-5 -time_end 6e-4 -contact_type force"
)
MASS = "-all_mass_redistribute false"  # the rule is impulse
FRICTION = "-contact_law coulomb -contact_friction 0.3"
STATIC = "-left_ts_type static -left_boundary_displacement xmin -left_boundary_displacement_xmin 0,0 -right_mass_redistribute false -left_initial_velocity 0,0"

REFUSED = {
    "separation": (f"{FRICTION} -contact_separation false", ["-contact_separation false", "schwarz or alternation", "frictionless", "coulomb"]),
    "static": (STATIC, ["-contact_rule impulse", "'left'", "static", "-left_ts_type alpha2", "-<body>_mass_redistribute true"]),
    "linear-on-mass": (f"{MASS} -contact_rule linear", ["-contact_rule linear", "impulse", "-<body>_mass_redistribute true", "-contact_allow_unstable"]),
    "unknown-rule": ("-contact_rule sudden", ["-contact_rule", "sudden", "auto", "impulse", "linear"]),
    "balance": ("-contact_balance true", ["-contact_balance", "both linear elastic"]),
    "balance-on-mass": (f"{MASS} -contact_balance true", ["-contact_balance", "massless contact nodes"]),
    "outer-type": ("-schwarz_snes_type newtontr", ["-schwarz_snes_type newtontr", "nrichardson", "anderson", "ngmres", "qn"]),
    "newton": ("-schwarz_snes_type newtonls", ["-schwarz_snes_type newtonls", "no Jacobian", "nrichardson"]),
    "newton-alternation": ("-contact_type alternation -schwarz_snes_type newtonls", ["-schwarz_snes_type newtonls", "no Jacobian", "anderson"]),
    "line-search": ("-schwarz_snes_linesearch_type nleqerr", ["-schwarz_snes_linesearch_type nleqerr", "secant"]),
    # not read by this method
    "traction": ("-schwarz_traction internal", ["-schwarz_traction", "needs -contact_type alternation"]),
    "predictor": ("-schwarz_predictor last", ["-schwarz_predictor", "needs -contact_type alternation"]),
    "relaxation": ("-schwarz_relaxation aitken", ["-schwarz_relaxation", "needs -contact_type alternation"]),
    "swap-sides": ("-contact_swap_sides true", ["-contact_swap_sides", "needs -contact_type alternation"]),
    "penalty": ("-contact_penalty 1e9", ["-contact_penalty", "needs -contact_type penalty"]),
    "misspelt": ("-law_snes_max_its 3", ["-law_snes_max_its", "-law_snes_max_it"]),
    # steps are made again for the energy that contact brings, and with this rule it brings none
    "cap": (f"{MASS} -contact_energy_cap true", ["-contact_energy_cap true has no effect", "gains none by its rule"]),
    "excess": (f"{MASS} -contact_energy_excess 0", ["-contact_energy_excess has no effect", "gains none by its rule"]),
    "tolerance": (f"{MASS} -contact_energy_tolerance 1e-4", ["-contact_energy_tolerance has no effect", "gains none by its rule"]),
    # of other methods
    "rule-of-another": ("-contact_type alternation -contact_rule auto", ["-contact_rule auto", "needs -contact_type schwarz|force"]),
    "law-of-another": ("-contact_type alternation -law_snes_max_it 3", ["-law_snes_max_it 3", "needs -contact_type schwarz|force"]),
    "friction-of-another": (f"-contact_type alternation {MASS} {FRICTION}", ["-contact_law coulomb", "-contact_type alternation has no friction", "-contact_type schwarz"]),
    "mass-and-friction": (f"-contact_type lagrange {MASS} {FRICTION}", ["massless contact nodes", "-contact_type schwarz"]),
}


@pytest.mark.parametrize(("case", "ranks"), [*((case, 1) for case in REFUSED), ("traction", 3), ("outer-type", 3), ("cap", 3)])
def test_refused(case, ranks, impakt):
    options, words = REFUSED[case]
    check_message(impakt(joined(TWO, options), ranks, expect_failure=True), words)


def test_a_massless_layer_flows_away(impakt):
    """Copper meets a wall at 227 m/s: under a trial force its massless layer of rings yields without end. The error told of the law's solver before."""
    options = "-options_file options/taylor-bar-axisymmetric-wall.opts -rod_mass_redistribute true -time_end 1e-6 -output_history none -output_summary none"
    check_message(impakt(options, expect_failure=True), ["rod.ymin:wall", "not a number", "time 5e-09 s", "-<body>_mass_redistribute false", "cut in halves 4 times"])


# What the alternation alone has chooses it, and what is no more has no effect: both say so
LEFT = {
    "-contact_constraint gap_rate": "-contact_constraint goes with -contact_type alternation, which is taken",
    f"{MASS} -contact_stabilization naive": "-contact_stabilization goes with -contact_type alternation, which is taken",
    "-left_ts_alpha_alpha_m 0.9": "generalized alpha (-<body>_ts_alpha_...) goes with -contact_type alternation, which is taken",
    "-contact_type schwarz -schwarz_traction reaction": "-schwarz_traction is an option of -contact_type alternation, which is taken",
    f"{FRICTION} -contact_friction_dense_limit 10": "-contact_friction_dense_limit 10 has no effect any more",
    "-schwarz_condense 1": "-schwarz_condense 1 has no effect any more",
    "-contact_type alternation -schwarz_dense_limit 0": "-schwarz_dense_limit 0 has no effect any more",
    "-contact_type alternation -schwarz_interface_ksp_rtol 1e-9": "-schwarz_interface_ksp_rtol 1e-9 has no effect any more",
}


@pytest.mark.parametrize("options", LEFT)
def test_left_to_the_alternation(options, impakt):
    run = impakt(joined(TWO, options, "-time_end 4e-5"))
    assert f"impakt: warning: {LEFT[options]}" in run.stderr
    assert run.summary["contact"]["type"] == ("alternation" if "alternation" in options + LEFT[options] else "schwarz")


def test_bars_do_not_slide(impakt):
    check_message(impakt(f"{DEFAULTS} -contact_type force {FRICTION}", expect_failure=True), ["-contact_law coulomb", "one dimension", "frictionless"])


@pytest.mark.parametrize("options", ["-contact_energy_cap true -contact_energy_excess 1e-4 -contact_energy_tolerance 1e-2", "-contact_balance auto", "-contact_balance false", f"{MASS} -contact_energy_cap false"])
def test_taken(options, impakt):
    """What limits energy is taken where contact may gain some: with massless nodes. Balance by itself is off, and off is what the others say."""
    assert impakt(joined(TWO, options)).summary["contact"]["steps_in_contact"] > 5


@pytest.mark.parametrize(("options", "rule"), [("", "linear"), (MASS, "impulse"), ("-right_mass_redistribute false", "impulse"), ("-contact_rule impulse", "impulse")])
def test_rule_by_itself(options, rule, impakt):
    """-contact_view names the rule, and the tolerance that holds, not its default."""
    run = impakt(joined(TWO, options, "-contact_view -schwarz_snes_rtol 1e-4"))
    assert f"\n  rule {rule}, tolerance 0.0001 of the largest way of a row in the step\n" in run.stdout
    assert ("energy not limited: contact gains none by its rule" in run.stdout) == (rule == "impulse")


def test_loss_is_explained(impakt):
    """The run says what takes the energy, and not that contact may bring some; momentum is kept."""
    run = impakt(joined(TWO, MASS))
    assert run.summary["system"]["energy_error_min"] < -0.02
    assert run.summary["system"]["momentum_error_max"] < 1e-12
    (text,) = run.summary["warnings"]
    assert "contact takes the kinetic energy of the contact nodes that hit" in text
    assert "bring" not in text and "step" not in text
    assert "massless contact nodes" in text


def test_outer_iteration_has_a_limit(impakt):
    """A nonlinear body needs more than one pass; the message has the tolerance that the user has set, and bounds by it."""
    options = joined(TWO, "-left_material_type neo_hookean -controller_step_cuts 0")
    run = impakt(f"{options} -schwarz_snes_max_it 1 -schwarz_snes_rtol 0 -schwarz_snes_atol 1.25e-13", expect_failure=True)
    check_message(run, ["were not found in 2 passes", "where 1.25e-13 m are allowed", "-schwarz_snes_max_it"])
    impakt(f"{options} -schwarz_snes_max_it 1 -schwarz_snes_atol 1")


@pytest.mark.parametrize("ranks", [1, 3])
def test_law_has_limits(ranks, impakt):
    """Without an iteration of Newton's method and without sweeps node by node there is no solution, and the message says which options; either is enough."""
    options = joined(TWO, "-controller_step_cuts 0")
    run = impakt(f"{options} -law_snes_max_it 0 -law_nodes_snes_max_it 4", ranks, expect_failure=True)
    check_message(run, ["The law of the 5 contact rows", "-law_snes_max_it", "-law_nodes_snes_max_it"])
    for enough in ("-law_snes_max_it 0", "-law_nodes_snes_max_it 0"):
        assert impakt(f"{options} {enough}", ranks).summary["contact"]["steps_in_contact"] > 5


def test_law_has_tolerances(impakt):
    """With a tolerance above all forces the guess, which is none, solves the law: bodies fly through each other."""
    run = impakt(joined(TWO, "-law_snes_max_it 0 -law_nodes_snes_max_it 4 -law_snes_atol 1e30"))
    assert run.summary["contact"]["steps_in_contact"] == 0
    assert run.summary["contact"]["max_penetration"] > 1e-3


def test_views_of_solvers(impakt):
    """PETSc reads these options when it has solved, and they are known all the same."""
    run = impakt(joined(TWO, "-law_snes_view -schwarz_snes_view"))
    assert "(schwarz_) 1 MPI process" in run.stdout
    assert "(law_) 1 MPI process" in run.stdout
