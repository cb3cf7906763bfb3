"""Meshes of six-node triangles and ten-node tetrahedra, as Gmsh and Exodus II files with a block, surfaces and a node set."""

import meshio
import netCDF4
import numpy as np
import solidmeshes

SIZE = (0.5, 0.3, 0.2)
FACES = {"tri6": (4, 2), "tet10": (3, 2, 2)}
# corners of the sides of elements, and the edges with their middles, as Exodus II numbers sides
SIDES = {"tri6": [(0, 1), (1, 2), (2, 0)], "tet10": [(0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)]}


def mesh(shape):
    """Inner nodes off the middle of their edges by up to a tenth of these; elements and their sides at x = 0; and the nodes there."""
    points, cells = solidmeshes.box(shape, FACES[shape], SIZE)
    dim = solidmeshes.dim_of(shape)
    size = np.array(SIZE[:dim])
    inner = ((points[:, :dim] > 1e-9) & (points[:, :dim] < size - 1e-9)).all(axis=1)
    middles = np.zeros(len(points), bool)
    middles[cells[:, dim + 1 :]] = True
    moves = np.random.default_rng(1).uniform(-0.1, 0.1, (len(points), dim)) * size / FACES[shape]
    points[:, :dim] += moves * (inner & middles)[:, None] / 2
    left = [(e, s) for e, cell in enumerate(cells) for s, side in enumerate(SIDES[shape]) if (points[cell[list(side)], 0] == 0).all()]
    return points, cells, left, np.flatnonzero(points[:, 0] == 0)


def face(shape, cell, side):
    """Nodes of a side, those in the middle last."""
    corners, dim = SIDES[shape][side], solidmeshes.dim_of(shape)
    edges = solidmeshes.EDGES[: 3 if shape == "tri6" else 6]
    pairs = [(corners[i], corners[(i + 1) % len(corners)]) for i in range(len(corners) if len(corners) > 2 else 1)]
    return [cell[c] for c in corners] + [cell[dim + 1 + edges.index(tuple(sorted(pair)))] for pair in pairs]


def write_gmsh(path, shape, binary=False):
    """Version 2.2, "left" (7) of lines of three or triangles of six nodes, "all" (1)."""
    points, cells, left, _ = mesh(shape)
    dim = solidmeshes.dim_of(shape)
    faces = np.array([face(shape, cells[e], s) for e, s in left])
    tags = [np.full(len(faces), 7), np.ones(len(cells), int)]
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    groups = {"left": np.array([7, dim - 1]), "all": np.array([1, dim])}
    meshio.write(path, meshio.Mesh(points, [("line3" if dim == 2 else "triangle6", faces), (solidmeshes.SHAPES[shape], cells)], cell_data=data, field_data=groups), file_format="gmsh22", binary=binary)


# Gmsh numbers the last two edges of tetrahedra the other way round than VTK, and elements by their own types
GMSH = {"tri6": (9, [0, 1, 2, 3, 4, 5]), "tet10": (11, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8])}
GMSH_FACES = {"tri6": 8, "tet10": 9}


def write_gmsh41(path, shape):
    """The same in version 4.1, as text: physical groups belong to entities, the body to two of them, half of its elements each; numbers of nodes and elements have gaps."""
    points, cells, left, _ = mesh(shape)
    dim = solidmeshes.dim_of(shape)
    kind, order = GMSH[shape]
    faces = np.array([face(shape, cells[e], s) for e, s in left])
    halves = np.split(cells[:, order], [len(cells) // 2])
    low, high = (" ".join(map(repr, map(float, end(points, axis=0)))) for end in (np.min, np.max))
    entities = {dim - 1: [f"4 {low} {high} 1 7 0"], dim: [f"{tag} {low} {high} 1 1 1 4" for tag in (5, 9)]}
    numbers = 3 * np.arange(len(points)) + 10
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "2", f'{dim - 1} 7 "left"', f'{dim} 1 "all"', "$EndPhysicalNames"]
    lines += ["$Entities", " ".join(str(len(entities.get(d, []))) for d in range(4)), *entities[dim - 1], *entities[dim], "$EndEntities"]
    blocks = np.array_split(np.arange(len(points)), 2)
    lines += ["$Nodes", f"2 {len(points)} {numbers[0]} {numbers[-1]}"]
    for tag, block in zip((5, 9), blocks, strict=True):
        lines += [f"{dim} {tag} 0 {len(block)}", *(str(numbers[n]) for n in block), *(" ".join(map(repr, map(float, points[n]))) for n in block)]
    lines += ["$EndNodes", "$Elements", f"3 {len(faces) + len(cells)} 2 {2 * (len(faces) + len(cells))}"]
    number = 0
    for d, tag, of_kind, elements in ((dim - 1, 4, GMSH_FACES[shape], faces), (dim, 5, kind, halves[0]), (dim, 9, kind, halves[1])):
        lines.append(f"{d} {tag} {of_kind} {len(elements)}")
        for element in elements:
            number += 2
            lines.append(" ".join(map(str, [number, *numbers[element]])))
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def write_exodus(path, shape):
    """Side set "left" (7), node set "held" (3) of the nodes at x = 0, with those in the middle of edges."""
    points, cells, left, held = mesh(shape)
    dim = solidmeshes.dim_of(shape)
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        sizes = {"num_dim": dim, "num_nodes": len(points), "num_elem": len(cells), "num_el_blk": 1, "num_side_sets": 1, "num_node_sets": 1}
        sizes |= {"num_el_in_blk1": len(cells), "num_nod_per_el1": cells.shape[1], "num_side_ss1": len(left), "num_nod_ns1": len(held), "len_name": 33}
        for name, size in sizes.items():
            file.createDimension(name, size)

        def put(name, dimensions, values, kind="i4"):
            variable = file.createVariable(name, kind, dimensions)
            variable[:] = values
            return variable

        for axis, name in enumerate(("coordx", "coordy", "coordz")[:dim]):
            put(name, ("num_nodes",), points[:, axis], "f8")
        put("eb_prop1", ("num_el_blk",), [1])
        put("ss_prop1", ("num_side_sets",), [7])
        put("ns_prop1", ("num_node_sets",), [3])
        for kind, dimension, name in (("eb", "num_el_blk", "all"), ("ss", "num_side_sets", "left"), ("ns", "num_node_sets", "held")):
            put(f"{kind}_names", (dimension, "len_name"), netCDF4.stringtochar(np.array([name], "S33")), "S1")
        put("connect1", ("num_el_in_blk1", "num_nod_per_el1"), cells + 1).elem_type = {"tri6": "TRI6", "tet10": "TETRA10"}[shape]
        put("elem_ss1", ("num_side_ss1",), [e + 1 for e, _ in left])
        put("side_ss1", ("num_side_ss1",), [s + 1 for _, s in left])
        put("node_ns1", ("num_nod_ns1",), held + 1)
