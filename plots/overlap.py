"""Draws how deep bodies in two dimensions lie inside each other, at any point of their surfaces, over time: a line for each run, four at most.

    python plots/overlap.py fields.h5 [fields.h5 ...] figure.png

The files are those of -output_fields (with -output_fields_precision double overlaps below 1e-7 of the size mean something too).

Contact rows keep means of the gap over a Dirichlet node's faces from becoming negative. What is measured here is another thing: how deep a
boundary node of one body lies inside the outline of another, which is its distance from the nearest edge of that, both as deformed. As edges are
straight, no other point of them lies deeper, if nodes of both bodies are looked at.
"""

import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np
from figures import COLOURS, CannotDraw, command_line, labelled, scale
from impakt_results import Fields
from matplotlib.figure import Figure

FLOOR = 1e-9  # of an element: what is drawn of frames without overlap


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def outline(cells, positions):
    """Edges that belong to one cell alone, in the direction that has the body on the left."""
    corners = positions[cells]
    clockwise = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) < 0
    cells = np.where(clockwise[:, None], cells[:, ::-1], cells)
    edges = np.stack((cells, np.roll(cells, -1, axis=1)), axis=-1).reshape(-1, 2)
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    return edges[first[count == 1]]


class Bodies:
    """Positions of all nodes in each frame, and the outline of each body."""

    def __init__(self, path):
        fields = Fields(path)
        self.length, self.time_unit = fields.length, fields.time_unit
        body, cells, self.times = fields.body, fields.cells, fields.times
        flat = np.ptp(fields.nodes[:, 2]) == 0
        self.reference = fields.nodes[:, :2]
        self.frames = [fields.positions(frame)[:, :2] for frame in range(len(fields))]
        if not flat or cells.ndim != 2 or cells.shape[1] < 3:
            raise CannotDraw(f"{path}: overlaps are measured in two dimensions, and between bodies of one kind of element")
        self.outlines = [outline(cells[body == b], self.reference) for b in range(body.max() + 1)]

    def size(self):
        """Length of the shortest edge of any outline, before anything moves."""
        return min(np.linalg.norm(np.diff(self.reference[edges], axis=1), axis=-1).min() for edges in self.outlines)


def locate(points, start, end):
    """Distances of points from a closed outline, negative inside, and which edge is nearest."""
    along = end - start
    to = points[:, None] - start
    part = np.clip((to * along).sum(-1) / (along**2).sum(-1), 0, 1)
    distance = np.linalg.norm(to - part[..., None] * along, axis=-1)
    nearest = distance.argmin(axis=1)
    above = start[:, 1] > points[:, 1, None]
    crossed = (above != (end[:, 1] > points[:, 1, None])) & ((cross(along, to) > 0) == (along[:, 1] > 0))
    inside = crossed.sum(axis=1) % 2 == 1
    distance = distance[np.arange(len(points)), nearest]
    return np.where(inside, -distance, distance), nearest


def depths(points, start, end):
    """How deep points lie inside a closed outline, 0 outside, and which edge is nearest."""
    distance, nearest = locate(points, start, end)
    return np.maximum(-distance, 0), nearest


def distances(points, start, end):
    """Of points from a closed outline, negative inside."""
    return locate(points, start, end)[0]


def near(a, b):
    """Whether the boxes about two sets of points meet."""
    return np.all(a.max(axis=0) > b.min(axis=0)) and np.all(b.max(axis=0) > a.min(axis=0))


def overlaps(bodies):
    """For each ordered pair of bodies and each frame in which a node of the first is inside the second: the deepest of them."""
    found = []
    for frame, x in enumerate(bodies.frames):
        for a, mine in enumerate(bodies.outlines):
            for b, other in enumerate(bodies.outlines):
                nodes = mine[:, 0]
                if a == b or not near(x[nodes], x[other[:, 0]]):
                    continue
                depth, edge = depths(x[nodes], x[other[:, 0]], x[other[:, 1]])
                i = depth.argmax()
                if depth[i] > 0:
                    found.append(SimpleNamespace(frame=frame, time=bodies.times[frame], body=a, other=b, node=nodes[i], edge=other[edge[i]], depth=depth[i]))
    return found


def largest(path):
    """The deepest overlap of a run [m]."""
    return max((each.depth for each in overlaps(Bodies(path))), default=0)


def deepest(bodies):
    """In each frame, by the size of an element."""
    depth = np.zeros(len(bodies.frames))
    for each in overlaps(bodies):
        depth[each.frame] = max(depth[each.frame], each.depth)
    return depth / bodies.size()


def draw(*files, path):
    runs = [(Path(file).stem, Bodies(file)) for file in files[: len(COLOURS)]]
    matplotlib.rcParams.update({"font.size": 9, "axes.titlesize": 9, "lines.linewidth": 1.0, "axes.axisbelow": True})
    figure = Figure(figsize=(7, 3.4), layout="constrained")
    axes = figure.subplots()
    for colour, (name, bodies) in zip(COLOURS, runs, strict=False):
        depth = deepest(bodies)
        factor, unit = scale(bodies.size(), bodies.length)
        axes.semilogy(bodies.times, np.maximum(depth, FLOOR), color=colour, label=f"{name}: elements of {factor * bodies.size():.3g} {unit}, at most {depth.max():.1e} of one")
    axes.axhline(1e-6, color="0.5", linewidth=0.8, linestyle=":")
    axes.set_xlabel(labelled("time", runs[0][1].time_unit))
    axes.set_ylabel("deepest overlap / element")
    axes.grid(color="0.9", linewidth=0.6)
    figure.legend(frameon=False, loc="outside upper center")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    sys.exit(command_line("fields.h5 [fields.h5 ...] figure.png", draw))
