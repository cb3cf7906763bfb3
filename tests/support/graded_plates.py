"""A plate about the axis x = 0, fine where something hits its upper side, y = 0: the half-space that theories of indentation have."""

import meshio
import numpy as np


def graded(edge, until, growth, length):
    """Positions from 0 to `length`: edges of a length up to `until`, and from there each longer than the one before by `growth`."""
    positions = list(np.linspace(0, until, round(until / edge) + 1))
    fine = len(positions)
    while positions[-1] < length:
        edge *= growth
        positions.append(positions[-1] + edge)
    positions = np.array(positions)
    positions[fine:] = until + (positions[fine:] - until) * (length - until) / (positions[-1] - until)
    return positions


def write_plate(path, edge, until, growth, length):
    """Gmsh 2.2, quadrilaterals: 0 <= x <= length, -length <= y <= 0."""
    x = graded(edge, until, growth, length)
    n = len(x)
    points = np.stack([np.tile(x, n), np.repeat(-x[::-1], n), np.zeros(n * n)], axis=1)
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    cells = np.stack([first, first + 1, first + n + 1, first + n], axis=1)
    ones = np.ones(len(cells), int)
    mesh = meshio.Mesh(points, [("quad", cells)], cell_data={"gmsh:physical": [ones], "gmsh:geometrical": [ones]})
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return path
