"""Controller steps of explicit bodies with substeps that are made again under other contact forces."""

import re

import numpy as np
from cases import joined
from contactstep import model
from setups import box

STABLE = 1e-6  # less than the stable substep of cubes of 10 mm [s]
SUBSTEPS = {"upper": 5, "lower": 4}
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


def test_restart(impakt):
    """From within contact."""
    case = blocks(steps=16)
    whole, half = impakt(case), impakt(joined(case, f"-checkpoint c.h5 -time_end {7 * 4 * STABLE:.17g}"))
    rest = impakt(joined(case, f"-restart {half.folder / 'c.h5'}"))
    n = len(rest.history["time"][()])
    assert whole.history["contact/upper.zmin:lower.zmax/force"][()].max() > 0
    for name in ("contact/upper.zmin:lower.zmax/gap", "contact/upper.zmin:lower.zmax/force", "body/upper/momentum", "body/lower/kinetic"):
        np.testing.assert_array_equal(rest.history[name][()], whole.history[name][()][-n:], err_msg=name)


def test_ranks(impakt):
    """On two ranks: the same forces, to the tolerance of the outer iteration, 1e-7 of the way that they make in a step."""
    case = blocks()
    one, two = impakt(case), impakt(case, 2)
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
