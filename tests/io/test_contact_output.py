"""What history, summary and fields say of contact between solids: bars that meet head on, whose pressure is uniform.

Poisson's ratio is 0 and the nodes match, so that all is as in one dimension. The cross-section is 0.01 m by 0.02 m, its middle off
the origin, so that the force has a moment about it.
"""

import meshio
import numpy as np
import pytest
import pyvista
from cases import long

TIMES = "-time_start -2e-4 -time_end 2e-4 -time_step 2e-6"
ACROSS = 0.01 * 0.02
CENTRE = np.array((0, 0.025, -0.02))
SHAPES = {
    "bar2": f"-{{b}}_dm_plex_dim 1 -{{b}}_dm_plex_box_faces 25 -{{b}}_dm_plex_box_lower {{low}} -{{b}}_dm_plex_box_upper {{high}} -{{b}}_cross_section {ACROSS} -{{b}}_initial_velocity {{v}}",
    "quad4": "-{b}_dm_plex_dim 2 -{b}_dm_plex_box_faces 25,2 -{b}_dm_plex_box_lower {low},0.02 -{b}_dm_plex_box_upper {high},0.03 -{b}_thickness 0.02 -{b}_initial_velocity {v},0",
    "hex8": "-{b}_dm_plex_dim 3 -{b}_dm_plex_box_faces 25,2,3 -{b}_dm_plex_box_lower {low},0.02,-0.03 -{b}_dm_plex_box_upper {high},0.03,-0.01 -{b}_initial_velocity {v},0,0",
}
NODES = {"bar2": 1, "quad4": 3, "hex8": 12}
BODIES = (("l", -0.27, -0.02, 100), ("r", 0.02, 0.27, -100))
PAIR = "l.xmax:r.xmin"


def options(shape):
    """A bar in one dimension has no moments of inertia to keep: so that solids have its masses, they keep their centre alone."""
    bodies = [SHAPES[shape].format(b=b, low=low, high=high, v=v) + f" -{b}_density 1000 -{b}_youngs_modulus 1e9 -{b}_mass_moments centre" for b, low, high, v in BODIES]
    return " ".join([f"-bodies l,r -contact_pairs {PAIR}", TIMES, *bodies])


def centre(shape):
    return CENTRE * {"bar2": (0, 0, 0), "quad4": (0, 1, 0), "hex8": (0, 1, 1)}[shape]


@pytest.fixture
def force(shared_run):
    """In one dimension."""
    return shared_run(options("bar2")).history["contact"][PAIR]["force"][()]


@pytest.mark.parametrize(("shape", "ranks"), [("bar2", 1), ("quad4", 3), ("hex8", 2), *long(("bar2", 2), ("hex8", 3))])
def test_contact_output(shape, ranks, force, impakt):
    run = impakt(f"{options(shape)} -output_fields fields.h5 -output_fields_precision double -output_fields_interval 40", ranks=ranks)
    check_history(run, shape, force)
    reader = pyvista.get_reader(run.folder / "fields.xdmf")
    with meshio.xdmf.TimeSeriesReader(run.folder / "fields.xdmf") as other:
        other.read_points_cells()
        for frame, time in enumerate(reader.time_values):
            reader.set_active_time_value(time)
            grid = reader.read()
            for name, values in other.read_data(frame)[1].items():
                np.testing.assert_array_equal(grid[name], values)  # not-a-numbers too
            check(grid, run.history["contact"][PAIR], 40 * frame, NODES[shape])
    assert frame == 5


def check_history(run, shape, force):
    """The force is one in one dimension, to what the outer iteration leaves: it stops at 1e-12 m of displacements of 1e-2 m."""
    pair, touching = run.history["contact"][PAIR], force > 0
    assert touching.sum() > 90  # from 0 s on
    np.testing.assert_array_equal(pair["active"][()], np.where(touching, NODES[shape], 0))
    np.testing.assert_allclose(pair["area"][()], np.where(touching, ACROSS, 0), rtol=1e-12)
    vector = np.outer(force, (1, 0, 0))  # on r
    scale = force.max()
    np.testing.assert_allclose(pair["force"][()], force, rtol=0, atol=1e-8 * scale)
    np.testing.assert_allclose(pair["force_vector"][()], vector, rtol=0, atol=1e-8 * scale)
    np.testing.assert_allclose(pair["moment"][()], np.cross(centre(shape), vector), rtol=0, atol=1e-8 * scale * np.abs(CENTRE).max())
    # what r has got is what its momentum has changed by: it weighs 0.05 kg
    momentum = run.history["body/r/momentum"][()].reshape(len(force), -1)
    gained = np.pad(momentum - momentum[0], ((0, 0), (0, 3 - momentum.shape[1])))
    np.testing.assert_allclose(pair["impulse"][()], gained, rtol=0, atol=1e-10 * 0.05 * 100)
    summary = run.summary["pairs"][PAIR]
    assert summary["impulse_vector"] == list(pair["impulse"][-1])
    assert summary["area_max"] == pair["area"][()].max()
    assert summary["active_max"] == NODES[shape]


def check(grid, pair, step, n):
    """On both faces the pressure is F / A at every node, the nodal forces sum up to F, and elsewhere there is nothing."""
    force, touching = pair["force"][step], pair["active"][step] > 0
    assert touching == (step > 100)
    faces = {body: np.abs(grid.points[:, 0] - x) < 1e-9 for body, x in (("l", -0.02), ("r", 0.02))}
    for body, sign in (("l", -1), ("r", 1)):
        face = faces[body]
        assert face.sum() == n
        # differences of the outer iteration again: F / A is 1e8 Pa
        np.testing.assert_allclose(grid["contact_pressure"][face], force / ACROSS, rtol=1e-8)
        np.testing.assert_allclose(grid["contact_force"][face].sum(axis=0), (sign * force, 0, 0), rtol=0, atol=1e-9 * max(1, force))
        np.testing.assert_allclose(grid["contact_gap"][face], pair["gap"][step], rtol=0, atol=1e-12)
        np.testing.assert_array_equal(grid["contact_active"][face], 1.0 * touching)
    elsewhere = ~(faces["l"] | faces["r"])
    assert not grid["contact_force"][elsewhere].any()
    assert not grid["contact_pressure"][elsewhere].any()
    assert not grid["contact_active"][elsewhere].any()
    assert np.isnan(grid["contact_gap"][elsewhere]).all()
