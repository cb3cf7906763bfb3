"""A block on the edge of another one, beyond which its centre of mass lies by 5 mm: it has to tip. Nodes of it that lie beyond the edge guard the corner there; where it has
the rows they hold it, and the run has to say so."""

import numpy as np
import pytest
from cases import long

BEYOND, HEIGHT, WIDTH, GRAVITY = 0.005, 0.05, 0.1, 9.81
END = 0.06


def case(pair, more):
    common = f"-dm_plex_dim 2 -density 1000 -youngs_modulus 1e8 -poissons_ratio 0.25 -gravity 0,-{GRAVITY} {more}"
    return (
        f"-bodies low,top -contact_pairs {pair} -time_step 5e-5 -time_end {END} "
        f"-prefix_push low_ {common} -dm_plex_box_lower -0.2,-0.1 -dm_plex_box_upper 0,0 -dm_plex_box_faces 8,4 -boundary_displacement ymin "
        f"-boundary_displacement_ymin 0,0 -prefix_pop "
        f"-prefix_push top_ {common} -dm_plex_box_lower {BEYOND - WIDTH / 2},0 -dm_plex_box_upper {BEYOND + WIDTH / 2},{HEIGHT} -dm_plex_box_faces 5,3 -prefix_pop"
    )


def tilt(run):
    """By its angular momentum about its own centre [rad]."""
    body, time = run.history["body/top"], run.history["time"][()]
    mass, momentum = run.summary["bodies"]["top"]["mass"]["total"], body["momentum"][()]
    way = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * (momentum[1:] + momentum[:-1]) * np.diff(time)[:, None] / mass, axis=0)])
    centre = way + [BEYOND, HEIGHT / 2]
    own = body["angular_momentum"][()].reshape(len(time), -1)[:, -1] - centre[:, 0] * momentum[:, 1] + centre[:, 1] * momentum[:, 0]
    rate = own / (mass * (WIDTH**2 + HEIGHT**2) / 12)
    return np.sum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))


def rigid():
    """A rigid block that slides and turns on the edge without friction: g = n . x - HEIGHT / 2 stays zero."""
    mass = np.array([1, 1, (WIDTH**2 + HEIGHT**2) / 12])
    x, v, steps = np.array([BEYOND, HEIGHT / 2, 0.0]), np.zeros(3), 6000
    for _ in range(steps):
        normal, turn = np.array([-np.sin(x[2]), np.cos(x[2])]), np.array([-np.cos(x[2]), -np.sin(x[2])])
        row = np.array([*normal, turn @ x[:2]])
        load = np.array([0, -GRAVITY, 0])
        rest = 2 * v[2] * (turn @ v[:2]) - v[2] ** 2 * (normal @ x[:2])
        force = max(0, -(row @ load + rest) / (row @ (row / mass)))
        v = v + END / steps * (load + row * force / mass)
        x = x + END / steps * v
    return x[2]


NEO_HOOKEAN = "-material_type neo_hookean"
EXPLICIT = "-ts_type centraldifference -ts_time_step auto"
FIRST, SECOND = "low.ymax:top.ymin", "top.ymin:low.ymax -contact_rows second"


@pytest.mark.parametrize(
    ("pair", "more", "within"), [(FIRST, f"{NEO_HOOKEAN} {EXPLICIT}", 0.16), *long((SECOND, NEO_HOOKEAN, 0.16), (FIRST, "-material_type linear_elastic", 0.2))]
)
def test_tips(pair, more, within, shared_run):
    """An elastic block tips by 0.088 to 0.089 and a linear one, which counts that as strain, by 0.091; a rigid one by 0.078, and one with ten times the modulus by
    0.082."""
    run = shared_run(case(pair, more))
    assert tilt(run) == pytest.approx(rigid(), rel=within)
    assert "beyond the end" not in run.stderr


def test_says_that_it_does_not(shared_run):
    run = shared_run(case("top.ymin:low.ymax", f"{NEO_HOOKEAN} {EXPLICIT}"))
    assert abs(tilt(run)) <= 0.01
    assert "nodes beyond the end of the partner bear" in run.stderr
    assert "top.ymin:low.ymax" in run.stderr and "set -contact_rows second" in run.stderr
