"""Thin bodies, which keep their mass, so that `-contact_type force` makes the steps: plates that are hit, brackets that fall, sheets in stacks and between tools, tubes."""

from itertools import pairwise

import hollows
import meshio
import numpy as np
from cases import joined
from contactstep import STEEL, friction
from setups import box, material, plane, words
from solidmeshes import SIXTHS

LEG, WIDTH, SHEET = 0.024, 0.045, 0.002  # m, of the bracket
STABLE = 1.4e-7  # s, for cubes of steel of 1 mm: an explicit step
# How the bracket falls: on its longer face, on the edge between its legs, on a corner of that edge; axis and degrees
FALLS = {"flat": None, "edge": (0, 1, 0, -45), "corner": (-1, 1.3, 0, -40)}


def bracket(path, edge=1e-3):
    """An L of sheet, cubes of an edge; its legs lie in the planes z = 0 and x = 0, and its middle above the origin."""
    n, width, thick = (round(length / edge) for length in (LEG, WIDTH, SHEET))
    solid = np.zeros((n, width, n), bool)
    solid[:thick] = solid[:, :, :thick] = True
    return hollows.grid(path, solid, edge, (-LEG / 2, -WIDTH / 2, 0))


def in_tetrahedra(mesh, path):
    """Cubes as six tetrahedra each, about the same diagonal: `-<body>_element_formulation composite` makes tet10 of them."""
    read = meshio.read(mesh)
    cells = np.vstack([read.cells_dict["hexahedron"][:, part] for part in SIXTHS])
    ones = np.ones(len(cells), int)
    meshio.write(path, meshio.Mesh(read.points, [("tetra", cells)], cell_data={"gmsh:physical": [ones], "gmsh:geometrical": [ones]}), file_format="gmsh22", binary=False)
    return path


def turned(points, axis, degrees):
    axis = np.array(axis) / np.linalg.norm(axis)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points * c + np.cross(axis, points) * s + np.outer(points @ axis, axis) * (1 - c)


def model_formulation(of, kind):
    """Against locking in bending; elements with one point keep no history of plastic flow."""
    return "enhanced" if kind == "I" or of == "j2" else "reduced"


def model(name, of, kind, e=STEEL[0], yields=3e8, nu=STEEL[1], density=STEEL[2], formulation=None):
    """Elements that do not lock in bending, of implicit bodies (I) and explicit ones (E)."""
    flows = f"-{name}_yield_stress {yields:g} -{name}_hardening_modulus {e / 200:g}"
    return joined(
        f"-{name}_material_type {of} -{name}_element_formulation {formulation or model_formulation(of, kind)}",
        material(name, e, nu, density),
        flows if of == "j2" else "",
        f"-{name}_ts_type centraldifference" if kind == "E" else "",
    )


def drop(mesh, kind="E", of="neo_hookean", fall="flat", mu=0.3, speed=5.0, step=1e-6, end=1e-4, partner="plane", gap=1e-6, formulation=None, more=""):
    """The bracket falls on a plane, or on a block of 60 x 60 x 20 mm of 10 mm cubes, which is free, or on nothing (None)."""
    corners = np.array([(x, y, z) for x in (-LEG / 2, LEG / 2) for y in (-WIDTH / 2, WIDTH / 2) for z in (0, SHEET, LEG) if x < 0 or z < LEG])
    turn = FALLS[fall]
    low = turned(corners, turn[:3], turn[3])[:, 2].min() if turn else 0
    with_block = partner == "block"
    return joined(
        f"-bodies bracket{',block' if with_block else ''} -time_step {step:.17g} -time_end {end:.17g}",
        f"-bracket_dm_plex_filename {mesh} -bracket_initial_velocity 0,0,{-speed} -bracket_translate 0,0,{gap - low:.17g}",
        f"-bracket_rotate {words(turn)}" if turn else "",
        model("bracket", of, kind, formulation=formulation),
        joined(box("block", (6, 6, 2), (-0.03, -0.03, -0.02), (0.03, 0.03, 0)), model("block", of, "I"), "-contact_pairs bracket:block") if with_block else "",
        f"-obstacles t {plane('t', (0, 0, 0), (0, 0, 1))} -contact_pairs bracket:t" if partner == "plane" else "",
        "-contact_pairs none" if partner is None else "",
        friction(mu) if partner else "",
        more,
    )


def stack(n=10, kind="I", of="linear_elastic", mu=0.3, speed=5.0, step=2e-6, end=2e-4, faces=16, more=""):
    """Sheets of 80 mm x 1 mm, one element thick, that lie on each other, 1 um apart; the lowest on a plane, the uppermost hit by a block of 10 mm. Plane strain."""
    names = [f"s{k}" for k in range(n)]
    chain = ["t", *names, "block"]
    bodies = [joined(box(name, (faces, 1), (-0.04, k * 1.001e-3 + 1e-6), (0.04, k * 1.001e-3 + 1.001e-3)), model(name, of, kind)) for k, name in enumerate(names)]
    top = n * 1.001e-3 + 1e-6
    return joined(
        f"-bodies {','.join(names)},block -obstacles t {plane('t', (0, 0), (0, 1))} -time_step {step:.17g} -time_end {end:.17g}",
        f"-contact_pairs {','.join(f'{b}:{a}' for a, b in pairwise(chain))}",
        *bodies,
        joined(box("block", (4, 4), (-0.005, top), (0.005, top + 0.01)), model("block", "linear_elastic", kind), f"-block_initial_velocity 0,{-speed}"),
        friction(mu),
        more,
    )


TUBE, WALL = 20e-3, 1e-3  # m, mean radius and wall


def crushed(mesh, layers, faces, of="neo_hookean", kind="I", mu=0.3, closing=0.012, end=4e-3, step=1e-5, formulation=None, more=""):
    """The section of a tube, in plane strain, on a plane; a rigid plate above it goes down by `closing`, at first slowly."""
    hollows.ring(mesh, TUBE - WALL / 2, TUBE + WALL / 2, faces, layers)
    top = TUBE + WALL / 2
    way = f"0,-{closing:g}*(t/{end:g})^2*(2-t/{end:g})"
    return joined(
        f"-bodies tube,plate -obstacles t {plane('t', (0, -top - 1e-6), (0, 1))} -contact_pairs tube:t,tube:plate -contact_facing false",
        f"-time_step {step:.17g} -time_end {end:.17g} -tube_dm_plex_filename {mesh}",
        model("tube", of, kind, formulation=formulation),
        f"-tube_damping_mass 2000 {box('plate', (4, 1), (-0.03, top + 1e-6), (0.03, top + 0.005))} -plate_rigid true -plate_density 7800",
        f"-plate_rigid_displacement {way} -plate_rigid_rotation 0",
        friction(mu),
        more,
    )


def between_tools(kind="I", of="linear_elastic", mu=0.2, step=1e-6, end=3e-3, speed=0.5, pressure=1e7, more=""):
    """A sheet of 60 mm x 1 mm, one element thick, between two rigid tools of 20 mm, of which the upper presses; its right end is drawn, at first slowly. Plane strain. Damped in
    proportion to the stiffness, as sliding excites an undamped one."""
    tools = {"lower": ((-0.01, -0.0105), (0.01, -5e-4 - 1e-7)), "upper": ((-0.01, 5e-4 + 1e-7), (0.01, 0.0105))}
    way = f"{speed}*t*min(t/1e-3,1)/2+{speed / 2}*max(t-1e-3,0)"
    return joined(
        f"-bodies sheet,lower,upper -contact_pairs sheet:lower,sheet:upper -time_step {step:.17g} -time_end {end:.17g}",
        box("sheet", (60, 1), (-0.03, -5e-4), (0.03, 5e-4)),
        model("sheet", of, kind),
        f"-sheet_damping_stiffness {2e-6 if kind == 'I' else 2e-8} -sheet_boundary_displacement xmax -sheet_boundary_displacement_xmax {way},0",
        *(f"{box(name, (4, 2), *corners)} -{name}_rigid true -{name}_density 7800 -{name}_rigid_rotation 0" for name, corners in tools.items()),
        "-lower_rigid_displacement 0,0 -upper_rigid_displacement 0,free",
        f"-upper_boundary_traction ymax -upper_boundary_traction_ymax 0,-{pressure}*min(t/2e-4,1)",
        friction(mu),
        more,
    )
