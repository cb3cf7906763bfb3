"""Forces and moments that hold surfaces and that obstacles exert: against statics by hand, and against the momenta that they change."""

import numpy as np
import pytest
from cases import long
from pairs import pairwise

ROUND_OFF = 1e-11  # of the largest force in a run, against which solvers and sums of some hundred nodes have round-off
# E = 1 GPa, rho = 1000 kg/m^3: waves of 1000 m/s, here of bars and blocks 2 m long, in steps of less than half an element
BAR = "-bodies b -b_dm_plex_dim 1 -b_dm_plex_box_faces 20 -b_dm_plex_box_upper 2 -b_density 1000 -b_youngs_modulus 1e9 -b_cross_section 1e-2"
PLATE = (
    "-bodies b -b_dm_plex_dim 2 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 8,3 -b_dm_plex_box_upper 2,0.5 -b_density 1000 -b_youngs_modulus 1e9 "
    "-b_poissons_ratio 0.3 -b_thickness 0.2"
)
BLOCK = (
    "-bodies b -b_dm_plex_dim 3 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 4,2,2 -b_dm_plex_box_upper 2,0.5,0.4 -b_density 1000 -b_youngs_modulus 1e9 "
    "-b_poissons_ratio 0.3"
)
INTEGRATORS = {
    "implicit": "-time_step 4e-5",
    "implicit lumped": "-time_step 4e-5 -b_mass_type lumped",
    "explicit": "-time_step 3e-5 -b_ts_type centraldifference",
    "explicit averaged": "-time_step 3e-5 -b_ts_type centraldifference -b_mass_type averaged",
}
CLAMPED = "-b_boundary_displacement xmin -b_boundary_displacement_xmin"


def reaction(run, surface, body="b"):
    group = run.history[f"body/{body}/reaction/{surface}"]
    return group["force"][:], group["moment"][:]


def last(run, surface, body="b"):
    force, moment = reaction(run, surface, body)
    summary = run.summary["bodies"][body]["reactions"][surface]
    assert summary["force"] == list(force[-1])
    assert summary["moment"] == list(moment[-1])
    assert summary["force_peak"] == pytest.approx(np.linalg.norm(force, axis=1).max(), rel=1e-15)
    return force[-1], moment[-1]


def test_bar_pulled(impakt):
    """1 MPa x 1 cm^2, and 2 kN along the bar by a force in the volume, whose part at the held node is a load too."""
    run = impakt(f"{BAR} -b_ts_type static {CLAMPED} 0 -b_boundary_traction xmax -b_boundary_traction_xmax 1e6 -b_body_force 1e5 -time_end 1 -time_step 1", 3)
    force, moment = last(run, "xmin")
    np.testing.assert_allclose(force, [-12e3, 0, 0], atol=12e3 * ROUND_OFF)
    np.testing.assert_array_equal(moment, 0)
    assert reaction(run, "xmin")[0][0, 0] == 0  # it is loaded from the first step on
    assert "b.xmin" in run.stdout


@pytest.mark.parametrize(("material", "ranks"), [("linear_elastic", 1), ("neo_hookean", 2)])
def test_cantilever(material, ranks, impakt):
    """A tip force F at x = 2 m: the support has -F and the moment -2 m F about its middle, here about the origin at its lower corner. A nonlinear
    cantilever has its moment with the tip where it is then: that is in balance with the load on the nodes as they are, of the exact resultant F and,
    as the nodes of the tip stay together, of a moment that is off by its deflection of about F L^3 / 3 E I = 0.26 mm along x, squared over L."""
    load = "-b_boundary_traction xmax -b_boundary_traction_xmax 0,-1e5*t"
    run = impakt(f"{PLATE} -b_ts_type static -b_material_type {material} {CLAMPED} 0,0 {load} -time_end 1 -time_step 0.5", ranks)
    force, moment = last(run, "xmin")
    tip = -1e5 * 0.5 * 0.2
    np.testing.assert_allclose(force, [0, -tip, 0], atol=-tip * 1e-9)
    np.testing.assert_allclose(moment, [0, 0, -tip * 2], rtol=1e-9 if material == "linear_elastic" else 1e-3)
    np.testing.assert_allclose(reaction(run, "xmin")[0][1], force / 2, atol=-tip * 1e-9)


@pytest.mark.parametrize(("mass", "ranks"), [("averaged", 1), *long(("lumped", 3))])
def test_weight_of_a_held_block(mass, ranks, impakt):
    """400 kg: its weight, and the moment about the origin of its weight at (1, 0.25, 0.2) m, by statics alone, whatever the stiffness."""
    run = impakt(f"{BLOCK} -b_ts_type static -b_mass_type {mass} {CLAMPED} 0,0,0 -b_gravity 3,4,-12 -time_end 1 -time_step 1", ranks)
    force, moment = last(run, "xmin")
    weight = 400 * np.array([3, 4, -12])
    np.testing.assert_allclose(force, -weight, atol=5e3 * ROUND_OFF)
    np.testing.assert_allclose(moment, -np.cross([1, 0.25, 0.2], weight), atol=5e3 * 1e-10)


def test_two_surfaces_share_an_edge(impakt):
    """A block stands on rollers at three sides that meet; the nodes of their edges belong to the side named last where both hold the same component.
    xmin and ymin hold different ones, so that each has the whole force along its normal; zmin is held in all, and named last, then first."""
    load = "-b_boundary_traction xmax,ymax -b_boundary_traction_xmax -1e6,0,0 -b_boundary_traction_ymax 0,-2e6,0"
    held = "-b_boundary_displacement_xmin 0,free,free -b_boundary_displacement_ymin free,0,free -b_boundary_displacement_zmin 0,0,0"
    loads = np.array([-1e6 * 0.5 * 0.4, -2e6 * 2 * 0.4, 0])
    shares = []
    for order in ("xmin,ymin,zmin", "zmin,xmin,ymin"):
        run = impakt(f"{BLOCK} -b_ts_type static -b_boundary_displacement {order} {held} {load} -time_end 1 -time_step 1")
        force = {name: last(run, name)[0] for name in ("xmin", "ymin", "zmin")}
        moment = sum(last(run, name)[1] for name in force)
        np.testing.assert_allclose(sum(force.values()), -loads, atol=2e6 * ROUND_OFF)
        arms = np.cross([2, 0.25, 0.2], [loads[0], 0, 0]) + np.cross([1, 0.5, 0.2], [0, loads[1], 0])
        np.testing.assert_allclose(moment, -arms, rtol=1e-3)  # of the nodes as they are then, at strains of 2e-3
        assert force["xmin"][1] == force["xmin"][2] == force["ymin"][0] == 0
        shares.append(force["zmin"][0])
    assert shares[0] > shares[1] + 1e-3 * abs(loads[0])  # the edge counts for zmin, then for xmin


@pytest.mark.parametrize(("shape", "integrator", "material"), pairwise([PLATE, BAR], INTEGRATORS, ["linear_elastic", "neo_hookean"]) + long((BLOCK, "implicit", "neo_hookean"), (BLOCK, "explicit", "linear_elastic")))
def test_momentum_follows_loads_and_reactions(material, integrator, shape, impakt):
    """What is clamped at one end and pulled at the other: v(n+1) - v(n) = dt/2 (a(n) + a(n+1)) in both schemes, so that momentum changes by
    the trapezoidal sum of load and reaction, to round-off; and its support moves not at all."""
    dim = {BAR: 1, PLATE: 2, BLOCK: 3}[shape]
    area = {BAR: 1e-2, PLATE: 0.1, BLOCK: 0.2}[shape]
    zeros = ",0" * (dim - 1)
    traction = f"1e6*sin(2000*t){',3e5' if dim > 1 else ''}{',0' if dim > 2 else ''}"
    run = impakt(
        f"{shape} {INTEGRATORS[integrator]} -b_material_type {material} {CLAMPED} 0{zeros} -b_boundary_traction xmax "
        f"-b_boundary_traction_xmax {traction} -time_end 3e-3"
    )
    time, momentum = run.history["time"][:], run.history["body/b/momentum"][:].reshape(-1, dim)
    load = np.zeros((len(time), 3))
    load[:, 0] = 1e6 * area * np.sin(2000 * time)
    if dim > 1:
        load[:, 1] = 3e5 * area
    force = (reaction(run, "xmin")[0] + load)[:, :dim]
    np.testing.assert_allclose(np.diff(momentum, axis=0), 0.5 * np.diff(time)[:, None] * (force[1:] + force[:-1]), atol=1e-9 * np.abs(momentum).max())
    assert np.abs(reaction(run, "xmin")[0][:, 0]).max() > 0.5e6 * area  # the wave has come to the support


@pytest.mark.parametrize("integrator", ["", "-b_ts_type centraldifference", "-b_ts_time_step 5e-6"])
def test_prescribed_motion_carries_its_inertia(integrator, impakt):
    """Both ends of the bar move by c t^2 / 2: it is accelerated by c as a whole but for the first step, and the ends share its 20 kg c."""
    ends = "-b_boundary_displacement xmin,xmax -b_boundary_displacement_xmin 500*t^2 -b_boundary_displacement_xmax 500*t^2"
    run = impakt(f"{BAR} {ends} {integrator} -b_initial_velocity 0 -b_body_force 1e6 -time_end 1e-3 -time_step 1e-5")
    total = reaction(run, "xmin")[0][:, 0] + reaction(run, "xmax")[0][:, 0]
    np.testing.assert_allclose(total[1:], 0, atol=20e3 * 1e-6)  # rates of prescribed displacements are differences in time
    assert run.summary["bodies"]["b"]["reactions"]["xmin"]["force"][0] == pytest.approx(0, abs=20e3 * 1e-6)


BAR_AND_WALL = (
    f"{BAR} -obstacles wall -wall_obstacle_type plane -wall_point 2.0005 -wall_normal -1 -contact_pairs b.xmax:wall {CLAMPED} 0 -b_initial_displacement 0 "
    "-b_initial_velocity 5*x -time_end 1.5e-3 -time_step 1e-5"
)


@pytest.mark.parametrize("integrator", ["", "-b_ts_type centraldifference", "-b_ts_type centraldifference -b_ts_time_step 5e-6"])
def test_obstacle_and_support(integrator, impakt):
    """A bar that is held at one end, and hits a wall with the other: the obstacle has the opposite of the contact force on it, and both
    reactions together have the momentum's change: to the trapezoidal error of a controller step where there are two substeps."""
    run = impakt(f"{BAR_AND_WALL} {integrator} -contact_energy_cap false")
    wall, held = run.history["obstacle/wall/reaction/force"][:], reaction(run, "xmin")[0]
    np.testing.assert_array_equal(wall, -run.history["contact/b.xmax:wall/force_vector"][:])
    assert wall[:, 0].min() < -1e3 and wall[:, 0].max() <= 0
    assert run.summary["obstacles"]["wall"]["force_peak"] == -wall[:, 0].min()
    time, momentum = run.history["time"][:], run.history["body/b/momentum"][:].ravel()
    force = (wall + held)[:, 0]
    change = np.diff(momentum) - 0.5 * np.diff(time) * (force[1:] + force[:-1])
    assert np.abs(change).max() <= (1e-10 if "time_step" not in integrator else 2e-2) * np.abs(momentum).max()


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_obstacle_carries_the_weight(ranks, impakt):
    """A plate of 200 kg that stands on an obstacle at rest, and the moment of its weight about the origin; nothing holds it elsewhere but a roller."""
    floor = "-obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1 -contact_pairs b.ymin:floor"
    roller = f"{CLAMPED} 0,free"
    run = impakt(f"{PLATE} -b_ts_type static {floor} {roller} -b_gravity 0,-10 -time_end 1 -time_step 0.5", ranks)
    np.testing.assert_allclose(run.history["obstacle/floor/reaction/force"][-1], [0, 2000, 0], atol=2000 * 1e-9)
    support, at_support = last(run, "xmin")
    moment = run.history["obstacle/floor/reaction/moment"][-1] + at_support
    np.testing.assert_allclose(support, 0, atol=2000 * 1e-9)
    np.testing.assert_allclose(moment, [0, 0, 2000], rtol=1e-4)  # the nodes where they are then: 1e-6 m from where they were


@pytest.mark.parametrize(
    ("held", "more"),
    [("0,0", ""), ("0,free", "-b_ts_type centraldifference -b_damping_stiffness 1e-5"), ("0,0", "-b_material_type neo_hookean -b_damping_stiffness 1e-5 -b_damping_mass 100")],
)
def test_held_nodes_in_contact(more, held, impakt):
    """A plate that is held at one side swings down on a floor, which its held corner touches as well: what contact does to held nodes is the floor's
    reaction, and not the support's. Momentum follows from both, weight and drag, to round-off of 200 steps."""
    plate = PLATE.replace("upper 2,0.5", "lower 0,1e-5 -b_dm_plex_box_upper 2,0.50001").replace("thickness 0.2", "thickness 1")
    floor = "-obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1 -contact_pairs b.ymin:floor -contact_energy_cap false"
    run = impakt(f"{plate} {floor} {CLAMPED} {held} -b_gravity 0,-10 -b_initial_velocity 0,-0.1*x -controller_step_cuts 0 -time_end 4e-3 -time_step 2e-5 {more}")
    time, momentum = run.history["time"][:], run.history["body/b/momentum"][:]
    at_floor = run.history["obstacle/floor/reaction/force"][:, :2]
    force = reaction(run, "xmin")[0][:, :2] + at_floor + [0, -1e4] - (100 if "damping_mass" in more else 0) * momentum
    change = np.diff(momentum, axis=0) - 0.5 * np.diff(time)[:, None] * (force[1:] + force[:-1])
    assert np.abs(change).max() <= 1e-13 * np.abs(momentum).max()
    assert at_floor[:, 1].max() > 1e5


def test_held_face_that_pushes(impakt):
    """A block, all of whose face towards the other one is led, presses that by 1 mm: what leads it bears the whole contact force, and its work is what the other
    one has of strain energy. Linear: to round-off; measured 7e-14."""
    blocks = " ".join(f"-{b}_dm_plex_box_faces {n},{n} -{b}_density 1 -{b}_youngs_modulus 1e9 -{b}_poissons_ratio 0.3 -{b}_ts_type static" for b, n in (("a", 4), ("b", 3)))
    held = "-a_boundary_displacement ymin -a_boundary_displacement_ymin 0,0 -b_boundary_displacement ymin -b_boundary_displacement_ymin 0,-1e-3*t"
    run = impakt(f"-bodies a,b -contact_pairs a:b {blocks} -b_translate 0,1 {held} -time_step 0.5 -time_end 1")
    energy = run.history["body/a/potential"][-1]
    assert run.history["body/b/external_work"][-1] == pytest.approx(energy, rel=1e-11)
    pushes, bears = (run.history[f"body/{b}/reaction/ymin/force"][-1] for b in "ba")
    assert bears[1] == pytest.approx(2 * energy / 1e-3, rel=1e-11)
    np.testing.assert_allclose(pushes, -bears, rtol=0, atol=1e-11 * bears[1])
