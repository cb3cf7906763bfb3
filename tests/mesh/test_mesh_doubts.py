"""Warnings of mesh files that can hardly be meant: elements over each other, and meshes in pieces. Of bars they are errors."""

import itertools

import pytest
from cases import long

OPTIONS = "-bodies b -b_density 1000 -b_youngs_modulus 1e7 -time_step 1e-4 -time_end 1e-4"
# Gmsh's numbers of shapes; corners of a cell of 1 x 1 (x 1), counterclockwise, and the order in which they become simplices
BLOCK = {
    1: [(0,), (1,)],
    2: [(0, 0), (1, 0), (1, 1), (0, 1)],
    3: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
}
SHAPES = {
    "bar": (1, 1, [(0, 1)]),
    "triangle": (2, 2, [(0, 1, 2), (0, 2, 3)]),
    "quadrilateral": (3, 2, [(0, 1, 2, 3)]),
    "tetrahedron": (4, 3, [(0, 1, 2, 6), (0, 2, 3, 6), (0, 5, 1, 6), (0, 4, 5, 6), (0, 7, 4, 6), (0, 3, 7, 6)]),
    "hexahedron": (5, 3, [tuple(range(8))]),
}


def write_mesh(path, shape, origins, merge=True):
    """Cells of 1 m at the given places; nodes at the same place are one, or each cell has its own."""
    number, dim, cuts = SHAPES[shape]
    nodes, elements = [], []
    for origin in origins:
        place = []
        for corner in BLOCK[dim]:
            node = tuple(o + c for o, c in zip(origin, corner, strict=True)) + (0,) * (3 - dim)
            if not merge or node not in nodes:
                nodes.append(node)
                place.append(len(nodes))
            else:
                place.append(nodes.index(node) + 1)
        elements += [[place[i] for i in cut] for cut in cuts]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", len(nodes)]
    lines += [f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(nodes, 1)]
    lines += ["$EndNodes", "$Elements", len(elements)]
    lines += [f"{i} {number} 2 0 1 {' '.join(map(str, corners))}" for i, corners in enumerate(elements, 1)]
    path.write_text("\n".join(map(str, [*lines, "$EndElements", ""])))
    return path


def warnings(run):
    return [line for line in run.stderr.splitlines() if "impakt: warning" in line or "impakt: error" in line]


def grid(dim, n):
    return list(itertools.product(range(n), repeat=dim))


@pytest.mark.parametrize("shape", ["bar", "quadrilateral", "tetrahedron"])
def test_nothing_to_doubt(shape, tmp_path, impakt):
    path = write_mesh(tmp_path / "m.msh", shape, grid(SHAPES[shape][1], 3))
    assert not warnings(impakt(f"{OPTIONS} -b_dm_plex_filename {path}"))


@pytest.mark.parametrize(("shape", "ranks"), [("bar", 1), ("triangle", 1), ("hexahedron", 2)])
def test_pieces(shape, ranks, tmp_path, impakt):
    """Two cells that share all nodes of a face by their places, and none by their numbers; and a third one, far from them."""
    dim = SHAPES[shape][1]
    path = write_mesh(tmp_path / "m.msh", shape, [(0,) * dim, (1, *(0,) * (dim - 1)), (5,) * dim], merge=False)
    (line,) = warnings(impakt(f"{OPTIONS} -b_dm_plex_filename {path}", ranks, expect_failure=dim == 1))
    for words in ("in 3 pieces", f"({2 ** (dim - 1)} do)", "'b'", "m.msh"):
        assert words in line


@pytest.mark.parametrize(("shape", "shift"), [*((shape, (0, 0.25)[i % 2]) for i, shape in enumerate(SHAPES)), *long(("triangle", 0.75), ("hexahedron", 0.75))])
def test_overlap(shape, shift, tmp_path, impakt):
    """The same cell again, at the same place or not quite."""
    dim = SHAPES[shape][1]
    path = write_mesh(tmp_path / "m.msh", shape, [*grid(dim, 2), tuple(shift / (d + 1) for d in range(dim))])
    lines = warnings(impakt(f"{OPTIONS} -b_dm_plex_filename {path}", expect_failure=dim == 1))
    assert any("over others" in line and "'b'" in line for line in lines)


@pytest.mark.parametrize(("shape", "overlap"), [("triangle", 0.2), ("hexahedron", 0.2), *long(("quadrilateral", 0.4), ("tetrahedron", 0.4))])
def test_overlap_at_the_edge(shape, overlap, tmp_path, impakt):
    """A cell beside the others whose lines go on in it, with no centre of an element where it overlaps them, and no node but on their edges."""
    dim = SHAPES[shape][1]
    path = write_mesh(tmp_path / "m.msh", shape, [*grid(dim, 2), (2 - overlap, *[0] * (dim - 1))])
    lines = warnings(impakt(f"{OPTIONS} -b_dm_plex_filename {path}"))
    assert any("over others" in line and "'b'" in line for line in lines)
