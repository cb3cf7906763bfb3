"""Distorted boxes of triangles, quadrilaterals, tetrahedra or hexahedra, as Gmsh files, for tests of solid bodies."""

import itertools

import meshio
import numpy as np

SHAPES = {"tri3": "triangle", "quad4": "quad", "tet4": "tetra", "hex8": "hexahedron", "tri6": "triangle6", "tet10": "tetra10"}
LINEAR = {"tri6": "tri3", "tet10": "tet4"}
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]  # VTK's order
# six tetrahedra about the diagonal from corner 0 to corner 6
SIXTHS = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
HALVES = [(0, 1, 2), (0, 2, 3)]


def dim_of(shape):
    return 3 if shape in ("tet4", "tet10", "hex8") else 2


def add_middles(points, cells):
    """Nodes in the middle of the edges of triangles or tetrahedra, and elements with these after their corners."""
    edges = EDGES[: 3 if cells.shape[1] == 3 else 6]
    pairs = np.sort(np.stack([cells[:, edge] for edge in edges], axis=1), axis=2)
    unique, at = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    middles = points[unique].mean(axis=1)
    return np.vstack([points, middles]), np.hstack([cells, len(points) + at.reshape(len(cells), -1)])


def box(shape, faces, size, distortion=0.0):
    """Points and elements. Inner nodes are moved along each axis by up to `distortion` of an element's edge, those on the boundary stay."""
    if shape in LINEAR:
        return add_middles(*box(LINEAR[shape], faces, size, distortion))
    dim = dim_of(shape)
    nodes = np.array(list(itertools.product(*(range(n + 1) for n in faces[::-1]))))[:, ::-1]  # x runs fastest
    edges = np.array(size[:dim]) / np.array(faces[:dim])
    inner = ((nodes > 0) & (nodes < np.array(faces))).all(axis=1)
    points = np.zeros((len(nodes), 3))
    random = np.random.default_rng(4).uniform(-1, 1, nodes.shape)  # a fixed seed: the same mesh each time
    points[:, :dim] = (nodes + distortion * inner[:, None] * random) * edges

    def node(*at):
        return sum(i * stride for i, stride in zip(at, np.cumprod([1, *(n + 1 for n in faces[:-1])])))

    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = [(*r, z) for z in (0, 1) for r in ring] if dim == 3 else ring
    cells = [[node(*(i + k for i, k in zip(at, corner))) for corner in corners] for at in itertools.product(*(range(n) for n in faces))]
    parts = {"tet4": SIXTHS, "tri3": HALVES}.get(shape)
    if parts:
        cells = [[cell[k] for k in part] for cell in cells for part in parts]
    return points, np.array(cells)


def write_box(path, shape, faces, size, distortion=0.0):
    """Gmsh 2.2; the surfaces are the sides of the bounding box, xmin to zmax."""
    points, cells = box(shape, faces, size, distortion)
    ones = np.ones(len(cells), int)
    mesh = meshio.Mesh(points, [(SHAPES[shape], cells)], cell_data={"gmsh:physical": [ones], "gmsh:geometrical": [ones]})
    meshio.write(path, mesh, file_format="gmsh22", binary=False)


def made_by_options(shape, name="b"):
    """Options for boxes of such elements: composite ones are cells of the linear ones, divided."""
    simplex = f"-{name}_dm_plex_simplex {str(shape[0] == 't').lower()}"
    return f"{simplex} -{name}_element_formulation composite" if shape in LINEAR else simplex


def sides(shape):
    return [f"{axis}{end}" for axis in "xyz"[: dim_of(shape)] for end in ("min", "max")]


def write_blocks(path, shape, faces, size, block_of, names, distortion=0.0):
    """Gmsh 2.2 with physical groups `names`; block_of(centre of a cell) is the place of its group there."""
    points, cells = box(shape, faces, size, distortion)
    tags = np.array([block_of(centre) + 1 for centre in points[cells].mean(axis=1)])
    groups = {name: np.array([k + 1, dim_of(shape)]) for k, name in enumerate(names)}
    data = {"gmsh:physical": [tags], "gmsh:geometrical": [tags]}
    mesh = meshio.Mesh(points, [(SHAPES[shape], cells)], cell_data=data, field_data=groups)
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return path
