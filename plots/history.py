"""Draws the history of a run: contact forces and reactions, error of the energy, nodes in contact and gaps over time.

    python plots/history.py history.h5 figure.png

Works for any number of bodies and pairs, and for held bodies without contact; nothing is compared with exact solutions, as plots/impact.py does for two bars.
"""

import sys

import matplotlib
import numpy as np
from figures import (
    COLOURS,
    GREEN,
    CannotDraw,
    command_line,
    labelled,
    scale,
    time_scale,
)
from impakt_results import read
from matplotlib.figure import Figure

MOST_NAMED = 8  # pairs; more would fill the figure with their names


def draw_pairs(axes, time, series, title, quantity, unit):
    """One line for each pair."""
    finite = [np.abs(values[np.isfinite(values)]) for values in series.values()]
    factor, unit = scale(max((values.max() for values in finite if values.size), default=0), unit)
    for i, (name, values) in enumerate(series.items()):
        axes.plot(time, factor * values, color=COLOURS[i % len(COLOURS)], label=name.replace(":", " : ") if i < MOST_NAMED else None)
    axes.set_title(title)
    axes.set_ylabel(labelled(quantity, unit))


def draw(file, path):
    run = read(file)
    held = {name: reaction["force"] for name, reaction in run.reactions.items() if name.partition(".")[0] in run.bodies}  # an obstacle's is that of its pairs
    if not run.pairs and not held:
        raise CannotDraw(f"{file} is not the history of an Impakt run with contact, or with held surfaces")
    matplotlib.rcParams.update({"font.size": 9, "axes.titlesize": 10, "lines.linewidth": 1.2, "axes.axisbelow": True})
    factor, unit = time_scale(run.time, run.units["time"])
    newton, metre = (next((unit for name, unit in run.units.items() if name.endswith(end)), "") for end in ("force", "contact_position"))
    time, pairs = factor * run.time, run.pairs

    figure = Figure(figsize=(10, 7), layout="constrained")
    (force, error), (active, gap) = figure.subplots(2, 2, sharex=True)
    forces = {name: pair["force_vector"] for name, pair in pairs.items()} | held
    title = " and ".join(["contact force"] * bool(pairs) + ["reaction"] * bool(held))
    draw_pairs(force, time, {name: np.linalg.norm(vector, axis=1) for name, vector in forces.items()}, title, "force", newton)
    draw_pairs(active, time, {name: pair["active"] for name, pair in pairs.items()}, "nodes in contact", "nodes", "1")
    draw_pairs(gap, time, {name: run.gap(name) for name in pairs}, "smallest gap", "gap", metre)
    error.plot(time, run.energy_error, color=GREEN)
    error.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)
    error.set_title("error of the energy of all bodies")
    error.set_ylabel("rel. error [1]")
    active.yaxis.get_major_locator().set_params(integer=True)
    for axes in (force, error, active, gap):
        axes.grid(color="0.9", linewidth=0.6)
        axes.margins(x=0.01)
    for axes in (active, gap):
        axes.set_xlabel(labelled("time", unit))
    if forces:
        force.legend(frameon=True, framealpha=0.9, edgecolor="0.8")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    sys.exit(command_line("history.h5 figure.png", draw))
