"""Bodies whose linear material turns far: a warning, once for the first body, and the angle in the summary."""

import pytest
from cases import long

# Boxes of 1 x 0.5 (x 0.5) m off the origin, which spin about their centres by 2 rad/s about an axis
COMMON = "-bodies b -b_density 1000 -b_youngs_modulus 1e7 -b_poissons_ratio 0.3 -time_step 1e-3"
PLANE = "-b_dm_plex_dim 2 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 4,2 -b_dm_plex_box_lower 3,4 -b_dm_plex_box_upper 4,4.5 -b_initial_velocity 5-2*(y-4.25),2*(x-3.5)"
SPACE = (
    "-b_dm_plex_dim 3 -b_dm_plex_simplex 1 -b_dm_plex_box_faces 4,2,2 -b_dm_plex_box_lower 3,4,5 -b_dm_plex_box_upper 4,4.5,5.5 "
    "-b_initial_velocity 5+1.2*(z-5.25),-1.6*(z-5.25),1.6*(y-4.25)-1.2*(x-3.5)"  # about (1.6, 1.2, 0) rad/s
)


def warnings(run):
    return [line for line in run.stderr.splitlines() if "warning" in line]


@pytest.mark.parametrize(("body", "ranks"), [(PLANE, 1), (SPACE, 1), *long((SPACE, 2))])
def test_far(impakt, body, ranks):
    """After 0.04 s a linear body has turned by 0.08 rad. The linear body stretches as it turns, and follows a rotation by a growing error: measured
    0.08 to 5e-3 of it."""
    run = impakt(f"{COMMON} {body} -time_end 0.04", ranks)
    line, verdict = warnings(run)  # when it happens, and at the end
    assert "'b'" in line and "'b' has turned by 0.08" in verdict
    assert verdict.endswith(run.summary["warnings"][0])
    assert "0.025 s" in line or "0.026 s" in line
    assert "saint_venant_kirchhoff" in line
    assert run.summary["bodies"]["b"]["rotation_max"] == pytest.approx(0.08, rel=0.02)


def test_many(impakt):
    """Of six bodies the first is named as it turns, three at the end, and the others are counted: sentences on many bodies once took the room of all
    that follow them."""
    names = [f"b{i}" for i in range(6)]
    bodies = " ".join(
        f"-{name}_density 1000 -{name}_youngs_modulus 1e7 -{name}_poissons_ratio 0.3 {PLANE.replace('-b_', f'-{name}_')} -{name}_translate {3 * i},0"
        f" -{name}_initial_velocity -2*(y-4.25),2*(x-{3.5 + 3 * i})"
        for i, name in enumerate(names)
    )
    run = impakt(f"-bodies {','.join(names)} -contact_pairs none {bodies} -time_step 1e-3 -time_end 0.04", 2)
    told = [line for line in warnings(run) if "counts rotations as strains" in line]
    assert len(told) == 1
    verdict = run.summary["warnings"]
    assert sum("set a nonlinear" in line for line in verdict) == 3
    assert verdict[-1] == "as above, there are 3 more linear bodies that turned too far"


def test_not_far(impakt):
    run = impakt(f"{COMMON} {PLANE} -time_end 0.02")
    assert not warnings(run)
    assert run.summary["bodies"]["b"]["rotation_max"] == pytest.approx(0.04, rel=0.01)


def test_nonlinear(impakt):
    """A nonlinear material may turn as far as it likes."""
    run = impakt(f"{COMMON} {PLANE} -b_material_type neo_hookean -time_end 0.04")
    assert not warnings(run)
    assert run.summary["bodies"]["b"]["rotation_max"] == 0


def test_vibration(impakt):
    """A body that bends to and fro, free of rotation, has turned by nothing, though its ends have."""
    run = impakt(
        f"{COMMON} -b_dm_plex_dim 2 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 40,4 -b_dm_plex_box_lower -1,0 -b_dm_plex_box_upper 1,0.1 "
        "-b_initial_velocity 0,3*(x^2-1/3) -time_end 0.04"
    )
    assert not warnings(run)
    assert run.summary["bodies"]["b"]["rotation_max"] <= 1e-10


def test_spin_has_no_momentum(impakt):
    """The momentum of a block that spins about its centre is round-off of its parts, and no change of that is an error."""
    run = impakt(
        "-bodies b -b_dm_plex_dim 2 -b_dm_plex_box_faces 4,4 -b_density 1000 -b_youngs_modulus 1e7 -b_poissons_ratio 0.3 -b_material_type neo_hookean "
        "-b_initial_velocity -10*(y-0.5),10*(x-0.5) -time_step 0.01 -time_end 0.5"
    )
    assert run.summary["system"]["momentum_error_max"] <= 1e-10
    assert not any("the momentum error" in text for text in run.summary["warnings"])
