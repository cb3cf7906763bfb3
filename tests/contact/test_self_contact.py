"""Rows whose two parts lie on one body: a clip whose arms meet is twice its upper half beside a rigid plane."""

import meshio
import numpy as np
import pytest
from cases import TIGHT, long

EDGE, LENGTH, ARM = 2.5e-4, 0.011, 1e-3  # m: of elements; of the clip, the thickness of its arms and its back
SLOT, GAP, FLAT = 5e-4, 2e-5, 3e-3  # m: between the arms at the back, and from FLAT on: turned by little, a face is as good as the plane of symmetry
STEEL = "-c_density 7850 -c_youngs_modulus 2.1e11 -c_poissons_ratio 0.3"
FLOOR = "-obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1"
STEP = 2.5e-8  # s: 0.6 of the stable one


def write_clip(path, half):
    """Two arms of squares from x = ARM on, on a back; `half`: what lies above the middle. Surfaces upper and lower face each other, middle is the cut."""
    x = EDGE * np.arange(round(LENGTH / EDGE) + 1)
    above = np.concatenate([[0], SLOT / 2 + EDGE * np.arange(round(ARM / EDGE) + 1)])
    y = above if half else np.concatenate([-above[:0:-1], above])
    number = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    inner = np.abs(y[:-1] + y[1:]) < SLOT
    cells = [number[[i, i + 1, i + 1, i], [j, j, j + 1, j + 1]] for i in range(len(x) - 1) for j in range(len(y) - 1) if x[i] < ARM - EDGE / 2 or not inner[j]]

    def faces(at, begin, end):
        j = int(np.argmin(np.abs(y - at)))
        return [number[[i, i + 1], [j, j]] for i in range(len(x) - 1) if begin - EDGE / 2 < x[i] < end - EDGE / 2]

    groups = {"upper": faces(SLOT / 2, FLAT, LENGTH)} | ({"middle": faces(0, 0, ARM)} if half else {"lower": faces(-SLOT / 2, FLAT, LENGTH)})
    grid = np.array(np.meshgrid(x, y, indexing="ij")).reshape(2, -1).T
    grid[:, 1] -= np.sign(grid[:, 1]) * (SLOT - GAP) / 2 * np.clip((grid[:, 0] - ARM) / (FLAT - ARM), 0, 1)
    used, renumbered = np.unique(np.concatenate([np.ravel(cells), *(np.ravel(part) for part in groups.values())]), return_inverse=True)
    cells, lines = renumbered[: 4 * len(cells)].reshape(-1, 4), renumbered[4 * len(cells) :].reshape(-1, 2)
    tags = [np.repeat(np.arange(len(groups)) + 2, [len(part) for part in groups.values()]), np.ones(len(cells), int)]
    names = {name: np.array([k + 2, 1]) for k, name in enumerate(groups)} | {"all": np.array([1, 2])}
    points = np.pad(grid[used], ((0, 0), (0, 1)))
    mesh = meshio.Mesh(points, [("line", lines), ("quad", cells)], cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=names)
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return path


def options(path, half, speed, more):
    """The arms swing towards each other, or a half of the clip towards the plane in the middle."""
    mesh = write_clip(path / f"{'half' if half else 'clip'}.msh", half)
    pair = f"{FLOOR} -contact_pairs c.upper:floor -c_boundary_displacement middle -c_boundary_displacement_middle free,0" if half else "-contact_pairs c.upper:c.lower"
    swing = f"0,{-speed}*max(x-{ARM},0)/{LENGTH - ARM}*(y>0?1:-1)"
    return f"-bodies c -c_dm_plex_dim 2 -c_dm_plex_filename {mesh} {STEEL} -c_initial_velocity '{swing}' {pair} -time_step {STEP} -time_end 1.2e-5 {TIGHT} {more}"


def force_of(run, pair):
    return run.history[f"contact/{pair}/force"][()]


@pytest.mark.parametrize("more", ["", *long("-c_ts_type centraldifference", "-contact_law coulomb -contact_friction 0.3")])
def test_half(more, tmp_path, impakt):
    """Contact nodes have mass: massless ones give theirs to others so that moments of the whole body stay, and half a body has others."""
    kept = "-c_mass_redistribute false"
    whole = impakt(options(tmp_path, False, 40, f"{kept} {more}"))
    half = impakt(options(tmp_path, True, 40, f"{kept} {more.split('-contact_law')[0]}"))  # arms that rub stick, each to its mirror image
    force, beside = force_of(whole, "c.upper:c.lower"), force_of(half, "c.upper:floor")
    assert (beside > 0).sum() > 40
    assert force == pytest.approx(beside, abs=1e-5 * beside.max())  # faces have turned by 0.002, with that squared between normals; measured: 1.2e-6
    energy = [run.history["body/c/kinetic"][-1] + run.history["body/c/potential"][-1] for run in (whole, half)]
    assert energy[0] == pytest.approx(2 * energy[1], rel=1e-5)


@pytest.mark.parametrize("more", ["-c_material_type neo_hookean", *long("-c_ts_type centraldifference", "-contact_type penalty", "-contact_type lagrange", "-contact_type augmented_lagrangian")])
def test_massless(more, tmp_path, impakt):
    """By any method: forces on both surfaces are opposite, and contact keeps the energy."""
    run = impakt(options(tmp_path, False, 40, more))
    system = run.summary["system"]
    assert force_of(run, "c.upper:c.lower").max() > 5e6  # N per metre; measured: 7.0e6
    assert np.abs(run.history["body/c/momentum"][()]).max() <= 1e-10  # of 3 N s in each arm
    assert system["energy_error_max"] <= 1e-4
    assert system["energy_error_final"] >= -0.012  # arms hit flat, within a step; measured: -0.0024, with central differences -0.0070


def test_sides_and_ranks(tmp_path, impakt):
    run = impakt(options(tmp_path, False, 40, "-c_mass_redistribute false"))
    turned = impakt(options(tmp_path, False, 40, "-c_mass_redistribute false -contact_pairs c.lower:c.upper"), 3)
    assert force_of(turned, "c.lower:c.upper") == pytest.approx(force_of(run, "c.upper:c.lower"), abs=1e-9 * force_of(run, "c.upper:c.lower").max())


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("-contact_pairs c:c", "name the two surfaces by which the body touches itself"),
        ("-contact_pairs c.upper:c.upper", "have nodes in common"),
        ("-contact_type alternation", "choose -contact_type schwarz"),
    ],
)
def test_refusals(more, message, tmp_path, impakt):
    assert message in impakt(options(tmp_path, False, 40, more), expect_failure=True).stderr
