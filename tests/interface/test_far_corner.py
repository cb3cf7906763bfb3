"""Bodies that are far from each other and do not move do not touch, whatever their corners look at.

The normal of a node at a corner is half way between those of its two faces. What lies before one of them far away lies far beside that normal, and
weights that continue the partner as a line to where the normal meets it have been 50, with a gap of -0.3 m where surfaces are 0.55 m apart.
"""

import pytest
from setups import material

SQUARE = "-a_dm_plex_dim 2 -a_dm_plex_box_faces 3,3 -a_dm_plex_box_lower -0.07,-0.07 -a_dm_plex_box_upper 0.07,0.07 -a_rotate 64.04"
DISC = "-b_dm_plex_dim 2 -b_dm_plex_shape ball -b_ball_radius 0.1 -b_ball_divisions 4 -b_ball_keep_volume false"
BODIES = " ".join(f"{material(name, e=1e8, rho=1000)} -{name}_ts_type centraldifference" for name in "ab")


@pytest.mark.parametrize("ranks", [1, 2])
def test_square_and_disc(impakt, ranks):
    run = impakt(f"-bodies a,b -contact_pairs a:b -contact_facing false {SQUARE} {DISC} {BODIES} -b_ball_centre 0.6728,-0.356 -time_step 2e-4 -time_end 2e-3", ranks)
    assert not run.history["contact/a:b/active"][()].any()
    assert run.history["contact/a:b/gap"][()].min() > 0.3  # of planes through faces that look at each other; the nearest nodes are 0.58 m apart
    assert all(not run.history[f"body/{name}/kinetic"][()].any() for name in "ab")
