"""Draws what presses or falls on a rigid plane, or two bodies that press or hit each other, beside Hertz's theory: a panel for each history.

    python plots/hertz.py out/hertz-cylinder.h5 out/hertz-sphere.h5 out/hertz-impact.h5 figure.png
    python plots/hertz.py out/hertz-cylinders.h5 out/hertz-spheres.h5 figure.png

Of static runs the contact pressure at the end over the distance from the axis, from the fields that the run wrote too; of others
the contact force over time. Bodies are discs or balls from options (-<body>_dm_plex_shape ball), or parts of them.

Hertz: K. L. Johnson, Contact mechanics (1985), eqs. 4.22 to 4.24 (spheres), 4.43 and 4.45 (cylinders), 11.21 to 11.24 (impact).
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
from impakt_results import text
from matplotlib.figure import Figure

PARTS = {"full": 1, "half": 2, "quarter": 4}
TRUE = ("true", "1", "yes", "on", "")


class Ball:
    """A disc (of unit thickness) or ball, of rings too, as the options of a run describe it, and what Hertz says of it on a rigid plane."""

    def __init__(self, options, name):
        def option(key, default=None):
            value = options.get(f"-{name}_{key}", default)
            if value is None:
                raise CannotDraw(f"the run has no option -{name}_{key}: no disc or ball from options")
            return value

        self.name, self.dim = name, int(option("dm_plex_dim"))
        if option("dm_plex_shape", "box") != "ball":
            raise CannotDraw(f"body {name} is no disc or ball from options")
        self.rings = option("axisymmetric", "false").lower() in TRUE
        self.parts = 1 if self.rings else PARTS[option("ball_part", "full")]  # forces of rings are those of the whole
        self.radius = float(option("ball_radius", "1"))
        self.centre = np.array([float(x) for x in option("ball_centre", "0,0,0").split(",")])[: self.dim]
        rigid = option("rigid", "false").lower() in TRUE
        self.modulus = np.inf if rigid else float(option("youngs_modulus")) / (1 - float(option("poissons_ratio", "0")) ** 2)
        self.static = option("ts_type", "alpha2") == "static"

    def contact(self, load):
        """Radius of the contact (of a disc: half its width) and largest pressure."""
        if self.dim == 2 and not self.rings:
            radius = np.sqrt(4 * load * self.radius / (np.pi * self.modulus))
            return radius, 2 * load / (np.pi * radius)
        radius = (3 * load * self.radius / (4 * self.modulus)) ** (1 / 3)
        return radius, 3 * load / (2 * np.pi * radius**2)

    def lower_surface(self, positions):
        """Nodes of the half of the surface that faces the plane, by their positions from the centre. Their radii differ from the ball's, so that the
        mesh has its volume; other nodes are deeper by an element, which is more than a thousandth of the radius."""
        return (np.linalg.norm(positions, axis=1) > 0.999 * self.radius) & (positions[:, -1] < 0)

    def impact(self, mass, speed):
        """Approach, duration and largest force of a ball's impact."""
        approach = (15 * mass * speed**2 / (16 * self.modulus * np.sqrt(self.radius))) ** 0.4
        return approach, 2.943 * approach / speed, 4 / 3 * self.modulus * np.sqrt(self.radius) * approach**1.5

    def force_over_time(self, mass, speed, n=400):
        """With sin(phi) = (approach / largest)^(5/4), dt = largest / speed (phi / sin phi)^(1/5) du, u = phi^(4/5)."""
        approach, _, force = self.impact(mass, speed)
        phi = np.linspace(0, (np.pi / 2) ** 0.8, n) ** 1.25
        rate = np.r_[1, phi[1:] / np.sin(phi[1:])] ** 0.2
        time = approach / speed * np.r_[0, np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(phi**0.8))]
        force = force * np.sin(phi) ** 1.2
        return np.r_[time, 2 * time[-1] - time[-2::-1]], np.r_[force, force[-2::-1]]


class Pair(Ball):
    """Two discs or balls in contact, one of which may be rigid: theory knows one radius, modulus and mass of both."""

    def __init__(self, balls):
        self.name, self.dim, self.parts = " and ".join(ball.name for ball in balls), balls[0].dim, balls[0].parts
        self.static = any(ball.static for ball in balls)  # a rigid one has no inertia to count if it is led
        self.rings = balls[0].rings
        self.radius, self.modulus = (1 / sum(1 / value for value in values) for values in ([ball.radius for ball in balls], [ball.modulus for ball in balls]))


def hertz_pressure(distance):
    """By the largest, at distances by the radius of the contact."""
    return np.sqrt(np.maximum(0, 1 - distance**2))


def read(path):
    """The ball, and what is drawn of it: loads and momenta are those of the whole ball."""
    with history_file(path) as file:
        options = {name: str(value) for name, value in file.attrs.items()}
        balls = [Ball(options, name) for name in file["body"]]
        if len(balls) > 2:
            raise CannotDraw(f"the run has {len(balls)} bodies: theory is for one on a plane, or two")
        ball = balls[0] if len(balls) == 1 else Pair(balls)
        pair = file["contact"][next(iter(file["contact"]))]
        bodies = [file["body"][each.name] for each in balls]
        series = {"force": ball.parts * pair["force"][()], "area": ball.parts * pair["area"][()], "active": pair["active"][()]}
        velocities, momenta = ([body[name][:, ball.dim - 1] for body in bodies] for name in ("mean_velocity", "momentum"))
        series |= {"time": file["time"][()], "velocity": velocities[0] - (velocities[1] if len(balls) == 2 else 0), "momentum": ball.parts * momenta[0]}
        if not ball.static:
            series["mass"] = ball.parts / sum(velocity[0] / momentum[0] for velocity, momentum in zip(velocities, momenta, strict=True))
        series["units"] = {"force": text(pair["force"].attrs["units"]), "time": text(file["time"].attrs["units"])}
    if ball.static:
        series |= pressures(ball, find_fields(Path(path), options))
    return ball, series


def find_fields(history, options):
    if "-output_fields" not in options:
        raise CannotDraw(f"the run of {history} wrote no fields: give it -output_fields")
    name = Path(options["-output_fields"])
    found = [path for path in (history.parent / name, name) if path.is_file()]  # the run may have been in another folder
    if not found:
        raise CannotDraw(f"the fields of {history}, {name}, are not there")
    return found[0]


def pressures(ball, path):
    """Of the nodes of the surface by their distance from the axis, which is that before they moved, as in theory."""
    with h5py.File(path, "r") as file:
        positions = file["mesh/positions"][:, : ball.dim]
        last = max(file["contact_pressure"])
        pressure, active, gap = (file[f"{name}/{last}"][()].ravel() for name in ("contact_pressure", "contact_active", "contact_gap"))
        unit = file[f"contact_pressure/{last}"].attrs["units"]
    if isinstance(ball, Pair) or ball.rings:  # on the axis through the origin
        surface = np.isfinite(gap)
    else:
        positions = positions - ball.centre
        surface = ball.lower_surface(positions)
    distance = np.linalg.norm(positions[:, :-1], axis=1)
    order = np.flatnonzero(surface)[np.argsort(distance[surface])]
    return {"distance": distance[order], "pressure": pressure[order], "touches": active[order] > 0, "unit": text(unit)}


def fit(distance, pressure):
    """Radius of the contact and largest pressure, from squares of pressures, which should be p0^2 (1 - (r/a)^2)."""
    square, slope = np.linalg.lstsq(np.column_stack((np.ones_like(distance), -(distance**2))), pressure**2, rcond=None)[0]
    return np.sqrt(square / slope), np.sqrt(square)


def draw_pressure(axes, ball, series):
    radius, peak = ball.contact(series["force"][-1])
    factor, unit = scale(peak, series["unit"])
    distance = np.linspace(0, 1.2, 600)
    shown = series["distance"] < 1.2 * radius
    axes.plot(series["distance"][shown] / radius, factor * series["pressure"][shown], "o", color=BLUE, markersize=3, label="nodes")
    axes.plot(distance, factor * peak * hertz_pressure(distance), **DASHED, label="Hertz")
    how = f"pressed together, a = {radius / ball.radius:.3f} R*" if isinstance(ball, Pair) else f"pressed on a plane, a = {radius / ball.radius:.3f} R"
    axes.set_title(f"{ball.name} {how}")
    axes.set_xlabel("distance from the axis / a")
    axes.set_ylabel(labelled("contact pressure", unit))


def draw_force(axes, ball, series):
    speed = abs(series["velocity"][0])
    time, force = ball.force_over_time(series["mass"], speed)
    factor, unit = scale(force.max(), series["units"]["force"])
    late, time_unit = scale(series["time"][-1], series["units"]["time"])
    start = series["time"][np.argmax(series["force"] > 0) - 1]
    axes.plot(late * series["time"], factor * series["force"], color=BLUE, label="Impakt")
    axes.plot(late * (start + time), factor * force, **DASHED, label="Hertz")
    how = "hit, part with" if isinstance(ball, Pair) else "falls on a plane, leaves with"
    axes.set_title(f"{ball.name} {how} {abs(series['velocity'][-1]) / speed:.4f} of the velocity")
    axes.set_xlabel(labelled("time", time_unit))
    axes.set_ylabel(labelled("contact force", unit))


def draw(*files, path):
    runs = [read(file) for file in files]
    matplotlib.rcParams.update({"font.size": 9, "axes.titlesize": 9, "lines.linewidth": 1.2, "axes.axisbelow": True})
    figure = Figure(figsize=(4.2 * len(runs), 3.4), layout="constrained")
    for axes, (ball, series) in zip(figure.subplots(1, len(runs), squeeze=False)[0], runs, strict=True):
        (draw_pressure if ball.static else draw_force)(axes, ball, series)
        axes.grid(color="0.9", linewidth=0.6)
        axes.set_ylim(bottom=0)
        axes.legend(frameon=True, framealpha=0.9, edgecolor="0.8")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    sys.exit(command_line("history.h5 [history.h5 ...] figure.png", draw))
