"""Draws a contact patch test: the blocks as deformed, and how far the pressure at each node of their surfaces is off its mean.

    python plots/contact_patch.py fields.xdmf picture.png

For two blocks, one on the other along z, whose contact pressure should be uniform.
"""

import sys

import numpy as np
from figures import CannotDraw, command_line, labelled, scale
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from render import Fields

SCALE = 100  # of the displacements, in the picture of the blocks
FLOOR, CEILING = 1e-16, 1e-8  # of the errors that are told apart
COLOURS = ("#8fb4d9", "#f0c58f")


def outside(mesh, k):
    """Faces of a body's boundary, each as numbers of the body's nodes, and what these are in the whole mesh."""
    block = mesh.extract_cells(np.flatnonzero(mesh.cell_data["colour"] == k))
    surface = block.extract_surface(algorithm="dataset_surface")
    return [surface.point_data["vtkOriginalPointIds"][face] for face in surface.irregular_faces], block.point_data["vtkOriginalPointIds"]


def draw_blocks(axes, fields, blocks):
    moved = fields.points + SCALE * fields.data("displacement", -1)[()]
    for (faces, origin), colour in zip(blocks, COLOURS):
        axes.add_collection3d(Poly3DCollection([moved[origin[face]] for face in faces], facecolor=colour, edgecolor="#333333", linewidth=0.4))
    low, high = moved.min(axis=0), moved.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.0)
    axes.view_init(20, -60)
    axes.set_axis_off()
    axes.set_title(f"displacements × {SCALE}")


def draw_errors(axes, fields, block, name, colour):
    faces, origin = block
    active = fields.data("contact_active", -1)[()] > 0
    pressure = fields.data("contact_pressure", -1)[()]
    error = np.abs(pressure / pressure[active].mean() - 1)
    for face in faces:
        corners = origin[face]
        if active[corners].all():
            axes.fill(*fields.points[corners, :2].T, facecolor=colour, alpha=0.5, edgecolor="#333333", linewidth=0.6)
    nodes = origin[active[origin]]
    dots = axes.scatter(*fields.points[nodes, :2].T, c=np.maximum(error[nodes], FLOOR), norm=LogNorm(FLOOR, CEILING), s=45, zorder=2)
    axes.set_aspect("equal")
    metre = fields.units(("displacement", None))
    factor, unit = scale(pressure[nodes].mean(), fields.units(("contact_pressure", None)))
    axes.set(xlabel=labelled("x", metre), ylabel=labelled("y", metre))
    axes.set_title(f"{name}: {len(nodes)} nodes, {factor * pressure[nodes].mean():.4g} {unit},\nat most {error[nodes].max():.1e} off")
    return dots


def draw(file, path):
    fields = Fields(file)
    body = fields.heavy["mesh/body"]
    names = body.attrs["names"].split(",")
    if len(names) != 2 or "contact_pressure" not in fields.datasets[0]:
        raise CannotDraw("it takes two bodies in contact")
    mesh = fields.mesh(len(fields) - 1, 1, body[()], True)
    blocks = [outside(mesh, k) for k in range(2)]
    figure = Figure(figsize=(11, 4), layout="constrained")
    draw_blocks(figure.add_subplot(1, 3, 1, projection="3d"), fields, blocks)
    panels = [figure.add_subplot(1, 3, 2 + k) for k in range(2)]
    for k in range(2):
        dots = draw_errors(panels[k], fields, blocks[k], names[k], COLOURS[k])
    figure.colorbar(dots, ax=panels, label="relative error of the pressure", shrink=0.8)
    figure.savefig(path, dpi=95)


if __name__ == "__main__":
    sys.exit(command_line("fields.xdmf picture.png", draw))
