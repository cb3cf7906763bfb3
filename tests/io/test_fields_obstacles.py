"""Surfaces of the obstacles beside the fields: on the obstacles by their formulas, around the bodies, and read by libraries of others."""

import h5py
import numpy as np
import pytest
import pyvista

RUN = "-time_step 1e-6 -time_end 1e-6 -output_fields f.h5"
BODY = "-bodies b -b_density 1000 -b_youngs_modulus 1e9 -b_dm_plex_simplex 0"
SOLID = f"{BODY} -b_dm_plex_dim 3 -b_dm_plex_box_lower 1,2,3 -b_dm_plex_box_upper 2,4,5 -b_dm_plex_box_faces 2,3,3 {RUN}"  # its box: centre 1.5,3,4, diagonal 3
SHEET = f"{BODY} -b_dm_plex_dim 2 -b_dm_plex_box_lower 1,2 -b_dm_plex_box_upper 4,6 -b_dm_plex_box_faces 3,3 {RUN}"  # centre 2.5,4, diagonal 5
ROUND = {"ball": ("sphere", (1.5, 3, -2), (0, 0, 0), 1.5), "roll": ("cylinder", (9, 0, 4), (3, 4, 0), 2)}
OF_SOLID = {"floor": ("plane", (0, 0, 1), (0.6, 0, 0.8), 0), **ROUND}
OF_SHEET = {
    "wall": ("plane", (0, -3, 0), (-0.6, 0.8, 0), 0),
    "ball": ("sphere", (8, 1, 0.5), (0, 0, 0), 1.5),
    "disc": ("cylinder", (2, -1, 5), (0, 0, 1), 2),
    "skew": ("cylinder", (2, -2, 1), (0.6, 0, 0.8), 1),
    "shaft": ("cylinder", (-3, 0, 0), (0, 1, 0), 2),
}


def options(obstacles):
    words = [f"-obstacles {','.join(obstacles)} -contact_pairs {','.join(f'b:{name}' for name in obstacles)} -contact_facing false"]
    for name, (kind, point, direction, radius) in obstacles.items():
        words.append(f"-{name}_obstacle_type {kind} -{name}_point {','.join(map(str, point))}")
        if kind != "sphere":
            words.append(f"-{name}_{'normal' if kind == 'plane' else 'axis'} {','.join(map(str, direction))}")
        if kind != "plane":
            words.append(f"-{name}_radius {radius}")
    return " ".join(words)


def distance(x, kind, point, direction, radius):
    """Of points from a surface, by its formula."""
    unit = np.array(direction) / max(np.linalg.norm(direction), 1e-300)
    from_point = x - point
    along = from_point @ unit
    return along if kind == "plane" else np.linalg.norm(from_point - along[:, None] * unit, axis=1) - radius


def surfaces(run):
    with h5py.File(run.folder / "f.h5") as file:
        assert all(item["points"].attrs["units"] == b"m" for item in file["mesh/obstacles"].values())
        return {name: (item["points"][()], item["cells"][()]) for name, item in file["mesh/obstacles"].items()}


@pytest.mark.parametrize(("space", "obstacles"), [(SOLID, OF_SOLID), (SHEET, OF_SHEET)], ids=["solid", "sheet"])
def test_surfaces(space, obstacles, impakt):
    centre, diagonal = ((1.5, 3, 4), 3) if space == SOLID else ((2.5, 4, 0), 5)
    run = impakt(f"{space} {options(obstacles)}")
    found = surfaces(run)
    assert set(found) == set(obstacles)
    for name, (x, cells) in found.items():
        kind, point, direction, _ = obstacles[name]
        np.testing.assert_allclose(distance(x, *obstacles[name]), 0, atol=1e-13)  # rounding of coordinates up to 10
        assert np.array_equal(np.unique(cells), np.arange(len(x)))  # each point is in a cell
        corners = x[cells]
        if space == SHEET:
            assert not x[:, 2].any()
            assert cells.shape[1] == 2
        else:  # quadrilaterals have the normal of the obstacle: halfway between their corners it is close
            normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
            away = corners.mean(axis=1) + 1e-3 * normals
            assert (distance(away, *obstacles[name]) > distance(corners.mean(axis=1), *obstacles[name])).all()
        if kind == "plane":  # a patch of 1.5 diagonals about the foot of the centre
            foot = np.array(centre) - (np.array(centre) - point) @ np.array(direction) * np.array(direction)
            np.testing.assert_allclose(x.mean(axis=0), foot, atol=1e-13)
            np.testing.assert_allclose(np.linalg.norm(x - foot, axis=1).max(), 0.75 * diagonal * (1 if space == SHEET else np.sqrt(2)), rtol=1e-13)
        elif kind == "cylinder" and not direction[2]:  # as long, beside the centre
            along = (x - centre) @ np.array(direction) / np.linalg.norm(direction)
            np.testing.assert_allclose((along.min(), along.max()), (-0.75 * diagonal, 0.75 * diagonal), rtol=1e-13)
    ball = found["ball"][0] - obstacles["ball"][1]
    least = np.sqrt(1.5**2 - (0.5**2 if space == SHEET else 0))  # the sheet cuts it 0.5 m from its centre
    np.testing.assert_allclose([ball[:, :2].min(), ball[:, :2].max()], [-least, least], rtol=1e-13)
    blocks = pyvista.get_reader(run.folder / "f-obstacles.xdmf").read()  # VTK's: what ParaView shows
    assert set(obstacles) <= set(blocks.keys())
    for name, (x, cells) in found.items():
        np.testing.assert_array_equal(blocks[name].points, x)
        assert blocks[name].n_cells == len(cells)
    assert isinstance(pyvista.get_reader(run.folder / "f.xdmf").read(), pyvista.UnstructuredGrid)  # of the bodies, as without obstacles


def test_ranks(impakt):
    """The same bits on one rank and on three, with a body that is not where its mesh is."""
    moved = f"{SOLID} {options(OF_SOLID)} -b_initial_displacement 0.1*x,0,0.5"
    one, three = (surfaces(impakt(moved, ranks)) for ranks in (1, 3))
    for name in OF_SOLID:
        for mine, other in zip(one[name], three[name], strict=True):
            np.testing.assert_array_equal(mine, other)
    foot = np.array((1.65, 3, 4.5)) - (0.6 * 1.65 + 0.8 * 3.5) * np.array((0.6, 0, 0.8))
    np.testing.assert_allclose(one["floor"][0].mean(axis=0), foot, atol=1e-13)


def test_without(impakt):
    run = impakt(SOLID)
    assert not list(run.folder.glob("*obstacles*"))
    with h5py.File(run.folder / "f.h5") as file:
        assert "obstacles" not in file["mesh"]
