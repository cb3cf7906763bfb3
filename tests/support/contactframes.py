"""Gaps between two bodies with flat faces, measured on their deformed meshes, by code that has nothing of the program's: fields of each step (`FIELDS`) come in."""

from functools import cached_property

import h5py
import numpy as np

FIELDS = "-output_fields fields.h5 -output_fields_precision double -output_fields_interval 1"
GAUSS = np.array([-1, 1]) / np.sqrt(3)


class Frames:
    """Plane bodies number `rows` and `other` of -bodies; nodes of the first have the rows, `other` None is an obstacle, the plane through the origin. `normal`: of the
    face of the first."""

    def __init__(self, run, rows, other, normal):
        self.file = h5py.File(run.folder / "fields.h5", "r")
        self.normal = np.array(normal, float)
        self.along = np.array([-normal[1], normal[0]], float)
        self.time = self.file["time"][()]
        self.start = self.file["mesh/positions"][:, :2]
        self.face = self.surface(rows, 1)
        self.partner = None if other is None else self.surface(other, -1)

    def surface(self, body, sign):
        """Nodes of the face whose normal is `sign` times that of the first body's, in the order of its tangent."""
        nodes = np.unique(self.file["mesh/cells"][()][self.file["mesh/body"][()] == body])
        height = sign * self.start[nodes] @ self.normal
        face = nodes[height > height.max() - 1e-6 * np.ptp(height)]
        return face[np.argsort(self.start[face] @ self.along)]

    def field(self, name, frame):
        return self.file[f"{name}/{frame:04d}"][()]

    def means(self, frame, name=None):
        """Of the gap, or of the rate at which `velocity` changes it, about each node of the first face: weighed by its hat function, where the partner is opposite."""
        place = self.start + self.field("displacement", frame)[:, :2]
        value = place if name is None else self.field(name, frame)[:, :2]
        s, v = place[self.face] @ self.along, -value[self.face] @ self.normal
        if self.partner is None:
            points, opposite = s, (lambda x: np.zeros_like(x))
        else:
            t, w = place[self.partner] @ self.along, -value[self.partner] @ self.normal
            opposite = lambda x: np.interp(x, t, w)
            points = np.unique(np.clip(np.concatenate([s, t]), max(s[0], t[0]), min(s[-1], t[-1])))
        if len(points) < 2:
            return np.full(len(s), np.nan)
        half, middle = np.diff(points) / 2, (points[1:] + points[:-1]) / 2
        x = (middle[:, None] + half[:, None] * GAUSS).ravel()
        weight = np.repeat(half, 2)
        part = np.clip(np.searchsorted(s, x) - 1, 0, len(s) - 2)
        right = (x - s[part]) / (s[part + 1] - s[part])
        gap = v[part] * (1 - right) + v[part + 1] * right - opposite(x)
        area, sums = np.zeros(len(s)), np.zeros(len(s))
        for node, share in ((part, 1 - right), (part + 1, right)):
            np.add.at(area, node, weight * share)
            np.add.at(sums, node, weight * share * gap)
        with np.errstate(invalid="ignore"):
            return np.where(area > 0, sums / area, np.nan)

    @cached_property
    def gaps(self):
        return np.array([self.means(frame) for frame in range(len(self.time))])

    @cached_property
    def rates(self):
        return np.array([self.means(frame, "velocity") for frame in range(len(self.time))])

    @cached_property
    def closed(self):
        return np.array([self.field("contact_active", frame)[self.face] > 0 for frame in range(len(self.time))])

    @cached_property
    def sag(self):
        """By how much bent faces, which are polygons, deviate from arcs through their nodes, both faces together, at most: an eighth of the second differences. As they slide,
        means of their gaps change by so much."""
        faces = [face for face in (self.face, self.partner) if face is not None]
        heights = [[np.diff(place[face] @ self.normal, 2) for face in faces] for place in (self.start + self.field("displacement", k)[:, :2] for k in range(len(self.time)))]
        return max(sum(np.abs(bend).max(initial=0) for bend in frame) for frame in heights) / 8

    @cached_property
    def joins(self):
        """Nodes that are closed, and were not a step before."""
        return np.vstack([np.zeros_like(self.closed[:1]), self.closed[1:] & ~self.closed[:-1]])

    @cached_property
    def closing(self):
        """Rates at which nodes close as the step begins in which they join, per step and node; 0 of others."""
        return np.vstack([np.zeros_like(self.rates[:1]), np.where(self.joins[1:], np.maximum(-self.rates[:-1], 0), 0)])

    def masses(self, density, reach=0):
        """Of each node of the first face [kg], in series with that of the face opposite: of half of the elements behind it and half of `reach`, the way of a wave in a
        step, as far as the body goes. A node that joins alone takes as much of either side with it."""
        own = self.shares(self.face)
        width = np.gradient(self.start[self.face] @ self.along)
        first = own * density * self.depth(self.face, reach)
        if self.partner is None:
            return first * (1 + reach / width)
        second = own * density * self.depth(self.partner, reach)
        return first * second / (first + second) * (1 + reach / width)

    def shares(self, face):
        """Of the length of the face that each of its nodes has."""
        return np.gradient(self.start[face] @ self.along) * np.r_[0.5, np.ones(len(face) - 2), 0.5]

    def depth(self, face, reach):
        """Half of the elements at a face and half of `reach`, at most all of the body."""
        cells = self.file["mesh/cells"][()]
        of = cells[np.isin(cells, face).any(1)]
        height = np.ptp(self.start[of[0]] @ self.normal)
        body = np.unique(cells[self.file["mesh/body"][()] == self.file["mesh/body"][()][np.isin(cells, face).any(1)][0]])
        return min((height + reach) / 2, np.ptp(self.start[body] @ self.normal))
