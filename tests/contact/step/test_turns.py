"""Turns of gaps (-contact_balance) in the contact step: a soft body between both sides of a pair, whose own force is made zero."""

import numpy as np
import pytest
from cases import joined, long

DISCS = "-options_file options/discs.opts -time_step 5e-7 -time_end 3.5e-4"
STEP = "-contact_type force"
# A third disc above, so that the second one has rows of two pairs
ABOVE = (
    "-bodies a,b,c -contact_pairs a:b,b:c -c_dm_plex_dim 2 -c_dm_plex_shape ball -c_ball_radius 0.01 -c_ball_centre 0.0095,0.0292 -c_ball_divisions 16 "
    "-c_material_type neo_hookean -c_density 1000 -c_youngs_modulus 1e8 -c_poissons_ratio 0.25 -c_ts_type centraldifference -c_initial_velocity 0,-2"
)
# Blocks that meet flat: no turn of them is any use, and each would be too far
FLAT = (
    "-bodies left,right -left_dm_plex_box_faces 8,8 -right_dm_plex_box_faces 6,6 -all_density 1000 -all_youngs_modulus 1e9 -left_initial_velocity 20,1 "
    "-right_translate 1.005,0.1 -all_material_type neo_hookean -time_step 1e-5 -time_end 6e-4"
)


def vectors(run):
    return [run.history[f"contact/{pair}/force_vector"][()] for pair in run.history["contact"]]


def off(run, other):
    """By how much forces of two runs differ, of the largest."""
    return max(np.abs(one - two).max() / np.abs(two).max() for one, two in zip(vectors(run), vectors(other), strict=True))


@pytest.mark.parametrize("more", ["", *long(ABOVE, "-a_ts_type alpha2 -b_ts_type alpha2", "-b_ts_time_step 1.25e-7")], ids=["two", "three", "implicit", "substeps"])
def test_as_by_traces(more, shared_run):
    step, traces = (shared_run(joined(DISCS, more, which)) for which in (STEP, "-contact_type schwarz"))
    assert "forces balanced" in step.stdout
    assert off(step, traces) <= 1e-6  # 3e-8 to 9e-8: passes are right to 1e-7
    assert off(step, shared_run(joined(DISCS, more, STEP, "-contact_balance false"))) > 0.01  # 0.12 and more
    assert step.summary["schwarz"]["mean_contact_steps"] <= traces.summary["schwarz"]["mean_contact_steps"]


def test_flat(shared_run):
    balanced, free = (shared_run(joined(FLAT, STEP, f"-contact_balance {word}")) for word in ("true", "false"))
    assert off(balanced, free) <= 1e-10  # 1.4e-14


@pytest.mark.parametrize("ranks", [2, *long(3)])
def test_ranks(ranks, shared_run):
    options = joined(DISCS, STEP, "-schwarz_snes_rtol 1e-11")
    assert off(shared_run(options, ranks), shared_run(options)) <= 1e-10  # 1.2e-11
