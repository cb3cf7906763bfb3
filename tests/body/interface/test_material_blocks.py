"""Bodies of several materials, by blocks of their mesh."""

import re

import h5py
import numpy as np
import pytest
from cases import SAME, TIGHT, long, worst_energy_error
from conftest import ROOT
from messages import check_message
from solidmeshes import write_blocks

FACES = {"quad4": (12, 4), "tri3": (12, 4), "hex8": (8, 3, 4), "tet4": (6, 2, 4), "tri6": (6, 2), "tet10": (3, 1, 2)}
LOWER = {2: lambda x: int(x[1] > 0.1), 3: lambda x: int(x[2] > 0.1)}
MOVING = {2: "20*y,-30*x", 3: "20*z,10*x*y,-30*x"}


def layers(tmp_path, shape, faces=None, distortion=0.2, names=("core", "skin")):
    """A box of 1 x 0.2 (x 0.2) m, its upper half in the second block."""
    dim = len(FACES[shape])
    return write_blocks(tmp_path / "layers.msh", shape, faces or FACES[shape], (1.0, 0.2, 0.2), LOWER[dim], names, distortion)


def motion(path, shape, more=""):
    """A free body that bends and turns."""
    return (
        f"-bodies b -b_dm_plex_filename {path} -time_step 1e-4 -time_end 2e-3 -b_density 1000 -b_youngs_modulus 1e7 -b_poissons_ratio 0.3 "
        f"-b_initial_velocity {MOVING[len(FACES[shape])]} {more}"
    )


def energies(run):
    body = run.history["body/b"]
    return np.concatenate([body[name][:].ravel() for name in ("kinetic", "potential")])


KINDS = [
    ("quad4", "-b_material_type neo_hookean -b_ts_type centraldifference"),
    ("quad4", "-b_plane_stress -b_element_formulation enhanced"),
    ("quad4", "-b_axisymmetric -b_material_type saint_venant_kirchhoff"),
    ("tri3", "-b_material_type neo_hookean"),
    ("tet4", "-b_material_type saint_venant_kirchhoff -b_ts_type centraldifference"),
    ("hex8", "-b_material_type neo_hookean -b_ts_type centraldifference -b_element_formulation reduced"),
    ("hex8", "-b_material_type j2 -b_yield_stress 1e5 -b_ts_type centraldifference"),
    ("quad4", "-b_material_type neo_hookean -b_damping_stiffness 1e-5"),
    ("tri6", "-b_damping_stiffness 1e-5"),
    ("tet10", "-b_material_type j2 -b_yield_stress 1e5 -b_ts_type centraldifference"),
    ("tet10", "-b_element_formulation full"),
]


@pytest.mark.parametrize("shape, options", KINDS)
def test_equal_blocks(impakt, tmp_path, shape, options):
    """Blocks of one material are the body without blocks, but for the order in which its forces are summed: round-off, which steps add up."""
    if "axisymmetric" in options:
        options += " -b_initial_velocity 0,-30*x"
    base = motion(layers(tmp_path, shape), shape, options)
    plain, blocks = (impakt(base + more) for more in ("", " -b_core_density 1000 -b_skin_youngs_modulus 1e7"))
    for name in ("kinetic", "potential"):
        values = [run.history[f"body/b/{name}"][:] for run in (plain, blocks)]
        assert values[0].max() > 0
        np.testing.assert_allclose(values[1], values[0], rtol=0, atol=1e-11 * values[0].max())


def test_inheritance(impakt, tmp_path):
    """What a block does not say it takes from the body; where all cells are in blocks, the body need not say anything."""
    path = layers(tmp_path, "quad4")
    said = impakt(motion(path, "quad4", "-b_skin_youngs_modulus 4e7"))
    full = impakt(
        f"-bodies b -b_dm_plex_filename {path} -time_step 1e-4 -time_end 2e-3 -b_initial_velocity {MOVING[2]} "
        "-b_core_density 1000 -b_core_youngs_modulus 1e7 -b_core_poissons_ratio 0.3 "
        "-b_2_density 1000 -b_2_youngs_modulus 4e7 -b_2_poissons_ratio 0.3"
    )
    np.testing.assert_allclose(energies(full), energies(said), rtol=0, atol=1e-10 * np.abs(energies(said)).max())


def test_mass(impakt, tmp_path):
    """0.1 m^2 of each: 700 and 100 kg; momentum is that of the true density."""
    path = layers(tmp_path, "quad4", distortion=0)
    run = impakt(motion(path, "quad4", "-b_core_density 7000 -b_initial_velocity 3,0 -b_body_view"))
    assert run.history["body/b/kinetic"][0].item() == pytest.approx(0.5 * 800 * 9, rel=1e-12)
    assert "block core: linear_elastic, mass 700. kg" in run.stdout
    assert "the rest: linear_elastic, mass 100. kg" in run.stdout


def halves(tmp_path, n):
    return write_blocks(tmp_path / "bar.msh", "quad4", (n, 1), (1.0, 0.01), lambda x: int(x[0] > 0.5), ["near", "far"])


@pytest.mark.parametrize("ts", ["centraldifference", "alpha2"])
def test_wave_between_blocks(impakt, tmp_path, ts):
    """A pulse from impedance 1 to 4 kg/(m^2 s), c = 1 m/s and 2 m/s: particle velocities 2 Z1 / (Z1 + Z2) = 0.4 go on and (Z1 - Z2) / (Z1 + Z2) = -0.6
    come back. The pulse is 30 elements of 1/400 m wide; measured 0.7 % off at most."""
    pulse = "exp(-((x-0.25)/0.04)^2)"
    run = impakt(
        f"-bodies b -b_dm_plex_filename {halves(tmp_path, 400)} -time_step 5e-4 -time_end 0.5 -b_ts_type {ts} -b_density 1 -b_youngs_modulus 1 "
        "-b_far_density 2 -b_far_youngs_modulus 8 -b_poissons_ratio 0 -b_probe 0.35,0.005;0.7,0.005 "
        f"-b_initial_displacement 1e-3*{pulse},0 -b_initial_velocity 2e-3*(x-0.25)/0.04^2*{pulse},0"
    )
    near, far = (run.history[f"body/b/probe/{k}/velocity"][:].reshape(len(run.history["time"]), -1)[:, 0] for k in (0, 1))
    time = run.history["time"][:]
    incident, reflected = np.abs(near[time < 0.2]).max(), near[time > 0.3]
    assert np.abs(far).max() / incident == pytest.approx(0.4, rel=0.02)
    assert np.abs(reflected).max() / incident == pytest.approx(0.6, rel=0.02)


@pytest.mark.parametrize("shape", ["quad4", "hex8"])
def test_layered_cantilever(impakt, tmp_path, shape):
    """Skins ten times as stiff as the core: the deflection under an end load is F L^3 / (3 sum E I), with sum E I of the layers about the middle, and
    of shear some F L / (k G A), about 1 % of it at length/height 20: measured 1.0095 times that of bending alone."""
    three = len(FACES[shape]) - 2
    faces, across, load = ((80, 2, 8), 2, "0,0,1") if three else ((80, 8), 1, "0,1")
    path = write_blocks(tmp_path / "beam.msh", shape, faces, (1.0, 0.05, 0.05), lambda x: int(abs(x[across] - 0.025) > 0.0125), ["core", "skin"])
    run = impakt(
        f"-bodies b -b_dm_plex_filename {path} -time_step 1 -time_end 1 -b_ts_type static -b_density 1 -b_element_formulation enhanced "
        f"-b_core_youngs_modulus 1e6 -b_skin_youngs_modulus 1e7 -b_poissons_ratio 0 -b_boundary_displacement xmin "
        f"-b_boundary_displacement_xmin 0,0{',0' * three} -b_boundary_traction xmax -b_boundary_traction_xmax {load} "
        f"-b_probe 1,0.025{',0.025' * three}" + ("" if three else " -b_plane_stress")
    )
    tip = run.history["body/b/probe/0/displacement"][-1].ravel()[across]
    inertia = 1e6 * 0.025**3 / 12 + 1e7 * (0.05**3 - 0.025**3) / 12
    assert tip == pytest.approx(0.05 / (3 * inertia), rel=0.02)


PLASTIC = "-b_skin_material_type j2 -b_skin_yield_stress 2e4 -b_skin_hardening_modulus 1e6 -b_core_material_type neo_hookean"


def test_fields(impakt, tmp_path):
    """The number of each cell's block, and plastic strain in one of them alone."""
    options = motion(layers(tmp_path, "quad4"), "quad4", f"{PLASTIC} -output_fields f.h5")
    run = impakt(options)
    with h5py.File(run.folder / "f.h5") as file:
        found = {name: file[name]["0020"][()].ravel() for name in ("block", "plastic_strain")}
    assert sorted(np.unique(found["block"])) == [0, 1]
    block, strain = found["block"], found["plastic_strain"]
    assert strain[block == 1].max() > 0
    assert np.all(strain[block == 0] == 0)


@pytest.mark.parametrize(("ts", "before", "after"), [("centraldifference", 1, 3), ("alpha2", 1, 1), *long(("alpha2", 3, 1), ("centraldifference", 2, 2))])
def test_restart_on_other_ranks(impakt, tmp_path, ts, before, after):
    """To round-off, with the history of each point in its element of its block, and to the last bit on as many ranks. Measured: 4e-15."""
    base = motion(layers(tmp_path, "hex8"), "hex8", f"{PLASTIC} -b_ts_type {ts} -b_mesh_division graph")
    whole = impakt(base, ranks=before if before == after else 1)
    impakt(f"{base} -time_end 1e-3 -checkpoint {tmp_path}/c.h5", ranks=before)
    rest = impakt(f"{base} -restart {tmp_path}/c.h5", ranks=after)
    assert whole.history["body/b/plastic_work"][-1] > 1.2 * whole.history["body/b/plastic_work"][10] > 0
    for name in ("kinetic", "potential", "plastic_work"):
        wanted = whole.history[f"body/b/{name}"][:]
        np.testing.assert_allclose(rest.history[f"body/b/{name}"][-1], wanted[-1], rtol=0, atol=0 if before == after else 1e-12 * wanted.max())
    if after == 1:
        other = impakt(f"{base.replace('-b_skin_yield_stress 2e4', '-b_skin_yield_stress 3e4')} -restart {tmp_path}/c.h5", expect_failure=True)
        check_message(other, ["-b_skin_yield_stress"])


PATTERNS = {
    "layers": lambda x: int(4 * x[2]) % 2,
    "core": lambda x: int(np.abs(x - 0.5).max() < 0.25),
}


@pytest.mark.parametrize(
    ("pattern", "faces", "jump", "more", "ranks", "most"),
    [
        ("core", 8, 1, "", 1, 25),
        ("layers", 8, 1e6, "", 1, 150),
        ("core", 8, 1e-4, "-b_material_type neo_hookean", 1, 60),
        *long(("core", 14, 1e-4, "", 2, 60), ("core", 14, 1e6, "", 1, 60), ("layers", 14, 1e6, "", 3, 150)),
    ],
)
def test_multigrid(impakt, tmp_path, pattern, faces, jump, more, ranks, most):
    """Conjugate gradients with GAMG, stiffnesses that jump by 10^6, within bounds that do not depend on the mesh. Measured: 17 and 18 iterations without a jump; of layers 40 with 10^2, 78 with 10^4,
    115 with 10^6, of a core 40 at most. With PETSc's estimates of eigenvalues the smoothers of soft cores were indefinite. The energy is that of a direct solution."""
    path = write_blocks(tmp_path / "jump.msh", "hex8", (faces,) * 3, (1.0, 1.0, 1.0), PATTERNS[pattern], ["a", "b"])
    case = (
        f"-bodies b -b_dm_plex_filename {path} -b_density 1 -b_youngs_modulus 1e6 -b_poissons_ratio 0.3 -b_b_youngs_modulus {1e6 * jump} -b_ts_type static -b_boundary_displacement zmin "
        f"-b_boundary_displacement_zmin 0,0,0 -b_boundary_traction zmax -b_boundary_traction_zmax 1,0,1 -time_step 1 -time_end 1 {more}"
    )
    direct = impakt(case).summary["bodies"]["b"]["potential"]
    run = impakt(f"{case} -b_ksp_type cg -b_pc_type gamg -b_ksp_converged_reason", ranks=ranks)
    iterations = [int(n) for n in re.findall(r"Linear b_ solve converged due to CONVERGED_RTOL iterations (\d+)", run.stdout)]
    assert iterations
    assert max(iterations) <= most
    assert run.summary["bodies"]["b"]["potential"] == pytest.approx(direct, rel=1e-7)


def test_stable_step(impakt, tmp_path):
    """The least of those of the materials, each alone in the whole body."""
    path = layers(tmp_path, "quad4")
    steps = {}
    for name, more in {"soft": "", "stiff": "-b_youngs_modulus 9e7", "both": "-b_skin_youngs_modulus 9e7"}.items():
        run = impakt(motion(path, "quad4", f"-b_ts_type centraldifference -b_body_view {more}"))
        steps[name] = float(next(line for line in run.stdout.splitlines() if "stable step" in line).split()[2])
    assert steps["stiff"] == pytest.approx(steps["soft"] / 3, rel=1e-4)
    assert steps["stiff"] <= steps["both"] * (1 + 1e-6)
    assert steps["both"] < 1.4 * steps["stiff"]


ERRORS = {
    "-b_sikn_density 3": "has no block 'sikn'; it has: core, skin, 1, 2",
    "-b_skin_yield_stress 3": "-b_skin_yield_stress 3 (",
    "-b_skin_thickness 3": "-b_skin_thickness 3 (",
    "-b_skin_density -3": "-b_skin_density is -3. kg/m^3; a density must be positive",
    "-b_skin_material_type rubber": "-b_skin_material_type",
    "-b_skin_material_type mooney_rivlin -b_element_formulation enhanced": "enhanced with mooney_rivlin",
    "-b_skin_material_type j2 -b_skin_yield_stress 1 -b_element_formulation reduced": "it keeps no history of plastic flow",
    "-b_skin_density 7 -exact characteristics": "-exact",
    "-b_skin_density 3 -b_2_density 4": "in block '2' and in block 'skin' at once",
}


@pytest.mark.parametrize("options", ERRORS)
def test_errors(impakt, tmp_path, options):
    run = impakt(motion(layers(tmp_path, "quad4"), "quad4", options), ranks=3 if "sikn" in options else 1, expect_failure=True)
    check_message(run, [ERRORS[options]])


def test_plate_mesh(tmp_path):
    """The file that the options name is what write_blocks() writes."""
    skin = write_blocks(tmp_path / "plate.msh", "quad4", (40, 6), (0.4, 0.03), lambda x: int(abs(x[1] - 0.015) > 0.01), ["core", "skin"])
    assert skin.read_text() == (ROOT / "tests/meshes/layered/plate.msh").read_text()


PLATE = "-options_file options/layered-plate.opts -time_end 2e-4"


def test_layered_plate(shared_run):
    """The case of the options file: the skin flows and the energy with plastic work is kept; measured 0.041 % worst."""
    run = shared_run(PLATE)
    plate = run.summary["bodies"]["plate"]
    assert plate["blocks"]["skin"]["material"] == "j2"
    assert plate["blocks"]["skin"]["mass"] == pytest.approx(0.4 * 0.01 * 2700, rel=1e-12)
    assert plate["blocks"]["(rest)"]["mass"] == pytest.approx(0.4 * 0.02 * 200, rel=1e-12)
    assert plate["plastic_work"] > 100
    assert worst_energy_error(run.summary) < 1e-3


@pytest.mark.long
def test_layered_plate_on_ranks(shared_run):
    one, three = (shared_run(PLATE, ranks).history["body/plate"] for ranks in (1, 3))
    for name in ("kinetic", "potential", "plastic_work"):
        np.testing.assert_allclose(three[name][:], one[name][:], rtol=0, atol=1e-6 * np.abs(one[name][:]).max())


@pytest.mark.parametrize("contact", ["schwarz", "penalty"])
def test_equal_blocks_in_contact(impakt, tmp_path, contact):
    """Blocks of one material in contact are the body without blocks: impedances and penalty parameters are its own."""
    lines = (ROOT / "options/layered-plate.opts").read_text().splitlines()
    plain = tmp_path / "plain.opts"
    plain.write_text("\n".join(line for line in lines if not line.strip().startswith("-skin_")))
    base = f"-options_file {plain} -time_end 4e-5 -contact_type {contact} {TIGHT}"
    runs = [impakt(f"{base}{more}") for more in ("", " -plate_skin_density 200")]
    for body in ("block", "plate"):
        for name in ("kinetic", "potential"):
            values = [run.history[f"body/{body}/{name}"][:] for run in runs]
            np.testing.assert_allclose(values[1], values[0], rtol=0, atol=SAME * np.abs(values[0]).max())
