"""Elements of linear bodies that are inside out: a warning, once for the first body, and their number in the summary."""

import pytest
from cases import long

COMMON = "-bodies b -b_density 1000 -b_youngs_modulus 1e7 -b_poissons_ratio 0.3 -time_step 1e-4 -time_end 1e-3 -energy_guard 0"
# Boxes in [0, 1], of elements of 0.25 m, whose parts with x > 0.5 m fly into the others: edges along x become shorter by the speed times the time
BODIES = {
    "bar2": "-b_dm_plex_dim 1 -b_dm_plex_box_faces 4",
    "quad4": "-b_dm_plex_dim 2 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 4,4",
    "tri3": "-b_dm_plex_dim 2 -b_dm_plex_simplex 1 -b_dm_plex_box_faces 4,4",
    "hex8": "-b_dm_plex_dim 3 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 4,2,2",
    "tet4": "-b_dm_plex_dim 3 -b_dm_plex_simplex 1 -b_dm_plex_box_faces 4,2,2",
}


def warnings(run):
    return [line for line in run.stderr.splitlines() if "warning" in line and "inside out" in line]


def speed(value, shape):
    zeros = ",0" * (int(BODIES[shape].split()[1]) - 1)
    return f"-b_initial_velocity {value}*(1-2*(x>0.5)){zeros}"


@pytest.mark.parametrize(("shape", "ranks"), [*((shape, 1) for shape in BODIES), *long(("hex8", 2))])
def test_inverted(shape, ranks, impakt):
    run = impakt(f"{COMMON} {BODIES[shape]} {speed(400, shape)}", ranks)
    first, last = warnings(run)
    assert "body 'b' has" in first
    assert "around (0." in first
    assert "-b_material_type" in first
    assert "linear body 'b'" in last
    assert run.summary["bodies"]["b"]["inverted_max"] > 0
    assert any("inside out" in warning for warning in run.summary["warnings"])


@pytest.mark.parametrize("shape", ["quad4", "tet4"])
def test_nearly(shape, impakt):
    """Strains of up to 0.6, which no linear material knows, but nothing inside out; corners of elements are looked at all the same."""
    run = impakt(f"{COMMON} {BODIES[shape]} {speed(60, shape)}")
    assert not warnings(run)
    assert run.summary["bodies"]["b"]["inverted_max"] == 0
    assert run.summary["bodies"]["b"]["peak_potential"] > 0


def test_turned_by_any_angle(impakt):
    """A linear body that turns grows, and is not inside out even where it has turned by half a circle."""
    body = "-b_dm_plex_dim 2 -b_dm_plex_simplex 0 -b_dm_plex_box_faces 4,4 -b_initial_displacement -2*(y-0.5),2*(x-0.5)"
    run = impakt(f"{COMMON} {body}")
    assert not warnings(run)
