"""Contact patch tests: two blocks, whose meshes do not match, are pressed together, and the pressure is uniform.

Taylor and Papadopoulos, On a patch test for contact problems in two dimensions, in: Computational Methods in Nonlinear Mechanics (1991).
Each case has an exact solution, linear in space, that both meshes hold, so that errors are those of iterations: of Schwarz's, which
stops at 1e-12 m. The issue wants 1e-8.
"""

import h5py
import meshio
import numpy as np
import pytest
import solidmeshes
from test_solids_wave import rotation

pytest_plugins = "shared_runs"

# per pairing: elements of the lower and of the upper block, which of them are simplices
PAIRINGS = {
    "quad4-quad4-2:1": ("2,2", "4,4", ""),
    "quad4-quad4-2:3": ("2,2", "3,2", ""),
    "quad4-tri3-3:2": ("3,2", "2,2", "b"),
    "tri3-quad4-3:2": ("3,2", "2,2", "a"),
    "hex8-hex8-2:1": ("2,2,2", "4,4,2", ""),
    "hex8-hex8-3:2": ("3,3,2", "2,2,2", ""),
    "hex8-tet4-3:2": ("3,3,2", "2,2,2", "b"),
    "tet4-hex8-2:1": ("4,4,2", "2,2,2", "a"),
}
LAWS = {"frictionless": "", "tied": "-contact_law tied"}
# axes and angles of the whole set-up
TURNS = {2: {"aligned": ((0, 0, 1), 0), "turned": ((0, 0, 1), 33), "over": ((0, 0, 1), -110)}, 3: {"aligned": ((0, 0, 1), 0), "turned": ((1, -2, 0.7), 71), "over": ((-0.3, 0.2, 1), 203)}}
SIZE = np.array((0.5, 0.4))  # of the interface [m]
HEIGHTS = (0.3, 0.5)  # of the lower and the upper block [m]
E, NU = (1e9, 3e9), (0.3, 0.2)  # unlike blocks: they slide on each other as they widen
PRESSURE = 2e6  # strains of 1e-3
FIELDS = "-output_fields fields.h5 -output_fields_precision double -output_fields_interval 1000000"
STATIC = f"-bodies a,b -time_step 1 -time_end 1 -a_ts_type static -b_ts_type static {FIELDS}"


def dim_of(pairing):
    return PAIRINGS[pairing][0].count(",") + 1


def material(i, tied):
    """Tied blocks widen alike only if their materials do."""
    return (E[0], NU[0]) if tied else (E[i], NU[i])


def boxes(pairing):
    """One on the other, each with its elements; the interface is where the last coordinate is the lower one's height."""
    dim = dim_of(pairing)
    *faces, simplices = PAIRINGS[pairing]
    across = ",".join(map(str, SIZE[: dim - 1]))
    words = [f"-{b}_dm_plex_dim {dim} -{b}_dm_plex_box_faces {n} {f'-{b}_dm_plex_simplex' if b in simplices else ''}" for b, n in zip("ab", faces)]
    words.append(f"-a_dm_plex_box_upper {across},{HEIGHTS[0]} -b_dm_plex_box_lower {'0,' * (dim - 1)}{HEIGHTS[0]} -b_dm_plex_box_upper {across},{sum(HEIGHTS)}")
    return " ".join(words)


def middle(dim):
    """Of the interface."""
    return np.array([*SIZE[: dim - 1] / 2, HEIGHTS[0]])


def linear(gradient, origin, factor=""):
    """Formulas of the displacement G (x - x0)."""
    dim = len(origin)
    terms = ["+".join(f"({gradient[i, j]:.17g})*({'xyz'[j]}-({origin[j]:.17g}))" for j in range(dim)) for i in range(dim)]
    return ",".join(f"{factor}({term})" for term in terms)


def uniaxial(dim, e, nu, pressure=PRESSURE):
    """Strain under a pressure along the last axis, in two dimensions plane strain (Timoshenko and Goodier, Theory of Elasticity, section 16)."""
    if dim == 3:
        return pressure / e * np.diag((nu, nu, -1))
    return pressure / e * np.diag((nu * (1 + nu), -(1 - nu**2)))


def last_frame(run):
    with h5py.File(run.folder / "fields.h5") as fields:
        frame = max(fields["displacement"])
        return {name: fields[name][frame][()] for name in ("stress", "contact_pressure", "contact_active")}


def check(run, pressure, stress, within=1e-8):
    """Pressure at all nodes of both surfaces, stress in all elements."""
    frame = last_frame(run)
    active = frame["contact_active"] > 0
    assert active.any()
    np.testing.assert_allclose(frame["contact_pressure"][active], pressure, rtol=within)
    assert not frame["contact_pressure"][~active].any()
    dim = len(stress)
    found = frame["stress"].reshape(-1, 3, 3)[:, :dim, :dim]
    np.testing.assert_allclose(found, np.broadcast_to(stress, found.shape), rtol=0, atol=within * pressure)
    return active.sum()


def turned(pairing, turn, law):
    """The ends of the blocks are held where the exact solution has them, their sides are free."""
    dim = dim_of(pairing)
    axis, degrees = TURNS[dim][turn]
    across = rotation(axis, degrees)[:dim, :dim]
    words = [boxes(pairing), LAWS[law]]
    for i, (b, end) in enumerate((("a", "min"), ("b", "max"))):
        e, nu = material(i, law == "tied")
        exact = linear(across @ uniaxial(dim, e, nu) @ across.T, across @ middle(dim), "t*")
        side = "xyz"[dim - 1] + end
        words.append(f"-{b}_rotate {degrees if dim == 2 else ','.join(map(str, (*axis, degrees)))} -{b}_density 1000 -{b}_youngs_modulus {e} -{b}_poissons_ratio {nu}")
        words.append(f"-{b}_boundary_displacement {side} -{b}_boundary_displacement_{side} {exact} -{b}_exact_displacement {exact}")
    normal = across[:, -1]
    return " ".join(words), -PRESSURE * np.outer(normal, normal)


def nodes(pairing):
    return sum(int(np.prod([int(n) + 1 for n in faces.split(",")[:-1]])) for faces in PAIRINGS[pairing][:2])


@pytest.mark.parametrize("law", list(LAWS))
@pytest.mark.parametrize("turn", ["aligned", "turned", "over"])
@pytest.mark.parametrize("pairing", list(PAIRINGS))
def test_pressed(pairing, turn, law, shared_run):
    """Any element on any, whatever way the interface faces. Measured: 2e-12 (frictionless), 2e-14 (tied) at most."""
    options, stress = turned(pairing, turn, law)
    run = shared_run(f"{STATIC} -contact_pairs auto {options}")
    assert check(run, PRESSURE, stress, 1e-10) == nodes(pairing)
    for b in "ab":
        assert run.summary["bodies"][b]["displacement_error"] <= 1e-10
    assert run.summary["schwarz"]["max"] <= 2 and run.summary["schwarz"]["set_changes"] == 0


@pytest.mark.parametrize("method", ["-schwarz_condense 0", "-schwarz_snes_type anderson", "-contact_pairs a:b", "-contact_pairs b:a"])
@pytest.mark.parametrize("pairing", ["quad4-tri3-3:2", "hex8-tet4-3:2"])
def test_methods(pairing, method, shared_run):
    """Whole bodies in every sweep, another outer iteration, either side. Measured: 4e-11 with Anderson's iteration."""
    options, stress = turned(pairing, "over", "frictionless")
    auto = "" if "pairs" in method else "-contact_pairs auto"
    assert check(shared_run(f"{STATIC} {auto} {options} {method}"), PRESSURE, stress, 1e-9) == nodes(pairing)


@pytest.mark.parametrize("ranks", [2, 3])
@pytest.mark.parametrize("law", list(LAWS))
def test_ranks(law, ranks, shared_run):
    options, stress = turned("hex8-tet4-3:2", "turned", law)
    assert check(shared_run(f"{STATIC} -contact_pairs auto {options}", ranks), PRESSURE, stress, 1e-10) == nodes("hex8-tet4-3:2")
