"""Nodes that touch two obstacles at once, in corners and grooves."""

import h5py
import numpy as np
import pytest
from cases import SAME, TIGHT, joined, last, long, same, worst_energy_error
from setups import FIELDS, box, linear, material, plane, rotation, words

EXPLICIT = "-a_ts_type centraldifference"


# A block pressed into a corner by the displacement of its far faces: its strain is uniform, so that any mesh has the exact solution.

FACES = (3, 2, 2)
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
    parts = [box("a", FACES[:dim], (0,) * dim, SIZE[:dim], simplex or "-a_dm_plex_simplex 0"), material("a", more=f"-a_material_type {kind} -a_ts_type static")]
    parts.append(f"-a_rotate {degrees if dim == 2 else words((*axis, degrees))} -a_rotate_centre {words((0,) * dim)}")
    parts.append(f"-a_boundary_displacement {','.join(far)} " + " ".join(f"-a_boundary_displacement_{side} {exact}" for side in far))
    parts.append(f"-a_exact_displacement {exact} -bodies a -obstacles {','.join(names)} {FIELDS} -time_step 1 -time_end 1")
    parts += [plane(name, (0,) * 3, (*across[:, i], *(0,) * (3 - dim))) for i, name in enumerate(names)]
    return " ".join(parts), dim, names, across


def check_pressed(run, dim, names, across, pressure):
    """What the walls carry of the uniform stress: where nodes of the far faces are held, which contact could not move, they carry nothing."""
    for i, name in enumerate(names):
        pair = f"a:{name}"
        assert last(run, pair, "active") == np.prod(np.delete(FACES[:dim], i))  # nodes but those of far faces
        assert last(run, pair, "force") == pytest.approx(-pressure[i] * last(run, pair, "area"), rel=1e-9)
        np.testing.assert_allclose(last(run, pair, "force_vector")[:dim], -last(run, pair, "force") * across[:, i], rtol=1e-9, atol=1e-12)
    assert run.summary["bodies"]["a"]["displacement_error"] <= 1e-9
    with h5py.File(run.folder / "fields.h5") as fields:
        found = fields["stress"][max(fields["displacement"])][()].reshape(-1, 3, 3)
    first = found[0]
    np.testing.assert_allclose(found, np.broadcast_to(first, found.shape), rtol=0, atol=1e-9 * np.abs(first).max())


@pytest.mark.parametrize(
    ("shape", "kind", "ranks"), [("quad4", "linear_elastic", 1), ("tri3", "neo_hookean", 1), ("hex8", "saint_venant_kirchhoff", 2), ("tet4", "linear_elastic", 1), ("hex8", "neo_hookean", 1)]
)
def test_pressed_into_a_corner(shape, kind, ranks, shared_run):
    options, dim, names, across = pressed(shape, kind)
    check_pressed(shared_run(options, ranks), dim, names, across, stress(kind, dim))


# A block flies into a corner, and turns back in both directions.

INTEGRATORS = {"implicit": "", "implicit-substeps": "-a_ts_time_step 0.01", "explicit": EXPLICIT, "explicit-substeps": f"{EXPLICIT} -a_ts_time_step 0.01"}


def thrown(degrees, more="", dim=2):
    """The corner is at the origin; the block reaches one wall after the other."""
    axis = (0, 0, 1) if dim == 2 else (1, -2, 0.7)
    across = rotation(axis, degrees)[:dim, :dim]
    lower, velocity = np.array((0.02, 0.03, 0.025))[:dim], across @ np.array((-0.1, -0.1, -0.07))[:dim]
    names = "lmn"[:dim]
    parts = [box("a", (4, 4, 3)[:dim], lower, lower + 1, f"-a_dm_plex_simplex 0 -a_initial_velocity {words(velocity)}"), material("a")]
    parts.append(f"-a_rotate {degrees if dim == 2 else words((*axis, degrees))} -bodies a -obstacles {','.join(names)} -time_step 0.02 -time_end 2.4")
    parts += [plane(name, (0,) * 3, (*across[:, i], *(0,) * (3 - dim))) for i, name in enumerate(names)]
    return joined(*parts, more)


def check_impulse(run, pairs, body="a"):
    """What the walls have given is what the body has got: the forces of each step act in the middle of two, so that round-off is left."""
    momentum = run.history[f"body/{body}/momentum"][()]
    given = -sum(run.history[f"contact/{pair}/impulse"][()][-1] for pair in pairs)[: momentum.shape[1]]
    np.testing.assert_allclose(given, momentum[-1] - momentum[0], rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("integrator", "dim", "kind"),
    [("implicit", 3, ""), ("explicit-substeps", 2, ""), ("implicit", 2, "neo_hookean"), *long(("implicit-substeps", 2, ""), ("explicit", 3, ""), ("explicit", 2, "neo_hookean"))],
)
def test_thrown_into_a_corner(integrator, dim, kind, shared_run):
    more = joined(INTEGRATORS[integrator], kind and f"-a_material_type {kind} {TIGHT}")
    options = thrown(23, more, dim)
    pairs = [f"a:{name}" for name in "lmn"[:dim]]
    run = shared_run(options)
    both = sum(run.history[f"contact/{pair}/active"][()] > 0 for pair in pairs)
    assert both.max() == dim  # at once
    assert worst_energy_error(run.summary) <= (2.5e-4 if kind else 2e-4)  # of steps of 0.02 s, in proportion to their square; measured: 1.9e-4, 1.6e-4
    assert run.summary["contact"]["tension_max"] == 0
    assert run.summary["contact"]["max_penetration"] <= 1e-11
    # Newton's method of the body leaves 1e-12 of its forces, the sweeps 1e-12 m of 0.1 m
    within = 1e-8 if kind else SAME
    same(run, shared_run(options, 2), within, "a", pairs)
    same(run, shared_run(thrown(0, more, dim)), within, "a", pairs)
    if "substeps" not in integrator:
        check_impulse(run, pairs)


# A square stands on its corner in a groove, whose walls are not square to each other: one node touches both.

GROOVE = 100  # degrees between the walls


def grooved(more=""):
    lean = np.radians(GROOVE / 2)
    walls = [plane("l", (0, 0, 0), (np.cos(lean), np.sin(lean), 0)), plane("r", (0, 0, 0), (-np.cos(lean), np.sin(lean), 0))]
    return joined(box("a", (4, 4), (0.02, 0.02), (1.02, 1.02), "-a_dm_plex_simplex 0 -a_rotate 45 -a_initial_velocity 0,-0.1"), material("a"), "-bodies a -obstacles l,r -time_step 0.02 -time_end 3", *walls, more)


@pytest.mark.parametrize("more", ["", f"{EXPLICIT} -a_material_type neo_hookean"])
def test_groove(more, shared_run):
    """By symmetry both walls push alike: twice the force times the sine of half the angle is what turns the square back."""
    run = shared_run(grooved(joined(more, TIGHT)))
    left, right = (run.history[f"contact/{pair}/force"][()] for pair in ("a:l", "a:r"))
    assert left.max() > 0
    np.testing.assert_allclose(left, right, rtol=0, atol=1e-9 * left.max())
    momentum = run.history["body/a/momentum"][()]
    impulse = 2 * np.sin(np.radians(GROOVE / 2)) * np.sum(0.02 * (left[1:] + left[:-1]) / 2)
    assert momentum[-1, 1] - momentum[0, 1] == pytest.approx(impulse, rel=1e-9)
    np.testing.assert_allclose(momentum[:, 0], 0, atol=1e-11)
    assert worst_energy_error(run.summary) <= 4.2e-4  # measured: 1e-4 to 3.3e-4


# Plane obstacles side by side, or one behind the other


@pytest.mark.parametrize("point", [(1, 0, 0), (0, -0.001, 0)])
def test_parallel_planes(point, impakt):
    """The nearer one alone would ever be touched."""
    walls = [plane(name, at, (0, 1, 0)) for name, at in (("l", (0, 0, 0)), ("r", point))]
    run = impakt(joined(box("a", (4, 4), (-1, 0.02), (1, 1.02), "-a_dm_plex_simplex 0"), material("a"), "-bodies a -obstacles l,r -time_step 0.02 -time_end 3", *walls), expect_failure=True)
    assert "a:l,a:r: two planes with one normal" in run.stderr


# More partners of a node than it has displacements

LEANT = {"concurrent": (0, 0, 0), "before": (0.001, 0.001, 0)}  # a point of the third plane, which cuts the corner off, or touches it


@pytest.mark.parametrize(("third", "more"), [("concurrent", ""), ("before", "-a_material_type neo_hookean"), *long(("before", EXPLICIT))])
def test_three_planes_in_two_dimensions(third, more, shared_run):
    """None is entered. Single forces of more rows than a node has displacements are not unique, what the body gets of them is."""
    options = joined(thrown(0, more), TIGHT, "-obstacles l,m,n", plane("n", LEANT[third], (1, 1, 0)))
    run = shared_run(options)
    pairs = ("a:l", "a:m", "a:n")
    check_impulse(run, pairs)
    assert worst_energy_error(run.summary) <= 1.8e-4  # measured: 1.3e-4
    assert run.summary["contact"]["max_penetration"] <= 1e-11
    assert run.summary["contact"]["tension_max"] == 0
    if not more:
        same(run, shared_run(options, 2), SAME, "a", ())


def test_tied_in_a_corner(shared_run):
    """The node in the corner is held by one of both. From touching, nothing moves any wall, and all energy stays in the block."""
    run = shared_run(joined(thrown(0), "-a_dm_plex_box_lower 0,0 -a_dm_plex_box_upper 1,1 -contact_law tied"), 2)
    check_impulse(run, ("a:l", "a:m"))
    assert worst_energy_error(run.summary) <= 1e-12
    assert run.summary["contact"]["max_penetration"] <= 1e-11
