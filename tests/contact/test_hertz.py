"""Cylinder and sphere on a rigid plane against Hertz: pressed without inertia, and in an impact. plots/hertz.py has the formulas."""

import os
import sys

import h5py
import hertz
import numpy as np
import pytest
from cases import long, validate
from conftest import ROOT
from test_hertz_pairs import COARSE, CYLINDERS, SIDES, SPHERES

CYLINDER = "-options_file options/hertz-cylinder.opts"
SPHERE = "-options_file options/hertz-sphere.opts"
COARSE_SPHERE = f"{SPHERE} -sphere_ball_divisions 12 -time_step 1"
IMPACT = "-options_file options/hertz-impact.opts"
COARSE_IMPACT = f"{IMPACT} -ball_ball_divisions 8 -ball_ball_grading 32"
EXPLICIT = "-ball_ts_type centraldifference -ball_ts_time_step auto"


def read(run):
    return hertz.read(run.folder / "history.h5")


@pytest.mark.parametrize(("options", "inner", "rms"), [(CYLINDER, 0.01, 0.01), *long((SPHERE, 0.015, 0.02))], ids=["cylinder", "sphere"])
def test_pressure(options, inner, rms, shared_run):
    """Pressures within 1 % of the largest (measured 0.7 %), in the sphere 1.5 % (0.9 %), but for the rim: there the profile is vertical, and
    what nodes have are means over an element, which is 0.1 a. Over all nodes that touch the root mean square is 0.7 % and 1.1 %. The demand is 3 % of the pressure that
    theory has at the node, for all nodes that are an element or more inside the contact: measured 1.4 % and 1.9 %."""
    ball, series = read(shared_run(options))
    radius, peak = ball.contact(series["force"][-1])
    distance, pressure, touches = series["distance"] / radius, series["pressure"] / peak, series["touches"]
    theory, inside = hertz.hertz_pressure(distance), distance < 0.9
    assert 0.05 < radius / ball.radius < 0.12  # small, as in theory
    assert np.sum(touches) == series["active"][-1]
    assert np.abs(pressure - theory)[inside].max() <= inner
    assert np.sqrt(np.mean((pressure - theory)[touches & (distance < 2)] ** 2)) <= rms
    assert np.all(pressure[~touches] == 0)
    assert np.all(pressure >= 0)
    assert distance[~inside].min() < 0.96  # the next one is in the last element
    assert np.abs(pressure[inside] / theory[inside] - 1).max() <= 0.025


FACES = np.array([[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])  # of a hexahedron


def means(run):
    """Distance of nodes from the axis by the radius of the contact of a sphere, their pressures by the largest one, and the means of Hertz's that belong to
    them: int p phi_i / int phi_i, over the plane, by 40 x 40 points on each face."""
    ball, series = read(run)
    radius, peak = ball.contact(series["force"][-1])
    with h5py.File(run.folder / "out/hertz-sphere-fields.h5") as file:
        positions = (file["mesh/positions"] - ball.centre)[:, :3]
        faces = file["mesh/cells"][()][:, FACES].reshape(-1, 4)
        pressure = file["contact_pressure"][max(file["contact_pressure"])][()].ravel() / peak
    distance = np.linalg.norm(positions[:, :2], axis=1) / radius
    surface = ball.lower_surface(positions) & (distance < 1.5)
    faces = faces[surface[faces].all(axis=1)]
    x, y = (each.ravel() for each in np.meshgrid(*2 * [(np.arange(40) + 0.5) / 40]))
    shapes = np.stack(((1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y))
    slopes = np.stack((y - 1, 1 - y, y, -y)), np.stack((x - 1, -x, x, 1 - x))
    corners = positions[faces][:, :, :2]
    points = np.einsum("kq,fkd->fqd", shapes, corners)
    along, across = (np.einsum("kq,fkd->fqd", each, corners) for each in slopes)
    area = np.abs(along[..., 0] * across[..., 1] - along[..., 1] * across[..., 0])
    sums = np.zeros((2, len(positions)))
    for weight, total in zip((area * hertz.hertz_pressure(np.linalg.norm(points, axis=-1) / radius), area), sums, strict=True):
        np.add.at(total, faces, np.einsum("fq,kq->fk", weight, shapes))
    inside = surface & (distance < 1)
    return distance[inside], pressure[inside], sums[0][inside] / sums[1][inside]


@pytest.mark.long
def test_pressures_are_means(shared_run):
    """What is left of the error where the profile is curved is that a node's pressure is a mean over its faces: with that of Hertz's, the sphere's agree
    to 0.12 % of the largest within 0.9 of the radius (measured 0.09 %, where values at the nodes differ by 0.9 %), and to 2.2 % up to the rim (1.7 %)."""
    distance, pressure, mean = means(shared_run(SPHERE))
    assert len(distance) > 60
    error = np.abs(pressure - mean)
    assert error[distance < 0.9].max() <= 0.0012
    assert error.max() <= 0.022


@pytest.mark.parametrize("options", [CYLINDER, *long(SPHERE)], ids=["cylinder", "sphere"])
def test_radius(options, shared_run):
    """From the profile within 1 %: measured -0.42 % and -0.43 %, with largest pressures 0.11 % and -0.17 % off; from the area of the nodes that
    touch, which changes by whole nodes, within 3 %: measured 0.06 % and 2.6 %."""
    ball, series = read(shared_run(options))
    radius, peak = ball.contact(series["force"][-1])
    inner = series["distance"] < 0.9 * radius
    assert hertz.fit(series["distance"][inner], series["pressure"][inner]) == pytest.approx((radius, peak), rel=0.01)
    area = series["area"][-1] / 2 if ball.dim == 2 else np.sqrt(series["area"][-1] / np.pi)
    assert area == pytest.approx(radius, rel=0.03)
    if ball.dim == 3:
        return
    # As the square root of the load on a cylinder, in each of ten load steps within an element at the rim, of 0.0066 R: the outermost node that
    # touches may be almost half an element beyond Hertz's radius, and has half an element there of its own. Measured -0.0011 to 0.0049 R
    radius, _ = ball.contact(series["force"][1:])
    assert np.abs(series["area"][1:] / 2 - radius).max() <= 0.0066 * ball.radius
    assert radius[-1] > 2 * radius[0]


@pytest.mark.parametrize("options", [*long(IMPACT), *validate(f"{IMPACT} {EXPLICIT}")], ids=["implicit", "explicit"])
def test_impact(options, shared_run):
    """Contact time and largest force of the true ball, which the mesh weighs as much as, within 1.3 %: measured 0.95 % (a step is 0.65 %) and 0.94 %;
    with twice the elements -1.0 % and 1.2 %. The ball is no half-space, which makes it stiffer: on meshes that resolve it, the force is 0.5 a/R above
    theory, a/R being 0.032 here (measured 2.8 % at 0.3 m/s, 3.9 % at 1 m/s). Restitution 0.99995 implicit, 0.9999 explicit; contact once."""
    run = shared_run(options)
    ball, series = read(run)
    mass, speed = series["momentum"][0] / series["velocity"][0], -series["velocity"][0]
    assert mass == pytest.approx(4000 / 3 * np.pi * ball.radius**3, rel=1e-12)
    _, duration, force = ball.impact(mass, speed)
    taken = np.count_nonzero(series["force"]) * series["time"][1]  # in whole controller steps
    assert (taken, series["force"].max()) == pytest.approx((duration, force), rel=0.013)
    assert run.summary["contact"]["onsets"] == 1
    assert series["force"][-1] == 0
    assert 0.9997 <= series["velocity"][-1] / speed <= 1
    # Of rows that open inside a step. Nodes beside massless ones bear what extrapolation adds to them: 4.1e-5 measured, 2.9e-6 where mass moves and inertia with it.
    assert run.summary["system"]["energy_error_max"] <= 5e-5
    transit = 2 * ball.radius / np.sqrt(1.3462e9 / 1000)  # wave speed from the modulus E (1 - nu) / (1 + nu) / (1 - 2 nu)
    assert taken > 15 * transit


@pytest.mark.parametrize("options", [*long(COARSE_IMPACT), f"{CYLINDER} -time_step 0.5", *validate(COARSE_SPHERE)], ids=["impact", "cylinder", "sphere"])
def test_ranks(options, shared_run):
    """The same history on 3 ranks to 1e-7 of the largest number; gaps that are closed, to the round-off of positions of 1 m."""
    first, other = (shared_run(options, ranks=ranks).history for ranks in (1, 3))

    def compare(name, one):
        if not isinstance(one, h5py.Dataset):
            return
        size = np.abs(one[()]).max()
        assert np.abs(one[()] - other[name][()]).max() <= 1e-7 * size + 1e-15, name

    first.visititems(compare)


QUICK = [CYLINDER, "-options_file options/hertz-sphere-axisymmetric.opts", f"{SPHERES} {COARSE}"]


@pytest.mark.parametrize("cases", [QUICK, *long([SPHERE, IMPACT, f"{CYLINDERS} {SIDES['upper first']}"])], ids=["quick", "long"])
def test_figure(cases, shared_run, launch, tmp_path):
    figure = tmp_path / "figure.png"
    command = [sys.executable, ROOT / "plots/hertz.py"]
    run = launch([*command, *(shared_run(options).folder / "history.h5" for options in cases), figure], env={**os.environ, "MPLBACKEND": "Agg"})
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_not_a_ball(shared_run, launch, tmp_path):
    """A run of boxes is told apart, and what is not there."""
    history = shared_run("-options_file options/blocks.opts -time_end 1e-6").folder / "history.h5"
    run = launch([sys.executable, ROOT / "plots/hertz.py", history, tmp_path / "figure.png"])
    assert run.returncode > 0
    assert "no disc or ball" in run.stderr
    assert not (tmp_path / "figure.png").exists()
    run = launch([sys.executable, ROOT / "plots/hertz.py", tmp_path / "nowhere.h5", tmp_path / "figure.png"])
    assert run.returncode > 0
    assert "nowhere.h5" in run.stderr
    assert "Traceback" not in run.stderr
