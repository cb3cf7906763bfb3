"""Meshes of bodies with hollows, as Gmsh files: grids with holes, rings and tubes, gears."""

import itertools

import meshio
import numpy as np

SHAPES = {2: "quad", 3: "hexahedron"}
CORNERS = {2: [(0, 0), (1, 0), (1, 1), (0, 1)], 3: [(*at, z) for z in (0, 1) for at in ((0, 0), (1, 0), (1, 1), (0, 1))]}


def write(path, points, cells):
    used, cells = np.unique(cells, return_inverse=True)
    points = np.pad(points[used], ((0, 0), (0, 3 - points.shape[1])))
    cells = cells.reshape(-1, 4 if points[:, 2].max() == points[:, 2].min() else 8)
    ones = np.ones(len(cells), int)
    meshio.write(path, meshio.Mesh(points, [(SHAPES[2 if cells.shape[1] == 4 else 3], cells)], cell_data={"gmsh:physical": [ones], "gmsh:geometrical": [ones]}), file_format="gmsh22", binary=False)
    return path


def bricks(path, solid, positions):
    """Rectangles or bricks between these positions along each axis, where `solid` is true."""
    solid = np.array(solid, bool)
    number = np.arange(np.prod(np.array(solid.shape) + 1)).reshape(np.array(solid.shape) + 1)
    points = np.array(list(itertools.product(*positions)))
    return write(path, points, np.array([[number[tuple(at + np.array(corner))] for corner in CORNERS[solid.ndim]] for at in np.argwhere(solid)]))


def grid(path, solid, edge, origin):
    """Squares or cubes of one edge where `solid` is true."""
    return bricks(path, solid, [start + edge * np.arange(n + 1) for start, n in zip(np.broadcast_to(origin, np.ndim(solid)), np.shape(solid), strict=True)])


def ring(path, inner, outer, faces, layers, height=None):
    """About the z axis: `faces` round, `layers` through its thickness, between two radii that may be functions of the angle. `height`: a tube of that, with cubes about as high as wide."""
    angle, part = np.meshgrid(2 * np.pi * np.arange(faces) / faces, np.arange(layers + 1) / layers, indexing="ij")
    radius = (1 - part) * (inner(angle) if callable(inner) else inner) + part * (outer(angle) if callable(outer) else outer)
    flat = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 2)

    def node(i, j):
        return (i % faces) * (layers + 1) + j

    quads = np.array([[node(i, j), node(i, j + 1), node(i + 1, j + 1), node(i + 1, j)] for i in range(faces) for j in range(layers)])
    if height is None:
        return write(path, flat, quads)
    levels = round(height * faces / (2 * np.pi * inner))
    points = np.vstack([np.column_stack([flat, np.full(len(flat), height * k / levels)]) for k in range(levels + 1)])
    return write(path, points, np.vstack([np.hstack([quads + k * len(flat), quads + (k + 1) * len(flat)]) for k in range(levels)]))
