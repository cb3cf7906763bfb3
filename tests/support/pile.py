"""Soft discs that fall on each other in a box and come to rest: many bodies that become one group."""

import math

RADIUS = 0.01  # m
STEP = 2.2e-4  # s
END = 0.35  # s
PITCH = 2.027e-2  # m: 16 nodes of a disc with its true area lie a little outside its radius


def pile(rows, columns, *, youngs_modulus=2e4, step=STEP, end=END, damping=60, slack=2e-4, lift=2e-3, more=""):
    """Options of rows x columns discs, each row on the gaps of the one below.

    Neo-Hookean discs of 64 elements, explicit, density 1000 kg/m^3. `slack`: gap between neighbours of a row, relative to their
    distance; `lift`: air below each row [m]; `damping` [1/s]: of their mass (Rayleigh). They lie off their places by some
    micrometres, so that they do not all meet at once.
    """
    pitch, off = PITCH * (1 + slack), 0.5 * RADIUS * slack
    names = [f"d{i}" for i in range(rows * columns)]
    words = [f"-bodies {','.join(names)} -contact_pairs auto -contact_facing false -obstacles floor,x0,x1 -time_step {step} -time_end {end}"]
    for name, point, normal in (("floor", "0,0", "0,1"), ("x0", "0,0", "1,0"), ("x1", f"{(columns + 0.5) * pitch},0", "-1,0")):
        words.append(f"-{name}_obstacle_type plane -{name}_point {point} -{name}_normal {normal}")
    for i, name in enumerate(names):
        row, column = divmod(i, columns)
        x = pitch * (column + 0.5 + 0.5 * (row % 2)) + off * math.sin(5.0 * i)
        y = 1.02 * RADIUS + lift + (0.866 * pitch + lift) * row + off * math.cos(7.0 * i)
        words.append(
            f"-{name}_dm_plex_dim 2 -{name}_dm_plex_shape ball -{name}_ball_radius {RADIUS} -{name}_ball_centre {x},{y} -{name}_ball_divisions 4"
            f" -{name}_material_type neo_hookean -{name}_density 1000 -{name}_youngs_modulus {youngs_modulus} -{name}_poissons_ratio 0.25"
            f" -{name}_ts_type centraldifference -{name}_gravity 0,-9.81 -{name}_damping_mass {damping}"
        )
    return " ".join([*words, more])
