"""Bodies on ranks of their own: the results of one rank, whatever the mesh, the integrator and the law, and whichever ranks have nothing at all."""

import os

import numpy as np
import pytest
from cases import long
from restarts import differences, summary
from solidmeshes import write_box

EXPLICIT = "-{0}_ts_type centraldifference -{0}_ts_time_step auto"
BOTH = EXPLICIT.format("left") + " " + EXPLICIT.format("right")
PLANE = (
    "-bodies left,right -left_dm_plex_box_faces 8,8 -left_density 1000 -left_youngs_modulus 1e9 -left_poissons_ratio 0.25 -left_initial_velocity 20,1 "
    "-right_dm_plex_box_faces 6,6 -right_density 1000 -right_youngs_modulus 1e9 -right_poissons_ratio 0.3 -right_translate 1.005,0.1 -time_step 1e-5 -time_end 6e-4 "
)
SPACE = (
    "-bodies left,right -left_dm_plex_dim 3 -left_dm_plex_box_faces 6,4,3 -left_dm_plex_box_upper 0.6,0.4,0.3 -left_density 1000 -left_youngs_modulus 1e9 "
    "-left_poissons_ratio 0.25 -left_initial_velocity 20,1,0 -right_dm_plex_dim 3 -right_density 1000 -right_youngs_modulus 1e9 -right_poissons_ratio 0.3 "
    "-time_step 4e-6 -time_end 2e-4 "
)
BOX = "-right_dm_plex_box_faces 5,3,3 -right_dm_plex_box_upper 0.5,0.3,0.3 -right_translate 0.6002,0.05,0.02 "
BALL = "-right_dm_plex_shape ball -right_ball_divisions 2 -right_ball_radius 0.2 -right_ball_centre 0.8002,0.2,0.15 -right_ball_pole -1,0,0 -contact_pairs left:right.surface "
ROD = "-right_dm_plex_shape rod -right_rod_divisions 2 -right_rod_elements 5 -right_rod_radius 0.1 -right_rod_length 0.4 -right_rotate 0,1,0,90 -right_translate 0.6002,0.2,0.15 "
FILE = "-right_dm_plex_filename {file} -right_translate 0.6002,0.05,0.02 "
ADDITIVE = "-schwarz_sweep additive "
PLASTIC = " ".join(f"-{body}_material_type j2 -{body}_yield_stress 4e6 -{body}_hardening_modulus 2e8" for body in ("left", "right")) + " "
FRICTION = "-contact_law coulomb -contact_friction 0.3 "
NEO_HOOKEAN = "-left_material_type neo_hookean -right_material_type neo_hookean "
CASES = {
    "plane": PLANE,
    "plane, neo-Hookean, friction": PLANE + NEO_HOOKEAN + FRICTION,
    "plane, explicit, friction": PLANE + FRICTION + BOTH,
    "plane, implicit and explicit": PLANE + EXPLICIT.format("right"),
    "plane, penalty": PLANE + "-contact_type penalty",
    "plane, multipliers": PLANE + "-contact_type lagrange",
    "plane, neo-Hookean, multipliers": PLANE + NEO_HOOKEAN + "-contact_type lagrange",
    "plane, neo-Hookean, additive": PLANE + NEO_HOOKEAN + ADDITIVE,
    "plane, neo-Hookean, additive, damped, long steps": PLANE.replace("1e-5", "5e-5") + NEO_HOOKEAN + ADDITIVE + "-left_damping_stiffness 1e-6",
    "space, plastic, additive": SPACE + BOX + PLASTIC + ADDITIVE,
    "plane, sweeps on bodies": PLANE + "-schwarz_condense 0",
    "plane, tied": PLANE.replace("1.005,0.1", "1,0") + "-contact_law tied",
    "plane, rigid": PLANE + "-right_rigid",
    "space": SPACE + BOX,
    "space, explicit": SPACE + BOX + BOTH,
    "space, neo-Hookean, explicit, friction": SPACE + BOX + NEO_HOOKEAN + FRICTION + BOTH,
    "space, factors of MUMPS": SPACE + BOX + "-left_dm_plex_box_faces 12,8,6",
    "space, explicit, tied, substeps": SPACE + BOX.replace("0.6002", "0.6") + "-contact_law tied -{0}_ts_type centraldifference -{1}_ts_type centraldifference "
    "-{0}_ts_time_step 1e-6 -{1}_ts_time_step 2e-6".format("left", "right"),
    "ball": SPACE + BALL,
    "ball, explicit": SPACE + BALL + BOTH,
    "rod": SPACE + ROD,
    "rod, explicit, friction": SPACE + ROD + FRICTION + BOTH,
    "tet4 of a file": SPACE + FILE,
    "tet4 of a file, explicit": SPACE + FILE + BOTH,
    "tet10 of a file": SPACE + FILE,
    "tet10 of a file, explicit": SPACE + FILE + BOTH,
    "composite ball, explicit": SPACE + BALL + "-right_dm_plex_simplex -right_element_formulation composite " + BOTH,
}
# by number of ranks: each body alone; one among ranks that the other has none of, and a rank without anything
SETS = {2: ["-left_ranks 0 -right_ranks 1", "-left_ranks 1"], 3: ["-left_ranks 0,2 -right_ranks 1", "-left_ranks 1-2 -right_ranks 1-2", "-left_ranks 2 -right_ranks 0-1"]}
SHORT = {
    ("plane", 2, 0), ("plane, neo-Hookean, friction", 3, 0), ("plane, explicit, friction", 3, 1), ("plane, implicit and explicit", 3, 2),
    ("plane, neo-Hookean, additive", 2, 0), ("plane, neo-Hookean, additive, damped, long steps", 3, 0), ("space, plastic, additive", 2, 0),
    ("plane, multipliers", 2, 0), ("plane, rigid", 3, 0), ("space", 3, 1), ("space, neo-Hookean, explicit, friction", 3, 0), ("space, factors of MUMPS", 2, 0),
    ("space, explicit, tied, substeps", 2, 1), ("ball, explicit", 3, 2),
    ("rod", 3, 2), ("tet4 of a file", 3, 0), ("tet10 of a file, explicit", 3, 2), ("composite ball, explicit", 3, 1),
}  # fmt: skip
ALL = [(name, ranks, i) for name in CASES for ranks in SETS for i in range(len(SETS[ranks]))]


@pytest.fixture
def options(tmp_path_factory):
    """options(name): those of a case, with its mesh file, one for all processes of pytest, whole from the moment it is there."""

    def make(name):
        text = CASES[name]
        if "{file}" in text:
            shape, base = name.split()[0], tmp_path_factory.getbasetemp()
            path = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / f"rank-sets-{shape}.msh"
            if not path.exists():
                own = path.with_suffix(f".{os.getpid()}")
                write_box(own, shape, (4, 3, 2), (0.5, 0.3, 0.3), 0.1)
                own.replace(path)
            text = text.replace("{file}", str(path))
        return text

    return make


def figures(run):
    history = run.history
    found = {f"{body} {name}": history[f"body/{body}/{name}"][()] for body in ("left", "right") for name in ("kinetic", "potential", "momentum", "angular_momentum")}
    for pair in history["contact"]:
        found |= {f"{pair} {name}": history[f"contact/{pair}/{name}"][()] for name in ("force", "impulse", "active")}
    return found


@pytest.mark.parametrize(("name", "ranks", "which"), [*(case for case in ALL if case in SHORT), *long(*(case for case in ALL if case not in SHORT))])
def test_ranks(name, ranks, which, options, shared_run):
    """Energies, momenta, forces, and rows in contact at every step. Seen: 2.3e-13 of the largest at most; where material flows, whose steps end at a
    tolerance, 2.1e-10, with a mesh that is divided among all ranks as well."""
    alone, apart = (shared_run(words, n) for words, n in ((options(name), 1), (f"{options(name)} {SETS[ranks][which]}", ranks)))
    expected, found = figures(alone), figures(apart)
    assert expected.keys() == found.keys()
    for figure, values in expected.items():
        assert np.abs(found[figure] - values).max() <= (1e-9 if "plastic" in name else 1e-11) * np.abs(values).max(), figure
    assert max(values.max() for figure, values in expected.items() if figure.endswith("active")) > 1
    for body, masses in ((body, one["mass"]) for body, one in alone.summary["bodies"].items() if "mass" in one):
        # the first rank writes what others may know of a body; what is zero comes out as round-off, and factors end at a tolerance
        for figure, values in masses.items():
            assert np.allclose(apart.summary["bodies"][body]["mass"][figure], values, rtol=1e-8, atol=1e-8), (body, figure)


@pytest.mark.parametrize("name", ["plane, neo-Hookean, friction", "space, plastic, additive", *long("plane, neo-Hookean, additive", "plane, explicit, friction", "space, explicit")])
def test_restart(name, run_in, folder, same_runs):
    """With the same ranks to the last bit; on another number of them with others, to round-off (2.8e-14 seen); and not with others on as many."""
    whole, other = folder("whole"), folder("continued")
    case, ranks, change = CASES[name], "-left_ranks 0,2 -right_ranks 1", "-restart_allow_changes"
    for where in (whole, other):
        run_in(f"{case} {ranks}", where, 3, "-checkpoint", "c.h5", "-checkpoint_interval", 35, fields=False)
    run_in(f"{case} {ranks}", other, 3, "-restart", "c.prev.h5", fields=False)
    same_runs(whole, other)
    for number, sets in ((2, "-left_ranks 1 -right_ranks 0"), (1, "")):
        run_in(f"{case} {sets}", other, number, "-restart", "c.prev.h5", change, fields=False)
        # where material flows sweeps end at a tolerance, now and then one earlier or later
        others = differences(whole, other, 1e-7 if "plastic" in name else 1e-10)
        assert [figure for figure in others if "plastic" not in name or not figure.endswith("schwarz/iterations")] == []
        assert summary(other)["run"]["complete"]
    history = (other / "h.h5").read_bytes()
    for sets, more, message in (
        ("-left_ranks 0-1 -right_ranks 2", [], "-left_ranks 0-1 (it had 0,2), -right_ranks 2 (it had 1)"),
        ("-left_ranks 0-1 -right_ranks 2", [change], "distributed otherwise"),
    ):
        assert message in run_in(f"{case} {sets}", other, 3, "-restart", "c.prev.h5", *more, code=None, fields=False).stderr
        assert (other / "h.h5").read_bytes() == history  # which was cut at the checkpoint before
    assert "-left_ranks 2: this run has 2 ranks" in run_in(f"{case} {ranks}", other, 2, "-restart", "c.prev.h5", change, code=None, fields=False).stderr


@pytest.mark.parametrize(
    ("options", "ranks", "sets"),
    [
        # what the rank of a body alone knows of rows that are prescribed when the checkpoint is written
        (CASES["plane, tied"] + " -schwarz_condense 0", 2, "-left_ranks 0"),
        # rows without held dofs, copied from matrices that have room for columns without entries
        (
            "-bodies left,right -left_dm_plex_dim 3 -left_dm_plex_box_faces 7,4,6 -left_density 1000 -left_youngs_modulus 1e9 -left_poissons_ratio 0.3 "
            "-left_initial_velocity 20,0,0 -left_mass_type consistent -right_dm_plex_dim 3 -right_dm_plex_box_faces 6,6,3 -right_dm_plex_box_lower 1,0,0 "
            "-right_dm_plex_box_upper 2,1,1 -right_density 1000 -right_youngs_modulus 1e9 -right_poissons_ratio 0.25 -right_ts_type centraldifference "
            "-right_ts_time_step 1e-5 -right_boundary_displacement xmax -right_boundary_displacement_xmax 0,0,0 -time_step 2e-5 -time_end 6e-4 " + FRICTION,
            3,
            "-right_ranks 2",
        ),
    ],
    ids=["tied", "held"],
)
def test_restart_whole_body(options, ranks, sets, run_in, folder):
    """One body on one rank, the other on all."""
    whole, other = folder("whole"), folder("continued")
    for where in (whole, other):
        run_in(f"{options} {sets}", where, ranks, "-checkpoint", "c.h5", "-checkpoint_interval", 9, fields=False)
    run_in(f"{options} {sets}", other, ranks, "-restart", "c.prev.h5", fields=False)
    # factors of several ranks need not have the same bits, and gaps of closed rows are round-off
    assert [name for name in differences(whole, other, 1e-10) if not name.endswith("/gap")] == []


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("-left_ranks 0-2", "-left_ranks 0-2: this run has 2 ranks"),
        ("-left_ranks 0,0", "-left_ranks names rank 0 twice"),
        ("-left_ranks 0;1", "'0;1' is neither a rank nor a range of ranks"),
        ("-left_ranks 0-1 -left_mesh_division whole", "-left_ranks names 2"),
        ("-left_ranks 0 -left_mesh_bricks 2,1", "there are 1 ranks that have a part"),
        ("-left_ranks 0 -left_dm_distribute_overlap 1", "-left_dm_distribute_overlap"),
        ("-middle_ranks 0", "-middle_ranks"),
    ],
)
def test_refused(options, message, impakt):
    """In one line, before anything is written."""
    run = impakt([*PLANE.split(), *options.split()], 2, expect_failure=True)
    assert message in run.stderr
    assert not list(run.folder.glob("*.h5")) and not list(run.folder.glob("*.json"))


def test_placed_as_told(impakt):
    """A body that may be whole on any rank is on the one that is named."""
    for options, where in (("-left_ranks 1", "1"), ("-left_ranks 1 -left_mesh_division whole", "1"), ("-left_ranks 0-1", "0-1")):
        assert f"mesh on rank{'s' if '-' in where else ''} {where} of 2" in impakt(PLANE + BOTH + " -time_end 1e-5 " + options, 2).stdout
