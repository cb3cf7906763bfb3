"""A nearly incompressible block in plane strain between bonded plates, by mixed elements: the reference that pressed rubber is compared with.

Displacements of nine nodes and a linear, discontinuous pressure in each element (Q2/P1, which is stable: M. Fortin, F. Brezzi, Mixed and hybrid finite element
methods, 1991), isochoric neo-Hookean with W = mu/2 (J^(-2/3) I1 - 3) + kappa/4 (J^2 - 1 - 2 ln J), where the pressure is a field of its own and J is
the change of volume at that pressure, kappa/2 (J - 1/J) = p, in the mean with each pressure function. Newton's method with the exact tangent, dense matrices. A quarter of the block: x = 0 and y = 0 are planes of symmetry,
nodes of y = height are bonded, x = width is free. Nothing of it is Impakt's.
"""

import numpy as np


def graded(count, length, power):
    """Edges of elements that become finer towards the end."""
    return length * (1 - (1 - np.linspace(0, 1, count + 1)) ** power)


def lagrange(s):
    """Quadratic shape functions of a line at s in [-1, 1], and their slopes."""
    return np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]), np.array([s - 0.5, -2 * s, s + 0.5])


def element_points():
    """Of 3 x 3 Gauss points: slopes of the nine functions, weights, pressure functions 1, s, t."""
    points, weights = np.polynomial.legendre.leggauss(3)
    slopes, pressures, total = [], [], []
    for t, wt in zip(points, weights):
        for s, ws in zip(points, weights):
            (fs, ds), (ft, dt) = lagrange(s), lagrange(t)
            slopes.append([np.outer(ft, ds).ravel(), np.outer(dt, fs).ravel()])
            pressures.append([1, s, t])
            total.append(ws * wt)
    return np.array(slopes), np.array(pressures), np.array(total)


def pair(a, b):
    return np.einsum("...ij,...kl->...ijkl", a, b)


def big(x):
    return x[..., None, None]


def stresses(F, mu):
    """Isochoric first Piola-Kirchhoff stress in the plane and its tangent, J, and its derivatives; F is an array of ... x 2 x 2."""
    J = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
    if J.min() <= 0:
        raise FloatingPointError("an element is inverted")
    cof = np.stack([np.stack([F[..., 1, 1], -F[..., 1, 0]], -1), np.stack([-F[..., 0, 1], F[..., 0, 0]], -1)], -2)
    dcof = np.zeros((2, 2, 2, 2))
    dcof[0, 0, 1, 1] = dcof[1, 1, 0, 0] = 1
    dcof[0, 1, 1, 0] = dcof[1, 0, 0, 1] = -1
    I1 = 1 + (F**2).sum((-1, -2))
    scale = (mu * J ** (-2 / 3))[..., None, None]
    ratio = (I1 / 3 / J)[..., None, None]
    P = scale * (F - ratio * cof)
    A = big(scale) * (
        pair(np.eye(2), np.eye(2)).transpose(0, 2, 1, 3)
        - big(ratio) * dcof
        - 2 / 3 / J[..., None, None, None, None] * (pair(F, cof) + pair(cof, F))
        + big(big(5 / 9 * I1 / J**2)) * pair(cof, cof)
    )
    return P, A, J, cof, dcof


class Block:
    def __init__(self, nx, ny, width=0.02, height=0.01, mu=1.0, kappa=5000.0, power=1.0):
        self.mu, self.kappa, self.height = mu, kappa, height
        xs, ys = graded(nx, width, power), graded(ny, height, power)
        fine = [np.sort(np.concatenate([e, (e[1:] + e[:-1]) / 2])) for e in (xs, ys)]
        columns = 2 * nx + 1
        self.nodes = np.array([(x, y) for y in fine[1] for x in fine[0]])
        self.cells = np.array([[(2 * j + b) * columns + 2 * i + a for b in range(3) for a in range(3)] for j in range(ny) for i in range(nx)])
        slopes, self.q, weights = element_points()
        map_ = np.einsum("pdn,enx->epdx", slopes, self.nodes[self.cells])
        self.gradients = np.einsum("epxd,pdn->epxn", np.linalg.inv(map_), slopes)  # e, p, x, n
        self.weights = np.linalg.det(map_) * weights
        x, y = self.nodes.T
        self.top = np.flatnonzero(y > height * (1 - 1e-9))
        held = np.zeros((len(x), 2), bool)
        held[x < 1e-12, 0] = held[y < 1e-12, 1] = held[self.top] = True
        self.free = np.flatnonzero(~held.ravel())
        self.dofs = (2 * self.cells[..., None] + [0, 1]).reshape(len(self.cells), 18)
        self.u, self.p = np.zeros_like(self.nodes), np.zeros((len(self.cells), 3))

    def system(self, u, p):
        """Residual of the displacements and tangent once pressures are condensed element by element, and what gives their increments."""
        F = np.eye(2) + np.einsum("eni,epxn->epix", u[self.cells], self.gradients)
        P, A, J, cof, dcof = stresses(F, self.mu)
        pressure = p @ self.q.T
        P = P + pressure[..., None, None] * cof
        A = A + pressure[..., None, None, None, None] * dcof
        w, g, n = self.weights, self.gradients, len(self.cells)
        f = np.einsum("ep,epix,epxn->eni", w, P, g).reshape(n, 18)
        K = np.einsum("ep,epixky,epxn,epym->enimk", w, A, g, g, optimize=True).reshape(n, 18, 18)
        B = np.einsum("ep,epix,epxn,pa->enia", w, cof, g, self.q, optimize=True).reshape(n, 18, 3)
        # kappa/2 (J - 1/J) = p is J = p / kappa + sqrt(1 + (p / kappa)^2)
        x = pressure / self.kappa
        volume = x + np.sqrt(1 + x**2)
        r = np.einsum("ep,pa->ea", w * (J - volume), self.q)
        M = np.einsum("ep,pa,pb->eab", w * (1 + x / np.sqrt(1 + x**2)) / self.kappa, self.q, self.q)
        Mi = np.linalg.inv(M)
        return f, K, B, r, Mi

    def step(self, top):
        """Newton's method to a displacement of the plate; its first step takes the plate along with all else, so that no layer bears it by itself."""
        change = np.zeros_like(self.u)
        change[self.top, 1] = top - self.u[self.top, 1]
        for iteration in range(30):
            f, K, B, r, Mi = self.system(self.u, self.p)
            BM = B @ Mi
            size = self.u.size
            k, residual = np.zeros((size, size)), np.zeros(size)
            np.add.at(k, (self.dofs[:, :, None], self.dofs[:, None, :]), K + BM @ B.transpose(0, 2, 1))
            np.add.at(residual, self.dofs, f + (BM @ r[..., None])[..., 0])
            du = change.ravel().copy()
            du[self.free] = np.linalg.solve(k[np.ix_(self.free, self.free)], -(residual + k @ du)[self.free])
            self.p = self.p + (Mi @ (r + (B.transpose(0, 2, 1) @ du[self.dofs][..., None])[..., 0])[..., None])[..., 0]
            self.u = self.u + du.reshape(self.u.shape)
            change[:] = 0
            if iteration and np.abs(du).max() <= 1e-11 * self.height:
                break
        else:
            raise FloatingPointError("Newton's method did not converge")
        forces = np.zeros(self.u.size)
        np.add.at(forces, self.dofs, self.system(self.u, self.p)[0])
        return forces.reshape(-1, 2)[self.top, 1].sum()

    def pressed(self, compression, steps=4):
        """Force on the upper plate [N/m] of the quarter."""
        for i in range(steps):
            force = self.step(-compression * self.height * (i + 1) / steps)
        return force
