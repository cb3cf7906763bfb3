"""Bodies that do not deform: free flight, contact with those that do, led by formulas; what is refused."""

import h5py
import hertz
import numpy as np
import pytest
from cases import SAME, long, worst_energy_error
from messages import check_message

BRICK = (
    "-bodies a -a_rigid true -a_dm_plex_dim 3 -a_dm_plex_box_upper 1,2,3 -a_dm_plex_box_faces 2,3,4 -a_density 1000 -time_end 2 "
    "-a_initial_velocity 1+3*(z-1.5)-0.02*(y-1),0.02*(x-0.5)-0.01*(z-1.5),0.01*(y-1)-3*(x-0.5)"
)
INERTIA = 6000 / 12 * np.array([4 + 9, 1 + 9, 1 + 4])  # of a brick of 6000 kg


def spin_of_brick(end, n=2000):
    """Euler's equations J w' = J w x w for the components along the axes of the brick, by the Runge-Kutta method of fourth order."""

    def rate(w):
        return np.cross(INERTIA * w, w) / INERTIA

    w, h = np.array([0.01, 3.0, 0.02]), end / n
    for _ in range(n):
        a = rate(w)
        b = rate(w + h / 2 * a)
        c = rate(w + h / 2 * b)
        w = w + h / 6 * (a + 2 * b + 2 * c + rate(w + h * c))
    return w


def turn(vector):
    """The matrix of the rotation by |vector| about it, by Rodrigues."""
    angle = np.linalg.norm(vector)
    axis = vector / angle
    cross = -np.cross(np.eye(3), axis).T
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def test_free_flight(impakt):
    """A brick that turns about its middle axis, which it does not stay at: energy and momenta to round-off at any step, angular velocity to second
    order in it; the moments of inertia are those of the true brick, however coarse its mesh."""
    errors, exact = [], spin_of_brick(2)
    for step in (2e-2, 1e-2, 5e-3):
        run = impakt(f"{BRICK} -time_step {step}")
        body = run.history["body/a"]
        spin, moment, kinetic = body["angular_velocity"][()], body["angular_momentum"][()], body["kinetic"][()]
        assert kinetic[0].item() == pytest.approx(0.5 * 6000 + 0.5 * (INERTIA * np.array([0.01, 3, 0.02]) ** 2).sum(), rel=1e-12)
        assert np.abs(kinetic / kinetic[0] - 1).max() <= 1e-12  # measured: 1e-13
        assert np.abs(moment - moment[0]).max() <= 1e-11 * np.abs(moment).max()
        np.testing.assert_allclose(body["centre"][-1], [2.5, 1, 1.5], rtol=0, atol=1e-11)
        frame = turn(body["rotation"][-1])
        errors.append(np.linalg.norm(frame.T @ spin[-1] - exact))
    assert errors[2] <= 2e-3  # measured: 6e-4 of 3 rad/s
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.1)


def test_spins_fast(impakt):
    """300 radians a second in steps of 0.1 s: far from accurate, and nothing is lost or gained."""
    run = impakt(f"{BRICK} -time_step 0.1 -a_initial_velocity 300*(z-1.5)-2*(y-1),2*(x-0.5)-(z-1.5),(y-1)-300*(x-0.5)")
    kinetic = run.history["body/a/kinetic"][()]
    assert np.abs(kinetic / kinetic[0] - 1).max() <= 1e-12


def test_forces(impakt):
    """Gravity moves, a traction on one face moves and turns; the work of both is the kinetic energy."""
    run = impakt(f"{BRICK.split(' -a_initial')[0]} -time_step 1e-2 -a_gravity 0,0,-9.81 -a_boundary_traction xmax -a_boundary_traction_xmax 0,600*y,0")
    body, time = run.history["body/a"], run.history["time"][()]
    np.testing.assert_allclose(body["centre"][:, 2], 1.5 - 9.81 * time**2 / 2, rtol=0, atol=1e-12)
    np.testing.assert_allclose(body["centre"][:, 1], 1 + 3600 / 6000 * time**2 / 2, rtol=0, atol=1e-12)  # 600 * 2 Pa on average on 2 x 3 m^2
    moment = 3600 * 0.5
    assert body["angular_velocity"][1, 2] == pytest.approx(moment / INERTIA[2] * 1e-2, rel=1e-3)
    np.testing.assert_allclose(body["external_work"][:].ravel(), body["kinetic"][:].ravel(), rtol=0, atol=1e-12 * body["kinetic"][-1])


def test_mass_on_a_bar(impakt):
    """F = Z v exp(-Z t / m): the velocity of the mass at all times, after the waves of the first elements; its impulse to the end."""
    run = impakt("-options_file options/rigid-mass.opts")
    body, time = run.history["body/mass"], run.history["time"][()]
    late = time > 2e-5
    np.testing.assert_allclose(body["mean_velocity"][()].ravel()[late], 10 * np.exp(-time[late] * 1e6 / 150), rtol=0, atol=3e-3)  # measured: 7e-4
    assert run.summary["contact"]["impulse"] == pytest.approx(1500 * (1 - np.exp(-9e-4 * 1e6 / 150)), rel=1e-4)
    assert worst_energy_error(run.summary) <= 1e-6
    assert run.summary["schwarz"]["max"] <= 2


def test_punch(impakt):
    """Hertz's profile under a rigid ball: radius and largest pressure for the force that leads it, as of two deformable ones."""
    run = impakt("-options_file options/rigid-punch.opts")
    load = run.history["body/punch/reaction/rigid/force"][-1, 1]
    assert load == pytest.approx(abs(next(iter(run.history["contact"].values()))["force_vector"][-1, 1]), rel=1e-9)
    modulus, curvature = 1e9 / (1 - 0.3**2), 1 / 0.5 + 1
    radius = (3 * load / (4 * modulus * curvature)) ** (1 / 3)
    peak = 3 * load / (2 * np.pi * radius**2)
    with h5py.File(run.folder / "out/rigid-punch-fields.h5") as fields:
        positions = fields["mesh/positions"][:, :2]
        pressure = fields["contact_pressure"][max(fields["contact_pressure"])][()].ravel()
    surface = (pressure > 0) & (positions[:, 0] < 0.9 * radius)
    fitted = np.array(hertz.fit(positions[surface, 0] / radius, pressure[surface] / peak))
    assert surface.sum() > 10
    assert fitted == pytest.approx([1, 1], abs=1e-2)  # measured: +4.8e-3, -3.1e-3
    # the picture of both, whose theory is that of two balls of which one is rigid
    pair, series = hertz.read(run.folder / "history.h5")
    assert series["force"][-1] == pytest.approx(load, rel=1e-4)  # of sizes, across the axis too: +3.3e-5
    assert pair.contact(load) == pytest.approx((radius, peak), rel=1e-12)
    hertz.draw(run.folder / "history.h5", path=run.folder / "figure.png")
    assert (run.folder / "figure.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


PLATE = (
    "-bodies plate,disc -time_end 8e-3 -time_step 4e-5 -plate_dm_plex_dim 2 -plate_dm_plex_box_lower -0.5,-0.2 -plate_dm_plex_box_upper 0.5,0 "
    "-plate_dm_plex_box_faces 30,6 -plate_density 1000 -plate_youngs_modulus 1e8 -plate_poissons_ratio 0.3 -plate_material_type neo_hookean "
    "-disc_dm_plex_dim 2 -disc_dm_plex_shape ball -disc_ball_radius 0.1 -disc_ball_centre 0.1,0.101 -disc_ball_divisions 6 -disc_density 8000 "
    "-disc_initial_velocity 0.5-20*(y-0.101),-1+20*(x-0.1) "
)
RIGID, PAIR = "-disc_rigid true ", "-contact_pairs plate:disc "
EXPLICIT, FRICTION = "-plate_ts_type centraldifference ", "-contact_law coulomb -contact_friction 0.3"


def momenta(run):
    """Worst changes of momentum and angular momentum, relative to the largest of a body."""
    bodies = run.history["body"].values()
    changes = []
    for name in ("momentum", "angular_momentum"):
        all_of = [body[name][()] for body in bodies]
        total = sum(all_of)
        changes.append(np.abs(total - total[0]).max() / max(np.abs(values).max() for values in all_of))
    return changes


@pytest.mark.parametrize(
    "options",
    ["", EXPLICIT, "-disc_ts_time_step 1e-5", "-contact_type lagrange", *long("-plate_ts_time_step 2e-5", EXPLICIT + "-plate_ts_time_step 1e-5", "-contact_type augmented_lagrangian", "-time_step 4e-4")],
)
def test_disc_hits_plate(shared_run, options):
    """Energy within what contact may gain and lose, momentum to round-off and angular momentum to second order, whatever the plate's integrator, the substeps of either
    body and the method. Measured: 1e-5 to 6e-3 (ten times the step), 1e-13 and 5e-6 (2e-3)."""
    run, large = shared_run(PLATE + RIGID + PAIR + options), "4e-4" in options
    assert run.summary["contact"]["steps_in_contact"] > 5
    assert worst_energy_error(run.summary) <= (2e-2 if large else 1e-4)
    linear, angular = momenta(run)
    assert linear <= 1e-11
    assert angular <= (5e-3 if large else 1e-5)  # measured: 2.1e-3, 5e-6


def test_order_does_not_matter(impakt):
    """It is the second side whatever is said: the same run, to the last bit."""
    pairs = ("plate:disc", "disc:plate -contact_view", "disc~plate", "auto")
    runs = [impakt(f"{PLATE} {RIGID} -time_end 2e-3 -contact_pairs {pair}") for pair in pairs]
    assert runs[0].summary["contact"]["onsets"] > 0
    for run in runs[1:]:
        np.testing.assert_array_equal(run.history["body/disc/kinetic"][()], runs[0].history["body/disc/kinetic"][()])
    assert "the rigid body takes forces" in runs[1].stdout


@pytest.mark.long
def test_stiff_bodies_tend_to_it(impakt, shared_run):
    """A disc of 10 and 100 times the stiffness that it needs to look rigid: the impulse tends to that of the rigid one. Measured: 3.3e-4, beside what
    contact nodes with mass take."""
    rigid = shared_run(PLATE + RIGID + PAIR).summary["contact"]["impulse"]
    errors = []
    for modulus in (1e10, 1e12):
        run = impakt(f"{PLATE} {PAIR} -disc_youngs_modulus {modulus} -disc_poissons_ratio 0.3 -disc_material_type neo_hookean -disc_mass_type consistent -disc_mass_redistribute false")
        errors.append(abs(run.summary["contact"]["impulse"] / rigid - 1))
    assert errors[1] <= 4e-4
    assert errors[1] < errors[0] < 2e-2


@pytest.mark.parametrize("plate", ["", EXPLICIT])
def test_friction(shared_run, plate):
    """Friction slows the spin; with what it takes the energy is closed, and so is the angular momentum."""
    run = shared_run(PLATE + RIGID + PAIR + plate + FRICTION)
    spin = run.history["body/disc/angular_velocity"][:, 2]
    assert spin[0] == pytest.approx(20, rel=1e-9)
    assert 0 < spin[-1] < 18  # measured: 16.9
    assert run.summary["contact"]["friction_loss"] > 0
    assert worst_energy_error(run.summary) <= 1e-3
    assert momenta(run)[1] <= 2e-3  # measured: 1.1e-3, and 5e-6 with a quarter of the step and a finer plate


def test_tied(impakt):
    """A mass tied to the end of a bar: the period of a mass on a bar, omega L / c tan(omega L / c) = m_bar / m."""
    run = impakt(
        "-bodies bar,mass -contact_pairs bar:mass -contact_law tied -time_step 2e-6 -time_end 2e-2 -bar_dm_plex_dim 1 -bar_dm_plex_box_faces 50 -bar_density 1000 "
        "-bar_youngs_modulus 1e9 -bar_boundary_displacement xmin -bar_boundary_displacement_xmin 0 -mass_rigid true -mass_dm_plex_dim 1 -mass_dm_plex_box_lower 1 "
        "-mass_dm_plex_box_upper 2 -mass_dm_plex_box_faces 2 -mass_density 2000 -mass_initial_velocity 1e-3 -bar_initial_velocity 1e-3*x"
    )
    low, high = 1e-6, np.pi / 2 - 1e-6
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if middle * np.tan(middle) < 0.5 else (low, middle)
    velocity, time = run.history["body/mass/mean_velocity"][()].ravel(), run.history["time"][()]
    crossings = time[1:][np.diff(np.sign(velocity)) != 0]
    assert np.pi / np.diff(crossings).mean() == pytest.approx(low * 1000, rel=2e-3)
    assert worst_energy_error(run.summary) <= 5e-6  # measured: 1.5e-6


FLAT = (
    "-time_step 1e-5 -time_end 2e-3 -b_dm_plex_dim 2 -b_dm_plex_box_lower 0.1,0.001 -b_dm_plex_box_upper 0.3,0.101 -b_dm_plex_box_faces 8,4 -b_density 1000 "
    "-b_youngs_modulus 1e8 -b_poissons_ratio 0.3 -b_material_type neo_hookean -b_initial_velocity 2*y,-2 "
)
FLOOR = "-bodies b,floor -floor_rigid true -floor_dm_plex_dim 2 -floor_dm_plex_box_lower 0,-0.1 -floor_dm_plex_box_upper 1,0 -floor_dm_plex_box_faces 5,1 -floor_density 1 -contact_pairs b:floor "


@pytest.mark.parametrize("ts", ["alpha2", "centraldifference"])
def test_as_an_obstacle(impakt, ts):
    """A flat one that is led nowhere is an obstacle, but for the directions of forces, which are normals of the block's own surface, tilted by 1e-3."""
    plane = impakt(f"-bodies b -obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1 -contact_pairs b:floor {FLAT} -b_ts_type {ts}")
    rigid = impakt(f"{FLOOR} -floor_rigid_displacement 0,0 -floor_rigid_rotation 0 {FLAT} -b_ts_type {ts}")
    for name in ("momentum", "angular_momentum", "kinetic"):
        values = [run.history[f"body/b/{name}"][()] for run in (plane, rigid)]
        np.testing.assert_allclose(values[1], values[0], rtol=0, atol=1e-5 * np.abs(values[0]).max())  # measured: 1e-6


def test_led(impakt):
    """A paddle that turns and hits a block: its work is what the block gains, the reaction has the opposite of the contact force, and the moment about the origin too."""
    run = impakt(
        f"{FLAT} {FLOOR} -floor_rigid_displacement 0,0 -floor_rigid_rotation (-0.5*sin(200*t)) -floor_ts_time_step 5e-6 -b_initial_velocity 0,0".replace("0.1,0.001", "0.1,0.002")
    )
    work = run.history["body/floor/external_work"][()].ravel()
    block = run.history["body/b"]
    gained = (block["kinetic"][()] + block["potential"][()] + run.history["body/floor/kinetic"][()]).ravel()
    assert work[-1] > 1
    assert np.abs(gained - gained[0] - work).max() <= 2e-3 * work.max()
    np.testing.assert_allclose(run.history["body/floor/rotation"][:, 2], -0.5 * np.sin(200 * run.history["time"][()]), rtol=0, atol=1e-12)


def test_led_along_one_axis(impakt):
    """Across it is led, along it falls: the reaction has the component that is led alone."""
    run = impakt(
        f"{BRICK.split(' -a_initial')[0]} -time_step 1e-2 -a_gravity 0,0,-9.81 -a_rigid_displacement 0.5*t^2,free,free -a_rigid_rotation 0,0,t"
    )
    body, time = run.history["body/a"], run.history["time"][()]
    np.testing.assert_allclose(body["centre"][:, 0], 0.5 + 0.5 * time**2, rtol=0, atol=1e-12)
    np.testing.assert_allclose(body["centre"][:, 2], 1.5 - 9.81 * time**2 / 2, rtol=0, atol=1e-10)
    force = body["reaction/rigid/force"][()]
    np.testing.assert_allclose(force[:, 0], 6000, rtol=1e-6)
    np.testing.assert_allclose(force[:, 1:], 0, rtol=0, atol=1e-5)
    np.testing.assert_allclose(body["angular_velocity"][:, 2], 1, rtol=1e-9)


@pytest.mark.parametrize(("plate", "ranks"), [(EXPLICIT, 2), *long(("", 3))])
def test_ranks(shared_run, plate, ranks):
    one, more = (shared_run(PLATE + RIGID + PAIR + plate + FRICTION, n) for n in (1, ranks))
    for name in ("kinetic", "angular_velocity"):
        values = [run.history[f"body/disc/{name}"][()] for run in (one, more)]
        np.testing.assert_allclose(values[1], values[0], rtol=0, atol=SAME * np.abs(values[0]).max())


@pytest.mark.parametrize(("options", "ranks"), [(EXPLICIT + FRICTION, 1), *long(("", 2), ("-disc_rigid_displacement 0.5*t,free", 1))])
def test_restart(impakt, shared_run, tmp_path, options, ranks):
    """In the middle of contact, to the last bit; on another number of ranks to round-off."""
    base = PLATE + RIGID + PAIR + options
    whole = shared_run(base, ranks)
    impakt(f"{base} -time_end 4e-3 -checkpoint {tmp_path}/c.h5 -checkpoint_interval 100", ranks=ranks)
    rest = impakt(f"{base} -restart {tmp_path}/c.h5", ranks=ranks)
    for name in ("kinetic", "rotation", "centre", "external_work"):
        np.testing.assert_array_equal(rest.history[f"body/disc/{name}"][-1], whole.history[f"body/disc/{name}"][-1])
    other = impakt(f"{base} -restart {tmp_path}/c.h5", ranks=3 - ranks)
    kinetic = [run.history["body/disc/kinetic"][-1].item() for run in (other, whole)]
    assert kinetic[0] == pytest.approx(kinetic[1], rel=SAME)


def test_no_stress(impakt):
    """In fields and at observed points, which go where the body goes, also where its material has moduli."""
    run = impakt(f"{BRICK} -time_step 1e-2 -a_youngs_modulus 1e9 -a_probe 1,2,3 -output_fields f.h5 -output_fields_interval 100")
    with h5py.File(run.folder / "f.h5") as file:
        assert not np.any(file["stress"][max(file["stress"])][()])
    body = run.history["body/a"]
    assert not np.any(body["probe/0/stress"][()])
    centre, vector = body["centre"][-1], body["rotation"][-1]
    np.testing.assert_allclose(body["probe/0/position"][-1], centre + turn(vector) @ [0.5, 1, 1.5], rtol=0, atol=1e-12)


ERRORS = {
    "-disc_rigid_displacement 0,x": "may use t, but not x",
    "-disc_rigid_displacement 0": "has 1 component",
    "-disc_rigid_rotation 0,0,1": "has 3 components; body 'disc' is 2-dimensional",
    "-disc_boundary_displacement surface -disc_boundary_displacement_surface 0,0": "-disc_rigid_displacement",
    "-disc_ts_type alpha2": "exclude each other",
    "-disc_mass_type lumped": "leave the option out",
    "-disc_mass_redistribute true": "-disc_mass_redistribute",
    "-disc_damping_mass 1": "-disc_damping_mass",
    "-disc_ts_time_step auto": "no stable step",
    "-disc_initial_velocity x,0": "not that of a rigid motion",
    "-disc_initial_displacement 0.1*x,0": "not that of a rigid motion",
    "-contact_type alternation -plate_rigid true": "both bodies are rigid",
    "-contact_rows second": "-contact_rows second",
    "-schwarz_transmission robin": "is rigid",
    "-contact_swap_sides true": "is rigid",
    "-contact_stabilization naive": "-contact_stabilization",
    "-plate_rigid_displacement 0,0": "-plate_rigid_displacement",
}


@pytest.mark.parametrize(("options", "ranks"), [*((options, 1) for options in ERRORS), *long(("-disc_initial_velocity x,0", 2), ("-contact_rows second", 2))])
def test_errors(impakt, options, ranks):
    run = impakt(PLATE + RIGID + PAIR + options, expect_failure=True, ranks=ranks)
    check_message(run, [ERRORS[options]])


def test_obstacle_is_refused(impakt):
    run = impakt(f"{PLATE} {RIGID} -contact_pairs disc:floor -obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1 -contact_type alternation", expect_failure=True)
    check_message(run, ["rigid", "obstacle"])
