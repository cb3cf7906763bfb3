"""A bar that flies to and fro between two walls, and one that bounces under gravity, against their exact solutions by characteristics.

Both files advance the bar explicitly, with lumped mass and steps of 0.9992 of a wave's way through an element: at 1 central differences carry waves
without dispersion. Shorter steps, or other integrators, smear the front that ends a contact over more elements, and what it leaves behind stays in the
bar as vibration, contact for contact: those need finer meshes for the same figures.
"""

import numpy as np
import pytest

WALLS = "-options_file options/two-walls.opts"
BOUNCE = "-options_file options/bouncing-bar.opts"
CONTACT, CYCLE = 5e-4, 1e-3  # s: 2 L/c, and from contact to contact
MASS, FORCE = 2.5e-4, 1  # kg; N: v sqrt(E rho) A at 1 m/s


def walls(run):
    """Of each contact: how late it begins, the impulse, the mean force of its middle three fifths; and how many there are. Exact: 0 s, 2 m v, v Z."""
    time = run.history["time"][()]
    sides = [run.history["contact"][pair]["force"][()] for pair in ("bar.xmin:left", "bar.xmax:right")]
    found = []
    for k in range(1, round(time[-1] / CYCLE) + 1):
        begin = (k - 0.5) * CYCLE
        window = slice(*np.searchsorted(time, (begin - 0.25 * CYCLE, begin + 0.75 * CYCLE)))
        force, other, t = sides[k % 2][window], sides[1 - k % 2][window], time[window]
        assert not other.any()
        onset = t[np.argmax(force > 0.3 * FORCE)]
        middle = force[(t > onset + 0.2 * CONTACT) & (t < onset + 0.8 * CONTACT)]
        found.append((onset - begin, force.sum() * (time[1] - time[0]), middle.mean()))
    return np.array(found).T


@pytest.mark.long
def test_hundred_impacts(shared_run):
    """Each contact takes 0.02 to 0.1 % of the velocity, part of which comes back from the vibration: 0.13 % are missing at the end (measured), impulses are
    0.005 to 0.13 % too small, forces up to 0.13 %; so contact 100 begins 60 us late, 0.06 % of the time until then. Which steps contacts begin and end in hangs on
    round-off after some: with speed, gap or step changed by 1e-5 to 1e-4 of themselves the least energy was -0.12 to -0.18 %. None is gained: the run is not
    allowed any. With the 0.1 % of the energy that it may gain by default the largest was 0 to +0.1 %, in this deck +0.001 or +0.04 % by round-off."""
    run = shared_run(f"{WALLS} -contact_energy_excess 0")
    late, impulse, force = walls(run)
    assert len(late) == 100
    assert run.summary["contact"]["onsets"] == 100  # none breaks off on the way
    assert -1e-9 <= late.min() and late.max() <= 7e-5
    assert np.diff(late).mean() <= 7e-7  # the period, of 1 ms
    assert impulse == pytest.approx(2 * MASS, rel=2e-3)
    assert force == pytest.approx(FORCE, rel=2e-3)
    velocity = run.history["body/bar/mean_velocity"][()].ravel()[-1]
    assert velocity == pytest.approx(1, rel=2e-3)
    assert run.history["body/bar/potential"][-1] <= 2e-3 * MASS / 2
    system = run.summary["system"]
    assert -2e-3 <= system["energy_error_min"] <= system["energy_error_max"] <= 1e-12
    assert max(pair["max_penetration"] for pair in run.summary["pairs"].values()) <= 1e-12


def test_longer_steps(shared_run):
    """Ten impacts, with controller steps 10 times as long, which take some at each contact, and the bar's own unchanged."""
    run = shared_run(f"{WALLS} -time_step 6.245e-6 -bar_ts_time_step 6.245e-7 -time_end 0.0102 -controller_step_cuts 0 -contact_energy_excess 0")
    late, impulse, _ = walls(run)
    assert len(late) == 10
    assert impulse == pytest.approx(2 * MASS, rel=0.08)
    system = run.summary["system"]
    assert -0.15 <= system["energy_error_min"] <= system["energy_error_max"] <= 1e-12


# The bouncing bar: v0 = 10 m/s at the first contact, Z = 30 kg/s, g = 10 m/s^2
T, BETWEEN = 2 / 3, 8 / 3  # s: 2 L/c, and from contact to contact: T and a flight of 2 v0/g = 3 T


def exact_force(time):
    """The ground comes towards a bar in free fall with v0 + g t. A wave of that half runs through the bar and back: the force is Z (v0 + g t) until then. As
    flights last whole periods of the vibration that this leaves, the second contact takes it out again: Z (v0 + g (T - t)). And so on."""
    number = np.floor((time - 1) / BETWEEN + 1e-12)
    since = time - 1 - BETWEEN * number
    return np.where((time < 1) | (since >= T), 0, 300 + 300 * np.where(number % 2 == 0, since, T - since))


def exact_position(time):
    """Of the lower end. From rest it falls 5 m; a bar that does not vibrate flies as a whole; of one that does the end has the velocity
    v0 + 2 g s - g t in free flight, t from the beginning of contact, s from the last whole period."""
    number = np.maximum(0, np.floor((time - 1) / BETWEEN))
    flight = np.maximum(0, time - 1 - BETWEEN * number - T)
    periods = np.floor(flight / T)
    s = flight - periods * T
    vibrating = periods * T * (10 - 5 * T * periods) + (10 - 10 * (periods + 1) * T) * s + 5 * s**2
    return np.where(time < 1, 5 - 5 * time**2, np.where(number % 2 == 0, vibrating, 10 * flight - 5 * flight**2))


def bounce(run, contacts=8):
    """Of each contact: how late it begins, the impulse by the exact one, the largest error of the force in its middle; and the largest error of the position."""
    time, force = run.history["time"][()], run.history["contact/bar.xmin:ground/force"][()]
    found = []
    for k in range(contacts):
        begin = 1 + BETWEEN * k
        window = slice(*np.searchsorted(time, (begin - 0.6, begin + 1.2)))
        middle = slice(*np.searchsorted(time, (begin + 0.15 * T, begin + 0.85 * T)))
        found.append((time[window][np.argmax(force[window] > 0)] - begin, force[window].sum() * (time[1] - time[0]) / (400 * T), np.abs(force - exact_force(time))[middle].max()))
    position = run.history["body/bar/contact_position"][()].ravel()
    return *np.array(found).T, np.abs(position - exact_position(time)).max()


def test_bounce(shared_run):
    """Eight contacts and 20 s: measured, they begin up to 5.7 ms late (a wave needs 333 ms through the bar), their impulses are right to 0.07 %, forces to 0.63 N of 300 to
    500 N, the position of the lower end to 0.06 m of 5 m, the largest where it jumps in velocity. Energy: -0.102 % to +0.036 % of the largest kinetic energy."""
    run = shared_run(BOUNCE)
    late, impulse, error, position = bounce(run)
    assert run.summary["contact"]["onsets"] == 8
    assert run.summary["contact"]["onset_time"] == pytest.approx(1, abs=2e-3)
    assert np.abs(late).max() <= 8e-3
    assert impulse == pytest.approx(1, rel=1e-3)
    assert error.max() <= 1
    assert position <= 0.08
    system = run.summary["system"]
    assert -1.5e-3 <= system["energy_error_min"] <= system["energy_error_max"] <= 4.5e-4  # 1e-3 and 3e-4 of the energy in all
    velocity, time = run.history["body/bar/mean_velocity"][-1].item(), run.history["time"][-1]
    assert velocity == pytest.approx(10 - 10 * (time - 1 - 7 * BETWEEN - T), abs=0.06)  # measured: 0.053, and 0.031 with -bar_mass_moments total


def test_bounce_in_longer_steps(shared_run):
    """The first four contacts: impulses to 1 %, forces to 0.35 N with longer controller steps and the bar's own unchanged (measured)."""
    run = shared_run(f"{BOUNCE} -time_step 8.3265e-3 -bar_ts_time_step 8.3265e-4 -time_end 12 -controller_step_cuts 0 -contact_energy_excess 0")
    late, impulse, error, _ = bounce(run, 4)
    assert np.abs(late).max() <= 0.05
    assert impulse == pytest.approx(1, rel=0.01)
    assert error.max() <= 0.5
    assert run.summary["system"]["energy_error_max"] <= 1e-12
