"""Controller steps of explicit bodies with substeps that are made again under other contact forces, in the nodes that these have reached."""

import re

import numpy as np
import pytest
from cases import joined
from contactstep import model
from setups import box

STABLE = 1e-6  # less than the stable substep of cubes of 10 mm [s]
SUBSTEPS = {"upper": 5, "lower": 4}
MADE_AGAIN = re.compile(r"body '(\w+)': step made again with (\d+) of (\d+) forces of elements")
COLUMNS = re.compile(r"(\d+) new columns of the compliance of nodes of body '(\w+)'")


def blocks(of="neo_hookean", formulation="full", high=16, steps=20, speed=5, stable=STABLE, more=""):
    """Two blocks of steel, 50 x 50 mm wide and so many cubes high, one of them turned about the normal and shifted, that hit flat."""
    step = 4 * stable
    parts = []
    for name, lower, velocity in (("upper", 1e-7, -speed), ("lower", -1e-2 * high, speed)):
        parts += [
            box(name, (5, 5, high), (0, 0, lower), (0.05, 0.05, lower + 1e-2 * high)),
            model(name, of),
            f"-{name}_initial_velocity 1,0,{velocity} -{name}_ts_type centraldifference -{name}_ts_time_step {step / SUBSTEPS[name]:.17g}",
            f"-{name}_element_formulation {formulation}",
        ]
    place = "-upper_rotate 0,0,1,20 -upper_translate 0.01,0.005,0"
    contact = f"-bodies upper,lower -contact_type force -contact_pairs upper.zmin:lower.zmax -time_step {step:.17g} -time_end {steps * step:.17g}"
    return joined(*parts, contact, place, "-output_fields none", more)


def same(one, other):
    """Every number of two histories and of what contact did, but for the scale of the energy, which that of loads is part of."""
    names = []
    one.history.visit(names.append)
    for name in set(names) - {"energy/scale"}:
        if hasattr(one.history[name], "dtype") and one.history[name].dtype.kind in "fi":
            np.testing.assert_array_equal(one.history[name][()], other.history[name][()], err_msg=name)
    assert one.summary["schwarz"] == other.summary["schwarz"]


@pytest.mark.parametrize("of, formulation", [("linear_elastic", "full"), ("neo_hookean", "full"), ("neo_hookean", "reduced"), ("neo_hookean", "mean_dilatation")])
def test_to_the_last_bit(of, formulation, impakt):
    """A force of zero in the volume has all nodes stepped each time, since its work is summed up over all. In substep k nodes k elements away are stepped, for which k + 1 of the
    16 layers of elements are needed: 4 in the mean of 5 substeps. Elements are taken in batches of 8, so that up to 7 of the next layer's 25 come with them."""
    case = blocks(of, formulation, more="-info")
    front, whole = impakt(case), impakt(joined(case, "-upper_body_force 0,0,0 -lower_body_force 0,0,0"))
    same(front, whole)
    assert front.history["contact/upper.zmin:lower.zmax/force"][()].max() > 0
    assert not MADE_AGAIN.search(whole.stdout)
    again = MADE_AGAIN.findall(front.stdout)
    assert {name for name, _, _ in again} == set(SUBSTEPS)
    assert len(again) >= 2 * (front.summary["schwarz"]["mean_all_steps"] - 1) * 20 - 2  # but the first, before which no step has been made twice
    assert sum(int(some) for _, some, _ in again) < (4 + 7 / 25) / 16 * sum(int(all_) for _, _, all_ in again)


def test_restart(impakt):
    """From within contact, where the run that goes on has no record of the step before."""
    case = blocks(steps=16)
    whole, half = impakt(case), impakt(joined(case, f"-checkpoint c.h5 -time_end {7 * 4 * STABLE:.17g}"))
    rest = impakt(joined(case, f"-restart {half.folder / 'c.h5'}"))
    n = len(rest.history["time"][()])
    assert whole.history["contact/upper.zmin:lower.zmax/force"][()].max() > 0
    for name in ("contact/upper.zmin:lower.zmax/gap", "contact/upper.zmin:lower.zmax/force", "body/upper/momentum", "body/lower/kinetic"):
        np.testing.assert_array_equal(rest.history[name][()], whole.history[name][()][-n:], err_msg=name)


def test_ranks(impakt):
    """On two ranks all nodes are stepped: the same forces, to the tolerance of the outer iteration, 1e-7 of the way that they make in a step."""
    case = blocks(more="-info")
    one, two = impakt(case), impakt(case, 2)
    assert MADE_AGAIN.search(one.stdout) and not MADE_AGAIN.search(two.stdout)
    for name, scale in (("contact/upper.zmin:lower.zmax/impulse", 1e-6), ("body/upper/momentum", 1e-6), ("body/upper/kinetic", 1e-6)):
        a, b = one.history[name][()], two.history[name][()]
        np.testing.assert_allclose(a, b, rtol=0, atol=scale * np.abs(a).max(), err_msg=name)


def test_columns(impakt):
    """Normals turn a little as a nonlinear body deforms. A column for the one displacement of each contact node along the normal is enough then."""
    run = impakt(blocks(high=8, stable=4e-7, speed=1, more="-info -upper_dm_plex_box_faces 12,12,8 -lower_dm_plex_box_faces 11,11,8"))
    columns = {name: 0 for name in SUBSTEPS}
    for n, name in COLUMNS.findall(run.stdout):
        columns[name] += int(n)
    assert columns["upper"] <= 1.3 * 13**2 and columns["lower"] <= 1.3 * 12**2
    assert run.summary["schwarz"]["mean_contact_steps"] <= 4.5
