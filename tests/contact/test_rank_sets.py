"""Bodies on ranks of their own: the results of one rank, whatever the mesh, the integrator and the law, and whichever ranks have nothing at all."""

import os
import shutil

import numpy as np
import pytest
from cases import long, validate
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
FRICTION = "-contact_law coulomb -contact_friction 0.3 "
NEO_HOOKEAN = "-left_material_type neo_hookean -right_material_type neo_hookean "
PLASTIC = " ".join(f"-{body}_material_type j2 -{body}_yield_stress 4e6 -{body}_hardening_modulus 2e8" for body in ("left", "right")) + " "
SUBSTEPS = BOTH.replace("left_ts_time_step auto", "left_ts_time_step 1e-6").replace("right_ts_time_step auto", "right_ts_time_step 2e-6")
# by number of ranks: each body alone; one among ranks that the other has none of, and a rank without anything
SETS = {2: ["-left_ranks 0 -right_ranks 1", "-left_ranks 1"], 3: ["-left_ranks 0,2 -right_ranks 1", "-left_ranks 1-2 -right_ranks 1-2", "-left_ranks 2 -right_ranks 0-1"]}
# options, ranks, which of their sets: each set with each kind of body, integrator and law at least once, not all of all
QUICK = {
    "plane, neo-Hookean, friction": (PLANE + NEO_HOOKEAN + FRICTION, 3, 0),
    "space, explicit, tied, substeps": (SPACE + BOX.replace("0.6002", "0.6") + "-contact_law tied " + SUBSTEPS, 2, 1),
    "ball, explicit": (SPACE + BALL + BOTH, 3, 2),
    "tet4 of a file": (SPACE + FILE, 3, 1),
}
CASES = QUICK | {
    "plane, multipliers": (PLANE + "-contact_type lagrange", 2, 0),
    "plane, penalty, implicit and explicit": (PLANE + "-contact_type penalty " + EXPLICIT.format("right"), 3, 2),
    "plane, rigid": (PLANE + "-right_rigid", 2, 1),
    "space, neo-Hookean, explicit, friction": (SPACE + BOX + NEO_HOOKEAN + FRICTION + BOTH + " -schwarz_snes_rtol 1e-12", 3, 0),
    "rod, friction": (SPACE + ROD + FRICTION, 3, 2),
    "tet10 of a file, explicit": (SPACE + FILE + BOTH, 3, 0),
    "composite ball, explicit": (SPACE + BALL + "-right_dm_plex_simplex -right_element_formulation composite " + BOTH, 3, 1),
    "space, factors of MUMPS": (SPACE + BOX + "-left_dm_plex_box_faces 12,8,6", 2, 0),
    "space, plastic": (SPACE.replace("2e-4", "8e-5") + BOX + PLASTIC, 2, 0),
}


@pytest.fixture
def options(tmp_path_factory):
    """options(name): those of a case, with its mesh file, one for all processes of pytest, whole from the moment it is there."""

    def make(name):
        text = CASES[name][0]
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


@pytest.mark.parametrize("name", [*QUICK, *long(*(name for name in CASES if name not in QUICK))])
def test_ranks(name, options, shared_run):
    """Energies, momenta, forces, and rows in contact at every step. Seen: 2.3e-13 of the largest at most; where material flows, whose steps end at a
    tolerance, 2.1e-10, with a mesh that is divided among all ranks as well."""
    _, ranks, which = CASES[name]
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


@pytest.mark.parametrize(("name", "interval"), [*long(("plane, neo-Hookean, friction", 35), ("space, neo-Hookean, explicit, friction", 35)), *validate(("space, plastic", 12))])
def test_restart(name, interval, run_in, tmp_path, folder, same_runs):
    """With the same ranks to the last bit; on another number of them with others, to round-off (2.8e-14 seen); and not with others on as many."""
    whole, other = folder("whole"), tmp_path / "continued"
    case, ranks, change = CASES[name][0], "-left_ranks 0,2 -right_ranks 1", "-restart_allow_changes"
    run_in(f"{case} {ranks}", whole, 3, "-checkpoint", "c.h5", "-checkpoint_interval", interval, fields=False)
    shutil.copytree(whole, other, symlinks=True)
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


@pytest.mark.long
def test_restart_whole_body(run_in, tmp_path, folder):
    """One body on one rank, the other on all; rows without held dofs, copied from matrices that have room for columns without entries."""
    case = (
        "-bodies left,right -left_dm_plex_dim 3 -left_dm_plex_box_faces 7,4,6 -left_density 1000 -left_youngs_modulus 1e9 -left_poissons_ratio 0.3 "
        "-left_initial_velocity 20,0,0 -left_mass_type consistent -right_dm_plex_dim 3 -right_dm_plex_box_faces 6,6,3 -right_dm_plex_box_lower 1,0,0 "
        "-right_dm_plex_box_upper 2,1,1 -right_density 1000 -right_youngs_modulus 1e9 -right_poissons_ratio 0.25 -right_ts_type centraldifference "
        "-right_ts_time_step 1e-5 -right_boundary_displacement xmax -right_boundary_displacement_xmax 0,0,0 -time_step 2e-5 -time_end 6e-4 -right_ranks 2 "
    ) + FRICTION
    whole, other = folder("whole"), tmp_path / "continued"
    run_in(case, whole, 3, "-checkpoint", "c.h5", "-checkpoint_interval", 9, fields=False)
    shutil.copytree(whole, other, symlinks=True)
    run_in(case, other, 3, "-restart", "c.prev.h5", fields=False)
    # factors of several ranks need not have the same bits, and gaps of closed rows are round-off
    assert [name for name in differences(whole, other, 1e-10) if not name.endswith("/gap")] == []


@pytest.mark.parametrize(
    ("options", "ranks", "message"),
    [
        ("-left_ranks 0-2", 2, "-left_ranks 0-2: this run has 2 ranks"),
        ("-left_ranks 0,0", 1, "-left_ranks names rank 0 twice"),
        ("-left_ranks 0;1", 1, "'0;1' is neither a rank nor a range of ranks"),
        ("-middle_ranks 0", 1, "-middle_ranks"),
    ],
)
def test_refused(options, ranks, message, impakt):
    """In one line, before anything is written; rankset.c has what meshes refuse."""
    run = impakt([*PLANE.split(), *options.split()], ranks, expect_failure=True)
    assert message in run.stderr
    assert not list(run.folder.glob("*.h5")) and not list(run.folder.glob("*.json"))


def test_placed_as_told(impakt):
    """A body that may be whole on any rank is on the one that is named."""
    head = impakt(PLANE + BOTH + " -time_end 1e-5 -left_ranks 1 -left_mesh_division whole -right_ranks 0-1", 2).stdout
    assert "mesh on rank 1 of 2" in head and "mesh on ranks 0-1 of 2" in head
