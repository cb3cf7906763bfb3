"""Writers of small mesh files for the tests: a row of unit cubes or squares along x, as Gmsh or Exodus II."""

import meshio
import netCDF4
import numpy as np

CUBES = 6


def row(shape):
    """Points, elements, and the faces at x = 0 and x = CUBES. `shape`: tetra, hexahedron, triangle or quad."""
    solid = shape in ("tetra", "hexahedron")
    section = [(0, 0), (1, 0), (1, 1), (0, 1)] if solid else [(0,), (1,)]
    points = np.array([(x, *at) for x in range(CUBES + 1) for at in section], dtype=float)
    step = len(section)
    corners = range(8) if solid else (0, 2, 3, 1)
    cells = np.array([[step * i + k for k in corners] for i in range(CUBES)])
    ends = np.array([list(range(step)), [step * CUBES + k for k in range(step)]])
    if shape == "tetra":  # Freudenthal's division about the diagonal from corner 0 to corner 6
        parts = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
        cells = np.vstack([cell[list(part)] for cell in cells for part in parts])
        ends = np.vstack([end[[0, k, k + 1]] for end in ends for k in (1, 2)])
    if shape == "triangle":
        cells = np.vstack([cell[list(part)] for cell in cells for part in ((0, 1, 2), (0, 2, 3))])
    if not solid:
        points = np.column_stack([points, np.zeros(len(points))])
    return points, cells, ends


def write_gmsh(path, shape, version="4.1", binary=False):
    """By meshio; physical groups "left" (7), "right" (8) and "all" (1)."""
    points, cells, ends = row(shape)
    side = {"tetra": "triangle", "hexahedron": "quad"}.get(shape, "line")
    dim = 3 if shape in ("tetra", "hexahedron") else 2
    half = len(ends) // 2
    tags = [np.repeat([7, 8], half), np.ones(len(cells), int)]
    mesh = meshio.Mesh(points, [(side, ends), (shape, cells)])
    mesh.field_data = {"left": np.array([7, dim - 1]), "right": np.array([8, dim - 1]), "all": np.array([1, dim])}
    if version == "2.2":
        mesh.cell_data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        meshio.write(path, mesh, file_format="gmsh22", binary=binary)
        return
    # version 4.1 keeps groups with geometrical entities: one block of elements for each
    blocks = [(side, ends[:half]), (side, ends[half:]), (shape, cells)]
    mesh = meshio.Mesh(points, blocks, field_data=mesh.field_data)
    mesh.cell_data["gmsh:physical"] = [np.full(half, 7), np.full(half, 8), np.ones(len(cells), int)]
    mesh.cell_data["gmsh:geometrical"] = [np.full(half, 1), np.full(half, 2), np.ones(len(cells), int)]
    entity = np.tile([dim, 1], (len(points), 1))
    entity[points[:, 0] == 0] = [dim - 1, 1]
    entity[points[:, 0] == CUBES] = [dim - 1, 2]
    mesh.point_data["gmsh:dim_tags"] = entity
    meshio.write(path, mesh, file_format="gmsh", binary=binary)


def write_exodus(path, container="NETCDF3_64BIT_OFFSET", elem_type="HEX8", cells=None):
    """Hexahedra in a block "all" (1), side sets "left" (7) and "right" (8), node set "corner" (3) of the first node."""
    points, sound, _ = row("hexahedron")
    cells = sound if cells is None else cells
    with netCDF4.Dataset(path, "w", format=container) as file:
        sizes = {"num_dim": 3, "num_nodes": len(points), "num_elem": len(cells), "num_el_blk": 1, "num_side_sets": 2, "num_node_sets": 1}
        sizes |= {"num_el_in_blk1": len(cells), "num_nod_per_el1": cells.shape[1], "num_side_ss1": 1, "num_side_ss2": 1, "num_nod_ns1": 1, "len_name": 33}
        for name, size in sizes.items():
            file.createDimension(name, size)

        def put(name, dimensions, values, kind="i4"):
            variable = file.createVariable(name, kind, dimensions)
            variable[:] = values
            return variable

        for axis, name in enumerate(("coordx", "coordy", "coordz")):
            put(name, ("num_nodes",), points[:, axis], "f8")
        put("eb_prop1", ("num_el_blk",), [1])
        put("ss_prop1", ("num_side_sets",), [7, 8])
        put("ns_prop1", ("num_node_sets",), [3])
        for kind, dimension, names in (("eb", "num_el_blk", ["all"]), ("ss", "num_side_sets", ["left", "right"]), ("ns", "num_node_sets", ["corner"])):
            put(f"{kind}_names", (dimension, "len_name"), netCDF4.stringtochar(np.array(names, "S33")), "S1")
        put("connect1", ("num_el_in_blk1", "num_nod_per_el1"), cells + 1).elem_type = elem_type
        for number, (element, side) in enumerate(((1, 5), (len(cells), 6)), 1):
            put(f"elem_ss{number}", (f"num_side_ss{number}",), [element])
            put(f"side_ss{number}", (f"num_side_ss{number}",), [side])
        put("node_ns1", ("num_nod_ns1",), [1])
