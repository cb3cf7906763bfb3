"""-contact_law bonded: bodies that have met stick to each other."""

import h5py
import numpy as np
import pytest
from cases import SAME, worst_energy_error
from setups import box, material, words

INTEGRATORS = {"II": "", "IE": "-b_ts_type centraldifference", "EE": "-a_ts_type centraldifference -b_ts_type centraldifference"}


def cube(name, dim, low, faces, velocity):
    upper = (low + 1, *(1,) * (dim - 1))
    return box(name, (faces,) * dim, (low, *(0,) * (dim - 1)), upper, f"{material(name, 1e9, 0.3, 1000)} -{name}_initial_velocity {words(velocity[:dim])}")


def thrown(dim, faces, pairing, law="bonded", across=-3):
    return (f"-bodies a,b -contact_pairs a:b -contact_law {law} -time_step 1e-5 -time_end 6e-3 {INTEGRATORS[pairing]} "
            f"{cube('a', dim, 0, 4, (10, 3, 1))} {cube('b', dim, 1.002, faces, (-10, across, 2))}")  # fmt: skip


CASES = [(1, 4, "IE"), (2, 3, "EE"), (2, 4, "II"), (3, 3, "II"), (3, 3, "IE")]  # dimension, faces of b to an edge, where a has 4, integrators


FORCE = "-contact_type force"
KEPT = f"{FORCE} -all_mass_redistribute false"  # the rule is impulse


@pytest.mark.parametrize(("dim", "faces", "pairing", "method"), [*((*case, "") for case in CASES), *((*case, FORCE) for case in CASES[:4])])
def test_they_stick(dim, faces, pairing, method, shared_run):
    """They slide past each other until they meet after 1e-4 s, and pull at each other when they would bounce off. Nothing is lost. Measured: 2e-13."""
    run = shared_run(f"{thrown(dim, faces, pairing)} {method}")
    pair = run.history["contact/a:b"]
    active, force = pair["active"][()], pair["force"][()]
    first = np.flatnonzero(active)[0]
    assert run.history["time"][first] == pytest.approx(1e-4, abs=1.1e-5)
    assert (active[first:] == 5 ** (dim - 1)).all()
    assert force.max() > 1e6 and force.min() < -1e6  # N: rho c v of 1e7 Pa on 1 m^2, at first as pressure
    assert run.summary["contact"]["onsets"] == 1
    assert worst_energy_error(run.summary) <= 1e-9
    assert run.summary["system"]["momentum_error_max"] <= 1e-11
    assert abs(pair["gap"][first:]).max() <= (1e-12 * 0.25 if method else 4e-12)  # m: round-off, of an element; where the outer iteration stops
    if dim > 1:
        across = np.abs(pair["force_vector"][:, 1])
        assert across[first] <= 1e-9 * force.max() and across.max() > 1e5


@pytest.mark.parametrize(("dim", "faces", "pairing"), [(2, 3, "EE"), (2, 4, "II"), (3, 3, "IE")])
def test_they_stick_with_mass(dim, faces, pairing, shared_run):
    """Contact nodes that have mass lose what they move with against each other, also across, and no more, in two steps: those in which they touch and stick. Then
    they stay where they are to 1e-12 of an element, and momentum is kept."""
    run = shared_run(f"{thrown(dim, faces, pairing)} {KEPT}")
    pair, change = run.history["contact/a:b"], run.history["energy/change"][()] / run.history["energy/scale"][()].max()
    first = np.flatnonzero(pair["active"][()])[0]
    assert (pair["active"][first:] == 5 ** (dim - 1)).all() and pair["force"][()].min() < -1e6
    assert np.abs(pair["gap"][first + 2 :]).max() <= 1e-12 * 0.25
    assert change.max() <= 1e-9 and -0.2 < change[-1] < -0.08
    assert run.summary["contact"]["contact_loss"] / run.summary["system"]["energy_scale"] == pytest.approx(-change[-1], rel=1e-3 if pairing == "II" else 0.2)
    assert run.summary["system"]["momentum_error_max"] <= 1e-11


@pytest.mark.parametrize("method", ["", KEPT])
def test_ranks(method, shared_run):
    one, two = (shared_run(f"{thrown(2, 3, 'EE')} {method}", ranks).history["contact/a:b/force_vector"][()] for ranks in (1, 3 if method else 2))
    np.testing.assert_allclose(one, two, rtol=0, atol=SAME * np.abs(one).max())


def slips(run):
    """By how much each node of one side has slid past that of the other which lay opposite at the start, in each frame [m]."""
    with h5py.File(run.folder / "fields.h5") as fields:
        place = fields["mesh/positions"][()]
        sides = [np.flatnonzero(abs(place[:, 0] - x) < 1e-9) for x in (1, 1.002)]
        sides = [nodes[np.argsort(place[nodes, 1])] for nodes in sides]
        frames = [frame[()] for frame in fields["displacement"].values()]
    return np.array([frame[sides[1], :2] - frame[sides[0], :2] for frame in frames])


def test_relative_positions_stay(shared_run):
    """Of the nodes of matching faces that meet; those of faces that have slid by what they had until they met, the controller step before the one in which
    they stick included, stick to what lies between two nodes then, 1/400 of the way from one to the other: that part of the difference of their slips is left."""
    output = "-output_fields fields.h5 -output_fields_interval 1 -output_fields_precision double"
    met = slips(shared_run(f"{thrown(2, 4, 'II', across=3)} {output}"))
    assert met[12:] == pytest.approx(np.broadcast_to([-0.002, 0], met[12:].shape), abs=1e-12)
    slip = slips(shared_run(f"{thrown(2, 4, 'II')} {output}"))
    assert slip[-1, :, 1] == pytest.approx(-6 * 1e-4, abs=1.1e-4)  # 6 m/s for 1e-4 s, a step more or less
    assert np.ptp(slip[12:], axis=0).max() <= 0.03 * 6e-4  # measured: 0.022, of strains up to 0.01


@pytest.mark.parametrize("mass", ["", FORCE, f"{KEPT} -b_mass_type lumped", f"{KEPT} -b_ts_type centraldifference"])
def test_on_an_obstacle(mass, shared_run):
    """A block thrown at a wall sticks to it: its face stays where it hit, while the rest goes on and comes back. Nodes that keep their mass, that of half an element
    of 4, lose its energy along the normal and across, an eighth of the whole."""
    floor = "-obstacles wall -wall_obstacle_type plane -wall_point 1,0 -wall_normal -1,0 -contact_pairs b:wall"
    run = shared_run(f"-bodies b -contact_law bonded {floor} -time_step 1e-5 -time_end 6e-3 {cube('b', 2, -0.001, 4, (10, 3))} {mass}")
    pair = run.history["contact/b:wall"]
    first = np.flatnonzero(pair["active"])[0]
    assert (pair["active"][first:] == 5).all() and pair["force"][()].min() < -1e6
    position = run.history["body/b/contact_position"][first + 2 :, :2]
    assert np.abs(position - position[0]).max() <= 1e-12
    if KEPT in mass:
        assert run.summary["system"]["energy_error_final"] == pytest.approx(-1 / 8, rel=0.02)
    else:
        assert worst_energy_error(run.summary) <= 1e-9


@pytest.mark.parametrize("method", ["penalty", "lagrange"])
def test_other_methods_are_refused(method, impakt):
    run = impakt(f"{thrown(2, 4, 'II')} -contact_type {method}", expect_failure=True)
    for word in ("-contact_law bonded", "-contact_type schwarz", method):
        assert word in run.stderr
