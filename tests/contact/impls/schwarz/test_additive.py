"""Additive sweeps, in which both bodies start from the same forces: the solution of multiplicative ones, in about as many sweeps."""

import numpy as np
import pytest
from cases import long

BLOCKS = (
    "-bodies left,right -left_dm_plex_box_faces 8,8 -left_density 1000 -left_youngs_modulus 1e9 -left_poissons_ratio 0.25 -left_initial_velocity 20,1 "
    "-right_dm_plex_box_faces 6,6 -right_density 1000 -right_youngs_modulus 1e9 -right_poissons_ratio 0.3 -right_translate 1.005,0.1 -time_step 1e-5 -time_end 6e-4 "
)
TIED = BLOCKS.replace("1.005,0.1", "1,0") + "-contact_law tied "
NEO_HOOKEAN = "-left_material_type neo_hookean -right_material_type neo_hookean "
LEFT, RIGHT = (f"-{body}_ts_type centraldifference -{body}_ts_time_step auto " for body in ("left", "right"))
ADDITIVE = " -schwarz_sweep additive"
CASES = {
    "linear": BLOCKS,
    "linear, sweeps on bodies": BLOCKS + "-schwarz_condense 0",
    "neo-Hookean": BLOCKS + NEO_HOOKEAN,
    "neo-Hookean, sides changed": BLOCKS + NEO_HOOKEAN + "-contact_pairs right:left",
    "neo-Hookean, explicit": BLOCKS + NEO_HOOKEAN + LEFT + RIGHT,
    "neo-Hookean, implicit and explicit": BLOCKS + NEO_HOOKEAN + RIGHT,
    "neo-Hookean, explicit and implicit": BLOCKS + NEO_HOOKEAN + LEFT,
    "neo-Hookean, substeps": BLOCKS + NEO_HOOKEAN + LEFT.replace("auto", "5e-6") + RIGHT.replace("auto", "2.5e-6"),
    "neo-Hookean, steps of ten times": BLOCKS + NEO_HOOKEAN + "-time_step 1e-4 -time_end 1.5e-3",
    "neo-Hookean, steps of a tenth": BLOCKS + NEO_HOOKEAN + "-time_step 1e-6 -time_end 4e-4",
    "tied": TIED,
    "tied, neo-Hookean": TIED + NEO_HOOKEAN,
    "tied, neo-Hookean, explicit": TIED + NEO_HOOKEAN + LEFT + RIGHT,
    "rigid": BLOCKS + "-right_rigid",
    "mass on the second side": BLOCKS + "-right_mass_redistribute false",
}
FIRST = ("linear", "neo-Hookean", "neo-Hookean, explicit", "neo-Hookean, substeps", "tied, neo-Hookean", "rigid")


def same(runs, tolerance):
    histories = [run.history for run in runs]
    for name in ("body/left/kinetic", "body/right/kinetic", "body/left/potential", "contact/left:right/force", "contact/left:right/impulse"):
        values, found = (history[name if name in history else name.replace("left:right", "right:left")][()] for history in histories)
        assert np.abs(found - values).max() <= tolerance * np.abs(values).max(), name


@pytest.mark.parametrize("name", [*FIRST, *long(*(name for name in CASES if name not in FIRST))])
def test_same_solution(name, shared_run):
    """Both end where the positions agree to 5.7e-12 m: seen 2.3e-7 of the largest force, 4e-9 of others. Sweeps: 3.97 a step for 3.43 of neo-Hookean blocks, two of linear ones."""
    runs = [shared_run(CASES[name] + sweep) for sweep in ("", ADDITIVE)]
    same(runs, 1e-6)
    sweeps = [run.summary["schwarz"]["mean_contact_steps"] for run in runs]
    assert 2 <= sweeps[1] <= 1.5 * sweeps[0]
    assert "additive sweeps" in runs[1].stdout and "additive" not in runs[0].stdout


@pytest.mark.parametrize(("ranks", "where"), [(2, "-left_ranks 0 -right_ranks 1"), (3, "-left_ranks 0,2 -right_ranks 1")])
def test_ranks(ranks, where, shared_run):
    options = CASES["neo-Hookean"] + ADDITIVE
    same([shared_run(options), shared_run(f"{options} {where}", ranks)], 1e-9)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("-schwarz_transmission robin", "forces load both sides"),
        ("-schwarz_traction_waveform constant", "linear in time"),
        ("-contact_swap_sides", "none can be swapped"),
        ("-schwarz_snes_type anderson", "newtonls"),
        ("-left_mass_redistribute false", "let them be massless"),
        (f"-right_mass_redistribute false {RIGHT}", "body 'right' is explicit and has mass"),
        ("-contact_type penalty", "-schwarz_sweep"),
    ],
)
def test_refused(options, message, impakt):
    check = impakt(BLOCKS + options + ADDITIVE, expect_failure=True).stderr
    assert "-schwarz_sweep" in check and message in check
