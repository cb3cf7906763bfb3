"""Two unequal bodies against Hertz, both of which deform: cylinders pressed together, spheres that hit each other. Figures are those of true cylinders and
spheres: their radii and masses are the options', not the mesh's. K. L. Johnson, Contact mechanics (1985), eqs. 4.43 and 4.45, 11.21 to 11.24."""

import os
import sys

import h5py
import numpy as np
import pytest
from conftest import ROOT

CYLINDERS = "-options_file options/hertz-cylinders.opts -output_fields_interval 1"
SPHERES = "-options_file options/hertz-spheres.opts"
SIDES = {"upper first": "-contact_pairs upper.surface:lower.surface", "lower first": "-contact_pairs lower.surface:upper.surface"}
PARTS = {"half": 2, "quarter": 4}


class Pair:
    """Two discs or balls, or parts of them, as the options of a run describe them."""

    def __init__(self, run):
        options = {name: str(value) for name, value in run.history.attrs.items()}
        self.names = options["-bodies"].split(",")
        radii, moduli, densities, ratios = (np.array([float(options[f"-{name}_{key}"]) for name in self.names]) for key in ("ball_radius", "youngs_modulus", "density", "poissons_ratio"))
        self.centres = [np.array([float(x) for x in options[f"-{name}_ball_centre"].split(",")]) for name in self.names]
        self.radii, self.dim = radii, len(self.centres[0])
        self.radius, self.modulus = 1 / np.sum(1 / radii), 1 / np.sum((1 - ratios**2) / moduli)
        self.masses = densities * 4 / 3 * np.pi * radii**3
        self.parts = PARTS[options["-upper_ball_part"]]
        self.force = self.parts * next(iter(run.history["contact"].values()))["force"][()]

    def contact(self, load):
        """Half width and largest pressure of cylinders."""
        width = np.sqrt(4 * load * self.radius / (np.pi * self.modulus))
        return width, 2 * load / (np.pi * width)

    def impact(self, speed):
        """Radius of the contact at most, duration, and largest force."""
        approach = (15 / np.sum(1 / self.masses) * speed**2 / (16 * self.modulus * np.sqrt(self.radius))) ** 0.4
        return np.sqrt(self.radius * approach), 2.943 * approach / speed, 4 / 3 * self.modulus * np.sqrt(self.radius) * approach**1.5


def pressures(run, pair):
    """Of each load step, for each body: distance of the surface's nodes from the axis by the half width, and pressure by Hertz's largest, with the load."""
    with h5py.File(run.folder / "out/hertz-cylinders-fields.h5") as file:
        positions, cells, body = file["mesh/positions"][:, :2], file["mesh/cells"][()], file["mesh/body"][()].ravel()
        frames = [file["contact_pressure"][frame][()].ravel() for frame in sorted(file["contact_pressure"])]
    assert len(frames) == len(pair.force)
    found = []
    for b, (centre, radius) in enumerate(zip(pair.centres, pair.radii, strict=True)):
        edges = np.sort(cells[body == b][:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2), axis=1)
        edges, count = np.unique(edges, axis=0, return_counts=True)
        edges = edges[count == 1]
        ends = positions[edges] - centre
        along = ends[:, 1] - ends[:, 0]
        round_it = np.abs(np.einsum("ij,ij->i", along, ends[:, 0])) < 0.5 * radius * np.linalg.norm(along, axis=1)  # not on the cut
        nodes = np.unique(edges[round_it])
        nodes = nodes[np.abs(positions[nodes, 1]) < 0.1]
        found.append(nodes[np.argsort(positions[nodes, 0])])
    for load, frame in zip(pair.force, frames, strict=True):
        if load > 0:
            width, peak = pair.contact(load)
            yield load, [(positions[nodes, 0] / width, frame[nodes] / peak) for nodes in found]


def fitted(distance, pressure):
    """Half width and largest pressure by Hertz's, from p^2 = p0^2 (1 - (x/a)^2) at nodes within 0.9 a."""
    inner = distance < 0.9
    square, slope = np.linalg.lstsq(np.column_stack((np.ones(inner.sum()), -(distance[inner] ** 2))), pressure[inner] ** 2, rcond=None)[0]
    return np.sqrt(square / slope), np.sqrt(square)


@pytest.mark.parametrize("sides", SIDES.values(), ids=SIDES)
def test_cylinders(sides, shared_run):
    """Whichever side comes first. At the end, with 22 and 29 nodes to the half width: half width and largest pressure to 0.3 % (demanded: 2 %), the pressure of each
    node from 0.85 a to 0.95 a to 1.7 % (3 %). In all load steps that have 10 nodes and more: 0.5 %, and 2.1 % of each node within 0.9 a. Where rows were missing
    at the pole the first step had no pressure there: bodies start a micrometre apart, as a row's mean gap may be less than that of the nodes."""
    run = shared_run(f"{CYLINDERS} {sides}")
    pair = Pair(run)
    steps = list(pressures(run, pair))
    assert len(steps) == 10
    width, _ = pair.contact(steps[-1][0])
    assert 0.07 < width / pair.radius < 0.08  # small, as in theory
    looked_at = 0
    for load, sides_of_it in steps:
        for distance, pressure in sides_of_it:
            if np.sum(distance < 1) < 10:
                continue
            looked_at += 1
            last = load == steps[-1][0]
            assert fitted(distance, pressure) == pytest.approx([1, 1], abs=0.004 if last else 0.006)
            error = np.abs(pressure / np.sqrt(np.maximum(1e-9, 1 - distance**2)) - 1)
            assert error[distance < 0.9].max() <= 0.025
            if last:
                rim = (distance > 0.85) & (distance < 0.95)
                assert rim.sum() >= 2
                assert error[rim].max() <= 0.03
    assert looked_at == 17


@pytest.mark.long
def test_cylinders_converge(shared_run):
    """With half the elements nodes are wrong by 5 % near the rim, where the half width has 11 and 15."""
    errors = []
    for divisions in (48, 96):
        run = shared_run(f"{CYLINDERS} {SIDES['upper first']} -upper_ball_divisions {divisions} -lower_ball_divisions {divisions}")
        *_, (_, last) = pressures(run, Pair(run))
        errors.append(max(np.abs(pressure[distance < 0.9] / np.sqrt(1 - distance[distance < 0.9] ** 2) - 1).max() for distance, pressure in last))
    assert errors[1] <= 0.5 * errors[0]


def impact_errors(run):
    """Of contact time and largest force, of true spheres."""
    pair = Pair(run)
    velocities = [run.history["body"][name]["mean_velocity"][:, 2] for name in pair.names]
    for name, velocity, mass in zip(pair.names, velocities, pair.masses, strict=True):
        assert pair.parts * run.history["body"][name]["momentum"][0, 2] == pytest.approx(mass * velocity[0], rel=1e-10)  # meshes weigh what spheres do
    speed = velocities[1] - velocities[0]
    radius, duration, force = pair.impact(speed[0])
    contact = run.summary["contact"]
    assert radius < 0.036 * pair.radii.min()
    return np.array(((contact["separation_time"] - contact["onset_time"]) / duration - 1, pair.force.max() / force - 1)), -speed[-1] / speed[0]


@pytest.mark.long
@pytest.mark.parametrize("sides", SIDES.values(), ids=SIDES)
def test_spheres(sides, shared_run):
    """Contact time and largest force within 2 %: measured -0.7 % and 1.5 %, and -0.5 % and 0.8 % with the lower sphere first (a step is 0.7 %). A sphere is no half-space,
    which makes it stiffer: the radius of the contact is 0.036 and 0.028 of the spheres', and half of that is what the force is above theory."""
    run = shared_run(f"{SPHERES} {sides}")
    errors, restitution = impact_errors(run)
    assert np.abs(errors).max() <= 0.02
    assert 0.9998 <= restitution <= 1
    assert run.summary["contact"]["onsets"] == 1
    assert not run.summary["contact"]["in_contact_at_end"]
    assert run.summary["system"]["energy_error_max"] <= 1e-5
    assert run.summary["system"]["energy_error_min"] >= -2e-4


COARSE = "-upper_ball_divisions 8 -upper_ball_grading 64 -lower_ball_divisions 8 -lower_ball_grading 49 -time_step 4e-4"


def test_coarse_spheres(shared_run):
    """With one and a half nodes to the radius of the contact: measured 0.2 % and 6.5 %."""
    errors, restitution = impact_errors(shared_run(f"{SPHERES} {COARSE}"))
    assert abs(errors[0]) <= 0.01
    assert 0 <= errors[1] <= 0.085
    assert restitution >= 0.999


def test_figure(shared_run, launch, tmp_path):
    figure = tmp_path / "figure.png"
    histories = [shared_run(options).folder / "history.h5" for options in (f"{CYLINDERS} {SIDES['upper first']}", f"{SPHERES} {COARSE}")]
    run = launch([sys.executable, ROOT / "plots/hertz.py", *histories, figure], env={**os.environ, "MPLBACKEND": "Agg"})
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
