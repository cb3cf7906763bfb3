"""Steps of the rule `impulse` look at rows near contact alone (src/contact/rows/nearrows.c): what the others cost, and what outputs say of them."""

import os
import subprocess

import h5py
import numpy as np
import pytest
from cases import joined
from conftest import IMPAKT
from thinbodies import STABLE, bracket, drop

QUIET = "-output_fields none -output_history none -progress false"


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    """Of 506 cubes, and of 4140."""
    return {edge: bracket(tmp_path_factory.mktemp("bracket") / "b.msh", edge) for edge in (1e-3, 2e-3)}


@pytest.mark.parametrize("ranks", [1, 3])
def test_gaps_far_away(ranks, meshes, impakt):
    """It falls from where no row is near, in free flight, and lands: the smallest gap in the history, and that of each node in fields, are those of the surface at all times."""
    height, speed = 9e-3, 100.0
    case = drop(meshes[2e-3], fall="corner", speed=speed, gap=height, step=1e-6, end=9.5e-5)
    run = impakt(joined(case, "-output_fields fields.h5 -output_fields_precision double -output_fields_interval 20"), ranks)
    gap, time = run.history["contact/bracket:t/gap"][()].ravel(), run.history["time"][()].ravel()
    flight = time < 8.5e-5
    np.testing.assert_allclose(gap[flight], height - speed * time[flight], rtol=0, atol=1e-12)
    assert np.abs(run.history["contact/bracket:t/force"][-1]).item() > 0
    with h5py.File(run.folder / "fields.h5") as file:
        start, seen = file["mesh/positions"][()], 0
        for frame in sorted(file["displacement"]):
            place, of_node = start + file[f"displacement/{frame}"][()], file[f"contact_gap/{frame}"][()].ravel()
            has = np.isfinite(of_node)
            seen += has.sum()
            np.testing.assert_allclose(of_node[has], place[has, 2], rtol=0, atol=1e-12)
    assert seen > 300


def test_restart(meshes, impakt):
    """From within contact: to the last bit."""
    case = drop(meshes[2e-3], fall="edge", step=2e-7, end=2e-5, speed=20)
    whole = impakt(joined(case, "-output_fields none"))
    half = impakt(joined(case, "-output_fields none -checkpoint c.h5 -time_end 1.1e-5"))
    rest = impakt(joined(case, f"-output_fields none -restart {half.folder / 'c.h5'}"))
    n = len(rest.history["time"][()])
    assert whole.history["contact/bracket:t/force"][()].max() > 0
    for name in ("contact/bracket:t/gap", "contact/bracket:t/force_vector", "contact/bracket:t/impulse", "body/bracket/momentum", "body/bracket/kinetic"):
        np.testing.assert_array_equal(rest.history[name][()], whole.history[name][()][-n:], err_msg=name)


def test_first_rows_tell_who_touches(meshes, impakt):
    """It flies, then slides over the plane with friction. The first row of each node alone is read while nothing touches, all rows are where the coefficient might depend on the speed, here
    not by its value: all that comes out is the same to the last bit."""
    case = drop(meshes[2e-3], fall="edge", speed=20, gap=2e-4, step=1e-6, end=4e-5).replace("_velocity 0,0", "_velocity 15,0")
    first, every = impakt(joined(case, "-output_fields none")), impakt(joined(case, "-output_fields none -contact_friction_kinetic 0.3 -contact_friction_decay 1"))
    force = np.abs(first.history["contact/bracket:t/force"][()].ravel())
    assert force[:9].max() == 0 < force.max()
    assert first.history["contact/bracket:t/friction_loss"][-1] > 0
    for name in ("contact/bracket:t/force_vector", "contact/bracket:t/gap", "contact/bracket:t/friction_loss", "body/bracket/momentum", "body/bracket/kinetic"):
        np.testing.assert_array_equal(every.history[name][()], first.history[name][()], err_msg=name)


def seconds(options):
    """Of the processor."""
    before = os.times()
    subprocess.run([IMPAKT, *options.split()], check=True, capture_output=True, timeout=120)
    return os.times().children_user - before.children_user


def test_costs_what_touches(meshes):
    """A linear bracket of 4140 cubes that falls on its corner, with friction, in steps of its own, beside free flight. Measured: 1.3; all 13 000 rows in each step: 3.2."""
    step = STABLE / 2
    costs = [min(seconds(joined(drop(meshes[1e-3], of="linear_elastic", fall="corner", partner=partner, step=step, end=1200 * step), QUIET)) for _ in range(3)) for partner in ("plane", None)]
    assert costs[0] <= 1.7 * costs[1]


@pytest.mark.long
def test_costs_beside_flight_above_plane(meshes):
    """The same that falls flat, 1150 nodes at once, beside one that starts high above the plane. Measured: 1.13; with forces of all near rows written in each step 1.42."""
    case = "-contact_type force -bracket_mass_redistribute false"
    costs = [min(seconds(joined(drop(meshes[1e-3], of="linear_elastic", gap=gap, step=STABLE, end=1e-4, more=case), QUIET)) for _ in range(3)) for gap in (1e-6, 0.05)]
    assert costs[0] <= 1.3 * costs[1]
