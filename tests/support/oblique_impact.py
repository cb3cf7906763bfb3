"""Oblique elastic impact of a sphere with friction, integrated independently of Impakt: N. Maw, J. R. Barber, J. N. Fawcett, The oblique impact of elastic spheres,
Wear 38 (1976). They divide the contact into annuli, each of which sticks or slides, under Hertz's pressure, with the compliance across after Cattaneo and Mindlin,
which does not couple with that along the normal. Here these equations are integrated in the form that the method of dimensionality reduction gives them (V. L. Popov,
M. Hess, Method of dimensionality reduction in contact mechanics and friction, 2015; I. A. Lyashenko, V. L. Popov, Scientific Reports 5, 2015): springs in a row,
dx apart, under the profile x^2/R, with stiffnesses E* dx and G* dx, each of which slides where its force across is mu times the one along the normal."""

import numpy as np


def oblique_impact(ratio, friction, tangent, steps=2000, springs=400):
    """Velocity across, spin times radius, both by the velocity across before, and coefficient of restitution. `ratio`: G*/E*, of equal materials 2 (1 - nu)/(2 - nu);
    `tangent`: velocity across by that along the normal, before; solid sphere, no spin before. Units: mass, radius and E* are 1; the result does not depend on the speed."""
    normal = speed = 1e-3
    deepest = (15 / 16 * speed**2) ** 0.4
    dt = 2.94 * deepest / speed / steps
    x = (np.arange(springs) + 0.5) / springs * 1.02 * np.sqrt(deepest)
    dx, inertia = x[1] - x[0], 0.4
    way, across, spin, start = 0.0, speed * tangent, 0.0, speed * tangent
    moved = np.zeros(springs)
    while True:
        middle = way + 0.5 * dt * normal
        new = normal - dt * 2 * dx * np.maximum(middle - x**2, 0).sum()
        way += 0.5 * dt * (normal + new)
        normal = new
        if way <= 0:
            return across / start, spin / start, -normal / speed
        pressed = np.maximum(way - x**2, 0)
        bound = friction * pressed / ratio
        moved = np.clip(np.where(pressed > 0, moved + dt * (across + spin), 0), -bound, bound)
        force = -2 * ratio * dx * moved.sum()
        across += dt * force
        spin += dt * force / inertia
