"""Mesh files of both formats in all their containers, as the program reads them; damaged ones end it with a message."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from cases import long
from conftest import BUILD, IMPAKT
from meshes import row, write_exodus, write_gmsh
from pairs import pairwise

OPTIONS = "-bodies a -time_step 1 -time_end 1 -a_density 1 -a_youngs_modulus 1"


def mesh_of(text):
    """What PETSc's own view of the mesh (ascii_info_detail) tells: strata of labels over all ranks, and vertices' positions."""
    labels = {}
    for part in text.split("\nLabel '")[1:]:
        labels[part.split("'")[0]] = len(re.findall(r"^\s*\[\d+\]: \d+ \(1\)$", part, re.MULTILINE))
    found = re.findall(r"\(\s*\d+\) dof +\d+ offset +\d+((?: [-+.e\d]+)+)", text)
    return SimpleNamespace(labels=labels, points=np.array(sorted({tuple(map(float, line.split())) for line in found})))


def viewed(launch, tmp_path, path, ranks=1):
    done = launch([IMPAKT, *OPTIONS.split(), "-a_dm_plex_filename", path, "-a_dm_view", "::ascii_info_detail"], ranks, cwd=tmp_path)
    assert "mesh file" not in done.stderr, done.stderr
    return mesh_of(done.stdout)


def check(mesh, shape):
    points, cells, ends = row(shape)
    dim = 3 if shape in ("tetra", "hexahedron") else 2
    assert mesh.labels["all"] == len(cells)
    assert mesh.labels["left"] == mesh.labels["right"] == len(ends) // 2
    np.testing.assert_array_equal(mesh.points, sorted(map(tuple, points[:, :dim])))  # small whole numbers: exact


@pytest.mark.parametrize("shape, version, binary", pairwise(["tetra", "hexahedron", "triangle", "quad"], ["2.2", "4.1"], [False, True]))
def test_gmsh(launch, tmp_path, shape, version, binary):
    write_gmsh(tmp_path / "row.msh", shape, version, binary)
    check(viewed(launch, tmp_path, "row.msh", ranks=2 if binary and shape == "tetra" else 1), shape)


@pytest.mark.parametrize(("container", "extension"), [("NETCDF3_CLASSIC", "e"), ("NETCDF3_64BIT_OFFSET", "g"), ("NETCDF3_64BIT_DATA", "ex2"), ("NETCDF4", "exo")])
def test_exodus(launch, tmp_path, container, extension):
    write_exodus(tmp_path / f"row.{extension}", container)
    mesh = viewed(launch, tmp_path, f"row.{extension}", ranks=3 if extension == "g" else 1)
    check(mesh, "hexahedron")
    assert mesh.labels["corner"] == 1  # of one rank alone: it is a vertex of one cube


def refused(impakt, path, words, ranks):
    """One line by Impakt itself that names body and file, before any output is written."""
    run = impakt(f"{OPTIONS} -a_dm_plex_filename {path}", ranks, expect_failure=True, timeout=60)
    lines = [line for line in run.stderr.splitlines() if line.startswith("impakt: error")]
    assert len(lines) == 1, run.stderr
    assert "PETSC ERROR" not in run.stderr
    for word in ["'a'", str(path), *words]:
        assert word in lines[0], lines[0]
    assert not list(run.folder.glob("*.h5"))


KINDS = ["2.2-ascii", "2.2-binary", "4.1-ascii", "4.1-binary", "exodus-offset", "exodus-netcdf4"]


def write(folder, kind, shape):
    version, _, container = kind.partition("-")
    path = folder / ("cut.g" if version == "exodus" else "cut.msh")
    if version == "exodus":
        write_exodus(path, {"offset": "NETCDF3_64BIT_OFFSET", "netcdf4": "NETCDF4"}[container])
    else:
        write_gmsh(path, shape, version, container == "binary")
    return path


@pytest.mark.parametrize(("kind", "ranks"), [*((kind, 1) for kind in KINDS), ("4.1-binary", 3), *long(("exodus-netcdf4", 3))])
def test_truncated(impakt, tmp_path, kind, ranks):
    """Cut in the middle: more lengths of more files in mesh_files.c."""
    path = write(tmp_path, kind, "tetra")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    refused(impakt, path, ["cut short"], ranks)


@pytest.mark.parametrize("version", ["4.1", *long("2.2")])
def test_cut_binary(launch, tmp_path, version):
    """No length of a binary file is read as a whole one; none makes the program crash."""
    write_gmsh(tmp_path / "row.msh", "hexahedron", version, binary=True)
    whole = (tmp_path / "row.msh").read_bytes()
    end = whole.rindex(b"$EndElements") + len(b"$EndElements")
    for length in {*range(0, end, 113), *range(end - 3, end)}:
        (tmp_path / "cut.msh").write_bytes(whole[:length])
        done = launch([IMPAKT, *OPTIONS.split(), "-a_dm_plex_filename", "cut.msh"], cwd=tmp_path)
        assert done.returncode > 0
        assert re.match(r"impakt: error: Body 'a', mesh file 'cut.msh': ", done.stderr), (length, done.stderr)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_damaged(launch, tmp_path, kind):
    """Bytes changed at random: the program either reads the file (a coordinate that changed) or says what is wrong, and never
    crashes or hangs. Fixed seeds: the same files each time."""
    if (kind, BUILD.name) == ("exodus-netcdf4", "asan"):
        pytest.skip("HDF5 frees pointers that it has not set where a file is damaged, and the sanitizer fills memory with what makes it crash")
    path = write(tmp_path, kind, "hexahedron")
    whole = np.frombuffer(path.read_bytes(), np.uint8)
    for seed in range(10):
        random = np.random.default_rng(seed)
        bytes_ = whole.copy()
        bytes_[random.integers(0, len(whole), 3)] = random.integers(0, 256, 3)
        path.write_bytes(bytes_.tobytes())
        done = launch([IMPAKT, *OPTIONS.split(), "-a_dm_plex_filename", path], timeout=60, cwd=tmp_path)
        assert 0 <= done.returncode < 128, (seed, done.stderr)
        assert done.returncode == 0 or done.stderr.startswith("impakt: error: "), (seed, done.stderr)


def with_node(cells, element, corner, node):
    changed = cells.copy()
    changed[element, corner] = node
    return changed


BAD_EXODUS = {
    "node": (lambda cells: {"cells": with_node(cells, 2, 3, 28)}, ["element 3", "node 29", "1 to 28"]),
    "type": (lambda cells: {"elem_type": "WEDGE"}, ["WEDGE", "HEX8"]),
    "second-order": (lambda cells: {"elem_type": "HEX20", "cells": np.tile(cells, (1, 3))[:, :20]}, ["HEX20", "first-order"]),
    "inverted": (lambda cells: {"cells": np.vstack([cells[:3], cells[3:4, [4, 5, 6, 7, 0, 1, 2, 3]], cells[4:]])}, ["1 of 6 elements is inverted", "element 4", "(3.5, 0.5, 0.5)"]),
    "left-handed": (lambda cells: {"cells": cells[:, [4, 5, 6, 7, 0, 1, 2, 3]]}, ["all 6 elements", "left-handed"]),
}


@pytest.mark.parametrize("name", list(BAD_EXODUS))
def test_bad_exodus(impakt, tmp_path, name):
    change, words = BAD_EXODUS[name]
    write_exodus(tmp_path / "bad.g", **change(row("hexahedron")[1]))
    refused(impakt, tmp_path / "bad.g", words, 3 if name == "inverted" else 1)


@pytest.mark.parametrize("ranks", [1, *long(3)])
def test_no_file(impakt, tmp_path, ranks):
    refused(impakt, tmp_path / "nowhere.exo", ["no such file"], ranks)
    refused(impakt, tmp_path, ["directory"], ranks)
    (tmp_path / "row.obj").write_text("v 0 0 0\n")
    refused(impakt, tmp_path / "row.obj", [".msh", ".exo"], ranks)


FEW = {
    "quad4": "blocks.opts -left_dm_plex_box_faces 2,1 -right_dm_plex_box_faces 1,2 -time_end 4e-5",
    "explicit": "blocks.opts -left_dm_plex_box_faces 2,1 -right_dm_plex_box_faces 1,2 -left_ts_type centraldifference -left_ts_time_step auto -right_material_type neo_hookean -time_end 4e-5",
    "penalty": "blocks.opts -contact_type penalty -left_dm_plex_box_faces 2,1 -right_dm_plex_box_faces 1,2 -time_end 4e-5",
    "hex8 and tet4": "bars-3d.opts -left_dm_plex_box_faces 2,1,1 -right_dm_plex_box_faces 1,1,1 -time_end 5e-5",
    "static": "contact-patch.opts",
}


@pytest.mark.parametrize(("case", "ranks"), [("explicit", 5), *long(("hex8 and tet4", 5), ("quad4", 7), ("penalty", 5), ("static", 7))])
def test_more_ranks_than_elements(case, ranks, shared_run):
    """Some ranks have nothing to do, and the results are those of one rank."""
    one, many = (shared_run(f"-options_file options/{FEW[case]} -output_fields f.h5", n) for n in (1, ranks))
    assert one.summary["contact"]["force_peak"] > 0
    assert many.summary["contact"]["force_peak"] == pytest.approx(one.summary["contact"]["force_peak"], rel=1e-9)
    assert many.summary["contact"]["impulse"] == pytest.approx(one.summary["contact"]["impulse"], rel=1e-9)
