"""Oblique impacts with friction: what slides all the time leaves with the velocity and spin that rigid bodies would have."""

import numpy as np
import oblique_half_space
import pytest
from cases import long, validate, worst_energy_error
from oblique_impact import oblique_impact

DISC = "-options_file options/oblique-disc.opts"
R, START = 0.1, (0, 0.10005)
MASS = 1000 * np.pi * R**2


def outcome(run):
    """Velocities before and after, and the spin after."""
    body, time = run.history["body/disc"], run.history["time"][()]
    v, momentum = body["mean_velocity"][()], body["angular_momentum"][:, 2]
    x = START + np.vstack([[0, 0], np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(time)[:, None], axis=0)])
    spin = (momentum - MASS * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])) / (MASS * R**2 / 2)
    assert body["momentum"][0, 1] == pytest.approx(MASS * v[0, 1], rel=1e-12)
    assert abs(spin[0]) <= 1e-9
    return v[0], v[-1], spin[-1]


def check(run, mu, lever):
    before, after, spin = outcome(run)
    assert run.summary["contact"]["onsets"] == 1
    assert not run.summary["contact"]["in_contact_at_end"]
    slide = mu * (after[1] - before[1])  # mu (1 + e) v_n
    assert before[0] - after[0] == pytest.approx(slide, rel=1e-9)  # momentum: measured 1e-13
    assert -spin == pytest.approx(2 * slide / R, rel=lever)
    assert worst_energy_error(run.summary) <= 1e-5  # measured: 2e-6


@pytest.mark.parametrize(("velocity", "mu"), [("2,-0.5", 0.3), ("1,-0.5", 0.1), *long(("2,-0.25", 0.2))])
def test_gross_slip(velocity, mu, impakt):
    """A disc slides all the time where v_t is beyond 3 mu (1 + e) v_n. The spin is within 1 % (measured: -0.36, -0.63, +0.40 %), as the disc sinks in and its
    polygon is lower than R."""
    check(impakt(f"{DISC} -disc_initial_velocity {velocity} -contact_friction {mu}"), mu, 1e-2)


def test_rolls_off_where_it_sticks(impakt):
    """At a steeper angle it does not slide all the time: it takes less than in gross slip."""
    run = impakt(f"{DISC} -disc_initial_velocity 0.3,-0.5")
    before, after, spin = outcome(run)
    taken = (before[0] - after[0]) / (0.2 * (after[1] - before[1]))
    assert 0.505 < taken < 1  # a rigid disc that rolls off takes v_t / 3; this one springs back across. Measured: 0.73
    assert -spin == pytest.approx(2 * (before[0] - after[0]) / R, rel=2e-2)


BALL, FRICTION, POISSON = "-options_file options/oblique-impact.opts", 0.092, 0.235
# Angle from the normal [degrees], and v_t'/v_t of Kharaz, Gorham and Salman (2001)
KHARAZ = ((9.8, 0.675), (20.2, 0.599), (30.4, 0.690), (39.5, 0.774), (49.6, 0.848), (71.1, 0.937))
RATIO = 2 * (1 - POISSON) / (2 - POISSON)
# A tenth of the speed: the ball hardly turns, and may be linear; its elements are smaller where it touches, and it has the moment of inertia of a ball to 3 %
SLOW = (
    "-ball_ts_type alpha2 -ball_material_type linear_elastic -ball_mass_redistribute near -ball_mass_type consistent -ball_ball_grading 64 -time_step 1.58e-7 -time_end 2.3e-5"
)


def ball(run):
    """Ratios of a ball: velocity across, spin times radius (by friction's impulse and the moment of the contact about the centre), restitution."""
    body, time, radius = run.history["body/ball"], run.history["time"][()], 2.5e-3
    v, mass = body["mean_velocity"][()], body["momentum"][0, 2] / body["mean_velocity"][0, 2]
    assert 2 * mass == pytest.approx(3900 * 4 / 3 * np.pi * radius**3, rel=1e-9)
    x = [0, 0, radius] + np.vstack([[0, 0, 0], np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(time)[:, None], axis=0)])
    momentum = body["angular_momentum"][:, 0] - mass * (x[:, 1] * v[:, 2] - x[:, 2] * v[:, 1])
    spin = (momentum[-1] - momentum[0]) / (0.4 * mass * radius**2)
    return v[-1, 1] / v[0, 1], spin * radius / v[0, 1], -v[-1, 2] / v[0, 2]


def test_theory():
    """The integration itself: gross slip, where it is that of rigid bodies; no friction; steps and springs that are halved."""
    for angle in (39.5, 71.1):
        tangent = np.tan(np.radians(angle))
        across, spin, e = oblique_impact(RATIO, FRICTION, tangent)
        assert e == pytest.approx(1, abs=1e-6)
        assert across == pytest.approx(1 - 2 * FRICTION / tangent, rel=1e-5)
        assert spin == pytest.approx(-5 * FRICTION / tangent, rel=1e-5)
    assert oblique_impact(RATIO, 0, 1)[:2] == (1, 0)
    fine, coarse = (oblique_impact(RATIO, FRICTION, 0.3, n, k) for n, k in ((4000, 800), (1000, 200)))
    assert fine == pytest.approx(coarse, abs=2e-3)


@pytest.mark.parametrize(("angle", "measured"), [*long(KHARAZ[1]), *validate(*KHARAZ[2:])])
def test_ball(angle, measured, shared_run):
    """Within 5 % of theory and of the experiment, from 20.2 degrees on, where the ball slides at first; above 32 degrees it slides all the time."""
    tangent = np.tan(np.radians(angle))
    run = shared_run(f"{BALL} -ball_initial_velocity 0,{3.85 * np.sin(np.radians(angle))},{-3.85 * np.cos(np.radians(angle))}")
    across, spin, e = ball(run)
    theory = oblique_impact(RATIO, FRICTION, tangent)
    assert not run.summary["contact"]["in_contact_at_end"]
    assert 0.99 < e <= 1
    # A contact of 22 nodes. Measured at 20.2 degrees: -2.9 %; 10, 12 and 16 divisions of grading 48 have 0.558, 0.566 and 0.575 for 0.594. With mass that moves to inner
    # neighbours, and moments of inertia off by 39, 25 and 5 %, they have 0.671, 0.624 and 0.587.
    assert across == pytest.approx(theory[0], rel=0.035 if angle < 30 else 0.02)
    assert across == pytest.approx(measured, rel=0.05)  # measured: -2.5, +0.9, +0.5, -0.5, +0.1 %
    assert spin == pytest.approx(theory[1], rel=0.06)  # measured: +0.9, -4.3, -1.6, -1.2, -3.0 %, of a contact of 22 nodes
    assert worst_energy_error(run.summary) <= 1e-5  # measured: 2e-6
    if angle > 35:  # as rigid bodies
        assert across == pytest.approx(1 - FRICTION * (1 + e) / tangent, rel=0.01)  # measured: 0.1 %


def velocity(angle, speed=3.85):
    return f"-ball_initial_velocity 0,{speed * np.sin(np.radians(angle))},{-speed * np.cos(np.radians(angle))}"


FLAT, MEASURED = KHARAZ[0]
TANGENT = np.tan(np.radians(FLAT))


@pytest.mark.validate
def test_theory_of_half_spaces():
    """The integration of oblique_half_space.py: without coupling it is the other one; with it, on a rigid plane, 7.7 % less of the velocity across is left."""
    across, spin, e = oblique_half_space.impact(POISSON, FRICTION, TANGENT, coupled=False)
    theory = oblique_impact(RATIO, FRICTION, TANGENT)
    assert across == pytest.approx(theory[0], rel=1e-3)  # measured: 2e-4
    assert spin == pytest.approx(theory[1], rel=1e-3)
    assert e == pytest.approx(1, abs=1e-4)
    across, _, e = oblique_half_space.impact(POISSON, FRICTION, TANGENT)
    assert across == pytest.approx(0.923 * theory[0], rel=3e-3)  # with 16 and 20 squares across 0.925 and 0.926
    assert 0.996 < e < 0.999


@pytest.mark.validate
def test_equal_balls(shared_run):
    """At 9.8 degrees two equal balls, as in the theory, at a speed at which they are half spaces to their contact."""
    run = shared_run("-options_file options/oblique-impact-balls.opts")
    across, _, e = ball(run)
    assert not run.summary["contact"]["in_contact_at_end"]
    assert across == pytest.approx(oblique_impact(RATIO, FRICTION, TANGENT)[0], rel=0.05)  # measured: -2.6 %; with 12 divisions and twice the speed -4.1 %
    assert e == pytest.approx(1, abs=1e-3)
    first, second = (run.history[f"body/{name}/momentum"][()] for name in ("ball", "other"))
    assert np.abs((first + second)[:, 1:]).max() <= 1e-9 * np.abs(first).max()
    assert worst_energy_error(run.summary) <= 5e-4  # measured: 1e-04


@pytest.mark.validate
def test_ball_on_a_rigid_plate(shared_run):
    """At 9.8 degrees pressure moves the surface of a ball on a rigid plate inwards, and it slides: theory with that coupling. At a tenth of the speed the contact has
    0.03 of the radius. At 3.85 m/s it has 0.08, and the ball as a whole gives way across: 16 and 20 divisions have 0.533 and 0.540, where 12 have 0.515."""
    theory = oblique_half_space.impact(POISSON, FRICTION, TANGENT)[0]
    fast = ball(shared_run(f"{BALL} {velocity(FLAT)}"))[0]
    slow = ball(shared_run(f"{BALL} {velocity(FLAT, 0.385)} {SLOW}"))[0]
    assert slow == pytest.approx(theory, rel=0.05)  # measured: -2.7 %; with 16 divisions, whose moment of inertia is 3 % nearer to that of a ball, -4.7 %
    assert fast == pytest.approx(theory, rel=0.15)  # measured: -13.1 %; 16 divisions -10 %
    assert fast < slow < MEASURED  # of alumina on glass, which give way alike to some degree
