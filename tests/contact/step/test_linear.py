"""The rule `linear` of the contact step, for contact nodes without mass and for statics: the forces of the alternation, whose iteration is another, and where there is
friction, which that has not, the law itself."""

import re

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
    "blocks, cut steps": ("blocks", "-time_step 5e-6", "", 1e-10, 2.5),  # 1e-14
    "blocks, larger steps": ("blocks", "-time_step 2e-5", "", 1e-10, 3.2),  # 2e-15
    "blocks, neo-Hookean": ("blocks", NEO_HOOKEAN, "", 1e-6, 2.6),  # 3e-8; 2.15 passes, 3.5 where forces are guessed to stay, 5.0 without secants of earlier steps too
    "bars-high-speed": ("bars-high-speed", "", "", 1e-6, 2.4),  # 8e-8 as contact begins, by the tolerance of 1e-7; 2.00 passes: a second finds the first right
    "three-bars": ("three-bars", "", "", 1e-6, 2.4),  # 8e-8; 2.00 passes
    "discs": ("discs", "", "-contact_balance false", 1e-6, 3.3),  # 1e-7; 2.97 passes
    "cantilever-tied": ("cantilever-tied", joined("-time_end 2e-4", MOVED), "", 1e-10, 2.4),  # 4e-14
    "stack-static": ("stack-static", "", "", 1e-10, 17),  # 3e-12; 13.8 passes, 16.5 where forces are guessed to stay
    "rigid-punch": ("rigid-punch", "", "", 1e-9, 2.4),
}
# The same of bodies that rub, or slide without friction: by how much gaps and slips miss the law at most [m], measured beside it
RUBBING = {
    "blocks": ("blocks", RUBS, 1e-16, 2.4),  # 1.1e-17
    "blocks, IE": ("blocks", joined(RUBS, EXPLICIT.format("right")), 1e-16, 2.4),  # 1.1e-17
    "oblique-disc": ("oblique-disc", "", 2e-11, 3.3),  # 1.1e-11, of a way of 1e-4: the tolerance is 1e-7 of it
    "shear-pulse": ("shear-pulse", "", 2e-15, 2.4),  # 3.6e-16
    "sliding-flat": ("sliding-flat", "", 1e-14, 2.4),  # 1.3e-15
    "arch": ("arch", "", 1e-14, 100),  # 7e-16; 83 passes
    "capstan": ("capstan", "", 4e-11, 15),  # 1.6e-11, the law to 1e-13 of the 4 m by which the force of each of 81 nodes would bend the band; 6.2 to 12.8 passes, as round-off has it
}
# The outer iteration of the alternation to round-off of positions
ALTERNATION = "-contact_type alternation -schwarz_snes_atol 1e-14"
SLOW = ("blocks, neo-Hookean", "discs", "three-bars")
CAP = 1e-3  # what contact may bring over a run, by the energy that is exchanged


def errors(run):
    """Change of energy by what is exchanged, at all steps; nothing where nothing is."""
    change, scale = run.history["energy/change"][()], run.history["energy/scale"][()]
    return change / np.where(scale > 0, scale, 1)


@pytest.mark.parametrize("name", [*(name for name in CASES if name not in SLOW), *long(*SLOW)])
def test_as_another_method(name, shared_run):
    file, more, only, tolerance, most = CASES[name]
    expects, force = (shared_run(joined(f"-options_file options/{file}.opts", more, which)) for which in (f"{ALTERNATION} {only}", only))
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


@pytest.mark.parametrize("name", [*(name for name in RUBBING if name != "shear-pulse"), *long("shear-pulse")])
def test_law_of_bodies_that_rub(name, shared_run):
    """The residual of the law is of gaps and slips that bodies have, and knows nothing of S."""
    file, more, most_off, most = RUBBING[name]
    run = shared_run(joined(f"-options_file options/{file}.opts", more))
    contact = run.summary["contact"]
    assert contact["force_peak"] > 0
    assert max(contact.get("friction_residual", 0), contact["max_penetration"]) <= most_off
    assert errors(run).max() <= CAP
    assert run.summary["schwarz"]["mean_contact_steps"] <= most


# Blocks with massless nodes of rubber: fewer elements and larger steps; as they are, for which issue 37 asks at most 3.5 passes. Measured 2.70 and 2.07; 3.00
# and 2.73 where forces are guessed to stay. Without the secants of earlier steps either, 4.78 and 4.29 were seen
COARSE = "-left_dm_plex_box_faces 20,4 -right_dm_plex_box_faces 12,3 -time_end 1.6e-4 -time_step 4e-6"


@pytest.mark.parametrize(("more", "most"), [(COARSE, 3), *long(("", 2.5))])
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


def test_many_rows_of_layers_are_products(impakt):
    """More than 500 rows between linear explicit blocks: S is only multiplied with, and forces fulfil the law with the gaps and slips of the bodies, on three ranks and
    with a monitor too. Nodes stick and slide."""
    run = joined(
        box("a", (24, 24, 2), (0, 0, 0), (0.1, 0.1, 0.01)),
        box("b", (26, 26, 2), (0.003, 0.002, 0.0100001), (0.097, 0.098, 0.02)),
        *(f"{material(name, 2e11, 0.3, 7800)} -{name}_material_type linear_elastic -{name}_ts_type centraldifference" for name in "ab"),
        "-bodies a,b -contact_pairs b.zmin:a.zmax -a_initial_velocity 0,0,1 -b_initial_velocity 0.3,0.2,-1 -time_step 2.5e-7 -time_end 4e-6",
        "-contact_law coulomb -contact_friction 0.2 -all_mass_redistribute true",
    )
    force, ranks = impakt(f"{run} -info :contact,pc"), impakt(run, ranks=3)
    assert "S assembled: as products" in force.stdout and "S assembled: dense" not in force.stdout
    assert "since reuse preconditioner is set" in force.stdout  # incomplete factors stay while few nodes change their states
    watched = impakt(f"{run} -contact_monitor")
    (pair,) = force.history["contact"]
    found, other = (which.history[f"contact/{pair}/force_vector"][()] for which in (force, ranks))
    largest = np.abs(found).max()
    assert largest > 0
    assert max(force.summary["contact"][off] for off in ("friction_residual", "max_penetration")) <= 5e-14  # measured: 1.9e-14, of a way of 5e-7 in a step; laws hold to 1e-9 of the largest force, which is at edges
    np.testing.assert_allclose(other, found, rtol=0, atol=1e-10 * largest)
    np.testing.assert_array_equal(watched.history[f"contact/{pair}/force_vector"][()], found)


@pytest.mark.parametrize("ratio", [1e-2, 1e-3])
def test_products_with_a_soft_coarse_body(ratio, impakt):
    """Rows at nodes of a finer and stiffer body are more than the softer one has nodes, so that S nearly is singular. The matrix near S has what the stiff body adds: without,
    the law took 2·10⁵ products."""
    run = joined(
        box("a", (24, 24, 2), (0, 0, 0), (0.1, 0.1, 0.01)),
        box("b", (19, 19, 2), (0, 0.02, 0.01), (0.1, 0.12, 0.02)),
        *(f"{material(name, 2e9 * times, 0.3, 1000)} -{name}_ts_type centraldifference" for name, times in (("a", 1), ("b", ratio))),
        "-bodies a,b -contact_pairs a.zmax:b.zmin -a_initial_velocity 0,0,10 -b_initial_velocity 0,0,-10 -time_step 5e-7 -time_end 5e-6 -all_mass_redistribute true",
    )
    found = impakt(f"{run} -info :contact -log_view")
    assert "S assembled: as products" in found.stdout
    products = max(int(n) for n in re.findall(r"BodyCompliance +(\d+)", found.stdout))
    assert 0 < products <= 500  # of 10 steps and two bodies; measured: 116, 212
    assert found.summary["contact"]["max_penetration"] <= 2e-13  # measured: 6.8e-14, of a way of 1e-5 m
