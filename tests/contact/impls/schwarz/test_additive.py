"""Additive sweeps, in which both bodies start from the same forces: the solution of multiplicative ones, in about as many sweeps."""

import numpy as np
import pytest

BLOCKS = (
    "-bodies left,right -left_dm_plex_box_faces 8,8 -left_density 1000 -left_youngs_modulus 1e9 -left_poissons_ratio 0.25 -left_initial_velocity 20,1 "
    "-right_dm_plex_box_faces 6,6 -right_density 1000 -right_youngs_modulus 1e9 -right_poissons_ratio 0.3 -right_translate 1.005,0.1 -time_step 1e-5 -time_end 6e-4 "
)
NEO_HOOKEAN = BLOCKS + "-left_material_type neo_hookean -right_material_type neo_hookean "
ADDITIVE = " -schwarz_sweep additive"


def test_same_solution(shared_run):
    """Both end where the positions agree to 5.7e-12 m: seen 2.3e-7 of the largest force, 4e-9 of others. Sweeps: 3.97 a step for 3.43."""
    runs = [shared_run(NEO_HOOKEAN), shared_run(f"{NEO_HOOKEAN}{ADDITIVE} -left_ranks 0,2 -right_ranks 1", 3)]
    for name in ("body/left/kinetic", "body/right/kinetic", "body/left/potential", "contact/left:right/force", "contact/left:right/impulse"):
        values, found = (run.history[name][()] for run in runs)
        assert np.abs(found - values).max() <= 1e-6 * np.abs(values).max(), name
    sweeps = [run.summary["schwarz"]["mean_contact_steps"] for run in runs]
    assert 2 <= sweeps[1] <= 1.5 * sweeps[0]
    assert "additive sweeps" in runs[1].stdout and "additive" not in runs[0].stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("-schwarz_transmission robin", "forces load both sides"),
        ("-contact_swap_sides", "none can be swapped"),
        ("-schwarz_snes_type anderson", "newtonls"),
        ("-contact_type penalty", "-schwarz_sweep"),
    ],
)
def test_refused(options, message, impakt):
    check = impakt(BLOCKS + options + ADDITIVE, expect_failure=True).stderr
    assert "-schwarz_sweep" in check and message in check
