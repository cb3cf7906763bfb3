"""Oblique elastic impact of a sphere on a rigid plane with friction, integrated independently of Impakt, where pressure moves the surface across: that of a half space goes
towards the pressure, that of the plane does not. On squares with uniform tractions; displacements under these are integrals of those of Boussinesq and Cerruti under
point forces (K. L. Johnson, Contact mechanics, 1985, sections 3.2 and 3.6), in closed form over a square. Each square is open, sticks or slides (Coulomb); block
Gauss-Seidel. Of equal spheres the coupling cancels: then this is the theory of Maw, Barber and Fawcett, as in oblique_impact.py."""

import numpy as np


def influence(n, h, poisson, coupled):
    """Displacements [3 per square] under unit tractions, the first along the normal, of n x n squares with the edge h; the modulus E* is 1."""
    shear = (1 - poisson) / 2
    place = (np.arange(n) - (n - 1) / 2) * h
    x, y = (grid.ravel() for grid in np.meshgrid(place, place, indexing="ij"))
    dx, dy = x[:, None] - x, y[:, None] - y

    def square(function):
        return sum(p * q * function(dx + p * h / 2, dy + q * h / 2) for p in (-1, 1) for q in (-1, 1))

    first = square(lambda a, b: a * np.log(b + np.hypot(a, b)))  # of y^2/r^3
    second = square(lambda a, b: b * np.log(a + np.hypot(a, b)))  # of x^2/r^3
    mixed = square(lambda a, b: -np.hypot(a, b))  # of x y/r^3
    along = square(lambda a, b: b / 2 * np.log(a**2 + b**2) + a * np.arctan(b / a))  # of x/r^2
    across = square(lambda a, b: a / 2 * np.log(a**2 + b**2) + b * np.arctan(a / b))
    compliance = np.zeros((n * n, 3, n * n, 3))
    compliance[:, 0, :, 0] = (1 - poisson) * (first + second)
    compliance[:, 1, :, 1] = (1 - poisson) * (first + second) + poisson * second
    compliance[:, 2, :, 2] = (1 - poisson) * (first + second) + poisson * first
    compliance[:, 1, :, 2] = compliance[:, 2, :, 1] = poisson * mixed
    if coupled:
        for k, value in ((1, along), (2, across)):
            compliance[:, 0, :, k] = (1 - 2 * poisson) / 2 * value
            compliance[:, k, :, 0] = -compliance[:, 0, :, k]
    return compliance / (2 * np.pi * shear), x, y


def impact(poisson, friction, tangent, coupled=True, n=12, steps=80):
    """Velocity across, spin times radius, both by the velocity across before, and coefficient of restitution. `tangent`: velocity across by that along the normal,
    before; no spin before. Units: mass, radius and E* are 1; the result does not depend on the speed."""
    normal = before = 1e-3
    deepest = (15 / 16 * normal**2) ** 0.4
    edge, dt = 2.04 * np.sqrt(deepest) / n, 2.94 * deepest / normal / steps
    compliance, x, y = influence(n, edge, poisson, coupled)
    inside = np.hypot(x, y) < 1.06 * np.sqrt(deepest)
    columns = compliance[inside][:, :, inside].transpose(2, 0, 1, 3).copy()
    profile = (x[inside] ** 2 + y[inside] ** 2) / 2
    own = np.array([[column[i, k, k] for k in range(3)] for i, column in enumerate(columns)])
    force, moved = np.zeros((len(profile), 3)), np.zeros((len(profile), 3))
    way, speed, spin = 0.0, normal * tangent, 0.0
    while True:
        way, step, start = way + dt * normal, dt * (speed + spin), moved.copy()
        if way < 0:
            return speed / (before * tangent), spin / (before * tangent), -normal / before
        for _ in range(400):
            change = 0.0
            for i in range(len(profile)):
                pressure = max(0.0, force[i, 0] - (profile[i] - way + moved[i, 0]) / own[i, 0])
                if pressure == 0 == force[i, 0]:
                    continue
                trial = force[i, 1:] - (moved[i, 1:] - start[i, 1:] + (step, 0)) / own[i, 1:]
                size = np.hypot(*trial)
                new = np.array([pressure, *(trial * min(1.0, friction * pressure / size) if size > 0 else trial)])
                difference = new - force[i]
                force[i] = new
                moved += columns[i] @ difference
                change = max(change, np.abs(difference).max())
            if change <= 1e-7 * force.max():
                break
        total = force.sum(axis=0) * edge**2
        normal, speed, spin = normal - dt * total[0], speed + dt * total[1], spin + dt * total[1] / 0.4
