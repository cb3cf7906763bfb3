"""Static bodies that nothing but contact or ties holds, against closed forms and uncut bodies; and those that nothing holds."""

import h5py
import hertz
import numpy as np
import pytest
from cases import joined
from pairs import pairwise
from setups import FIELDS, box, material, plane

STACK = "-options_file options/stack-static.opts"
WEIGHTS = {"lower.ymin:floor": 60e3, "middle.ymin:lower.ymax": 40e3, "upper.ymin:middle.ymax": 10e3}
SINK = {"lower": (0, 50e-6), "middle": (50e-6, 62.5e-6), "upper": (62.5e-6, 112.5e-6)}  # of their lower and upper sides [m]
E, PRESSURE = 1e9, 1e6
FREE_FIRST, CLAMPED_FIRST = "free.xmin:clamped.xmax", "clamped.xmax:free.xmin"
CONTROLLER = "-time_step 1 -time_end 1"


def held(name, side, *displacement):
    return f"-{name}_boundary_displacement {side} -{name}_boundary_displacement_{side} {','.join(map(str, displacement))}"


def pulled(name, side, *traction):
    return f"-{name}_boundary_traction {side} -{name}_boundary_traction_{side} {','.join(map(str, traction))}"


def static(name, faces, lower, upper, more="", nu=0, e=E):
    return joined(box(name, faces, lower, upper, f"-{name}_ts_type static {more}"), material(name, e, nu, 1000))


def unit(name, dim, x, faces, more="", **kw):
    """A cube, square or bar from x to x + 1"""
    return static(name, (faces,) * dim, (x, *(0,) * (dim - 1)), (x + 1, *(1,) * (dim - 1)), more, **kw)


def zeros(dim, first=0):
    return (first, *(0,) * (dim - 1))


def last_fields(run):
    """Positions, displacements and pressures of all nodes at the end, by body if there are names."""
    with h5py.File(run.folder / "fields.h5") as file:
        step = max(file["displacement"])
        found = file["mesh/positions"][()], file["displacement"][step][()], file["contact_pressure"][step][()].ravel() if "contact_pressure" in file else None
    return found


@pytest.mark.parametrize(("dim", "pair", "law"), pairwise([1, 2, 3], ["a:b", "b:a"], ["tied", "pressed"]))
def test_uniaxial(dim, pair, law, shared_run):
    """A cube on one that is held, with other meshes, a traction on it: stress and strain are the same everywhere. Measured: displacements 6e-12 of the
    largest, forces 2e-12."""
    load = zeros(dim, f"{-PRESSURE}*t")
    options = joined(unit("a", dim, 0, 4, held("a", "xmin", *zeros(dim))), unit("b", dim, 1, 3, pulled("b", "xmax", *load)))
    run = shared_run(joined(f"-bodies a,b -contact_pairs {pair}", options, CONTROLLER, FIELDS, "-contact_law tied" if law == "tied" else ""))
    x, u, _ = last_fields(run)
    np.testing.assert_allclose(u[:, 0], -PRESSURE / E * x[:, 0], rtol=0, atol=2e-3 * 1e-10)
    assert np.abs(u[:, 1:]).max(initial=0) <= 2e-3 * 1e-10
    assert np.abs(next(iter(run.history["contact"].values()))["force"][-1]) == pytest.approx(PRESSURE, rel=1e-10)
    assert "floating, held by contact or ties alone: artificial springs of" in run.stdout


@pytest.mark.parametrize(("pairs", "ranks"), [(FREE_FIRST, 2), (CLAMPED_FIRST, 1)])
def test_tied_half_is_as_if_uncut(pairs, ranks, shared_run):
    """A cantilever, cut in two and tied, pulled, bent in both directions and twisted: measured 2e-11 of the largest displacement, half of it the error
    of the uncut body's solution in the condition of a slender beam."""
    low, middle, high = (0, 0, 0), (0.127, 0.0254, 0.0127), (0.254, 0.0254, 0.0127)
    load = ("1e4*t", "1e5*t*(1+100*z)", "2e4*t*(1-40*y)")
    more = f"{CONTROLLER} {FIELDS}"
    whole = joined(static("whole", (16, 4, 2), low, high, joined(held("whole", "xmin", 0, 0, 0), pulled("whole", "xmax", *load)), nu=0.25), more)
    parts = joined(static("clamped", (8, 4, 2), low, middle, held("clamped", "xmin", 0, 0, 0), nu=0.25),
                   static("free", (8, 4, 2), (0.127, 0, 0), high, pulled("free", "xmax", *load), nu=0.25), f"-contact_law tied {more}")  # fmt: skip
    x, u, _ = last_fields(shared_run(f"-bodies whole -contact_pairs none {whole}"))
    at = {tuple(place): each for place, each in zip(np.round(x / 1e-6).astype(int), u)}
    x, u, _ = last_fields(shared_run(f"-bodies free,clamped -contact_pairs {pairs} {parts}", ranks=ranks))
    uncut = np.array([at[tuple(place)] for place in np.round(x / 1e-6).astype(int)])
    assert np.abs(u - uncut).max() <= 1e-10 * np.abs(uncut).max()


METHODS = {
    "schwarz": "",
    "stiff springs": " ".join(f"-{name}_artificial_stiffness 0.1" for name in SINK),
    "anderson": "-schwarz_snes_type anderson",
    "lagrange": "-contact_type lagrange",
    "augmented": "-contact_type augmented_lagrangian -contact_penalty 1e12 -contact_augmentation_tolerance 1e-14",
    "neo-hookean": "-lower_material_type neo_hookean -middle_material_type neo_hookean -upper_material_type neo_hookean",
}


def check_stack(run, rtol):
    for pair, weight in WEIGHTS.items():
        np.testing.assert_allclose(run.history[f"contact/{pair}/force"][1:], weight * np.arange(0.25, 1.1, 0.25), rtol=rtol)
    x, u, pressure = last_fields(run)
    bottom = dict(zip(SINK, WEIGHTS.values()))
    for k, (name, (below, above)) in enumerate(SINK.items()):
        nodes = slice(*np.cumsum([0, 49, 36, 25])[k : k + 2])
        lies = np.isclose(x[nodes, 1], k)
        stands = np.isclose(x[nodes, 1], k + 1)
        np.testing.assert_allclose(pressure[nodes][lies], bottom[name], rtol=10 * rtol)  # 1 m wide
        np.testing.assert_allclose(-u[nodes, 1][lies], below, rtol=rtol, atol=1e-4 * rtol)
        np.testing.assert_allclose(-u[nodes, 1][stands], above, rtol=rtol)
        assert np.abs(u[nodes, 0]).max() <= 1e-4 * rtol


@pytest.mark.parametrize(("method", "ranks"), [*((method, 1) for method in METHODS), ("schwarz", 3)])
def test_stack(method, ranks, shared_run):
    """Every force, pressure and displacement as in theory: of linear bodies to 2e-10 of them (measured 1e-10), where iterations end earlier to 1e-6;
    of nonlinear ones to the strain, of 1e-4."""
    check_stack(shared_run(f"{STACK} {FIELDS} {METHODS[method]}", ranks), {"neo-hookean": 2e-4, "stiff springs": 1e-9, "anderson": 1e-6, "lagrange": 1e-7}.get(method, 2e-10))


def test_stack_by_penalty(shared_run):
    """Blocks sink into each other by their weight over the penalty, and nothing else changes."""
    run = shared_run(f"{STACK} -contact_type penalty -contact_penalty 1e12")
    for pair, weight in WEIGHTS.items():
        assert run.history[f"contact/{pair}/force"][-1] == pytest.approx(weight, rel=1e-10)
        assert run.history[f"contact/{pair}/gap"][-1] == pytest.approx(-weight / 1e12, rel=1e-6)


def test_falls_until_it_lies(shared_run):
    """The upper block begins 0.1 m above the middle one, and to its side: it comes to lie in the first step, and weighs on as before."""
    run = shared_run(f"{STACK} -upper_translate 0.2,0.1")
    for pair, weight in WEIGHTS.items():
        assert run.history[f"contact/{pair}/force"][-1] == pytest.approx(weight, rel=1e-9)


@pytest.mark.parametrize(("law", "dim"), [("", 2), ("-contact_law tied", 3)], ids=["pressed", "tied"])
def test_chain(law, dim, shared_run):
    """Of three cubes the middle one floats between one that is held and one that is pushed by 1 mm, twice as stiff as the others: 0.4, 0.2 and 0.4 mm."""
    options = joined(unit("a", dim, 0, 3, held("a", "xmin", *zeros(dim))), unit("b", dim, 1, 2, e=2 * E),
                     unit("c", dim, 2, 4, held("c", "xmax", *zeros(dim, "-1e-3*t"))), CONTROLLER, FIELDS, law)  # fmt: skip
    x, u, _ = last_fields(shared_run(f"-bodies a,b,c -contact_pairs a.xmax:b.xmin,c.xmin:b.xmax {options}"))
    np.testing.assert_allclose(-u[:, 0], np.interp(x[:, 0], [0, 1, 2, 3], [0, 4e-4, 6e-4, 1e-3]), rtol=0, atol=1e-13)


def test_punch(shared_run):
    """A block that may widen lies on a plane, under a punch that comes down by 1 mm: plane strain, uniform, E / (1 - nu^2) in height; both are of one
    material, the punch may not widen at its upper side, far from the block."""
    options = joined(static("block", (4, 4), (-0.5, 0), (0.5, 1), nu=0.3),
                     static("punch", (12, 4), (-2, 1), (2, 2), held("punch", "ymax", 0, "-1e-3*t"), nu=0, e=1e4 * E), CONTROLLER, FIELDS)  # fmt: skip
    run = shared_run(f"-bodies block,punch -obstacles floor {plane('floor', (0, 0), (0, 1))} -contact_pairs block.ymin:floor,block.ymax:punch.ymin {options}")
    x, u, _ = last_fields(run)
    block = slice(0, 25)
    force = 1e-3 * E / (1 - 0.3**2)
    assert run.history["contact/block.ymin:floor/force"][-1] == pytest.approx(force, rel=2e-4)  # the punch yields by 1e-4
    np.testing.assert_allclose(u[block, 1], -1e-3 * x[block, 1], rtol=0, atol=3e-7)
    np.testing.assert_allclose(u[block, 0], 1e-3 * 0.3 / 0.7 * x[block, 0], rtol=0, atol=3e-7)


@pytest.mark.long
def test_cylinder_between_plates(shared_run):
    """A cylinder between a rigid plane below and an elastic plate above, which comes down by 20 mm: Hertz's half width and largest pressure with the
    force that both bear, from nodes inside 0.9 of the half width: measured -0.5 and +0.3 % below, where it is 4 elements, -2.1 and +1.0 % above, where the plate
    is no half space. It may roll, and nothing makes it do so: its middle stays in place."""
    ball = joined("-ball_dm_plex_dim 2 -ball_dm_plex_shape ball -ball_ball_radius 1 -ball_ball_divisions 96 -ball_ball_layers 32 -ball_ball_keep_volume false",
                  "-ball_ts_type static", material("ball", E, 0.3, 1000))  # fmt: skip
    more = joined(static("plate", (128, 32), (-1, 1), (1, 2), held("plate", "ymax", 0, "-0.02*t"), nu=0.3), "-time_step 0.5 -time_end 1", FIELDS)
    floor = plane("floor", (0, -1), (0, 1))
    run = shared_run(f"-bodies ball,plate -obstacles floor {floor} -contact_pairs ball.surface:floor,ball.surface:plate.ymin {ball} {more}")
    x, u, pressure = last_fields(run)
    force = [abs(run.history[f"contact/ball.surface:{other}/force_vector"][-1][1]) for other in ("floor", "plate.ymin")]
    assert force[0] == pytest.approx(force[1], rel=1e-9)
    radius = np.hypot(x[:, 0], x[:, 1])
    for sign, compliance in ((-1, 1), (1, 2)):
        modulus = E / (1 - 0.3**2) / compliance
        width, peak = np.sqrt(4 * force[0] / (np.pi * modulus)), np.sqrt(force[0] * modulus / np.pi)
        nodes = (np.abs(radius - 1) < 0.01) & (sign * x[:, 1] > 0.9) & (np.abs(x[:, 0]) < 0.9 * width)
        np.testing.assert_allclose(np.array(hertz.fit(np.abs(x[nodes, 0]), pressure[nodes])) / (width, peak), 1, atol=0.03)
    assert np.abs(u[radius < 1e-9, 0]).max() <= 1e-9


UNHELD = {
    "sideways": ("-upper_body_force 1e-2*t,-1e4*t", "'upper'", "move along x", "-upper_boundary_displacement"),
    "up": ("-upper_body_force 0,1e4*t", "'upper'", "move along y"),
    "no-floor": ("-contact_pairs middle.ymin:lower.ymax,upper.ymin:middle.ymax", "move along y"),
    "neo-hookean": ("-upper_material_type neo_hookean -upper_body_force 1e2*t,-1e4*t", "'upper'", "move along x"),
}


@pytest.mark.parametrize("case", UNHELD)
def test_unheld(case, impakt):
    """What contact cannot hold is an error that says which body, and which way it goes."""
    options, *said = UNHELD[case]
    run = impakt(f"{STACK} {options}", expect_failure=True)
    for word in (*said, "is static, and neither contact nor ties hold it", "0 s"):
        assert word in run.stderr
    assert run.stderr.count("impakt: error") == 1


def test_no_contact_at_all(impakt):
    run = impakt(f"{STACK} -contact_pairs lower.ymin:floor,middle.ymin:lower.ymax", expect_failure=True)
    for word in ("'upper' is static", "nothing holds it", "move along x, y and turn about z", "-upper_boundary_displacement"):
        assert word in run.stderr


def test_substeps_are_refused(impakt):
    run = impakt(f"{STACK} -lower_ts_time_step 0.125", expect_failure=True)
    for word in ("'lower' is static", "2 substeps", "-lower_ts_time_step"):
        assert word in run.stderr


def test_bad_stiffness(impakt):
    run = impakt(f"{STACK} -lower_artificial_stiffness 0", expect_failure=True)
    assert "-lower_artificial_stiffness" in run.stderr and "positive" in run.stderr
