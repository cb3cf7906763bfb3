"""Transmission conditions, predictors and swapped sides on the high-speed impact: one solution, other numbers of sweeps.

`make paper` has them all with each pairing of integrators.
"""

import math

import pytest
from cases import (
    DEFAULTS,
    MOVING,
    PAIRINGS,
    UNLIKE,
    force_scatter,
    joined,
    long,
    worst_energy_error,
)

# A frame in which the last position of the contact nodes is not the answer
CASES = {"II": "", "EE": f"{PAIRINGS['EE']} -left_mass_type lumped -right_mass_type lumped", "IE": f"{PAIRINGS['IE']} -right_mass_type lumped -contact_allow_unstable true"}
WAYS = {
    "robin": "-schwarz_transmission robin",
    "impedance": "-schwarz_transmission impedance",
    "plain-robin": "-schwarz_transmission robin -schwarz_snes_type nrichardson",
    "last": "-schwarz_predictor last",
    "swapped": "-contact_swap_sides",
    "swapped-robin": "-contact_swap_sides -schwarz_transmission robin",
}
QUICK = [("II", "robin"), ("EE", "impedance"), ("IE", "swapped-robin"), ("II", "plain-robin")]
LONG = [("IE", "robin"), ("II", "swapped"), ("EE", "last"), ("II", "last")]


def same(one, other, relative, absolute=0.0):
    return math.isclose(one, other, rel_tol=relative, abs_tol=absolute)


@pytest.mark.parametrize(("case", "way"), [*QUICK, *long(*LONG)])
def test_one_solution(case, way, shared_run):
    """The conditions change the way to the solution, not the solution, which is that of the contact step. Unlike bars: of equal ones the first guess is the solution
    already. A spring as stiff as the massless layer behind it makes the plain alternation converge without relaxation, where Dirichlet and Neumann conditions only
    alternate: at most 4 sweeps have been seen, the last of which finds no change."""
    base = joined(DEFAULTS, MOVING, UNLIKE, CASES[case])
    reference, summary = shared_run(base).summary, shared_run(joined(base, WAYS[way])).summary
    assert summary["schwarz"]["mean_contact_steps"] > 1.4
    # Where both sides make the same substeps only the outer tolerance is left, 1e-12 m: 3e-10 was seen in these figures, which are
    # means and peaks over many steps, and 2.2e-9 with another processor's kernels of the factors. Where they do not, what happens between the ends of the controller step is a matter of the conditions: a soft
    # spring leaves a path that a displacement forces; 3e-5 was seen in the peak of the force.
    tolerance = 5e-5 if case == "IE" else 1e-8
    for name in ("force_mean", "force_peak", "impulse"):
        assert same(summary["contact"][name], reference["contact"][name], tolerance), name
    for name in ("first_contact_time", "release_time", "onsets", "steps_in_contact"):
        assert summary["contact"][name] == reference["contact"][name], name
    for body in ("left", "right"):
        assert same(summary["bodies"][body]["peak_potential"], reference["bodies"][body]["peak_potential"], tolerance)
    # Differences of large numbers, in which round-off shows: 1.9e-3, 2e-8, and behind the soft spring of an impedance, where sweeps end
    # a hundred times as far from the solution, 1.0e-6 and 2.5e-6 with sums in another order
    close = 2e-3 if case == "IE" else 1e-5 if way == "impedance" else 1e-6
    for name in ("kinetic", "potential", "contact_position", "mean_velocity"):
        assert same(summary["errors"][name], reference["errors"][name], close), name
    assert summary["contact"]["max_penetration"] <= 2e-12  # the outer tolerance
    assert worst_energy_error(summary) <= 4e-6  # measured: 3.1e-6
    assert force_scatter(summary) <= 2.1e-5  # measured: 1.6e-5
    assert summary["schwarz"]["unconverged_steps"] == 0
    assert 2 <= summary["schwarz"]["max"] <= 4


def test_ranks(shared_run):
    """Two ranks that share bodies and rows: the same within round-off."""
    options = joined(DEFAULTS, MOVING, UNLIKE, WAYS["robin"], "-time_step 1e-6 -time_end 1e-4")
    one, two = (shared_run(options, ranks).summary for ranks in (1, 2))
    assert one["schwarz"]["max"] == two["schwarz"]["max"]
    assert same(one["contact"]["force_mean"], two["contact"]["force_mean"], 1e-8)
    assert same(one["bodies"]["left"]["peak_potential"], two["bodies"]["left"]["peak_potential"], 1e-8)


def test_constant_traction_calms_the_papers_mixed_variant(shared_run):
    """With the traction held over the explicit substeps the implicit-explicit variant of the paper shows the little chatter that the
    paper reports; with a linear one it does not (measured 0.0054 and 0.27)."""
    paper = "-options_file options/paper/high-speed/ie.opts"
    assert force_scatter(shared_run(f"{paper} -schwarz_traction_waveform constant").summary) <= 0.01
    assert force_scatter(shared_run(paper).summary) >= 0.1
