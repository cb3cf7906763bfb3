"""Draws the contact pressure between a liner and the shell that it is pressed into from within, beside the closed solution.

    python plots/tube_expansion.py out/tube-expansion.h5 figure.png

Small strains, plane strain, incompressible: the displacement is A / r everywhere, the equivalent strain of von Mises 2 A / (sqrt(3) r^2), and
sigma_theta - sigma_r = 2 / sqrt(3) times the equivalent stress. Integrated over the radius: R. Hill, The mathematical theory of plasticity (1950), chapter V.
"""

import sys

import numpy as np
from figures import BLUE, DASHED, command_line, history_file, labelled, scale
from impakt_results import read
from matplotlib.figure import Figure


def root(function, low, high):
    """Where a function that grows is zero, by bisection."""
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2


class Tubes:
    """Radii [m], moduli and strength [Pa] of a liner (a to b) and an elastic shell (b + clearance to d)."""

    def __init__(self, a, b, inner, d, modulus, shell_modulus, strength, hardening):
        self.a, self.b, self.inner, self.d = a, b, inner, d
        self.modulus, self.shell_modulus, self.strength, self.hardening = modulus, shell_modulus, strength, hardening  # shear moduli

    @classmethod
    def of_run(cls, run):
        number = run.number
        (a, b), (inner, d) = ([float(run.options[f"-{body}_dm_plex_box_{end}"].split(",")[0]) for end in ("lower", "upper")] for body in ("liner", "shell"))
        shear = [number(f"-{body}_youngs_modulus") / 2 / (1 + number(f"-{body}_poissons_ratio")) for body in ("liner", "shell")]
        return cls(a, b, inner, d, *shear, number("-liner_yield_stress"), number("-liner_hardening_modulus"))

    def contact(self, amplitude):
        """Pressure of the shell on the liner, whose displacement is amplitude / r."""
        return max(0.0, 2 * self.shell_modulus * (amplitude - (self.inner - self.b) * self.b) * (1 / self.inner**2 - 1 / self.d**2))

    def radius(self, amplitude):
        """To where the liner flows: its equivalent stress, 2 sqrt(3) G A / r^2, is its strength there."""
        return min(max(np.sqrt(2 * np.sqrt(3) * self.modulus * amplitude / self.strength), self.a), self.b)

    def pressure(self, amplitude):
        """Within the liner, for a displacement that has only grown."""
        c, three = self.radius(amplitude), 3 * self.modulus
        flows = 2 / np.sqrt(3) * three / (three + self.hardening) * (self.strength * np.log(c / self.a) + self.hardening * amplitude / np.sqrt(3) * (1 / self.a**2 - 1 / c**2))
        return flows + 2 * self.modulus * amplitude * (1 / c**2 - 1 / self.b**2) + self.contact(amplitude)

    def loaded(self, pressure):
        """Displacement times radius at a pressure that has only grown."""
        return root(lambda amplitude: self.pressure(amplitude) - pressure, 0.0, self.a**2)

    def unloaded(self, largest, pressure):
        """The same at a pressure that has fallen from its largest, as long as nothing flows back and the contact lasts."""
        elastic = 2 * self.modulus * (1 / self.a**2 - 1 / self.b**2) + 2 * self.shell_modulus * (1 / self.inner**2 - 1 / self.d**2)
        return self.loaded(largest) - (largest - pressure) / elastic


def contact_pressure(run):
    """Mean contact pressure over time: force per area of the shell's bore."""
    low, high = (float(run.options[f"-shell_dm_plex_box_{end}"].split(",")[1]) for end in ("lower", "upper"))
    pair = next(iter(run.pairs.values()))
    return pair["force"] / (2 * np.pi * Tubes.of_run(run).inner * (high - low))


def pressures(run, largest):
    """In the liner: up to the largest at time 1, and down to nothing at time 2."""
    return largest * (1 - np.abs(1 - np.asarray(run.time)))


def expected(tubes, time, pressure, largest):
    return np.array([tubes.contact(tubes.loaded(p) if t <= 1 + 1e-9 else tubes.unloaded(largest, p)) for t, p in zip(time, pressure)])


def draw(path_of_run, path):
    with history_file(path_of_run):
        run = read(path_of_run)
    largest = float(run.options["-liner_boundary_traction_xmin"].split("*")[0])
    tubes, pressure = Tubes.of_run(run), pressures(run, largest)
    factor, unit = scale(largest, {"SI": "Pa", "mm-t-s": "MPa", "none": ""}[run.unit_system])
    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    for time in (np.linspace(0, 1, 201), np.linspace(1.001, 2, 201)):
        exact = largest * (1 - np.abs(1 - time))
        axes.plot(factor * exact, factor * expected(tubes, time, exact, largest), label="Hill, incompressible" if time[0] == 0 else None, **DASHED)
    axes.plot(factor * pressure, factor * contact_pressure(run), "o", color=BLUE, markersize=4, label="Impakt")
    axes.set(xlabel=labelled("pressure in the liner", unit), ylabel=labelled("contact pressure", unit), title="a tube is pressed into another one and let go")
    axes.legend()
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    sys.exit(command_line("history.h5 figure.png", draw))
