"""Obstacles whose normal points the wrong way, and obstacles that nothing can touch."""

import pytest
from messages import check_message

BOX = "-bodies b -b_density 1000 -b_youngs_modulus 1e7 -b_dm_plex_dim 2 -b_dm_plex_box_faces 4,4 -b_initial_velocity 0,-1 -time_step 1e-4 -time_end 1e-3"
FLOOR = "-obstacles floor -floor_obstacle_type plane -floor_point 0,-0.01"
WALL = "-wall_obstacle_type plane -wall_point -1,0 -wall_normal 1,0"


def warnings(run):
    return [line for line in run.stderr.splitlines() if "warning" in line]


@pytest.mark.parametrize("pairs", ["auto", "b.ymin:floor"])
def test_wrong_normal(pairs, impakt):
    run = impakt(f"{BOX} {FLOOR} -floor_normal 0,-1 -contact_pairs {pairs}", expect_failure=True)
    assert run.returncode > 0
    check_message(run, ["floor", "-floor_normal may point the wrong way"])


def test_in_no_pair(impakt):
    """Told once; a floor whose normal is right is not told of."""
    (line,) = [line for line in warnings(impakt(f"{BOX} {FLOOR} -floor_normal 0,1 {WALL} -obstacles floor,wall -contact_pairs b:floor", 2)) if "no body can touch" in line]
    assert "'wall'" in line
    assert "in no pair" in line


@pytest.mark.parametrize("radius", [0.3, 3])
def test_body_about_a_sphere(radius, impakt):
    """One that lies in the body, or the body in it: no face looks at it, and there are no contact rows at all."""
    (line,) = warnings(impakt(f"{BOX} -obstacles ball -ball_obstacle_type sphere -ball_point 0.5,0.5 -ball_radius {radius}"))
    assert "'ball'" in line
    assert "no face" in line
