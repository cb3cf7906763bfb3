"""How deep bodies lie inside each other at any point of their surfaces, which is more than what contact rows say: see plots/overlap.py.

On a rigid plane rows are gaps of nodes, and so are they between surfaces whose nodes lie on each other: nothing overlaps. Between other meshes rows
are means, and faces that are bent by h^2/8 of their curvature overlap by that; rows that are kept while surfaces slide by less than
-contact_slip_bound of a face are off by that slip times the angle between the surfaces.
"""

import os
import sys

import numpy as np
import overlap
import pytest
from cases import long
from conftest import ROOT

FIELDS = "-output_fields fields.h5 -output_fields_precision double"
STACK = f"-options_file options/stack.opts {FIELDS} -output_fields_interval 10"
BLOCKS = "abcde"
# What keeps the moments of inertia grades the masses of a coarse block, by 0.3 to 1.9, and by others on another mesh
CENTRE = " ".join(f"-{b}_mass_moments centre" for b in BLOCKS)


def bodies(run):
    return overlap.Bodies(run.folder / "fields.h5")


def test_depths():
    """A square of edge 2: points inside, outside, and beyond a corner."""
    corners = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    depth, edge = overlap.depths(np.array([[0.5, 1], [1, 1.75], [3, 1], [-0.1, -0.1], [1.9, 0.3]]), corners, np.roll(corners, -1, axis=0))
    np.testing.assert_allclose(depth, [0.5, 0.25, 0, 0, 0.1], atol=1e-15)
    assert list(edge[[0, 1, 4]]) == [3, 2, 1]


def test_stack_between_other_meshes(shared_run):
    """Of the five blocks, whose ends lie anywhere on their neighbours: 0.240 mm measured, 0.69 % of the smallest element (0.44 to 0.98 % with other steps and
    masses, and as much with rows that were laid before the blocks met), and 0.12 % in the root of the mean square of all overlaps; with rows of covered nodes alone, corners of tilting blocks got 2.3 mm deep. The deepest one hangs on how the
    blocks tilt, and so on their masses: 0.15 mm before these were moved so that they do not spread along the layer and keep their moments of inertia.
    Nothing gets into the floor."""
    stack = bodies(shared_run(f"{STACK} -time_end 0.3"))
    depths = np.array([each.depth for each in overlap.overlaps(stack)])
    assert 0.003 * stack.size() < depths.max() <= 0.0075 * stack.size()
    assert np.sqrt(np.mean(depths**2)) <= 0.0013 * stack.size()
    assert min(x[:, 1].min() for x in stack.frames) >= -1e-6 * stack.size()


def test_stack_of_matching_meshes(shared_run):
    """Equal blocks that do not bulge: the demand of 1e-6 of an element holds at every point, to round-off (1e-16 m). Their masses are the same across
    the blocks: graded ones shear the blocks, whose nodes then do not lie on each other."""
    heights = [(0.02 + 0.21 * i, 0.22 + 0.21 * i) for i in range(5)]
    same = " ".join(f"-{b}_dm_plex_box_lower -0.2,{lower} -{b}_dm_plex_box_upper 0.2,{upper} -{b}_dm_plex_box_faces 8,4 -{b}_poissons_ratio 0" for b, (lower, upper) in zip(BLOCKS, heights, strict=True))
    run = shared_run(f"{STACK} -time_end 0.15 {same} {CENTRE}")
    stack = bodies(run)
    contacts = run.history["contact"]
    assert len(contacts) == 5 and all(np.any(contacts[pair]["active"][()]) for pair in contacts)
    assert max((each.depth for each in overlap.overlaps(stack)), default=0) <= 1e-6 * stack.size()
    assert min(x[:, 1].min() for x in stack.frames) >= -1e-6 * stack.size()


@pytest.mark.long
def test_stack_converges(shared_run):
    """Half the element: the root of the mean square is 15 rather than 30 micrometres, of all overlaps in the first 0.15 s. The blocks' courses differ
    in the end, so that there is no exact order. With the moments of inertia kept, the masses of both meshes differ by more, and so do the courses."""
    finer = "-a_dm_plex_box_faces 16,8 -b_dm_plex_box_faces 14,6 -c_dm_plex_box_faces 16,8 -d_dm_plex_box_faces 12,6 -e_dm_plex_box_faces 16,8"
    coarse, fine = (np.array([each.depth for each in overlap.overlaps(bodies(shared_run(f"{STACK} -output_fields_interval 5 -time_end 0.15 {CENTRE} {more}")))]) for more in ("", finer))
    assert len(fine) > 100
    assert np.sqrt(np.mean(fine**2)) <= 0.75 * np.sqrt(np.mean(coarse**2))
    assert fine.max() <= 0.75 * coarse.max()  # 71 and 120 micrometres


def box(name, lower, upper, faces, top, displacement):
    options = {"ts_type": "static", "dm_plex_dim": 2, "dm_plex_box_lower": lower, "dm_plex_box_upper": upper, "dm_plex_box_faces": faces}
    options |= {"density": 1000, "youngs_modulus": 1e9, "poissons_ratio": 0.25, "boundary_displacement": top, f"boundary_displacement_{top}": displacement}
    return " ".join(f"-{name}_{option} {value}" for option, value in options.items())


def pressed(shared_run, order, half, n):
    """Force and overlap of a block that is pressed on a wider one by 1 mm, and tilted."""
    base = box("base", "-1,-1", "1,0", f"{20 * n},{10 * n}", "ymin", "0,0")
    block = box("block", f"{-half},0", f"{half},0.6", f"{6 * n},{6 * n}", "ymax", "0,-0.001*t-0.002*t*x")
    run = shared_run(f"-bodies base,block -contact_pairs {order} {base} {block} -time_step 1 -time_end 1 {FIELDS}")
    contact = next(iter(run.history["contact"].values()))
    return abs(contact["force_vector"][-1][1]), overlap.largest(run.folder / "fields.h5")


@pytest.mark.parametrize("half", [0.345, *long(0.31, 0.33)])
def test_end_on_a_face(half, shared_run):
    """The block's ends lie 10 to 90 % along faces of the base. Whether they are nodes that take displacements or lie between nodes of the base that
    do: the force is the same to 0.7 % and 0.3 % (coarse, fine), and the overlap no more than twice that of the first (measured 1.7 at most).
    Without rows of the nodes beyond the end it was 5 to 70 times, growing on the finer mesh, and the force 2.3 % off."""
    for n, bound in ((1, 0.01), (2, 0.004)):
        inner, outer = (pressed(shared_run, order, half, n) for order in ("block.ymin:base.ymax", "base.ymax:block.ymin"))
        assert outer[0] == pytest.approx(inner[0], rel=bound)
        assert outer[1] <= 2 * inner[1]
        assert inner[1] <= 0.05 * 1e-3  # of the pressing


@pytest.mark.parametrize(("left", "right"), [(0.03, 0.07), (-0.04, 0.04), (-0.02, 0.12)])
def test_side_by_side(left, right, shared_run):
    """Two blocks whose ends lie on the same face, or on faces beside each other: a node guards one of them at most, and none if the other touches
    it; prescribed twice, it would end the run with an error. For their widths, the blocks bear the same to 5 % (measured 4 %), the end that is
    not guarded (of the second case, with ends 4 cm before the same node) is 0.12 mm deep of 1 mm."""
    base = box("base", "-1,-1", "1,0", "20,10", "ymin", "0,0")
    blocks = [box(name, f"{lower},0", f"{upper},0.4", "6,4", "ymax", "0,-0.001*t") for name, lower, upper in (("left", -0.6, left), ("right", right, 0.6))]
    run = shared_run(f"-bodies base,left,right -contact_pairs base.ymax:left.ymin,base.ymax:right.ymin {base} {' '.join(blocks)} -time_step 1 -time_end 1 {FIELDS}")
    forces = [-contact["force_vector"][-1][1] for contact in run.history["contact"].values()]
    assert forces[0] / (left + 0.6) == pytest.approx(forces[1] / (0.6 - right), rel=0.05)
    assert overlap.largest(run.folder / "fields.h5") <= 0.15e-3


@pytest.mark.long
def test_figure(shared_run, launch, tmp_path):
    figure = tmp_path / "figure.png"
    run = shared_run(f"{STACK} -time_end 0.3")
    drawn, failed = (launch([sys.executable, ROOT / "plots/overlap.py", run.folder / name, figure], env={**os.environ, "MPLBACKEND": "Agg"}) for name in ("fields.h5", "history.h5"))
    assert drawn.returncode == 0 and not drawn.stderr, drawn.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert failed.returncode > 0
    assert "no fields of an Impakt run" in failed.stderr and "Traceback" not in failed.stderr
