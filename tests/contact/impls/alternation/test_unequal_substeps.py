"""What does not go well with substeps that the bodies do not share says so: Robin conditions, and reactions of nodes with mass."""

import pytest

BLOCKS = "-options_file options/blocks.opts -contact_pairs left:right -controller_step_cuts 0"
WITH_MASS = "-left_mass_type lumped -right_mass_type lumped -left_mass_redistribute false -right_mass_redistribute false -schwarz_traction reaction"


def test_robin_conditions_are_refused(impakt):
    """Under a mixture that is linear over the substeps the forces of both sides bring other impulses: 19 % of the momentum at a step of 1e-4 s (robin). Bodies tied to
    each other, and bars, are refused too. With equal substeps nothing is lost."""
    options = f"{BLOCKS} -time_step 1e-4 -time_end 1e-3 -schwarz_transmission robin -contact_view"
    run = impakt(f"{options} -left_ts_time_step 5e-5", expect_failure=True)
    assert "robin and impedance keep neither momentum nor energy where two bodies make unequal substeps" in run.stderr
    assert "-contact_allow_unstable true" in run.stderr
    run = impakt(f"{options} -left_ts_time_step 5e-5 -contact_allow_unstable true")
    assert run.summary["system"]["momentum_error_max"] > 1e-2
    assert "not in every step, since Robin and impedance conditions over unequal substeps keep neither momentum nor energy" in run.stdout
    assert any("momentum error" in text and "choose equal substeps" in text for text in run.summary["warnings"])
    run = impakt(f"{options} -left_ts_time_step 5e-5 -right_ts_time_step 5e-5")
    assert run.summary["system"]["momentum_error_max"] <= 1e-10
    assert "not in every step" not in run.stdout and not any("momentum" in text for text in run.summary["warnings"])


@pytest.mark.parametrize(
    "options",
    ["options/bars-high-speed.opts -left_ts_time_step 1e-8", "options/cantilever-tied.opts -clamped_ts_time_step 5e-7", "options/striker.opts"],
)
def test_robin_conditions_are_refused_in_all_cases(options, impakt):
    run = impakt(f"-options_file {options} -schwarz_transmission robin", expect_failure=True)
    assert "leave -schwarz_transmission out" in run.stderr


def test_steps_that_gain_are_told(impakt):
    """One step of these gains more than it may: the summary counts it, and the last lines of the run say it."""
    run = impakt(f"{BLOCKS} -time_step 1e-4 -time_end 3e-3 -schwarz_transmission robin -left_ts_time_step 5e-5 -contact_allow_unstable true")
    assert run.summary["schwarz"]["unlimited_steps"] == 1
    assert "1 step gained more energy at contact than -contact_energy_excess allows" in run.stderr


@pytest.mark.parametrize("choice, word", [("-contact_type lagrange -contact_stabilization contact_stabilized", "a stabilization changes"), ("-contact_stabilization naive", "nodes with mass"), ("-contact_type lagrange {explicit}", "forward increments")])
def test_what_is_not_limited_says_so(choice, word, impakt):
    explicit = "-left_ts_type centraldifference -right_ts_type centraldifference"
    lumped = "-left_mass_type lumped -right_mass_type lumped -left_mass_redistribute false -right_mass_redistribute false"
    run = impakt(f"-options_file options/bars-high-speed.opts {lumped} {choice.format(explicit=explicit)} -time_end -1.99e-4 -controller_view")
    assert f"energy not limited: {word}" in run.stdout


def test_reactions_over_substeps_are_refused(impakt):
    """In two dimensions, where they lose 12 % of the momentum or bring energy; bars with 3, 10 and 50 substeps keep their energy to 1.5e-6, and where their stiffness or density is 100 to 1 to 1.1e-2."""
    options = f"{BLOCKS} {WITH_MASS} -left_ts_time_step 5e-7 -left_youngs_modulus 1e11 -time_end 1e-4"
    run = impakt(options, expect_failure=True)
    assert "-schwarz_traction reaction" in run.stderr and "-contact_allow_unstable true" in run.stderr
    bars = "-options_file options/bars-high-speed.opts -time_step 1e-6 -time_end 1e-4"
    run = impakt(f"{bars} {WITH_MASS} -left_ts_time_step 1e-7")
    assert abs(run.summary["system"]["energy_error_final"]) <= 1e-3
    run = impakt(f"{bars} {WITH_MASS} -left_ts_time_step 1e-7 -left_ts_type centraldifference", expect_failure=True)
    assert "body 'left' is explicit" in run.stderr
