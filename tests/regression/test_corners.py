"""Nodes that touch two partners at once: in corners and grooves their normals are oblique, beside each other they are the same."""

import h5py
import numpy as np
import pytest
from cases import joined, worst_energy_error
from test_contact_patch import linear
from test_solids_wave import rotation

pytest_plugins = "shared_runs"

EXPLICIT = "-a_ts_type centraldifference"
SAME = 1e-9  # the issue's: sweeps on the compliance or on the bodies
FIELDS = "-output_fields fields.h5 -output_fields_precision double -output_fields_interval 1000000"


def words(values):
    return ",".join(f"{value:.17g}" for value in values)


def plane(name, point, normal):
    return f"-{name}_obstacle_type plane -{name}_point {words(point)} -{name}_normal {words(normal)}"


def box(name, faces, lower, upper, more=""):
    return f"-{name}_dm_plex_dim {len(lower)} -{name}_dm_plex_box_faces {','.join(map(str, faces))} -{name}_dm_plex_box_lower {words(lower)} -{name}_dm_plex_box_upper {words(upper)} {more}"


def material(name, e=1, nu=0.25, rho=1, more=""):
    return f"-{name}_youngs_modulus {e} -{name}_poissons_ratio {nu} -{name}_density {rho} {more}"


def last(run, pair, name):
    return run.history[f"contact/{pair}/{name}"][()][-1]


def same(first, second, tolerance, bodies, pairs):
    for pair in pairs:
        np.testing.assert_array_equal(first.history[f"contact/{pair}/active"], second.history[f"contact/{pair}/active"])
    for name in [f"contact/{pair}/force" for pair in pairs] + [f"body/{b}/{energy}" for b in bodies for energy in ("kinetic", "potential")]:
        values = first.history[name][()]
        np.testing.assert_allclose(second.history[name][()], values, rtol=0, atol=tolerance * np.abs(values).max(), err_msg=name)


# A block pressed into a corner by the displacement of its far faces: its strain is uniform, so that any mesh has the exact solution.

SIZE = np.array((0.6, 0.5, 0.4))
STRAIN = np.array((-0.02, -0.01, -0.015))
TURNS = {2: ((0, 0, 1), 37), 3: ((1, -2, 0.7), 71)}
CORNERS = {"quad4": (2, ""), "tri3": (2, "-a_dm_plex_simplex 1"), "hex8": (3, ""), "tet4": (3, "-a_dm_plex_simplex 1")}


def stress(kind, dim, e=1, nu=0.25):
    """First Piola-Kirchhoff stress along the axes; in two dimensions the third strain is zero."""
    mu, lame = e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))
    strain = np.array([*STRAIN[:dim], *(0,) * (3 - dim)])
    if kind == "linear_elastic":
        return 2 * mu * strain + lame * strain.sum()
    stretch = 1 + strain
    if kind == "saint_venant_kirchhoff":  # F S with S = 2 mu E + lambda tr E
        green = (stretch**2 - 1) / 2
        return stretch * (2 * mu * green + lame * green.sum())
    return mu * (stretch - 1 / stretch) + lame / 2 * (stretch.prod() ** 2 - 1) / stretch  # neo-Hookean, as in src/body/material/neohookean.c


def pressed(shape, kind):
    """The corner is at the origin, and the walls are the planes across the axes, all turned."""
    dim, simplex = CORNERS[shape]
    axis, degrees = TURNS[dim]
    across = rotation(axis, degrees)[:dim, :dim]
    exact = linear(across @ np.diag(STRAIN[:dim]) @ across.T, np.zeros(dim), "t*")
    names = "lmn"[:dim]
    far = [f"{x}max" for x in "xyz"[:dim]]
    parts = [box("a", (3, 2, 2)[:dim], (0,) * dim, SIZE[:dim], simplex or "-a_dm_plex_simplex 0"), material("a", more=f"-a_material_type {kind} -a_ts_type static")]
    parts.append(f"-a_rotate {degrees if dim == 2 else words((*axis, degrees))} -a_rotate_centre {words((0,) * dim)}")
    parts.append(f"-a_boundary_displacement {','.join(far)} " + " ".join(f"-a_boundary_displacement_{side} {exact}" for side in far))
    parts.append(f"-a_exact_displacement {exact} -bodies a -obstacles {','.join(names)} {FIELDS} -time_step 1 -time_end 1")
    parts += [plane(name, (0,) * 3, (*across[:, i], *(0,) * (3 - dim))) for i, name in enumerate(names)]
    return " ".join(parts), dim, names, across


def check_pressed(run, dim, names, across, pressure):
    """What the walls carry of the uniform stress: where nodes of the far faces are held, which contact could not move, they carry nothing."""
    for i, name in enumerate(names):
        pair = f"a:{name}"
        assert last(run, pair, "force") == pytest.approx(-pressure[i] * last(run, pair, "area"), rel=1e-9)
        np.testing.assert_allclose(last(run, pair, "force_vector")[:dim], -last(run, pair, "force") * across[:, i], rtol=1e-9, atol=1e-12)
    assert run.summary["bodies"]["a"]["displacement_error"] <= 1e-9
    with h5py.File(run.folder / "fields.h5") as fields:
        found = fields["stress"][max(fields["displacement"])][()].reshape(-1, 3, 3)
    first = found[0]
    np.testing.assert_allclose(found, np.broadcast_to(first, found.shape), rtol=0, atol=1e-9 * np.abs(first).max())


@pytest.mark.parametrize("kind", ["linear_elastic", "saint_venant_kirchhoff", "neo_hookean"])
@pytest.mark.parametrize("shape", CORNERS)
def test_pressed_into_a_corner(shape, kind, shared_run):
    options, dim, names, across = pressed(shape, kind)
    pressure = stress(kind, dim)
    runs = [shared_run(options), shared_run(f"{options} -schwarz_condense 0"), shared_run(options, 2)]
    for run in runs:
        check_pressed(run, dim, names, across, pressure)
