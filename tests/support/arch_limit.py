"""Limit analysis of a semicircular arch of rigid blocks under its weight: whether there are forces in its joints that balance it. Mean radius and specific weight are 1.

An arch that is cut at its crown is statically determinate, and by symmetry the crown bears a thrust H and its moment about the centre alone. So each joint's forces are
linear in these two, and what its opening and Coulomb's law demand of them (centre of pressure within the joint, |T| <= mu N) are half-planes: there is an
equilibrium where all of them have a point in common. J. Heyman, The stone skeleton, International Journal of Solids and Structures 2 (1966); weights act at the
blocks' own centroids (Milankovitch 1907), not on the centre line.
"""

import numpy as np


def loads(blocks, thickness, facets):
    """Of the joints from the crown to the springing: angles, and weights above them and their moments about the centre. Each block is a polygon of some facets."""
    inner, outer, step = 1 - thickness / 2, 1 + thickness / 2, np.pi / blocks / facets
    middle = (np.arange(blocks * facets // 2) + 0.5) * step
    weight = np.full(middle.size, np.sin(step) / 2 * (outer**2 - inner**2))
    moment = np.sin(step) * np.cos(step / 2) / 3 * (outer**3 - inner**3) * np.sin(middle)
    assert blocks % 2 == 0
    count = np.arange(blocks // 2 + 1) * facets
    return count * step, *(np.concatenate([[0], np.cumsum(values)])[count] for values in (weight, moment))


def cut(polygon, normal, bound):
    """The part of a convex polygon in which normal.x <= bound."""
    side, kept = polygon @ normal - bound, []
    for i, (p, a) in enumerate(zip(polygon, side)):
        q, b = polygon[(i + 1) % len(polygon)], side[(i + 1) % len(polygon)]
        if a <= 0:
            kept.append(p)
        if a * b < 0:
            kept.append(p + (q - p) * a / (a - b))
    return np.array(kept)


def has_equilibrium(blocks, thickness, friction, facets=1):
    inner, outer, large = 1 - thickness / 2, 1 + thickness / 2, 10 * thickness
    polygon = np.array([[0, 0], [large, 0], [large, 2 * large], [0, 2 * large]])  # of thrust and moment
    for angle, weight, moment in zip(*loads(blocks, thickness, facets)):
        normal, of_weight = np.array([np.cos(angle), 0]), weight * np.sin(angle)  # N = H cos + W sin
        shear, across = np.array([-np.sin(angle), 0]), weight * np.cos(angle)  # T = W cos - H sin
        lever = np.array([0, 1])  # N times the radius of the centre of pressure = moment of H and of W
        for half_plane, bound in (
            (inner * normal - lever, moment - inner * of_weight),
            (lever - outer * normal, outer * of_weight - moment),
            (shear - friction * normal, friction * of_weight - across),
            (-shear - friction * normal, friction * of_weight + across),
        ):
            polygon = cut(polygon, half_plane, bound)
            if len(polygon) < 3:
                return False
    return True


def least(holds, low, high):
    """Where a condition begins to hold, which it does at `high`."""
    assert holds(high) and not holds(low)
    for _ in range(25):
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def least_thickness(blocks, friction, facets=1):
    return least(lambda thickness: has_equilibrium(blocks, thickness, friction, facets), 0.01, 0.4)


def least_friction(blocks, thickness, facets=1):
    return least(lambda friction: has_equilibrium(blocks, thickness, friction, facets), 0.1, 1)
