"""Writes what fuzzing starts from, a folder for each target: python seeds.py FOLDER"""

import struct
import sys
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent / "support"))

from meshes import write_exodus, write_gmsh

EXPRESSIONS = ["0.5*sin(2*pi*x)", "100", "-1e-3,2,x+y", "t<1e-3 ? 1 : 0", "10*nx", "exp(-((x-0.5)/0.1)^2)", "min(t,1)*max(x,y,z)", "sqrt(-1)", "1/0", "x^y^z", "(((t)))", "1,,2"]
TABLES = ["0 0\n1e-3 5\n", "# time value\n0 1\n\n0.5\t2 # in the middle\n1 3\n", "0 1\r\n1 2\r\n", "0 1\r1 2\r", "1 0\n0 1\n", "0\n", "0 nan\n1 inf\n", "0,1\n"]


def record(name, kind, count, values):
    """As src/checkpoint/checkpoint.c has them."""
    values += bytes(-len(values) % 8)
    return struct.pack("39scq", name.encode(), kind.encode(), count) + values


def records():
    yield record("body", "s", 0, b"")
    yield record("reals", "r", 3, struct.pack("3d", 1, 2, 3))
    yield record("ints", "i", 2, struct.pack("2i", 4, 5))
    yield record("long", "l", 1, struct.pack("q", 6))
    yield record("bools", "b", 3, struct.pack("3?", True, False, True))
    yield record("bytes", "c", 5, b"bytes")
    yield record("sizes", "i", 2, struct.pack("2i", 4, 5))
    yield record("matrix", "i", 3, struct.pack("3i", 0, 1, 3))
    yield record("columns", "i", 3, struct.pack("3i", 0, 1, 2))
    yield record("entries", "r", 3, struct.pack("3d", 7, 8, 9))


def main(folder):
    for target in ("checkpoint", "expression", "table", "options_file", "mesh_gmsh", "mesh_exodus"):
        (folder / target).mkdir(parents=True, exist_ok=True)
    for i, text in enumerate(EXPRESSIONS):
        (folder / "expression" / str(i)).write_text(text)
    for i, text in enumerate(TABLES):
        (folder / "table" / str(i)).write_bytes(text.encode())
    for path in sorted((ROOT / "options").glob("*.opts")):
        (folder / "options_file" / path.stem).write_bytes(path.read_bytes())
    for shape in ("tetra", "hexahedron", "triangle", "quad"):
        for version in ("2.2", "4.1"):
            for binary in (False, True):
                write_gmsh(folder / "mesh_gmsh" / f"{shape}-{version}-{'binary' if binary else 'text'}", shape, version, binary)
    for container in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA"):
        write_exodus(folder / "mesh_exodus" / container, container)
    (folder / "checkpoint" / "stream").write_bytes(b"\1" + b"".join(records()))
    (folder / "checkpoint" / "file").write_bytes(b"\0" + b"\x89HDF\r\n\x1a\n" + bytes(92) + struct.pack("8sQQ", b"impaktC1", 100, 0))
    for path in (HERE / "found").glob("*/*"):  # what has broken a target once
        (folder / path.parent.name / f"found-{path.name}").write_bytes(path.read_bytes())


main(Path(sys.argv[1]))
