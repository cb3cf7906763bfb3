"""A block astride others: the nodes over the joint touch several, with one normal."""

import h5py
import numpy as np
import pytest
from cases import SAME, joined, last, long, same, worst_energy_error
from setups import FIELDS, box, linear, material, words

JOINT = 0.0
UNDER = {"II": "", "IE": "b c", "EI": "a", "EE": "a b c"}


def explicit(bodies):
    return " ".join(f"-{b}_ts_type centraldifference" for b in bodies.split())


def stack(halves, pairing="II", more="", dim=2, nu=0, widths=(-1, 1)):
    """Block a falls on blocks b and c, or on b alone, which is as wide as both. The masses of b and c are those of the one: mass moves by elements."""
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
    parts.append(f"-bodies {','.join(bodies)} -contact_pairs {'a:b,a:c' if halves else 'a:b'} -all_mass_redistribute true -time_step 0.02 -time_end 2.6")
    return joined(*parts, explicit(" ".join(b for b in UNDER[pairing].split() if b in bodies)), more)


def both(run, name):
    return run.history[f"contact/a:b/{name}"][()] + run.history[f"contact/a:c/{name}"][()]


@pytest.mark.parametrize(("pairing", "dim"), [("II", 3), ("IE", 2), ("EI", 3), ("EE", 2)])
def test_astride_two_blocks(pairing, dim, shared_run):
    """Without lateral strain the joint makes no difference. The meshes do not match, but the joint lies under a node."""
    halves, whole = shared_run(stack(True, pairing, dim=dim)), shared_run(stack(False, pairing, dim=dim))
    for name in ("force", "area"):
        values = whole.history[f"contact/a:b/{name}"][()]
        np.testing.assert_allclose(both(halves, name), values, rtol=0, atol=1e-8 * values.max(), err_msg=name)
    assert halves.summary["system"]["energy_error_final"] == pytest.approx(whole.summary["system"]["energy_error_final"], abs=1e-9)
    assert worst_energy_error(halves.summary) <= 1.7e-4  # measured: 1.3e-4
    assert halves.summary["system"]["momentum_error_max"] <= 1e-12
    assert halves.summary["contact"]["max_penetration"] <= 1e-11
    assert halves.summary["contact"]["tension_max"] == 0
    assert halves.summary["schwarz"]["set_cycles"] == 0
    assert halves.summary["schwarz"]["mean_contact_steps"] <= 2.5


UNLIKE = "-b_poissons_ratio 0.3 -c_poissons_ratio 0.2 -c_youngs_modulus 0.5"


@pytest.mark.parametrize(("pairing", "law"), [("II", "frictionless"), ("IE", "tied"), *long(("EE", "frictionless"))])
def test_astride_unlike_blocks(pairing, law, shared_run):
    """Each presses back as it can: what both take is what Robin conditions say, which know nothing of which row is prescribed."""
    tied = "-contact_tie_distance 0.1" if law == "tied" else ""  # the gap is 0.02 m, 0.04 of a face
    options = stack(True, pairing, f"{UNLIKE} -contact_law {law} {tied}", nu=0.25)
    pairs = ("a:b", "a:c")
    run = shared_run(options)
    assert worst_energy_error(run.summary) <= (1e-10 if law == "tied" and pairing == "II" else 7e-5)  # measured: 5.4e-5
    assert run.summary["system"]["momentum_error_max"] <= 1e-12
    same(run, shared_run(options, 2), SAME, "abc", pairs)
    same(run, shared_run(f"{options} -schwarz_transmission robin"), 1e-7, "abc", pairs)


@pytest.mark.parametrize("more", [explicit("b c") + " -b_ts_time_step 0.01 -c_ts_time_step 0.005", explicit("a b c") + " -a_ts_time_step 0.01 -b_ts_time_step 0.005 -c_ts_time_step 0.01"])
def test_astride_with_substeps(more, shared_run):
    options = stack(True, more=f"{UNLIKE} {more}", nu=0.25)
    run = shared_run(options)
    assert worst_energy_error(run.summary) <= 9e-5  # measured: 6.7e-5
    assert run.summary["system"]["momentum_error_max"] <= 1e-12


def test_astride_with_mass(shared_run):
    """Rows are shared by area: again the joint makes no difference."""
    mass = "-contact_type alternation " + " ".join(f"-{b}_mass_redistribute 0" for b in "abc")
    halves = shared_run(stack(True, "EE", mass))
    whole = shared_run(stack(False, "EE", mass.replace("-c_mass_redistribute 0", "")))
    force = whole.history["contact/a:b/force"][()]
    np.testing.assert_allclose(both(halves, "force"), force, rtol=0, atol=1e-8 * force.max())
    assert halves.summary["contact"]["max_penetration"] <= 1e-11


@pytest.mark.parametrize(("shape", "law"), [("quad4", "tied"), ("hex8", "frictionless")])
def test_patch_astride(shape, law, shared_run):
    """Pressed on two blocks of unlike widths and meshes, the pressure is uniform, and each takes as much as its width."""
    dim = 2 if shape == "quad4" else 3
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


def quarters(whole):
    """A block on a larger one, or on its quarters, whose moments of inertia are others: with the centres of mass alone kept, they have the
    masses of the whole."""
    parts = [box("a", (4, 4, 3), (-1, -1, 0.02), (1, 1, 1.02), "-a_dm_plex_simplex 0 -a_initial_velocity 0,0,-0.1"), material("a", nu=0)]
    under = {"b": (-1, -1)} if whole else {"b": (-1, -1), "c": (0, -1), "d": (-1, 0), "e": (0, 0)}
    for name, (x, y) in under.items():
        wide = 2 if whole else 1
        parts.append(box(name, (3 * wide, 3 * wide, 3), (x, y, -1), (x + wide, y + wide, 0), f"-{name}_dm_plex_simplex 0"))
        parts.append(material(name, nu=0))
    parts += [f"-{name}_mass_moments centre" for name in ("a", *under)]
    return joined(*parts, f"-bodies a,{','.join(under)} -contact_pairs {','.join(f'a:{name}' for name in under)} -time_step 0.04 -time_end 2.4")


def test_on_four_blocks(shared_run):
    """The node over the edge that all four share has four rows of one direction."""
    whole, four = shared_run(quarters(True)), shared_run(quarters(False))
    force = whole.history["contact/a:b/force"][()]
    assert force.max() > 0
    for pair in ("a:b", "a:c", "a:d", "a:e"):
        np.testing.assert_allclose(4 * four.history[f"contact/{pair}/force"][()], force, rtol=0, atol=1e-8 * force.max())
    assert four.summary["system"]["momentum_error_max"] <= 1e-12
    same(four, shared_run(quarters(False), 2), SAME, "abcde", ("a:b", "a:c", "a:d", "a:e"))


def over_a_joint():
    """options/sliding-flat.opts with the base in two parts, the joint at 1.83 m."""
    parts = [box("a", (21, 10), (0.5, 0), (1.5, 0.5), "-a_dm_plex_simplex 0"), box("b", (28, 4), (-1, -0.4), (1.83, 0), "-b_dm_plex_simplex 0"), box("c", (32, 4), (1.83, -0.4), (5, 0), "-c_dm_plex_simplex 0")]
    parts += [material(name, 1e9, 0.25, 1000, f"-{name}_ts_type static") for name in "abc"]
    parts.append("-a_boundary_displacement ymax -a_boundary_displacement_ymax 4*max(0,t-0.1),-5e-6*min(1,10*t)")
    parts += [f"-{name}_boundary_displacement ymin -{name}_boundary_displacement_ymin 0,0" for name in "bc"]
    return joined(*parts, "-bodies a,b,c -contact_pairs a.ymin:b.ymax,a.ymin:c.ymax -time_step 5e-3 -time_end 0.5")


def both_vectors(run):
    return sum(run.history[f"contact/a.ymin:{name}.ymax/force_vector"][()] for name in "bc")


def test_slides_over_a_joint(shared_run):
    """Over it a node after the other has a row for both sides. The edges there yield more than the middle."""
    run = shared_run(over_a_joint())
    force = both_vectors(run)
    moving = run.history["time"][()] > 0.1 + 1e-9
    normal = force[moving, 1]
    assert np.abs(force[moving, 0]).max() <= 2e-6 * np.abs(normal).mean()  # the tilt of the pressed surface; measured: 1.1e-6
    assert np.abs(normal / normal.mean() - 1).max() <= 0.027  # measured: 0.0204
    assert run.summary["contact"]["max_penetration"] <= 1e-12


@pytest.mark.parametrize("more", ["", "-b_ts_type centraldifference"])
def test_bar_on_two_bars(more, shared_run):
    """The bars take from the first the velocity v0 Z_a / (Z_a + Z_b + Z_c), and push back by it times their impedance Z = sqrt(E rho) A, which is
    the same along a bar where masses but those next to contact stay as they are; what keeps the centre of mass grades it, by 5e-4 of the force."""
    impedance = {"a": 1, "b": 1, "c": 0.5}
    parts = [f"-{name}_dm_plex_dim 1 -{name}_dm_plex_box_faces 50 -{name}_density {z} -{name}_youngs_modulus {z} -{name}_mass_moments total" for name, z in impedance.items()]
    parts.append("-a_dm_plex_box_lower -1.01 -a_dm_plex_box_upper -0.01 -a_initial_velocity 0.1 -bodies a,b,c -contact_pairs a:b,a:c -time_step 5e-3 -time_end 2.6")
    run = shared_run(joined(*parts, more))
    time = run.history["time"][()]
    steady = (time > 0.5) & (time < 1.9)  # contact begins at 0.1 s, and waves are back 2 s later
    velocity = 0.1 / sum(impedance.values())
    for name in "bc":
        force = run.history[f"contact/a:{name}/force"][()][steady]
        np.testing.assert_allclose(force, impedance[name] * velocity, rtol=6.3e-4)  # measured: 4.8e-4, half the factor on the masses of 50 elements, and what is left of the front, which dispersion spreads
    assert worst_energy_error(run.summary) <= 1.4e-4  # measured: 1.02e-4 at most
    assert run.summary["system"]["momentum_error_max"] <= 1e-12
