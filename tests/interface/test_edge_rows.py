"""Rows of nodes at an edge, whose dual functions see nodes of the partner's edge alone, and of nodes at a corner, which look at what lies far beside them."""

import pytest
from cases import joined, long
from setups import box, material

LOWER, UPPER = (f"-{body}_ts_type centraldifference" for body in ("lower", "upper"))
N = 14


def plates(more):
    """Two plates, pressed together by 10^-3 of their modulus, of which the upper one is pushed from one end and slides without friction."""
    h = 1 / N
    step = 0.3 * h
    return joined(
        box("lower", (N - 2, N - 2, 3), (0, 0, -3 * h), (1, 1, 0), "-lower_initial_displacement 0,0,-1e-3*z -lower_boundary_traction zmin -lower_boundary_traction_zmin 0,0,1e-3"),
        box("upper", (N, N, 3), (0, 0, 0), (1, 1, 3 * h), "-upper_initial_displacement 0,0,-1e-3*z -upper_boundary_traction zmax,xmin -upper_boundary_traction_zmax 0,0,-1e-3"),
        f"-upper_boundary_traction_xmin {7.5e-4 / (3 * h)}*min(1,t/{10 * step}),0,0",
        material("lower", nu=0.3),
        material("upper", nu=0.3),
        f"-bodies lower,upper -contact_pairs upper.zmin:lower.zmax -time_step {step} -time_end {100 * step}",
        more,
    )


@pytest.mark.parametrize("integrators", [UPPER, *long(f"{LOWER} {UPPER}")])
def test_plates_slide_without_loss(integrators, shared_run):
    """The edges bulge by 1.5 % of an element while the partner's edge stays straight to 10^-5 of its length. Weights of up to 1000 at these nodes that made up for
    that cost 2.4 % (IE) and 1.0 % (EE) of the energy; 0.03 % and 0.07 % are left, of nodes that come to lie beside the partner."""
    run = shared_run(plates(integrators))
    assert -1.5e-3 < run.summary["system"]["energy_error_min"]
    assert run.summary["system"]["energy_error_max"] < 2e-4
    assert run.summary["schwarz"]["max"] <= 6


@pytest.mark.parametrize(("along", "turn"), [(0, 1e-10), (30, 3e-5)])  # measured: 7e-16, 1.0e-5, and 8.5e-8 in a fifth of the step
def test_plates_meet_without_loss(along, turn, impakt):
    """Edges of plates that meet bulge by 10⁻³ of an element, the finer one's by 2 % less. Weights of edge nodes alone that made up for that cost 11 % of the energy as the
    edges began to bend, and those that did not 1e-3 of the angular momentum of plates that slide, without a word."""
    run = joined(
        box("a", (12, 12, 2), (0, 0, 0), (0.1, 0.1, 0.01), f"-a_initial_velocity {along},0,10"),
        box("b", (9, 9, 2), (0, 0, 0.01), (0.1, 0.1, 0.02), "-b_initial_velocity 0,0,-10"),
        *(f"{material(name, 2e9, 0.3, 1000)} -{name}_material_type neo_hookean -{name}_ts_type centraldifference" for name in "ab"),
        "-bodies a,b -contact_pairs a.zmax:b.zmin -time_step 5e-7 -time_end 1e-5 -all_mass_redistribute true",
    )
    found = impakt(run)
    assert max(abs(found.summary["system"][f"energy_error_{end}"]) for end in ("min", "max")) <= 1e-4  # measured: 1.4e-5
    assert found.summary["system"]["angular_momentum_error_max"] <= turn
    assert found.summary["schwarz"]["max"] <= 6  # measured: 4


SQUARE = "-a_dm_plex_dim 2 -a_dm_plex_box_faces 3,3 -a_dm_plex_box_lower -0.07,-0.07 -a_dm_plex_box_upper 0.07,0.07 -a_rotate 64.04"
DISC = "-b_dm_plex_dim 2 -b_dm_plex_shape ball -b_ball_radius 0.1 -b_ball_divisions 4 -b_ball_keep_volume false -b_ball_centre 0.6728,-0.356"


def test_square_and_disc(impakt):
    """Far from each other, they do not move and do not touch. The normal of a node at a corner is half way between those of its two faces: what lies before one of them far
    away lies far beside that normal, and weights that continue the partner as a line to where the normal meets it have been 50, with a gap of -0.3 m at a distance of 0.55 m."""
    bodies = " ".join(f"{material(name, e=1e8, rho=1000)} -{name}_ts_type centraldifference" for name in "ab")
    run = impakt(f"-bodies a,b -contact_pairs a:b -contact_facing false {SQUARE} {DISC} {bodies} -time_step 2e-4 -time_end 2e-3")
    assert not run.history["contact/a:b/active"][()].any()
    assert run.history["contact/a:b/gap"][()].min() > 0.3  # of planes through faces that look at each other; the nearest nodes are 0.58 m apart
    assert all(not run.history[f"body/{name}/kinetic"][()].any() for name in "ab")
