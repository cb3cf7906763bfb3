"""-contact_constraint at high speed: the gap rate in place of the gap or beside it."""

import pytest
from cases import (
    DEFAULTS,
    FRAMES,
    PAIRINGS,
    force_scatter,
    joined,
    long,
    never_tensile,
    worst_energy_error,
)

MASSIVE = "-left_mass_type lumped -right_mass_type lumped -left_mass_redistribute false -right_mass_redistribute false"
PENALTY = f"{DEFAULTS} -contact_type penalty"
LAGRANGE = f"{DEFAULTS} -contact_type lagrange"
EXPLICIT = joined(LAGRANGE, PAIRINGS["EE"], MASSIVE)
IMPEDANCE = 1.0  # sqrt(E rho) A of the bars [N s/m]
SPEED = 100.0  # [m/s]
DURATION = 5e-4  # of contact [s]


@pytest.mark.parametrize("integrators", ["", *long(PAIRINGS["EE"])], ids=["II", "EE"])
def test_dampers_alone(integrators, shared_run):
    """c = 100 impedances. The nodes that meet go on at v = V Z / (Z + 2 c), and nothing stops them: penetration grows at 2 v. The force
    is Z (V - v), and the dampers take 2 v F all the time: of 2.5 J, 0.0198."""
    run = shared_run(joined(PENALTY, "-contact_constraint gap_rate -contact_penalty_damping 100", integrators))
    v = SPEED * IMPEDANCE / (IMPEDANCE + 2 * 100)
    assert run.summary["contact"]["force_mean"] == pytest.approx(IMPEDANCE * (SPEED - v), rel=1e-7)  # measured: 1.8e-8
    assert run.summary["contact"]["max_penetration"] == pytest.approx(2 * v * DURATION, rel=0.01)
    assert run.summary["system"]["energy_error_final"] == pytest.approx(-2 * v * (SPEED - v) * DURATION / 2.5, rel=0.01)
    assert run.summary["system"]["energy_error_max"] <= 1e-10
    assert run.summary["system"]["penalty_energy_max"] == 0
    assert run.summary["contact"]["onsets"] == 1
    assert force_scatter(run.summary) <= 1.8e-5  # measured: 1.34e-5, half the factor on the masses left
    assert never_tensile(run)


@pytest.mark.parametrize("integrators", ["", *long(joined(PAIRINGS["EE"], MASSIVE))], ids=["II", "EE-massive"])
def test_springs_and_dampers(integrators, shared_run):
    """The paper's spring with a damper of one impedance. In the end all of the spring's energy that a rise of its force by 1 - exp(-t/T)
    lets through the damper is lost: 0.039 to 0.042 of the energy, none is gained."""
    run = shared_run(joined(PENALTY, "-contact_constraint both -contact_penalty 7.5e4 -contact_penalty_damping 1", integrators))
    assert -0.043 <= run.summary["system"]["energy_error_final"] <= -0.038
    assert run.summary["system"]["energy_error_max"] <= 1e-10
    assert run.summary["contact"]["max_penetration"] == pytest.approx(100 / 7.5e4, rel=0.01)
    assert run.summary["system"]["penalty_energy_max"] == pytest.approx(100**2 / 2 / 7.5e4, rel=0.01)
    assert run.summary["contact"]["onsets"] == 1
    assert force_scatter(run.summary) <= 5e-4
    assert never_tensile(run)


@pytest.mark.parametrize("method", [LAGRANGE, f"{DEFAULTS} -right_ts_type centraldifference", *long(f"{DEFAULTS} -schwarz_transmission robin")], ids=["lagrange", "schwarz-IE", "robin"])
def test_rate_of_massless_nodes(method, shared_run):
    """The gap that is open at the start of the step of impact stays: as much as was left of it, 3.7e-6 m where the bars meet inside
    the step, but for what 1e-12 m a step may add. Energy as with the gap."""
    run = shared_run(joined(method, "-contact_constraint gap_rate", FRAMES["moving-inside"]))
    active = run.history["contact/left:right/active"][()] > 0
    gaps = run.history["contact/left:right/gap"][()][active]
    assert abs(gaps - 3.7e-6).max() <= 5e-11  # measured: 7.9e-12
    assert force_scatter(run.summary) <= 1.8e-5  # measured: 1.34e-5, half the factor on the masses left
    assert worst_energy_error(run.summary) <= 4e-6
    assert run.summary["contact"]["onsets"] == 1
    assert never_tensile(run)


def test_rate_by_forward_increment(shared_run):
    """Keeps the gap, and for the rest is as the gap alone."""
    run = shared_run(joined(EXPLICIT, "-contact_constraint gap_rate", FRAMES["inside"]))
    active = run.history["contact/left:right/active"][()] > 0
    assert abs(run.history["contact/left:right/gap"][()][active] - 3.7e-6).max() <= 1e-12
    assert run.summary["contact"]["force_mean"] == pytest.approx(100, rel=1e-6)  # measured: 1.3e-7
    assert force_scatter(run.summary) <= 2e-4
    assert run.summary["system"]["energy_error_min"] == pytest.approx(-1 / 400, rel=1e-9)  # the contact nodes are stopped, with 1/400 of the mass
    assert run.summary["system"]["energy_error_max"] <= 1e-12
    assert never_tensile(run)


def test_both_by_forward_increment(shared_run):
    """Gap and rate: the velocities of the nodes in contact are the common one, so that the error of the contact velocity is smaller."""
    run, gap = shared_run(joined(EXPLICIT, "-contact_constraint both")), shared_run(EXPLICIT)
    assert run.summary["contact"]["max_penetration"] <= 1e-12
    active = run.history["contact/left:right/active"][()] > 0
    rate = run.history["body/right/contact_velocity"][()] - run.history["body/left/contact_velocity"][()]
    assert abs(rate.reshape(len(active), -1)[active][:-1]).max() <= 1e-9  # but in the last step, which lets go
    assert run.summary["contact"]["force_mean"] == pytest.approx(100, rel=1e-6)  # measured: 1.3e-7
    assert force_scatter(run.summary) <= 2e-4
    assert -2.6e-3 <= run.summary["system"]["energy_error_min"] <= -1 / 400  # measured: -2.52e-3; the contact nodes are stopped, with 1/400 of the mass
    assert run.summary["system"]["energy_error_max"] <= 1e-12
    assert run.summary["errors"]["contact_velocity"] < 0.9 * gap.summary["errors"]["contact_velocity"]
    assert run.summary["contact"]["onsets"] == 1
    assert run.summary["system"]["momentum_error_max"] <= 1e-10
