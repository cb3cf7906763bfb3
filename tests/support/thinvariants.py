"""Random variants of thin bodies for tests/contact/step/test_variants.py: sheets and plates, an L-bracket, a tube, on an obstacle, on a block, on each other; sheets pressed on each
other, or on blocks, by loads."""

import math
from itertools import pairwise
from types import SimpleNamespace

import hollows
import numpy as np
from cases import joined
from contactstep import MM_T_S, SI, STEEL, friction, turned
from setups import box, linear, plane, words
from thinbodies import bracket, in_tetrahedra, model
from thinbodies import turned as about

SHEET = 1e-3  # m, its thickness; the block that it meets is ten times as thick
SCENES = ("sheet on plane", "sheet on block", "stack", "sheet between", "plate", "bracket", "tube")
PLAIN = 0.4  # of the size of an element over the speed of waves, 5870 m/s in steel: an explicit step of all formulations
WAVE = 5870
PRESSED = 1e-4  # strain of bodies that loads press on each other: 22 MPa in steel, which moves a sheet without contact by half its thickness in steps of 2e-5 s
HALF = 0.012  # m, half of their width
FACES = {"sheet on block": ("a", "b"), "stack": ("a", "b"), "sheet between": ("a", "c")}  # the bodies with the loads, on their outer faces


def pressed(scene, names, turn, units, at_rest, pulse, frame):
    """Options, and the force on the first, of bodies in plane strain that lie on each other without gaps, as wide as each other, at rest under loads on the outer faces: uniaxial stress. Unless all is `at_rest`, a
    pulse of +-2 m/s, `pulse` degrees from the faces, starts in the middle of the first."""
    e, nu, _ = STEEL
    modulus, axes = e / (1 - nu**2), turned(np.eye(2), turn)
    strain = axes @ np.diag((nu / (1 - nu) * PRESSED, -PRESSED)) @ axes.T
    load = -axes[:, 1] * modulus * PRESSED * units[1] / units[0]
    (top, bottom), along = FACES[scene], axes[:, 0] / units[0]
    place = f"(({along[0]:.17g}*x+{along[1]:.17g}*y)/0.004)"
    bump = f"2.33*{place}*exp(-{place}^2)"  # without momentum, so that none slides off the other
    hit = 0 * frame if at_rest else turned((2, 0), turn + pulse) * units[0]
    options = [f"-{name}_initial_displacement {linear(strain, (0, 0))}" for name in names]
    options += [f"-{name}_boundary_traction {face} -{name}_boundary_traction_{face} {words(sign * load)}" for name, face, sign in ((top, "ymax", 1), (bottom, "ymin", -1))]
    starts = [",".join(f"{v:.17g}+({h:.17g})*{bump}" for v, h in zip(frame, hit, strict=True))] + [words(frame)] * (len(names) - 1)
    options += [f"-{name}_initial_velocity {start}" for name, start in zip(names, starts, strict=True)]
    return joined(*options), 2 * HALF * units[0] ** 2 * load


def scaled(box_of, units):
    name, faces, low, high = box_of
    return box(name, faces, [x * units[0] for x in low], [x * units[0] for x in high])


def parts_of(scene, layers, gap, half=None):
    """Boxes, or names of meshes; the first falls on the next, and so on. `half`: half of the width of all, where loads press them on each other."""
    wide = lambda left, right: (-half, half) if half else (left, right)
    flat = lambda name, faces, left, right, low, high: (name, faces, (wide(left, right)[0], low), (wide(left, right)[1], high))
    upper = flat("a", (20, layers), -0.02, 0.02, gap, gap + SHEET)
    return {
        "sheet on plane": [upper],
        "sheet on block": [upper, flat("b", (8, 4), -0.012, 0.012, -0.01, 0)],
        "stack": [upper, flat("b", (16, layers), -0.015, 0.015, -SHEET, 0)],
        "sheet between": [
            flat("a", (4, 4), -0.006, 0.006, gap, gap + 0.01),
            flat("b", (20, layers), -0.02, 0.02, -SHEET, 0),
            flat("c", (4, 4), -0.004, 0.008, -0.01 - SHEET - gap, -SHEET - gap),
        ],
        "plate": [("a", (6, 6, layers), (-0.01, -0.01, gap), (0.01, 0.01, gap + 2e-3)), ("b", (3, 3, 3), (-0.006, -0.006, -0.008), (0.006, 0.006, 0))],
    }.get(scene, [("a",)])


def thin_variant(draw, folder):
    """What `draw`, a random.Random, draws: options, and what the checks have to know of them. Meshes go to `folder`."""
    scene, of, mu = draw.choice(SCENES), draw.choice(("linear_elastic", "linear_elastic", "neo_hookean", "j2")), draw.choice((0, draw.uniform(0, 0.8)))
    layers, swap, units = draw.choice((1, 1, 2)), draw.random() < 0.5, draw.choice((SI, SI, MM_T_S)) if scene not in ("bracket", "tube") else SI
    gap, speed, across = 10 ** draw.uniform(-6, -5), 10 ** draw.uniform(-0.3, 1.2), draw.uniform(-3, 3)
    turn, frame = draw.choice((0, draw.uniform(0, 360))), draw.choice(((0, 0), (draw.uniform(-20, 20), draw.uniform(-20, 20))))
    step, ranks = 1e-6 * 10 ** draw.uniform(math.log10(0.2), math.log10(20)), draw.choice((1, 1, 2, 3))
    solid, edge = scene in ("plate", "bracket"), 2e-3 if scene in ("plate", "bracket") else SHEET / layers
    obstacle = scene in ("sheet on plane", "bracket", "tube")
    tets = scene == "bracket" and draw.random() < 0.3
    names = [part[0] for part in parts_of(scene, layers, gap)]
    kinds = "E" if tets else "".join(draw.choice("IE") for _ in names)  # implicit steps of these take minutes
    if solid or of != "linear_elastic":
        step = max(step, 1e-6)
    stable = PLAIN * (0.7 * edge if tets else edge if scene != "plate" else 2e-3 / layers) / WAVE
    if obstacle and kinds == "E":
        step = min(step, stable)  # a body with an obstacle meets it in each of its substeps
    least = {name: math.ceil(step / stable) if kind == "E" else 1 for name, kind in zip(names, kinds, strict=True)}
    substeps = [1] if obstacle else [round(math.exp(draw.uniform(math.log(n), math.log(max(n, 200 if kind == "E" else 3))))) for n, kind in zip(least.values(), kinds, strict=True)]
    while len(substeps) > 1 and math.gcd(*substeps) > 1:
        substeps[kinds.find("E")] += 1  # contact makes a step of its own for each common part of all
    loads, at_rest, pulse, axis = scene in FACES and draw.random() < 0.4, draw.random() < 0.3, draw.uniform(0, 180), [draw.gauss(0, 1) for _ in range(3)]
    angle, shift = draw.choice((0, draw.uniform(0, 360))), np.array([draw.uniform(-0.05, 0.05) for _ in range(3)])
    if loads:
        gap = 0
        steps = min(math.ceil(1e-2 / step), 400 if of == "linear_elastic" else 60, math.ceil((10000 if of == "linear_elastic" else 1500) / max(substeps)))
    else:
        most = 15 if solid else 25 if of != "linear_elastic" else 50
        steps = math.ceil(gap / speed / step) + min(math.ceil(1e-4 / step), most, math.ceil(3000 / max(substeps)))
    spin = (lambda vector: about(np.array([vector], float), axis, angle)[0]) if solid else (lambda vector: turned(vector, turn))
    rotation = f"{words(axis)},{angle:.17g}" if solid and angle else turn if turn and not solid else ""
    down = spin((across, 0.3 * across, -speed) if solid else (across, -speed))
    shared = (spin((*frame, 0)) if solid else np.array(frame)) * (not obstacle)
    bodies = []
    for place, (part, kind, n) in enumerate(zip(parts_of(scene, layers, gap, HALF if loads else None), kinds, substeps, strict=True)):
        name, start = part[0], (shared + (down if place == 0 else 0)) * units[0]
        if scene == "bracket":
            mesh = bracket(folder / "bracket.msh", 2e-3)
            mesh = in_tetrahedra(mesh, folder / "tets.msh") if tets else mesh
            bodies.append(f"-{name}_dm_plex_filename {mesh} -{name}_translate {words(spin((0, 0, gap)) + shift)}")
        elif scene == "tube":
            mesh = hollows.ring(folder / "tube.msh", 9e-3, 1e-2, 40, layers)
            bodies.append(f"-{name}_dm_plex_filename {mesh}")
        else:
            bodies.append(scaled(part, units))
            bodies.append(f"-{name}_translate {words(shift * units[0])}" if solid else f"-{name}_thickness {units[0]:.17g}")
        metre, kilogram = units
        e, nu, rho = STEEL
        composite = "composite" if tets else None
        bodies += [
            model(name, of, kind, e * kilogram / metre, 3e8 * kilogram / metre, nu, rho * kilogram / metre**3, composite),
            f"-{name}_initial_velocity {words(start)}" if np.any(start) and not loads else "",
            f"-{name}_rotate {rotation}" if rotation else "",
            f"-{name}_ts_time_step {step / n:.17g}",
        ]
    # Sides are swapped of bodies only: an obstacle has no nodes
    touching = ["a:t"] if obstacle else [f"{y}:{x}" if swap else f"{x}:{y}" for x, y in pairwise(names)]
    lowest = shift if solid else spin((0, -1e-2 - gap if scene == "tube" else 0))
    up = spin((0, 0, 1) if solid else (0, 1))
    loaded, force = pressed(scene, names, turn, units, at_rest, pulse, shared * units[0]) if loads else ("", 0)
    options = joined(
        f"-bodies {','.join(names)} -contact_type force -contact_pairs {','.join(touching)} -time_step {step:.17g} -time_end {steps * step:.17g}",
        f"-obstacles t {plane('t', lowest, up)}" if obstacle else "",
        *bodies,
        loaded,
        "-units mm-t-s" if units == MM_T_S else "",
        friction(mu),
    )
    way = 0.5 * STEEL[0] / (1 - STEEL[1] ** 2) * PRESSED / (STEEL[2] * SHEET) * step**2  # m, that loads move a sheet without contact in a step
    v = SimpleNamespace(scene=scene, names=names, kinds=kinds, of=of, step=step, substeps=substeps, mu=mu, ranks=ranks, steps=steps, units=units, options=options, load=force, way=way * units[0], speed=speed, pressed=loads, at_rest=loads and at_rest)
    # Of two elements, inner nodes span an implicit body around one of its faces, not around both; explicit ones keep their mass all the same. The coarse tube is spanned by
    # the arc of its inner nodes: it loses 0.1 % where it loses 3.5 to 15 % with its mass kept.
    flat = kinds if scene == "stack" else kinds[0]
    thin = layers == 1 or scene in ("sheet between", "bracket") or "E" in flat
    if scene == "tube":
        thin = kinds == "E" and layers == 1
    v.rule, v.massless, v.free, v.edge, v.turns = "impulse" if thin else "linear", [not thin], names, edge, (5e-5, 1e-3)
    v.newton = 2e-5  # the impulse of contact with friction, in steps cut for their energy, measured 7.8e-6, of another seed 3.4e-6 as with `schwarz` (6e-10 without friction); momenta of both add up to 4e-14
    v.rows, v.other, v.normal = int(swap), int(not swap), turned((0, 1 if swap else -1), turn)
    if scene == "sheet on plane":
        v.rows, v.other, v.normal = 0, None, turned((0, -1), turn)
    elif scene not in ("sheet on block", "stack"):
        v.normal = None
    return v
