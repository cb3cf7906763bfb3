"""Manufactured solutions: order 2 in space and in time, for every shape and integrator."""

import numpy as np
import pytest
from cases import long, validate
from solidmeshes import LINEAR, SHAPES, dim_of, made_by_options, sides

E, NU, RHO = 8.0, 0.3, 2.0
LAMBDA, MU = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
COMMON = f"-bodies b -b_density {RHO} -b_youngs_modulus {E} -b_poissons_ratio {NU}"
OMEGA = 3.0


def box(shape, n):
    dim = dim_of(shape)
    return f"-b_dm_plex_dim {dim} {made_by_options(shape)} -b_dm_plex_box_faces {','.join([str(n)] * dim)}"


def error(impakt, options):
    return impakt(options).summary["bodies"]["b"]["displacement_error"]


def orders(errors):
    return np.log2(np.array(errors[:-1]) / errors[1:])


def standing(dim, w):
    """u = f phi a, f = sin(w t)^3, which starts smoothly, phi = sin(pi x) sin(pi y) [sin(pi z)]. With the
    Hessian H of phi, div sigma = mu lap u + (lambda + mu) grad div u = f (-mu dim pi^2 phi a + (lambda + mu) H a), also in plane strain;
    the body force is rho u'' - div sigma, with f'' = w^2 (6 sin(w t) - 9 sin(w t)^3)."""
    axes = "xyz"[:dim]
    a = [0.3, -0.2, 0.1][:dim]
    f, acceleration = f"sin({w}*t)^3", f"{w**2}*(6*sin({w}*t)-9*sin({w}*t)^3)"
    square = float(np.pi**2)

    def product(cosines=()):
        return "*".join(f"{'cos' if axis in cosines else 'sin'}({np.pi!r}*{axis})" for axis in axes)

    force = []
    for i in range(dim):
        terms = [f"({RHO * a[i]!r}*{acceleration}+({((dim + 1) * MU + LAMBDA) * square * a[i]!r})*{f})*{product()}"]
        terms += [f"({-(LAMBDA + MU) * square * a[j]!r})*{f}*{product((axes[i], axes[j]))}" for j in range(dim) if j != i]
        force.append("+".join(terms))
    return ",".join(force), ",".join(f"({c})*{f}*{product()}" for c in a)


# Edge of the box [m] and elements along it in the finest of three meshes. Tetrahedra take more of them for a wave until their order shows
BOXES = {"tri3": (1, 32), "quad4": (1, 32), "tet4": (0.4, 8), "hex8": (1, 12), "tri6": (1, 16), "tet10": (0.4, 8)}
# Least orders from the first mesh to the second, and to the third. Tetrahedra are on their way to 2 from below: measured 1.80 and 1.92 for tet4, 1.66
# and 1.83 for tet10, which has a third of its error; tri6 has 1.86 and 1.95, others 1.92 to 2.00
ORDERS = {"tet4": (1.75, 1.9), "tri6": (1.85, 1.9), "tet10": (1.65, 1.8)}


@pytest.mark.parametrize(
    ("shape", "ts"),
    [
        *((shape, "alpha2 averaged") for shape in ("quad4", "tet4", "tri6")),
        *long(("tri3", "alpha2 averaged"), ("hex8", "alpha2 averaged"), ("tet10", "alpha2 averaged"), ("quad4", "centraldifference lumped")),
        *validate(*((shape, "centraldifference lumped") for shape in ("tri3", "tet4", "hex8", "tri6"))),
    ],
)
def test_space(impakt, shape, ts):
    """The exact displacement on the boundary. The step shrinks with the elements, so that this is order 2 in both."""
    edge, finest = BOXES[shape]
    dim = dim_of(shape)
    force, exact = standing(dim, 1 / edge)
    names = sides(shape)
    held = f"-b_boundary_displacement {','.join(names)} " + " ".join(f"-b_boundary_displacement_{name} {exact}" for name in names)
    ts, mass = ts.split()
    errors = []
    for n in (finest // 4, finest // 2, finest):
        step = edge / (n * (2 if ts == "alpha2" else 14))
        options = f"{COMMON} {box(shape, n)} -b_dm_plex_box_upper {','.join([str(edge)] * dim)} {held} -b_body_force {force} -b_exact_displacement {exact}"
        errors.append(error(impakt, f"{options} -b_ts_type {ts} -b_mass_type {mass} -time_step {step!r} -time_end {edge}"))
    first, last = ORDERS.get(shape, (1.9, 1.9))
    assert orders(errors)[0] >= first
    assert orders(errors)[-1] >= last
    assert errors[-1] < 0.01  # measured: 0.0078 at most


def homogeneous(dim, material):
    """u = f a x, f = sin(OMEGA t) + 1 - cos(OMEGA t), held at x = 0: a homogeneous deformation, which every mesh has exactly,
    with an acceleration from the start. Traction P N on the other sides; body
    force rho u''. F = I + f a (x) e_x, J = 1 + f a_x, F^-T = I - (f / J) e_x (x) a, and neo-Hookean
    P N = mu (F - F^-T) N + lambda/2 (J^2 - 1) F^-T N with F N - N = f N_x a and F^-T N = N - (f / J) (a . N) e_x."""
    axes = "xyz"[:dim]
    a = [0.2, 0.1, -0.15][:dim]
    f = f"(sin({OMEGA}*t)+1-cos({OMEGA}*t))"
    dot = "(" + "+".join(f"({c})*n{axis}" for c, axis in zip(a, axes)) + ")"
    traction = []
    for i in range(dim):
        normal, along = f"n{axes[i]}", float(i == 0)
        if material == "linear_elastic":  # lambda tr(eps) N + mu (N_x a + (a . N) e_x)
            traction.append(f"{f}*({LAMBDA * a[0]!r}*{normal}+{MU!r}*(({a[i]})*nx+{along}*{dot}))")
        else:
            J = f"(1+{a[0]}*{f})"
            inverse = f"({normal}-{along}*{f}/{J}*{dot})"
            traction.append(f"{MU!r}*({normal}+({a[i]})*{f}*nx-{inverse})+{LAMBDA / 2!r}*({J}^2-1)*{inverse}")
    force = ",".join(f"({RHO * OMEGA**2 * c!r})*x*(cos({OMEGA}*t)-sin({OMEGA}*t))" for c in a)
    velocity = ",".join(f"({OMEGA * c!r})*x" for c in a)
    return ",".join(traction), force, velocity, ",".join(f"({c})*x*{f}" for c in a)


STEPS = [0.04, 0.02, 0.01]
INTEGRATORS = [
    ("alpha2", "linear_elastic"),
    ("midpoint", "neo_hookean"),
    ("dissipative", "neo_hookean"),
    ("centraldifference", "linear_elastic"),
    ("explicit-consistent", "linear_elastic"),
    ("centraldifference", "neo_hookean"),
]


def turn(k):
    """Each integrator once, on the shape that is its own in this turn."""
    return [(shape, *INTEGRATORS[(i + k) % 6]) for i, shape in enumerate(SHAPES)]


@pytest.mark.parametrize(("shape", "ts", "material"), [*turn(0), *long(*turn(1), *turn(3)), *validate(*turn(2), *turn(4), *turn(5))])
def test_time(impakt, shape, ts, material):
    """Body force and inertia of a linear displacement balance for consistent mass on any mesh; for lumped mass, at inner nodes of uniform
    meshes, the others being held. The finest step also as four substeps of a controller step: the same error."""
    dim = dim_of(shape)
    traction, force, velocity, exact = homogeneous(dim, material)
    names = sides(shape)
    options = f"{COMMON} -b_material_type {material} -b_body_force {force} -b_initial_velocity {velocity} -b_exact_displacement {exact} -time_end 0.8"
    if ts == "centraldifference":
        options += f" {box(shape, 2 if shape in LINEAR else 4)} -b_ts_type {ts} -b_mass_type lumped -b_boundary_displacement {','.join(names)} "
        options += " ".join(f"-b_boundary_displacement_{name} {exact}" for name in names)
    else:
        alpha = {"alpha2": "", "midpoint": "-b_ts_alpha_alpha_m 0.5 -b_ts_alpha_alpha_f 0.5", "dissipative": "-b_ts_alpha_radius 0.8", "explicit-consistent": "-b_ts_type centraldifference"}[ts]
        options += f" {box(shape, 2)} {alpha} -b_mass_type consistent -b_boundary_displacement xmin -b_boundary_displacement_xmin {','.join('0' * dim)} "
        options += f"-b_boundary_traction {','.join(names[1:])} " + " ".join(f"-b_boundary_traction_{name} {traction}" for name in names[1:])
    errors = [error(impakt, f"{options} -time_step {step}") for step in STEPS]
    substeps = error(impakt, f"{options} -time_step {4 * STEPS[-1]} -b_ts_time_step {STEPS[-1]}")
    assert min(orders(errors)) >= 1.9
    assert errors[-1] > 1e-6  # far above rounding
    assert substeps == pytest.approx(errors[-1], rel=1e-8)  # measured: 3.7e-11
