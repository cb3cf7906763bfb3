"""-<body>_probe: points of a body in the history, anywhere in it."""

import re

import numpy as np
import pytest
from cases import long

# Gradient of the displacement at the start, and of the velocity
H = np.array([[1e-3, 2e-4, -3e-4], [4e-4, -5e-4, 6e-4], [0, 7e-4, 2e-4]])
SPEED = np.array([[1, 2, 0], [-1, 0.5, 0.3], [0.2, 0, -0.7]])
E, NU = 1e9, 0.3
LAMBDA, MU = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
BOXES = {
    "bar": (1, "-b_dm_plex_dim 1 -b_dm_plex_box_faces 7"),
    "tri3": (2, "-b_dm_plex_dim 2 -b_dm_plex_simplex 1 -b_dm_plex_box_faces 4,3"),
    "quad4": (2, "-b_dm_plex_dim 2 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 4,3"),
    "tet4": (3, "-b_dm_plex_dim 3 -b_dm_plex_simplex 1 -b_dm_plex_box_faces 3,2,2"),
    "tri6": (2, "-b_dm_plex_dim 2 -b_dm_plex_simplex 1 -b_dm_plex_box_faces 4,3 -b_element_formulation composite"),
    "tet10": (3, "-b_dm_plex_dim 3 -b_dm_plex_simplex 1 -b_dm_plex_box_faces 3,2,2 -b_element_formulation composite"),
    "hex8": (3, "-b_dm_plex_dim 3 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 3,2,2"),
    "disc": (2, "-b_dm_plex_dim 2 -b_dm_plex_shape ball -b_ball_divisions 4 -b_ball_centre 0.5,0.5"),
    "ball": (3, "-b_dm_plex_dim 3 -b_dm_plex_shape ball -b_ball_divisions 2 -b_ball_centre 0.5,0.5,0.5"),
}
# Inside of elements, on edges and faces between them, a corner and the middle
POINTS = np.array([[0.123, 0.456, 0.789], [0.5, 0.25, 0.3], [0.25, 0.6, 0.5], [0, 0, 0], [0.5, 0.5, 0.5], [0.999999, 0.7, 0.1]])


def formula(gradient, dim):
    return ",".join("+".join(f"({gradient[i, j]!r})*{x}" for j, x in enumerate("xyz"[:dim])) for i in range(dim)).replace("np.float64", "")


def body(kind):
    dim, mesh = BOXES[kind]
    nu = 0 if dim == 1 else NU
    return dim, f"-bodies b {mesh} -b_density 1000 -b_youngs_modulus {E} -b_poissons_ratio {nu} -time_step 1e-6 -time_end 1e-6"


def option(points):
    return "-b_probe " + ";".join(",".join(f"{x:.17g}" for x in point) for point in points)


@pytest.mark.parametrize(("kind", "ranks"), [*((kind, 1) for kind in BOXES), ("quad4", 3), *long(("tet10", 3))])
def test_linear_field(kind, ranks, impakt):
    """Shape functions carry a linear field exactly, wherever the point lies in the elements, on whatever ranks: to round-off of positions of 1 m."""
    dim, options = body(kind)
    points = POINTS[:, :dim]
    if kind in ("disc", "ball"):
        points = 0.3 + 0.4 * points  # inside of the round mesh
    gradient, speed = H[:dim, :dim], SPEED[:dim, :dim]
    run = impakt(f"{options} {option(points)} -b_initial_displacement {formula(gradient, dim)} -b_initial_velocity {formula(speed, dim)}", ranks=ranks)
    for k, point in enumerate(points):
        probe = run.history[f"body/b/probe/{k}"]
        start = {name: probe[name][0].ravel() for name in probe}
        np.testing.assert_allclose(start["displacement"], gradient @ point, atol=1e-15)
        np.testing.assert_allclose(start["position"], point + gradient @ point, rtol=1e-14, atol=1e-15)
        np.testing.assert_allclose(start["velocity"], speed @ point, rtol=1e-13, atol=1e-13)
        strain = np.zeros((3, 3))
        strain[:dim, :dim] = (gradient + gradient.T) / 2
        stress = LAMBDA * np.trace(strain) * np.eye(3) + 2 * MU * strain if dim > 1 else np.diag([E * strain[0, 0], 0, 0])
        expected = [stress[0, 0], stress[1, 1], stress[2, 2], stress[0, 1], stress[1, 2], stress[0, 2]]
        np.testing.assert_allclose(start["stress"], expected, atol=1e-11 * E)
    assert f"body/b/probe/{len(points)}" not in run.history
    assert run.history["body/b/probe/0/stress"].attrs["units"] == "Pa"
    assert len(run.history["body/b/probe/0/velocity"]) == len(run.history["time"])


def test_nodes_of_two_elements(impakt):
    """Where elements meet the stress is their mean: of a bar with a strain of 1e-3 in one half and 3e-3 in the other, the same on any ranks."""
    _, options = body("bar")
    for ranks in (1, 3):
        run = impakt(f"{options.replace('faces 7', 'faces 8')} -b_probe 0.5;0.51;0.49 -b_initial_displacement 1e-3*x+2e-3*max(0,x-0.5)", ranks=ranks)
        stress = [run.history[f"body/b/probe/{k}/stress"][0, 0] for k in range(3)]
        np.testing.assert_allclose(stress, [2e6, 3e6, 1e6], rtol=1e-11)


def test_points_move_with_the_body(impakt):
    """Free fall, and a displaced mesh: points are those of the placed body."""
    _, options = body("quad4")
    run = impakt(f"{options} -b_translate 3,4 -b_probe 3.5,4.5 -b_gravity 0,-10 -b_initial_velocity 2,0 -time_step 1e-3 -time_end 0.1")
    probe, t = run.history["body/b/probe/0"], run.history["time"][:]
    np.testing.assert_allclose(probe["position"][:], np.stack([3.5 + 2 * t, 4.5 - 5 * t**2], axis=1), rtol=1e-12)
    np.testing.assert_allclose(probe["velocity"][:], np.stack([2 + 0 * t, -10 * t], axis=1), atol=1e-11)


@pytest.mark.parametrize(
    "kind, value, words",
    [
        ("quad4", "0.5,0.5;1.25,0.5", r"-b_probe.*\(1.25, 0.5, 0\.?\) m lies outside.*about 0.25 m"),
        ("hex8", "0.5,0.5,-1e-3", r"-b_probe.*outside.*about 0.001 m"),
        ("tet4", "2,1,1", r"-b_probe.*outside.*about 1 m"),
        ("bar", "-0.5", r"-b_probe.*outside.*about 0.5 m"),
        ("disc", "1.6,0.5", r"-b_probe.*outside.*about 0.\d+ m"),
        ("quad4", "0.5", r"-b_probe"),
        ("quad4", "0.5,x", r"-b_probe.*numbers"),
        ("quad4", "0.5,0.5;", r"-b_probe.*empty"),
    ],
)
def test_bad_points(kind, value, words, impakt):
    run = impakt([*body(kind)[1].split(), "-b_probe", value], ranks=2 if kind == "tet4" else 1, expect_failure=True)
    assert re.search(words, run.stderr), run.stderr
