"""The rule `linear` of the contact step, for contact nodes without mass and for statics: the forces of other methods, whose iterations are others: the alternation, and
multipliers where there is friction."""

import numpy as np
import pytest
from cases import joined, long
from setups import box, material

KEPT, MOVED = (" ".join(f"-{body}_mass_redistribute {moved}" for body in ("free", "clamped")) for moved in ("false", "true"))
EXPLICIT = "-{0}_ts_type centraldifference -{0}_ts_time_step auto"
RUBS = "-contact_law coulomb -contact_friction 0.3 -left_initial_velocity 100,60"
NEO_HOOKEAN = "-left_material_type neo_hookean -right_material_type neo_hookean -time_end 2.5e-4"

# Per case: the options file, what both runs have beside it, what both have against what the step takes by itself; by how much forces differ, of the largest, measured
# beside it; most passes in a step in contact, 20 % more than were measured
CASES = {
    "blocks": ("blocks", "", "", 1e-10, 2.4),  # 1e-13
    "blocks, IE": ("blocks", EXPLICIT.format("right"), "", 1e-10, 2.4),  # 1e-13
    "blocks, EE": ("blocks", joined(EXPLICIT.format("left"), EXPLICIT.format("right")), "", 1e-10, 2.4),  # 3e-15
    "blocks, friction": ("blocks", RUBS, "", 1e-10, 2.4),  # 1e-13
    "blocks, friction, IE": ("blocks", joined(RUBS, EXPLICIT.format("right")), "", 1e-10, 2.4),  # 1e-13
    "blocks, cut steps": ("blocks", "-time_step 5e-6", "", 1e-10, 2.5),  # 1e-14
    "blocks, larger steps": ("blocks", "-time_step 2e-5", "", 1e-10, 3.2),  # 2e-15
    "blocks, neo-Hookean": ("blocks", NEO_HOOKEAN, "", 1e-6, 3.7),  # 3e-8; 3.52 passes, 5.0 without secants of earlier steps
    "bars-high-speed": ("bars-high-speed", "", "", 1e-6, 2.4),  # 8e-8 as contact begins, by the tolerance of 1e-7; 2.00 passes: a second finds the first right
    "three-bars": ("three-bars", "", "", 1e-6, 2.4),  # 8e-8; 2.00 passes
    "discs": ("discs", "", "-contact_balance false", 1e-6, 3.3),  # 1e-7; 2.97 passes
    "oblique-disc": ("oblique-disc", "", "", 1e-6, 3.3),  # 9e-8
    "shear-pulse": ("shear-pulse", "", "", 1e-9, 2.4),  # 2.6e-10: many rows, a slab gives S, and the tolerance is 1e-7
    "cantilever-tied": ("cantilever-tied", joined("-time_end 2e-4", MOVED), "", 1e-10, 2.4),  # 4e-14
    "sliding-flat": ("sliding-flat", "", "", 1e-9, 2.4),  # 5e-12
    "stack-static": ("stack-static", "", "", 1e-10, 20),  # 3e-12; 16.5 passes
    "arch": ("arch", "", "", 1e-9, 100),  # 83 passes
    "capstan": ("capstan", "", "", 1e-8, 15),  # 2e-9; 7.4 to 12.8 passes, as round-off has it
    "rigid-punch": ("rigid-punch", "", "", 1e-9, 2.4),
}
RUBBING = ("blocks, friction", "blocks, friction, IE", "oblique-disc", "shear-pulse", "sliding-flat", "arch", "capstan")
# The outer iteration of the alternation to round-off of positions
ALTERNATION = "-contact_type alternation -schwarz_snes_atol 1e-14"
SLOW = ("blocks, neo-Hookean", "discs", "shear-pulse", "blocks, friction, IE", "three-bars")
CAP = 1e-3  # what contact may bring over a run, by the energy that is exchanged


def errors(run):
    """Change of energy by what is exchanged, at all steps; nothing where nothing is."""
    change, scale = run.history["energy/change"][()], run.history["energy/scale"][()]
    return change / np.where(scale > 0, scale, 1)


@pytest.mark.parametrize("name", [*(name for name in CASES if name not in SLOW), *long(*SLOW)])
def test_as_another_method(name, shared_run):
    file, more, only, tolerance, most = CASES[name]
    other = "-contact_type lagrange" if name in RUBBING else ALTERNATION
    expects, force = (shared_run(joined(f"-options_file options/{file}.opts", more, which)) for which in (f"{other} {only}", only))
    assert list(force.history["contact"]) == list(expects.history["contact"])
    for pair in force.history["contact"]:
        expected, found = (run.history[f"contact/{pair}/force_vector"][()] for run in (expects, force))
        largest = np.abs(expected).max()
        assert largest > 0
        np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * largest)
        impulses = [run.history[f"contact/{pair}/impulse"][-1] for run in (expects, force)]
        np.testing.assert_allclose(*impulses, rtol=0, atol=tolerance * largest * force.history["time"][-1])
    expected, found = errors(expects), errors(force)
    assert found.max() <= max(CAP, expected.max() + tolerance)
    assert abs(found[-1] - expected[-1]) <= max(1e-6, tolerance)  # measured 1e-8, without inertia 2e-7: the work of forces that are right to 1e-9 in each step
    assert force.summary["step_control"]["step_cuts"] == expects.summary["step_control"]["step_cuts"] and ("cut" not in name or force.summary["step_control"]["step_cuts"])
    assert force.summary["schwarz"]["mean_contact_steps"] <= most


# Blocks with massless nodes of rubber: fewer elements and larger steps; as they are, for which issue 37 asks at most 3.5 passes. Measured 3.65 and 3.12, and 4.78
# and 4.29 where each step begins without the secants of those before it
COARSE = "-left_dm_plex_box_faces 20,4 -right_dm_plex_box_faces 12,3 -time_end 1.6e-4 -time_step 4e-6"


@pytest.mark.parametrize(("more", "most"), [(COARSE, 4), *long(("", 3.5))])
def test_secants_of_earlier_steps(more, most, impakt):
    run = impakt(joined(f"-options_file options/blocks.opts {NEO_HOOKEAN} -schwarz_snes_rtol 1e-6", more))
    assert run.summary["schwarz"]["mean_contact_steps"] <= most


def test_ties_with_mass_are_those_of_the_alternation(shared_run):
    """Tied nodes that keep their mass, of bodies of equal steps: the motion of the uncut body with either type, to round-off (measured 1e-13), and its forces."""
    end = f"-options_file options/cantilever-tied.opts -time_end 2e-5 {KEPT}"
    schwarz, force = shared_run(f"{end} {ALTERNATION}"), shared_run(end)
    for body in ("free", "clamped"):
        for name in ("kinetic", "potential", "mean_velocity", "contact_position"):
            expected = schwarz.history[f"body/{body}/{name}"][()]
            np.testing.assert_allclose(force.history[f"body/{body}/{name}"][()], expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    (pair,) = force.history["contact"]
    expected, found = (run.history[f"contact/{pair}/force_vector"][()] for run in (schwarz, force))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_many_rows_of_layers_are_products(shared_run, impakt):
    """More than 500 rows between linear explicit blocks: S is only multiplied with, and forces are those of multipliers (measured 2e-10), on three ranks and with a
    monitor too. Nodes stick and slide."""
    run = joined(
        box("a", (24, 24, 2), (0, 0, 0), (0.1, 0.1, 0.01)),
        box("b", (26, 26, 2), (0.003, 0.002, 0.0100001), (0.097, 0.098, 0.02)),
        *(f"{material(name, 2e11, 0.3, 7800)} -{name}_material_type linear_elastic -{name}_ts_type centraldifference" for name in "ab"),
        "-bodies a,b -contact_pairs b.zmin:a.zmax -a_initial_velocity 0,0,1 -b_initial_velocity 0.3,0.2,-1 -time_step 2.5e-7 -time_end 4e-6",
        "-contact_law coulomb -contact_friction 0.2 -all_mass_redistribute true",
    )
    schwarz, force, ranks = shared_run(f"{run} -contact_type lagrange"), impakt(f"{run} -info :contact,pc"), impakt(run, ranks=3)
    assert "S assembled: as products" in force.stdout and "S assembled: dense" not in force.stdout
    assert "since reuse preconditioner is set" in force.stdout  # incomplete factors stay while few nodes change their states
    watched = impakt(f"{run} -contact_monitor")
    (pair,) = force.history["contact"]
    expected, found, other = (which.history[f"contact/{pair}/force_vector"][()] for which in (schwarz, force, ranks))
    largest = np.abs(expected).max()
    assert largest > 0
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * largest)
    np.testing.assert_allclose(other, found, rtol=0, atol=1e-10 * largest)
    np.testing.assert_array_equal(watched.history[f"contact/{pair}/force_vector"][()], found)
