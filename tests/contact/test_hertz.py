"""Cylinder and sphere on a rigid plane against Hertz: pressed without inertia, and in an impact. plots/hertz.py has the formulas."""

import os
import sys

import h5py
import hertz
import numpy as np
import pytest
from cases import long, longest
from conftest import ROOT

CYLINDER = "-options_file options/hertz-cylinder.opts"
SPHERE = "-options_file options/hertz-sphere.opts"
COARSE_SPHERE = f"{SPHERE} -sphere_ball_divisions 12 -time_step 1"
IMPACT = "-options_file options/hertz-impact.opts"
COARSE_IMPACT = f"{IMPACT} -ball_ball_divisions 8 -ball_ball_grading 32"
EXPLICIT = "-ball_ts_type centraldifference -ball_ts_time_step auto"


def read(run):
    return hertz.read(run.folder / "history.h5")


def pressure_error(ball, series, within):
    """Of nodes up to a distance from the axis, by Hertz's largest pressure."""
    radius, peak = ball.contact(series["force"][-1])
    distance = series["distance"] / radius
    return (series["pressure"] / peak - hertz.hertz_pressure(distance))[distance < within]


def fitted(ball, series):
    """Radius and largest pressure, from nodes that are not at the rim, by those of Hertz."""
    radius, peak = ball.contact(series["force"][-1])
    inner = series["distance"] < 0.9 * radius
    return np.array(hertz.fit(series["distance"][inner], series["pressure"][inner])) / (radius, peak)


@pytest.mark.parametrize(("options", "inner", "rms"), [(CYLINDER, 0.01, 0.01), (SPHERE, 0.015, 0.02)], ids=["cylinder", "sphere"])
def test_pressure(options, inner, rms, shared_run):
    """Pressures within 1 % of the largest (measured 0.7 %), in the sphere 1.5 % (0.9 %), but for the rim: there the profile is vertical, and
    what nodes have are means over an element, which is 0.1 a. Over all nodes that touch the root mean square is 0.7 % and 1.1 %."""
    ball, series = read(shared_run(options))
    radius, _ = ball.contact(series["force"][-1])
    assert 0.05 < radius / ball.radius < 0.12  # small, as in theory
    assert np.sum(series["touches"]) == series["active"][-1]
    assert np.abs(pressure_error(ball, series, 0.9)).max() <= inner
    assert np.sqrt(np.mean(pressure_error(ball, series, 2)[series["touches"][series["distance"] < 2 * radius]] ** 2)) <= rms
    assert np.all(series["pressure"][~series["touches"]] == 0)
    assert np.all(series["pressure"] >= 0)


@pytest.mark.parametrize("options", [CYLINDER, SPHERE], ids=["cylinder", "sphere"])
def test_profile(options, shared_run):
    """The demand: the profile within 3 %, of the pressure that theory has at the node, for all nodes that are an element or more inside the contact,
    which is 0.9 of its radius in both files (measured 1.4 % and 1.9 %). Why not nearer to the rim: see below."""
    ball, series = read(shared_run(options))
    radius, peak = ball.contact(series["force"][-1])
    distance = series["distance"] / radius
    inside = distance < 0.9
    assert distance[~inside].min() < 0.96  # the next one is in the last element
    assert np.abs(series["pressure"][inside] / (peak * hertz.hertz_pressure(distance[inside])) - 1).max() <= 0.025


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


def test_pressures_are_means(shared_run):
    """What is left of the error where the profile is curved is that a node's pressure is a mean over its faces: with that of Hertz's, the sphere's agree
    to 0.12 % of the largest within 0.9 of the radius (measured 0.09 %, where values at the nodes differ by 0.9 %), and to 2.2 % up to the rim (1.7 %)."""
    distance, pressure, mean = means(shared_run(SPHERE))
    assert len(distance) > 60
    error = np.abs(pressure - mean)
    assert error[distance < 0.9].max() <= 0.0012
    assert error.max() <= 0.022


def test_rim(shared_run):
    """At the rim p falls as the root of the distance from it, and what nodes have there is off by some part of the pressure an element inside, whatever the mesh:
    0.2 to 0.29 sqrt(h/a) of the largest pressure, in the worst of 20 load steps, on meshes of 6, 12 and 24 elements to the radius. So 3 % of the largest for every node
    would take 90 elements; an element inside, the error is at most 3.5 % of the pressure there, on all of them."""
    for divisions in (16, 32, 64):
        run = shared_run(f"{CYLINDER} -cylinder_ball_divisions {divisions} -time_step 0.05 -output_fields_interval 1")
        ball, _ = read(run)
        force = ball.parts * next(iter(run.history["contact"].values()))["force"][()]
        with h5py.File(run.folder / "out/hertz-cylinder-fields.h5") as file:
            positions = file["mesh/positions"][:, :2] - ball.centre
            surface = ball.lower_surface(positions)
            pressures = [file["contact_pressure"][frame][()].ravel()[surface] for frame in sorted(file["contact_pressure"])]
        distance = positions[surface, 0]
        element = np.sort(distance)[1]
        looked_at = 0
        for load, pressure in zip(force, pressures, strict=True):
            if load == 0:
                continue
            radius, peak = ball.contact(load)
            if radius < 4 * element:
                continue
            looked_at += 1
            theory = hertz.hertz_pressure(distance / radius)
            inside = distance < radius - element
            assert np.abs(pressure / peak - theory).max() <= 0.35 * np.sqrt(element / radius)
            assert np.abs(pressure[inside] / peak / theory[inside] - 1).max() <= 0.045
        assert looked_at >= 10


@pytest.mark.parametrize("options", [CYLINDER, SPHERE], ids=["cylinder", "sphere"])
def test_radius(options, shared_run):
    """From the profile within 1 %: measured -0.42 % and -0.43 %, with largest pressures 0.11 % and -0.17 % off; from the area of the nodes that
    touch, which changes by whole nodes, within 3 %: measured 0.06 % and 2.6 %."""
    ball, series = read(shared_run(options))
    assert fitted(ball, series) == pytest.approx([1, 1], rel=0.01)
    radius, _ = ball.contact(series["force"][-1])
    area = series["area"][-1] / 2 if ball.dim == 2 else np.sqrt(series["area"][-1] / np.pi)
    assert area == pytest.approx(radius, rel=0.03)


def test_radius_grows_with_load(shared_run):
    """As the square root of the load on a cylinder, in each of ten load steps within an element at the rim, of 0.0066 R: the outermost node
    that touches may be almost half an element beyond Hertz's radius, and has half an element there of its own. Measured -0.0011 to 0.0049 R."""
    ball, series = read(shared_run(CYLINDER))
    radius, _ = ball.contact(series["force"][1:])
    assert np.abs(series["area"][1:] / 2 - radius).max() <= 0.0066 * ball.radius
    assert radius[-1] > 2 * radius[0]


def test_pressure_converges(shared_run):
    """The sphere, with 7 elements to the radius rather than 10: measured 1.8 % and -1.2 % rather than 0.9 % and -0.43 %."""
    coarse, fine = (read(shared_run(options)) for options in (COARSE_SPHERE, SPHERE))
    errors = [(np.abs(pressure_error(*each, 0.9)).max(), abs(fitted(*each)[0] - 1)) for each in (coarse, fine)]
    assert np.all(np.array(errors[0]) > 1.5 * np.array(errors[1]))


def contact_time(series):
    """In whole controller steps."""
    return np.count_nonzero(series["force"]) * series["time"][1]


def impact_errors(ball, series):
    """Of contact time and largest force."""
    mass, speed = series["momentum"][0] / series["velocity"][0], -series["velocity"][0]
    _, duration, force = ball.impact(mass, speed)
    return np.array((contact_time(series) / duration - 1, series["force"].max() / force - 1))


@pytest.mark.parametrize("options", [IMPACT, *long(f"{IMPACT} {EXPLICIT}")], ids=["implicit", "explicit"])
def test_impact(options, shared_run):
    """Contact time and largest force of the true ball, which the mesh weighs as much as, within 1.3 %: measured 0.95 % (a step is 0.65 %) and 0.94 %;
    with twice the elements -1.0 % and 1.2 %. The ball is no half-space, which makes it stiffer: on meshes that resolve it, the force is 0.5 a/R above
    theory, a/R being 0.032 here (measured 2.8 % at 0.3 m/s, 3.9 % at 1 m/s). Restitution 0.99995 implicit, 0.9999 explicit; contact once."""
    run = shared_run(options)
    ball, series = read(run)
    assert series["momentum"][0] / series["velocity"][0] == pytest.approx(4000 / 3 * np.pi * ball.radius**3, rel=1e-12)
    assert np.abs(impact_errors(ball, series)).max() <= 0.013
    assert run.summary["contact"]["onsets"] == 1
    assert series["force"][-1] == 0
    assert 0.9997 <= series["velocity"][-1] / -series["velocity"][0] <= 1
    assert run.summary["system"]["energy_error_max"] <= 4e-6  # measured: 2.9e-6, of rows that open inside a step
    transit = 2 * ball.radius / np.sqrt(1.3462e9 / 1000)  # wave speed from the modulus E (1 - nu) / (1 + nu) / (1 - 2 nu)
    assert contact_time(series) > 15 * transit


def test_impact_converges(shared_run):
    """With one element to the contact's radius rather than three, contact takes 6.1 % too long, and the force is 3.7 % too large."""
    coarse, fine = (np.abs(impact_errors(*read(shared_run(options)))) for options in (COARSE_IMPACT, IMPACT))
    assert np.all(coarse > 2 * fine)
    assert np.all(coarse < 0.1)


@pytest.mark.parametrize("options", [*long(COARSE_IMPACT), f"{CYLINDER} -time_step 0.5", *longest(COARSE_SPHERE)], ids=["impact", "cylinder", "sphere"])
def test_ranks(options, shared_run):
    """The same history on 2 and 3 ranks to 1e-7 of the largest number; gaps that are closed, to the round-off of positions of 1 m."""
    histories = [shared_run(options, ranks=ranks).history for ranks in (1, 2, 3)]

    def compare(name, one):
        if not isinstance(one, h5py.Dataset):
            return
        for other in histories[1:]:
            size = np.abs(one[()]).max()
            assert np.abs(one[()] - other[name][()]).max() <= 1e-7 * size + 1e-15, name

    histories[0].visititems(compare)


def test_figure(shared_run, launch, tmp_path):
    figure = tmp_path / "figure.png"
    histories = [shared_run(options).folder / "history.h5" for options in (CYLINDER, SPHERE, IMPACT)]
    command = [sys.executable, ROOT / "plots/hertz.py"]
    run = launch([*command, *histories, figure], env={**os.environ, "MPLBACKEND": "Agg"})
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    run = launch([*command, tmp_path / "nowhere.h5", figure])
    assert run.returncode > 0
    assert "nowhere.h5" in run.stderr
    assert "Traceback" not in run.stderr


def test_not_a_ball(shared_run, launch, tmp_path):
    """A run of boxes is told apart."""
    history = shared_run("-options_file options/blocks.opts -time_end 1e-6").folder / "history.h5"
    run = launch([sys.executable, ROOT / "plots/hertz.py", history, tmp_path / "figure.png"])
    assert run.returncode > 0
    assert "no disc or ball" in run.stderr
    assert not (tmp_path / "figure.png").exists()
