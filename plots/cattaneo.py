"""Draws two equal cylinders, or spheres, that are pressed together and pushed across, beside the theory of Cattaneo and Mindlin: a panel for each history.

    python plots/cattaneo.py out/cattaneo-cylinders.h5 out/cattaneo-spheres.h5 figure.png

Of cylinders the traction across the contact at some load steps, from the fields that the run wrote too; of spheres the force across over the load steps,
and what friction has taken after half a loop. What is moved and held is the surface "back" of either body (-<body>_boundary_displacement back).

K. L. Johnson, Contact mechanics (1985), section 7.2: (7.28) cylinders, (7.35) to (7.42) spheres; the loop of spheres in section 7.4 after R. D. Mindlin,
H. Deresiewicz, Elastic spheres in contact under varying oblique forces, Journal of Applied Mechanics 20 (1953).
"""

import sys
from pathlib import Path

import h5py
import matplotlib
import numpy as np
from figures import (
    BLUE,
    DASHED,
    CannotDraw,
    command_line,
    history_file,
    labelled,
    scale,
)
from hertz import find_fields
from impakt_results import text
from matplotlib.figure import Figure


def hertz(dim, load, radius, modulus):
    """Half width or radius of the contact, and largest pressure; with R = 1 / (1/R1 + 1/R2) and E* of both bodies."""
    if dim == 2:
        a = np.sqrt(4 * load * radius / (np.pi * modulus))
        return a, 2 * load / (np.pi * np.where(a > 0, a, 1))
    a = np.cbrt(3 * load * radius / (4 * modulus))
    return a, 3 * load / (2 * np.pi * np.where(a > 0, a, 1) ** 2)


def stick(dim, q):
    """Part of the half width, or radius, that sticks under a force Q = q mu P that has grown from nothing."""
    return (1 - q) ** (1 / dim)


def traction(dim, x, q):
    """By mu p0, at distances x, by a, from the middle."""
    c = stick(dim, q)
    inner = c * np.sqrt(np.maximum(0, 1 - (x / c) ** 2)) if c > 0 else 0
    return np.sqrt(np.maximum(0, 1 - x**2)) - inner


def loop_loss(friction, a, compliance, q):
    """What spheres lose in a loop from Q = q F to -q F and back, F = mu P, with the compliance S = sum (2 - nu) / G [J]. It is the area of the loop

        delta = 3 F S / (16 a) (2 (1 - (q* - q) / 2)^(2/3) - (1 - q*)^(2/3) - 1),

    both ways."""
    return (
        0.9
        * friction**2
        / a
        * compliance
        * (1 - (1 - q) ** (5 / 3) - 5 / 6 * q * (1 + (1 - q) ** (2 / 3)))
    )


class Run:
    """Loads and ways of two equal bodies, the first of which is moved along x, or in space along y."""

    def __init__(self, path):
        with history_file(path) as file:
            options = self.options = {
                name: str(value) for name, value in file.attrs.items()
            }
            self.names = list(options["-bodies"].split(","))
            if len(self.names) != 2 or "-contact_friction" not in options:
                raise CannotDraw("theory is for two bodies with -contact_friction")

            def option(key):
                values = {options.get(f"-{name}_{key}") for name in self.names}
                if len(values) > 1 or None in values:
                    raise CannotDraw(
                        f"theory is for two equal bodies: give both the same -<body>_{key}"
                    )
                return float(values.pop())

            self.dim, self.radius = int(option("dm_plex_dim")), option("ball_radius")
            young, nu = option("youngs_modulus"), option("poissons_ratio")
            self.modulus, self.compliance = (
                young / (1 - nu**2) / 2,
                2 * (2 - nu) * 2 * (1 + nu) / young,
            )
            (name,) = file["contact"]
            pair = file["contact"][name]
            self.first = self.names.index(
                name.split(":")[0].split(".")[0]
            )  # of the pair, whose nodes have the rows
            force = (1 - 2 * self.first) * pair["force_vector"][
                ()
            ]  # on the body that is held, which is named last
            self.time, self.loss, self.mu = (
                file["time"][()],
                pair["friction_loss"][()],
                float(options["-contact_friction"]),
            )
            self.joule = text(pair["friction_loss"].attrs["units"])
            self.load, self.across = -force[:, self.dim - 1], force[:, self.dim - 2]
        self.path = Path(path)
        self.a, self.peak = hertz(self.dim, self.load, self.radius / 2, self.modulus)
        self.q = np.divide(
            self.across,
            self.mu * self.load,
            out=np.zeros_like(self.load),
            where=self.load > 0,
        )

    def step(self, time):
        return int(np.argmin(np.abs(self.time - time)))

    def fields(self, step, *names):
        """Which nodes are those of the body that has the rows, their positions, and fields at a load step."""
        with h5py.File(find_fields(self.path, self.options)) as file:
            positions, cells = file["mesh/positions"][()], file["mesh/cells"][()]
            first = np.zeros(len(positions), bool)
            first[cells[file["mesh/body"][()].ravel() == self.first]] = True
            frame = sorted(file["contact_pressure"])[
                int(np.argmin(np.abs(file["time"][()] - self.time[step])))
            ]
            return [
                first,
                positions,
                *(np.squeeze(file[f"{name}/{frame}"][()]) for name in names),
            ]

    def of_rows(self, step):
        """P and Q / (mu P) by the forces along and across the rows, whose sums are not those along the axes: the plane of contact is turned by the traction
        across it, (1 - 2 nu) / (4 G) times that, and as the centres move past each other, together by some 2 % of mu."""
        first, _, pressure, traction, force = self.fields(
            step, "contact_pressure", "friction_traction", "contact_force"
        )
        touch = first & (pressure > 0)
        pressure, traction = pressure[touch], traction[touch]
        area = np.linalg.norm(force[touch], axis=1) / np.sqrt(
            pressure**2 + (traction**2).sum(axis=1)
        )
        load, across = (
            (pressure * area).sum(),
            (traction * area[:, None]).sum(axis=0)[self.dim - 2],
        )
        return float(load), float((2 * self.first - 1) * across / (self.mu * load))

    def half_loop(self, turn, back):
        """What theory has friction take between two load steps, at which the force across is largest to either side [J]."""
        (load, q), (_, other) = self.of_rows(turn), self.of_rows(back)
        return (
            loop_loss(self.mu * load, self.a[turn], self.compliance, (q - other) / 2)
            / 2
        )

    def nodes(self, step):
        """Of cylinders, the nodes that touch, of the body that has the rows: positions and tractions by those of theory, whether they slide; element [a]."""
        first, positions, pressure, sliding, traction = self.fields(
            step, "contact_pressure", "contact_sliding", "friction_traction"
        )
        along = traction[:, self.dim - 2]
        touch = np.flatnonzero(first & (pressure > 0))
        touch = touch[np.argsort(positions[touch, 0])]
        x = positions[touch, 0] / self.a[step]
        return (
            x,
            (2 * self.first - 1) * along[touch] / (self.mu * self.peak[step]),
            sliding[touch] > 0,
            np.median(np.diff(x)),
        )


def draw_traction(axes, run):
    loaded = np.flatnonzero(run.q > 0.02)
    x = np.linspace(-1.1, 1.1, 800)
    for step in loaded[[len(loaded) // 4, len(loaded) // 2, -1]]:
        place, along, slides, _ = run.nodes(step)
        axes.plot(x, traction(2, x, run.q[step]), **DASHED)
        axes.plot(place[~slides], along[~slides], "o", color=BLUE, markersize=3)
        axes.plot(
            place[slides],
            along[slides],
            "o",
            color=BLUE,
            markersize=3,
            markerfacecolor="white",
        )
    axes.plot([], [], "o", color=BLUE, markersize=3, label="node that sticks")
    axes.plot(
        [],
        [],
        "o",
        color=BLUE,
        markersize=3,
        markerfacecolor="white",
        label="node that slides",
    )
    axes.plot([], [], **DASHED, label="Cattaneo, Mindlin")
    axes.set_title(
        "cylinders pushed across by Q = "
        + ", ".join(
            f"{run.q[step]:.2f}"
            for step in loaded[[len(loaded) // 4, len(loaded) // 2, -1]]
        )
        + " µP"
    )
    axes.set_xlabel("distance from the middle / a")
    axes.set_ylabel("traction across / µp₀")


def draw_loop(axes, run):
    last = len(run.time) - 1
    turn = int(np.argmax(run.q))
    factor, unit = scale(run.loss[last], run.joule)
    axes.plot(run.time, run.q, color=BLUE, label="Q/µP")
    theory = run.half_loop(turn, last)
    other = axes.twinx()
    other.plot(run.time, factor * run.loss, color="0.4", label="taken by friction")
    other.set_ylabel(labelled("taken by friction", unit))
    other.axhline(factor * (run.loss[turn] + theory), **DASHED)
    axes.set_title(
        f"spheres pushed to and fro: half a loop takes {factor * theory:.3g} {unit} in theory"
    )
    axes.set_xlabel("time")
    axes.set_ylabel("Q/µP")


def draw(*files, path):
    runs = [Run(file) for file in files]
    matplotlib.rcParams.update(
        {
            "font.size": 9,
            "axes.titlesize": 9,
            "lines.linewidth": 1.2,
            "axes.axisbelow": True,
        }
    )
    figure = Figure(figsize=(5 * len(runs), 3.6), layout="constrained")
    for axes, run in zip(
        figure.subplots(1, len(runs), squeeze=False)[0], runs, strict=True
    ):
        (draw_traction if run.dim == 2 else draw_loop)(axes, run)
        axes.grid(color="0.9", linewidth=0.6)
        axes.legend(
            loc="upper left" if run.dim > 2 else "best",
            frameon=True,
            framealpha=0.9,
            edgecolor="0.8",
        )
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    sys.exit(command_line("history.h5 [history.h5 ...] figure.png", draw))
