"""Random variants of thin bodies for tests/contact/step/test_variants.py: sheets and plates, an L-bracket, a tube, on an obstacle, on a block, on each other."""

import math
from itertools import pairwise
from types import SimpleNamespace

import hollows
import numpy as np
from cases import joined
from contactstep import MM_T_S, SI, STEEL, friction, turned
from setups import box, plane, words
from thinbodies import bracket, in_tetrahedra, model

SHEET = 1e-3  # m, its thickness; the block that it meets is ten times as thick
SCENES = ("sheet on plane", "sheet on block", "stack", "sheet between", "plate", "bracket", "tube")
PLAIN = 0.4  # of the size of an element over the speed of waves, 5870 m/s in steel: an explicit step of all formulations
WAVE = 5870


def scaled(box_of, units):
    name, faces, low, high = box_of
    return box(name, faces, [x * units[0] for x in low], [x * units[0] for x in high])


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
    parts = {  # name: box, or mesh; the first falls on the next, and so on
        "sheet on plane": [("a", (20, layers), (-0.02, gap), (0.02, gap + SHEET))],
        "sheet on block": [("a", (20, layers), (-0.02, gap), (0.02, gap + SHEET)), ("b", (8, 4), (-0.012, -0.01), (0.012, 0))],
        "stack": [("a", (20, layers), (-0.02, gap), (0.02, gap + SHEET)), ("b", (16, layers), (-0.015, -SHEET), (0.015, 0))],
        "sheet between": [
            ("a", (4, 4), (-0.006, gap), (0.006, gap + 0.01)),
            ("b", (20, layers), (-0.02, -SHEET), (0.02, 0)),
            ("c", (4, 4), (-0.004, -0.01 - SHEET - gap), (0.008, -SHEET - gap)),
        ],
        "plate": [("a", (6, 6, layers), (-0.01, -0.01, gap), (0.01, 0.01, gap + 2e-3)), ("b", (3, 3, 3), (-0.006, -0.006, -0.008), (0.006, 0.006, 0))],
        "bracket": [("a",)],
        "tube": [("a",)],
    }[scene]
    names = [part[0] for part in parts]
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
    most = 15 if solid else 25 if of != "linear_elastic" else 50
    steps = math.ceil(gap / speed / step) + min(math.ceil(1e-4 / step), most, math.ceil(3000 / max(substeps)))
    down = turned((across, -speed), turn) if not solid else np.array([across, 0.3 * across, -speed])
    shared = np.array((*frame, 0)[: len(down)]) if not obstacle else 0 * down
    bodies = []
    for place, (part, kind, n) in enumerate(zip(parts, kinds, substeps, strict=True)):
        name, start = part[0], (shared + (down if place == 0 else 0)) * units[0]
        if scene == "bracket":
            mesh = bracket(folder / "bracket.msh", 2e-3)
            mesh = in_tetrahedra(mesh, folder / "tets.msh") if tets else mesh
            bodies.append(f"-{name}_dm_plex_filename {mesh} -{name}_translate 0,0,{gap:.17g}")
        elif scene == "tube":
            mesh = hollows.ring(folder / "tube.msh", 9e-3, 1e-2, 40, layers)
            bodies.append(f"-{name}_dm_plex_filename {mesh}")
        else:
            bodies.append(scaled(part, units))
            bodies.append("" if solid else f"-{name}_thickness {units[0]:.17g}")
        metre, kilogram = units
        e, nu, rho = STEEL
        composite = "composite" if tets else None
        bodies += [
            model(name, of, kind, e * kilogram / metre, 3e8 * kilogram / metre, nu, rho * kilogram / metre**3, composite),
            f"-{name}_initial_velocity {words(start)}" if np.any(start) else "",
            f"-{name}_rotate {turn}" if turn and not solid else "",
            f"-{name}_ts_time_step {step / n:.17g}",
        ]
    touching = ["a:t"] if obstacle else [f"{y}:{x}" if swap else f"{x}:{y}" for x, y in pairwise(names)]
    lowest = (0, 0, 0) if scene == "bracket" else turned((0, -1e-2 - gap if scene == "tube" else 0), turn)
    up = (0, 0, 1) if scene == "bracket" else turned((0, 1), turn)
    options = joined(
        f"-bodies {','.join(names)} -contact_type force -contact_pairs {','.join(touching)} -time_step {step:.17g} -time_end {steps * step:.17g}",
        f"-obstacles t {plane('t', lowest, up)}" if obstacle else "",
        *bodies,
        "-units mm-t-s" if units == MM_T_S else "",
        friction(mu),
    )
    v = SimpleNamespace(scene=scene, names=names, kinds=kinds, of=of, step=step, substeps=substeps, mu=mu, ranks=ranks, steps=steps, units=units, options=options)
    # Of two elements, inner nodes span an implicit body around one of its faces, not around both; explicit ones keep their mass all the same. The coarse tube is spanned by
    # the arc of its inner nodes: it loses 0.1 % where it loses 3.5 to 15 % with its mass kept.
    flat = kinds if scene == "stack" else kinds[0]
    thin = layers == 1 or scene in ("sheet between", "bracket") or "E" in flat
    if scene == "tube":
        thin = kinds == "E" and layers == 1
    v.rule, v.massless, v.free, v.edge, v.turns = "impulse" if thin else "linear", [not thin], names, edge, (5e-5, 1e-3)
    v.newton = 2e-6  # the impulse of contact, in steps cut for their energy, measured 1e-6 with `schwarz` too; momenta of both add up to 3e-15
    v.rows, v.other, v.normal = int(swap), int(not swap), turned((0, 1 if swap else -1), turn)
    if scene == "sheet on plane":
        v.rows, v.other, v.normal = 0, None, turned((0, -1), turn)
    elif scene not in ("sheet on block", "stack"):
        v.normal = None
    return v
