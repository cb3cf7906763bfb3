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


@pytest.mark.parametrize("kind", ["linear_elastic", "saint_venant_kirchhoff", "neo_hookean"])
@pytest.mark.parametrize("shape", CORNERS)
def test_pressed_into_a_corner(shape, kind, shared_run):
    options, dim, names, across = pressed(shape, kind)
    pressure = stress(kind, dim)
    runs = [shared_run(options), shared_run(f"{options} -schwarz_condense 0"), shared_run(options, 2)]
    for run in runs:
        check_pressed(run, dim, names, across, pressure)


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


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_thrown_into_a_corner(integrator, dim, shared_run):
    options = thrown(23, INTEGRATORS[integrator], dim)
    pairs = [f"a:{name}" for name in "lmn"[:dim]]
    run = shared_run(options)
    both = sum(run.history[f"contact/{pair}/active"][()] > 0 for pair in pairs)
    assert both.max() == dim  # at once
    assert worst_energy_error(run.summary) <= 5e-4  # of steps of 0.02 s, in proportion to their square; measured: 1e-4 to 2e-4
    assert run.summary["contact"]["tension_max"] == 0
    assert run.summary["contact"]["max_penetration"] <= 1e-11
    same(run, shared_run(f"{options} -schwarz_condense 0"), SAME, "a", pairs)
    same(run, shared_run(options, 2), SAME, "a", pairs)
    same(run, shared_run(thrown(0, INTEGRATORS[integrator], dim)), SAME, "a", pairs)
    if "substeps" not in integrator:
        check_impulse(run, pairs)


@pytest.mark.parametrize("kind", ["saint_venant_kirchhoff", "neo_hookean"])
@pytest.mark.parametrize("integrator", ["implicit", "explicit"])
def test_nonlinear_thrown_into_a_corner(integrator, kind, shared_run):
    options = thrown(23, f"{INTEGRATORS[integrator]} -a_material_type {kind}")
    run = shared_run(options)
    assert worst_energy_error(run.summary) <= 5e-4  # measured: 1e-4 to 3.3e-4
    assert run.summary["schwarz"]["mean_contact_steps"] <= 5
    check_impulse(run, ("a:l", "a:m"))
    # Newton's method of the body leaves 1e-12 of its forces, the sweeps 1e-12 m of 0.1 m
    same(run, shared_run(thrown(0, f"{INTEGRATORS[integrator]} -a_material_type {kind}")), 1e-8, "a", ("a:l", "a:m"))
    same(run, shared_run(f"{options} -schwarz_snes_type anderson"), 1e-8, "a", ("a:l", "a:m"))


# A square stands on its corner in a groove, whose walls are not square to each other: one node touches both.

GROOVE = 100  # degrees between the walls


def grooved(more=""):
    lean = np.radians(GROOVE / 2)
    walls = [plane("l", (0, 0, 0), (np.cos(lean), np.sin(lean), 0)), plane("r", (0, 0, 0), (-np.cos(lean), np.sin(lean), 0))]
    return joined(box("a", (4, 4), (0.02, 0.02), (1.02, 1.02), "-a_dm_plex_simplex 0 -a_rotate 45 -a_initial_velocity 0,-0.1"), material("a"), "-bodies a -obstacles l,r -time_step 0.02 -time_end 3", *walls, more)


@pytest.mark.parametrize("more", ["", EXPLICIT, "-a_material_type neo_hookean", f"{EXPLICIT} -a_material_type neo_hookean"])
def test_groove(more, shared_run):
    """By symmetry both walls push alike: twice the force times the sine of half the angle is what turns the square back."""
    run = shared_run(grooved(more))
    left, right = (run.history[f"contact/{pair}/force"][()] for pair in ("a:l", "a:r"))
    assert left.max() > 0
    np.testing.assert_allclose(left, right, rtol=0, atol=1e-9 * left.max())
    momentum = run.history["body/a/momentum"][()]
    impulse = 2 * np.sin(np.radians(GROOVE / 2)) * np.sum(0.02 * (left[1:] + left[:-1]) / 2)
    assert momentum[-1, 1] - momentum[0, 1] == pytest.approx(impulse, rel=1e-9)
    np.testing.assert_allclose(momentum[:, 0], 0, atol=1e-11)
    assert worst_energy_error(run.summary) <= 5e-4  # measured: 1e-4 to 3.3e-4
    if "neo" not in more:
        same(run, shared_run(grooved(f"{more} -schwarz_condense 0")), SAME, "a", ("a:l", "a:r"))
    same(run, shared_run(grooved(more), 2), SAME, "a", ("a:l", "a:r"))


# A block astride two others: the nodes over the joint touch both, with one normal.

JOINT = 0.0
UNDER = {"II": "", "IE": "b c", "EI": "a", "EE": "a b c"}


def explicit(bodies):
    return " ".join(f"-{b}_ts_type centraldifference" for b in bodies.split())


def stack(halves, pairing="II", more="", dim=2, nu=0, widths=(-1, 1)):
    """Block a falls on blocks b and c, or on b alone, which is as wide as both."""
    last_axis = (4,) if dim == 2 else (2, 4)
    depth = () if dim == 2 else (0.5,)
    low, high = (lambda x, y: (x, *((0,) if depth else ()), y)), (lambda x, y: (x, *depth, y))
    fly = words((*(0,) * (dim - 1), -0.1))
    parts = [box("a", (4, *last_axis), low(widths[0], 0.02), high(widths[1], 1.02), f"-a_dm_plex_simplex 0 -a_initial_velocity {fly}"), material("a", nu=nu)]
    ends = (widths[0], JOINT, widths[1]) if halves else widths
    for name, left, right in zip("bc", ends, ends[1:]):
        parts.append(box(name, (3 if halves else 6, *last_axis), low(left, -1), high(right, 0), f"-{name}_dm_plex_simplex 0"))
        parts.append(material(name, nu=nu))
    bodies = "abc" if halves else "ab"
    parts.append(f"-bodies {','.join(bodies)} -contact_pairs {'a:b,a:c' if halves else 'a:b'} -time_step 0.02 -time_end 2.6")
    return joined(*parts, explicit(" ".join(b for b in UNDER[pairing].split() if b in bodies)), more)


def both(run, name):
    return run.history[f"contact/a:b/{name}"][()] + run.history[f"contact/a:c/{name}"][()]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("pairing", UNDER)
def test_astride_two_blocks(pairing, dim, shared_run):
    """Without lateral strain the joint makes no difference. The meshes do not match, but the joint lies under a node."""
    halves, whole = shared_run(stack(True, pairing, dim=dim)), shared_run(stack(False, pairing, dim=dim))
    for name in ("force", "area"):
        values = whole.history[f"contact/a:b/{name}"][()]
        np.testing.assert_allclose(both(halves, name), values, rtol=0, atol=1e-8 * values.max(), err_msg=name)
    assert halves.summary["system"]["energy_error_final"] == pytest.approx(whole.summary["system"]["energy_error_final"], abs=1e-9)
    assert worst_energy_error(halves.summary) <= 5e-4
    assert halves.summary["system"]["momentum_error_max"] <= 1e-12
    assert halves.summary["contact"]["max_penetration"] <= 1e-11
    assert halves.summary["contact"]["tension_max"] == 0
    assert halves.summary["schwarz"]["set_cycles"] == 0
    assert halves.summary["schwarz"]["mean_contact_steps"] <= 2.5


UNLIKE = "-b_poissons_ratio 0.3 -c_poissons_ratio 0.2 -c_youngs_modulus 0.5"


@pytest.mark.parametrize("law", ["frictionless", "tied"])
@pytest.mark.parametrize("pairing", ["II", "IE", "EE"])
def test_astride_unlike_blocks(pairing, law, shared_run):
    """Each presses back as it can: what both take is what Lagrange multipliers, and Robin conditions, say, which know nothing of which row is prescribed."""
    options = stack(True, pairing, f"{UNLIKE} -contact_law {law}", nu=0.25)
    pairs = ("a:b", "a:c")
    run = shared_run(options)
    assert worst_energy_error(run.summary) <= (1e-10 if law == "tied" and pairing == "II" else 5e-4)
    assert run.summary["system"]["momentum_error_max"] <= 1e-12
    for more in ("-schwarz_condense 0", "-schwarz_dense_limit 0"):
        same(run, shared_run(f"{options} {more}"), 1e-8 if "limit" in more else SAME, "abc", pairs)
    same(run, shared_run(options, 2), SAME, "abc", pairs)
    same(run, shared_run(f"{options} -schwarz_snes_type anderson"), 1e-7, "abc", pairs)
    same(run, shared_run(f"{options} -schwarz_transmission robin"), 1e-7, "abc", pairs)
    if pairing == "II" and law == "frictionless":
        same(run, shared_run(f"{options} -contact_type lagrange"), 1e-7, "abc", pairs)


@pytest.mark.parametrize("more", [explicit("b c") + " -b_ts_time_step 0.01 -c_ts_time_step 0.005", explicit("a b c") + " -a_ts_time_step 0.01 -b_ts_time_step 0.005 -c_ts_time_step 0.01", explicit("c")])
def test_astride_with_substeps(more, shared_run):
    options = stack(True, more=f"{UNLIKE} {more}", nu=0.25)
    run = shared_run(options)
    assert worst_energy_error(run.summary) <= 1e-3
    assert run.summary["system"]["momentum_error_max"] <= 1e-12
    same(run, shared_run(f"{options} -schwarz_condense 0"), SAME, "abc", ("a:b", "a:c"))


@pytest.mark.parametrize("mass", [" ".join(f"-{b}_mass_redistribute 0" for b in "abc")])
@pytest.mark.parametrize("pairing", ["II", "EE"])
def test_astride_with_mass(pairing, mass, shared_run):
    """Rows are shared by area: again the joint makes no difference."""
    halves = shared_run(stack(True, pairing, mass))
    whole = shared_run(stack(False, pairing, mass.replace("-c_mass_redistribute 0", "")))
    force = whole.history["contact/a:b/force"][()]
    np.testing.assert_allclose(both(halves, "force"), force, rtol=0, atol=1e-8 * force.max())
    assert halves.summary["contact"]["max_penetration"] <= 1e-11


@pytest.mark.parametrize("law", ["frictionless", "tied"])
@pytest.mark.parametrize("shape", ["quad4", "hex8"])
def test_patch_astride(shape, law, shared_run):
    """Pressed on two blocks of unlike widths and meshes, the pressure is uniform, and each takes as much as its width."""
    dim, _ = CORNERS[shape]
    widths, split, pressure = (0.6, 0.4), 0.24, 0.01  # a node of the upper block lies over the joint: 5 elements
    depth = (widths[1],) if dim == 3 else ()
    boxes = {"a": ((5, 2, 2), (0, 0.3), (widths[0], 0.5)), "b": ((3, 3, 2), (0, 0), (split, 0.3)), "c": ((4, 1, 3), (split, 0), (widths[0], 0.3))}
    gradient = np.diag([0] * (dim - 1) + [-pressure])  # of E = 1 without lateral strain
    exact = linear(gradient, np.zeros(dim), "t*")
    parts = []
    for name, (faces, lower, upper) in boxes.items():
        side = "xyz"[dim - 1] + ("max" if name == "a" else "min")
        faces = faces if dim == 3 else (faces[0], faces[2])
        parts.append(box(name, faces, (lower[0], *(0 for _ in depth), lower[1]), (upper[0], *depth, upper[1]), f"-{name}_dm_plex_simplex 0"))
        parts.append(material(name, nu=0, more=f"-{name}_ts_type static -{name}_boundary_displacement {side} -{name}_boundary_displacement_{side} {exact} -{name}_exact_displacement {exact}"))
    run = shared_run(f"{' '.join(parts)} -bodies a,b,c -contact_pairs a:b,a:c -contact_law {law} -time_step 1 -time_end 1 {FIELDS}")
    across = widths[1] if dim == 3 else 1
    assert last(run, "a:b", "force") == pytest.approx(pressure * split * across, rel=1e-8)
    assert last(run, "a:c", "force") == pytest.approx(pressure * (widths[0] - split) * across, rel=1e-8)
    for name in boxes:
        assert run.summary["bodies"][name]["displacement_error"] <= 1e-8
    with h5py.File(run.folder / "fields.h5") as fields:
        frame = max(fields["displacement"])
        active = fields["contact_active"][frame][()] > 0
        np.testing.assert_allclose(fields["contact_pressure"][frame][()][active], pressure, rtol=1e-8)


# Plane obstacles side by side, or one behind the other

FLAT = {"one": [(0, 0, 0)], "two": [(0, 0, 0), (1, 0, 0)], "behind": [(0, -0.001, 0), (0, 0, 0)]}


def fallen(planes, more=""):
    names = "lr"[: len(FLAT[planes])]
    walls = [plane(name, point, (0, 1, 0)) for name, point in zip(names, FLAT[planes])]
    return joined(box("a", (4, 4), (-1, 0.02), (1, 1.02), "-a_dm_plex_simplex 0 -a_initial_velocity 0,-0.1"), material("a"), f"-bodies a -obstacles {','.join(names)} -time_step 0.02 -time_end 3 {FIELDS.replace('1000000', '50')}", *walls, more)


@pytest.mark.parametrize("more", ["", EXPLICIT, "-a_material_type neo_hookean", "-schwarz_condense 0", "-contact_type penalty", "-contact_type lagrange", f"{EXPLICIT} -contact_type lagrange"])
@pytest.mark.parametrize("planes", ["two", "behind"])
def test_obstacles_beside_each_other(planes, more, shared_run):
    """Only the nearest counts: nothing changes."""
    one, two = shared_run(fallen("one", more)), shared_run(fallen(planes, more))
    nearest, other = ("r", "l") if planes == "behind" else ("l", "r")
    force = one.history["contact/a:l/force"][()]
    assert force.max() > 0
    np.testing.assert_allclose(two.history[f"contact/a:{nearest}/force"][()], force, rtol=0, atol=1e-12 * force.max())
    assert not two.history[f"contact/a:{other}/force"][()].any()
    with h5py.File(one.folder / "fields.h5") as first, h5py.File(two.folder / "fields.h5") as second:
        frame = sorted(first["contact_pressure"])[1]
        pressure = first["contact_pressure"][frame][()]
        assert pressure.max() > 0
        np.testing.assert_allclose(second["contact_pressure"][frame][()], pressure, rtol=0, atol=1e-12 * pressure.max())


# More partners of a node than it has displacements

LEANT = {"concurrent": (0, 0, 0), "before": (0.001, 0.001, 0)}  # a point of the third plane, which cuts the corner off, or touches it


@pytest.mark.parametrize("more", ["", EXPLICIT, "-a_material_type neo_hookean"])
@pytest.mark.parametrize("third", LEANT)
def test_three_planes_in_two_dimensions(third, more, shared_run):
    """None is entered, though only two rows of the node can be active at once."""
    options = joined(thrown(0, more), "-obstacles l,m,n", plane("n", LEANT[third], (1, 1, 0)))
    run = shared_run(options)
    pairs = ("a:l", "a:m", "a:n")
    check_impulse(run, pairs)
    assert worst_energy_error(run.summary) <= 5e-4
    assert run.summary["contact"]["max_penetration"] <= 1e-11
    assert run.summary["contact"]["tension_max"] == 0
    same(run, shared_run(options, 2), SAME, "a", pairs)
    if "neo" not in more:
        same(run, shared_run(f"{options} -schwarz_condense 0"), SAME, "a", pairs)


def test_tied_in_a_corner(shared_run):
    """The node in the corner is held by one of both. From touching, nothing moves any wall, and all energy stays in the block."""
    options = joined(thrown(0), "-a_dm_plex_box_lower 0,0 -a_dm_plex_box_upper 1,1 -contact_law tied")
    run = shared_run(options)
    check_impulse(run, ("a:l", "a:m"))
    assert worst_energy_error(run.summary) <= 1e-12
    assert run.summary["contact"]["max_penetration"] <= 1e-11
    same(run, shared_run(f"{options} -schwarz_condense 0"), SAME, "a", ("a:l", "a:m"))
    same(run, shared_run(options, 2), SAME, "a", ("a:l", "a:m"))


def quarters(whole, nu):
    """A block on a larger one, or on its quarters."""
    parts = [box("a", (4, 4, 3), (-1, -1, 0.02), (1, 1, 1.02), "-a_dm_plex_simplex 0 -a_initial_velocity 0,0,-0.1"), material("a", nu=nu)]
    under = {"b": (-1, -1)} if whole else {"b": (-1, -1), "c": (0, -1), "d": (-1, 0), "e": (0, 0)}
    for name, (x, y) in under.items():
        wide = 2 if whole else 1
        parts.append(box(name, (3 * wide, 3 * wide, 3), (x, y, -1), (x + wide, y + wide, 0), f"-{name}_dm_plex_simplex 0"))
        parts.append(material(name, nu=nu))
    return joined(*parts, f"-bodies a,{','.join(under)} -contact_pairs {','.join(f'a:{name}' for name in under)} -time_step 0.04 -time_end 2.4")


def test_on_four_blocks(shared_run):
    """The node over the edge that all four share has four rows of one direction."""
    whole, four = shared_run(quarters(True, 0)), shared_run(quarters(False, 0))
    force = whole.history["contact/a:b/force"][()]
    assert force.max() > 0
    for pair in ("a:b", "a:c", "a:d", "a:e"):
        np.testing.assert_allclose(4 * four.history[f"contact/{pair}/force"][()], force, rtol=0, atol=1e-8 * force.max())
    assert four.summary["system"]["momentum_error_max"] <= 1e-12
    same(four, shared_run(quarters(False, 0), 2), SAME, "abcde", ("a:b", "a:c", "a:d", "a:e"))
    same(*(shared_run(f"{quarters(False, 0.25)} -schwarz_condense {way}") for way in (0, 1)), SAME, "abcde", ("a:b", "a:c", "a:d", "a:e"))


def over_a_joint(more=""):
    """options/sliding-flat.opts with the base in two parts, the joint at 1.83 m."""
    parts = [box("a", (21, 10), (0.5, 0), (1.5, 0.5), "-a_dm_plex_simplex 0"), box("b", (28, 4), (-1, -0.4), (1.83, 0), "-b_dm_plex_simplex 0"), box("c", (32, 4), (1.83, -0.4), (5, 0), "-c_dm_plex_simplex 0")]
    parts += [material(name, 1e9, 0.25, 1000, f"-{name}_ts_type static") for name in "abc"]
    parts.append("-a_boundary_displacement ymax -a_boundary_displacement_ymax 4*max(0,t-0.1),-5e-6*min(1,10*t)")
    parts += [f"-{name}_boundary_displacement ymin -{name}_boundary_displacement_ymin 0,0" for name in "bc"]
    return joined(*parts, "-bodies a,b,c -contact_pairs a.ymin:b.ymax,a.ymin:c.ymax -time_step 5e-3 -time_end 0.5", more)


def both_vectors(run):
    return sum(run.history[f"contact/a.ymin:{name}.ymax/force_vector"][()] for name in "bc")


def test_slides_over_a_joint(shared_run):
    """Over it a node after the other has a row for both sides. The edges there yield more than the middle, by what Lagrange multipliers say too."""
    run = shared_run(over_a_joint())
    force = both_vectors(run)
    moving = run.history["time"][()] > 0.1 + 1e-9
    normal = force[moving, 1]
    assert np.abs(force[moving, 0]).max() <= 2e-6 * np.abs(normal).mean()  # the tilt of the pressed surface; measured: 1.1e-6
    assert np.abs(normal / normal.mean() - 1).max() <= 0.05
    assert run.summary["contact"]["max_penetration"] <= 1e-12
    np.testing.assert_allclose(force, both_vectors(shared_run(over_a_joint("-contact_type lagrange"))), rtol=0, atol=1e-7 * np.abs(normal).max())
    np.testing.assert_allclose(force, both_vectors(shared_run(over_a_joint("-schwarz_condense 0"))), rtol=0, atol=SAME * np.abs(normal).max())
