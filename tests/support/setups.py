"""Options of bodies and obstacles that are boxes and planes, and formulas of displacements that are linear in space."""

import numpy as np

# The fields at the start and at the end of a run
FIELDS = "-output_fields fields.h5 -output_fields_precision double -output_fields_interval 1000000"


def rotation(axis, degrees):
    """Rodrigues's formula, of the right-hand rotation about an axis."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def words(values):
    return ",".join(f"{value:.17g}" for value in values)


def plane(name, point, normal):
    return f"-{name}_obstacle_type plane -{name}_point {words(point)} -{name}_normal {words(normal)}"


def box(name, faces, lower, upper, more=""):
    return f"-{name}_dm_plex_dim {len(lower)} -{name}_dm_plex_box_faces {','.join(map(str, faces))} -{name}_dm_plex_box_lower {words(lower)} -{name}_dm_plex_box_upper {words(upper)} {more}"


def material(name, e=1, nu=0.25, rho=1, more=""):
    return f"-{name}_youngs_modulus {e} -{name}_poissons_ratio {nu} -{name}_density {rho} {more}"


def linear(gradient, origin, factor=""):
    """Formulas of the displacement G (x - x0)."""
    dim = len(origin)
    terms = ["+".join(f"({gradient[i, j]:.17g})*({'xyz'[j]}-({origin[j]:.17g}))" for j in range(dim)) for i in range(dim)]
    return ",".join(f"{factor}({term})" for term in terms)
