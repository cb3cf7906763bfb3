"""Two bars that meet head on: in one dimension, or of quadrilaterals or hexahedra that lie in space as may be.

Poisson's ratio is 0, so that the solution is plane, and all methods find the same forces per area, whether the nodes across the bars match or not.
The bars move as a pair, and meet after 0.18 of a controller step: nothing is so symmetric that the first sweep would have it right.
"""

import numpy as np
from setups import rotation

WIDTH = 0.01  # of the square cross-section [m]
ENDS = {"l": (-0.2700737, -0.0200737), "r": (0.02, 0.27)}  # a gap of 0.0400737 m, closed at 200 m/s: after 2.003685e-4 s, 0.18 of a step
SPEEDS = {"l": 150, "r": -50}
ELEMENTS = 25
# per shape: dimension, axis and angle, elements across the left and the right bar
SHAPES = {
    "quad4": (2, (0, 0, 1), 0, 2, 2),
    "quad4-turned": (2, (0, 0, 1), 33, 2, 3),
    "quad4-over": (2, (0, 0, 1), -110, 2, 1),
    "hex8": (3, (0, 0, 1), 0, 1, 1),
    "hex8-turned": (3, (1, -2, 0.7), 71, 2, 1),
    "hex8-over": (3, (-0.3, 0.2, 1), 203, 1, 2),
}
NORMAL = {shape: rotation(axis, degrees)[:dim, 0] for shape, (dim, axis, degrees, *_) in SHAPES.items()}
TIMES = "-time_start -2e-4 -time_end 8e-4"
PENALTY = 7.5e10  # per area [N/m^3]


def bar(b):
    low, high = ENDS[b]
    return f"-{b}_dm_plex_dim 1 -{b}_dm_plex_box_faces {ELEMENTS} -{b}_dm_plex_box_lower {low} -{b}_dm_plex_box_upper {high} -{b}_cross_section {WIDTH**2} -{b}_initial_velocity {SPEEDS[b]}"


def solid(b, shape):
    dim, axis, degrees, *across = SHAPES[shape]
    low, high = ENDS[b]
    n = across["lr".index(b)]
    words = [f"-{b}_dm_plex_dim {dim} -{b}_dm_plex_box_faces {','.join([str(ELEMENTS)] + [str(n)] * (dim - 1))}"]
    words.append(f"-{b}_dm_plex_box_lower {low}{',0' * (dim - 1)} -{b}_dm_plex_box_upper {high}{f',{WIDTH}' * (dim - 1)}")
    words.append(f"-{b}_rotate {degrees if dim == 2 else ','.join(map(str, (*axis, degrees)))} -{b}_initial_velocity {','.join(f'{SPEEDS[b] * c:.17g}' for c in NORMAL[shape])}")
    words.append(f"-{b}_mass_moments centre")  # as in one dimension, where nothing turns
    if dim == 2:
        words.append(f"-{b}_thickness {WIDTH}")
    return " ".join(words)


def options(shape, more, pairs=None):
    bodies = [(solid(b, shape) if shape in SHAPES else bar(b)) + f" -{b}_density 1000 -{b}_youngs_modulus 1e9" for b in "lr"]
    pairs = pairs or ("l.xmax:r.xmin" if shape in SHAPES else "l:r")
    return " ".join(["-bodies l,r -contact_pairs", pairs, TIMES, *bodies, "-time_step 2e-6", more.format(penalty=PENALTY * (1 if shape in SHAPES else WIDTH**2))])


def figures(run, shape):
    """Over time: forces, energies, and what lies along the bars."""
    normal = NORMAL.get(shape, np.ones(1))
    history = run.history
    pair = next(iter(history["contact"].values()))
    found = {"force": pair["force"][()], "area": pair["area"][()], "touching": (pair["active"][()] > 0).astype(float)}
    for b in "lr":
        body = history[f"body/{b}"]
        found |= {f"{name} {b}": body[name][()] for name in ("kinetic", "potential")}
        for name in ("contact_velocity", "mean_velocity", "momentum"):
            found[f"{name} {b}"] = body[name][()].reshape(len(found["force"]), -1)[:, : len(normal)] @ normal
    return found


def compare(one, other, within):
    for name, expected in one.items():
        scale = np.abs(expected).max()
        assert scale > 0
        np.testing.assert_allclose(other[name], expected, rtol=0, atol=within * scale, err_msg=name)
