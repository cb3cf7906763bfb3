"""-contact_separation false: bodies that have met slide on each other and do not come apart."""

import numpy as np
import pytest
from cases import SAME, worst_energy_error
from test_bonded import CASES, FORCE, INTEGRATORS, KEPT, cube

HELD = "-contact_separation false"


def thrown(dim, faces, pairing, across=0.0, more=HELD):
    return (f"-bodies a,b -contact_pairs a:b {more} -time_step 1e-5 -time_end 6e-3 {INTEGRATORS[pairing]} "
            f"{cube('a', dim, 0, 4, (10, across, 0))} {cube('b', dim, 1.002, faces, (-10, -across, 0))}")  # fmt: skip


@pytest.mark.parametrize(("dim", "faces", "pairing", "method"), [*((*case, "") for case in CASES), *((*case, FORCE) for case in CASES[:4])])
def test_they_stay_together(dim, faces, pairing, method, shared_run):
    """They pull at each other when they would bounce off, and nothing is lost, as where they part. Measured: 1.3e-13."""
    run = shared_run(f"{thrown(dim, faces, pairing)} {method}")
    pair = run.history["contact/a:b"]
    active, force = pair["active"][()], pair["force"][()]
    first = np.flatnonzero(active)[0]
    assert run.history["time"][first] == pytest.approx(1e-4, abs=1.1e-5)
    assert (active[first + 1 :] == 5 ** (dim - 1)).all()
    assert force.max() > 1e6 and force.min() < -1e6
    assert run.summary["contact"]["onsets"] == 1
    assert worst_energy_error(run.summary) <= 1e-9
    assert run.summary["system"]["momentum_error_max"] <= 1e-11
    assert abs(pair["gap"][first:]).max() <= (1e-12 * 0.25 if method else 4e-12)


@pytest.mark.parametrize(("dim", "faces", "pairing"), [(2, 3, "EE"), (2, 4, "II"), (3, 3, "IE")])
def test_they_stay_together_with_mass(dim, faces, pairing, shared_run):
    """By the rule impulse gaps stay what they were when nodes met: the opening changes by no more than 1e-12 of an element. What is lost is what nodes that hit move
    with along the normal."""
    run = shared_run(f"{thrown(dim, faces, pairing)} {KEPT}")
    pair, change = run.history["contact/a:b"], run.history["energy/change"][()] / run.history["energy/scale"][()].max()
    first = np.flatnonzero(pair["active"][()])[0]
    assert (pair["active"][first + 1 :] == 5 ** (dim - 1)).all() and pair["force"][()].min() < -1e6
    assert np.ptp(pair["gap"][first:]) <= 1e-12 * 0.25
    assert change.max() <= 1e-9 and -0.2 < change[-1] < -0.08
    assert run.summary["system"]["momentum_error_max"] <= 1e-11


@pytest.mark.parametrize(("integrator", "mass"), [("", ""), (FORCE, ""), *((f"-b_ts_type centraldifference {more}", "-b_mass_redistribute false -b_mass_type lumped") for more in ("", FORCE)), (FORCE, "-b_mass_redistribute false -b_mass_type lumped")])
def test_on_an_obstacle(integrator, mass, shared_run):
    """A block thrown at a wall stays there and slides along it as fast as it came, to 7e-13. Nodes that keep their mass lose its energy as they stop, and no more."""
    floor = "-obstacles wall -wall_obstacle_type plane -wall_point 1,0 -wall_normal -1,0 -contact_pairs b:wall"
    run = shared_run(f"-bodies b {HELD} {floor} -time_step 1e-5 -time_end 6e-3 {cube('b', 2, -0.001, 4, (10, 3))} {integrator} {mass}")
    pair, momentum = run.history["contact/b:wall"], run.history["body/b/momentum"][:]
    first = np.flatnonzero(pair["active"])[0]
    assert (pair["active"][first:] == 5).all() and pair["force"][()].min() < -1e6
    assert np.abs(momentum[:, 1] / momentum[0, 1] - 1).max() <= 1e-11
    position = run.history["body/b/contact_position"][first + 1 :]
    assert np.abs(position[:, 0] - position[0, 0]).max() <= 1e-12
    assert np.ptp(position[:, 1]) == pytest.approx(3 * 5.9e-3, rel=0.02)
    if mass:  # that of half an element of 4, in a lumped layer of 5 nodes: an eighth of the energy along the normal, which is 100 / 109 of it
        assert run.summary["system"]["energy_error_final"] == pytest.approx(-100 / 109 / 8, rel=0.02)
    else:
        assert worst_energy_error(run.summary) <= 1e-9


@pytest.mark.parametrize("pairing", ["II", "EE"])
def test_sliding(pairing, shared_run):
    """Bodies slide past each other by 0.35 m, and a node that has no partner opposite any more is let go. Measured: what normals that turn take of the momentum across, 2.2e-3, and rows that are
    built again and let go of the energy, 8.7e-4; 3.9e-4 and 2.7e-4 where they part."""
    run = shared_run(thrown(2, 3, pairing, across=30))
    momentum = run.history["body/a/momentum"][:, 1]
    pair = run.history["contact/a:b"]
    assert pair["active"][-1] == 4 and pair["active"][()].max() == 5
    assert np.abs(momentum / momentum[0] - 1).max() < 3e-3
    assert pair["force"][()].min() < -1e6
    assert worst_energy_error(run.summary) <= 1e-3


@pytest.mark.parametrize("method", ["", FORCE, KEPT])
def test_ranks(method, shared_run):
    one, three = (shared_run(f"{thrown(2, 3, 'EE', across=3)} {method}", ranks).history["contact/a:b/force"][()] for ranks in (1, 3))
    np.testing.assert_allclose(one, three, rtol=0, atol=SAME * np.abs(one).max())


@pytest.mark.parametrize("more", ["-contact_type penalty", "-contact_law tied", "-contact_law coulomb -contact_friction 0.3"])
def test_others_are_refused(more, impakt):
    run = impakt(f"{thrown(2, 4, 'II')} {more}", expect_failure=True)
    for word in ("-contact_separation false", "-contact_type schwarz", "frictionless", more.split()[1]):
        assert word in run.stderr
