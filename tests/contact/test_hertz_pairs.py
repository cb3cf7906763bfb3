"""Two unequal bodies against Hertz, both of which deform: cylinders pressed together, spheres that hit each other. Figures are those of true cylinders and
spheres: their radii and masses are the options', not the mesh's. plots/hertz.py has the formulas."""

import h5py
import hertz
import numpy as np
import pytest
from cases import long, validate

CYLINDERS = "-options_file options/hertz-cylinders.opts -output_fields_interval 1"
SPHERES = "-options_file options/hertz-spheres.opts"
SIDES = {"upper first": "-contact_pairs upper.surface:lower.surface", "lower first": "-contact_pairs lower.surface:upper.surface"}
COARSE = "-upper_ball_divisions 8 -upper_ball_grading 64 -lower_ball_divisions 8 -lower_ball_grading 49 -time_step 4e-4"
MASSES = {"upper": 1500 * 4 / 3 * np.pi * 0.8**3, "lower": 1000 * 4 / 3 * np.pi}


def pressures(run, pair, loads):
    """Of each load step, for each body: distance of the surface's nodes from the axis by the half width, and pressure by Hertz's largest."""
    with h5py.File(run.folder / "out/hertz-cylinders-fields.h5") as file:
        positions, cells, body = file["mesh/positions"][:, :2], file["mesh/cells"][()], file["mesh/body"][()].ravel()
        frames = [file["contact_pressure"][frame][()].ravel() for frame in sorted(file["contact_pressure"])]
        surface = np.flatnonzero(np.isfinite(file["contact_gap"][max(file["contact_gap"])][()].ravel()) & (np.abs(positions[:, 1]) < 0.1))
    assert len(frames) == len(loads)
    sides = [nodes[np.argsort(positions[nodes, 0])] for nodes in (np.intersect1d(cells[body == b], surface) for b in (0, 1))]
    for load, frame in zip(loads[1:], frames[1:], strict=True):
        width, peak = pair.contact(load)
        yield [(positions[nodes, 0] / width, frame[nodes] / peak) for nodes in sides]


@pytest.mark.parametrize("sides", [SIDES["upper first"], *long(SIDES["lower first"])], ids=SIDES)
def test_cylinders(sides, shared_run):
    """Whichever side comes first. At the end, with 22 and 29 nodes to the half width: half width and largest pressure to 0.3 % (demanded: 2 %), the pressure of each
    node from 0.85 a to 0.95 a to 1.7 % (3 %). In all load steps that have 10 nodes and more: 0.5 %, and 2.1 % of each node within 0.9 a. Where rows were missing
    at the pole the first step had no pressure there: bodies start a micrometre apart, as a row's mean gap may be less than that of the nodes."""
    run = shared_run(f"{CYLINDERS} {sides}")
    pair, series = hertz.read(run.folder / "history.h5")
    steps = list(pressures(run, pair, series["force"]))
    assert len(steps) == 10
    assert 0.07 < pair.contact(series["force"][-1])[0] / pair.radius < 0.08  # small, as in theory
    looked_at = 0
    for step in steps:
        for distance, pressure in step:
            inner = distance < 0.9
            if np.sum(distance < 1) < 10:
                continue
            looked_at += 1
            assert hertz.fit(distance[inner], pressure[inner]) == pytest.approx((1, 1), abs=0.004 if step is steps[-1] else 0.006)
            error = np.abs(pressure / np.sqrt(np.maximum(1e-9, 1 - distance**2)) - 1)
            assert error[inner].max() <= 0.025
            if step is steps[-1]:
                rim = (distance > 0.85) & (distance < 0.95)
                assert rim.sum() >= 2
                assert error[rim].max() <= 0.03
    assert looked_at == 17


def impact_errors(run):
    """Of contact time and largest force, of true spheres; and the restitution."""
    pair, series = hertz.read(run.folder / "history.h5")
    for name, mass in MASSES.items():
        body = run.history["body"][name]
        assert pair.parts * body["momentum"][0, 2] == pytest.approx(mass * body["mean_velocity"][0, 2], rel=1e-10)  # meshes weigh what spheres do
    speed = np.abs(series["velocity"])
    approach, duration, force = pair.impact(1 / sum(1 / mass for mass in MASSES.values()), speed[0])
    contact = run.summary["contact"]
    assert np.sqrt(pair.radius * approach) < 0.036 * 0.8
    assert series["velocity"][0] * series["velocity"][-1] < 0
    return np.array(((contact["separation_time"] - contact["onset_time"]) / duration - 1, series["force"].max() / force - 1)), speed[-1] / speed[0]


@pytest.mark.parametrize("sides", [*long(SIDES["upper first"]), *validate(SIDES["lower first"])], ids=SIDES)
def test_spheres(sides, shared_run):
    """Contact time and largest force within 2 %: measured -0.7 % and 1.5 %, and -0.5 % and 0.8 % with the lower sphere first (a step is 0.7 %). A sphere is no half-space,
    which makes it stiffer: the radius of the contact is 0.036 and 0.028 of the spheres', and half of that is what the force is above theory."""
    run = shared_run(f"{SPHERES} {sides}")
    errors, restitution = impact_errors(run)
    assert np.abs(errors).max() <= 0.02
    assert 0.9998 <= restitution <= 1
    assert run.summary["contact"]["onsets"] == 1
    assert not run.summary["contact"]["in_contact_at_end"]
    assert run.summary["system"]["energy_error_max"] <= 2e-5  # measured: 1.3e-5, of rows that open inside a step
    assert run.summary["system"]["energy_error_min"] >= -2e-4


def test_coarse_spheres(shared_run):
    """With one and a half nodes to the radius of the contact: measured 0.2 % and 6.5 %."""
    errors, restitution = impact_errors(shared_run(f"{SPHERES} {COARSE}"))
    assert abs(errors[0]) <= 0.01
    assert 0 <= errors[1] <= 0.085
    assert restitution >= 0.999
