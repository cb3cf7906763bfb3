"""Draws the history of an impact: contact positions, contact force, energies and sweeps, beside the exact solution.

    python plots/impact.py history.h5 figure.png

The exact solution (dashed) is drawn for runs made with `-exact impact` or `-exact characteristics`; it is computed from the options in
the file.
"""

import sys

import matplotlib
import numpy as np
from characteristics import Impact
from figures import (
    BLUE,
    COLOURS,
    DASHED,
    GREEN,
    ORANGE,
    CannotDraw,
    command_line,
    labelled,
    scale,
    time_scale,
)
from impakt_results import read as read_results
from matplotlib.figure import Figure


def read(path):
    """All that is drawn, from the history file."""
    run = read_results(path)
    if not run.pairs:
        raise CannotDraw(f"{path} is not the history of an Impakt run with contact")
    first = run.options.get("-contact_pairs", "").split(",")[0]
    pairs = sorted(run.pairs, key=lambda name: name != first)
    return {
        "options": run.options,
        "time": run.time,
        "units": run.units,
        "sweeps": run.sweeps,
        "energy_error": run.energy_error,
        "forces": {name: run.pairs[name]["force"] for name in pairs},
        "pair": bodies_of(pairs[0], list(run.bodies)),
        "bodies": run.bodies,
    }


def bodies_of(pair, names):
    """The two bodies of a pair, Dirichlet side first; surfaces may stand behind a dot."""
    found = [side.split(".")[0] for side in pair.split(":")]
    return found if len(found) == 2 and all(name in names for name in found) else names[:2]


def contact_axis(history):
    """The coordinate along which the bodies of the first pair approach each other."""
    one, other = (history["bodies"][name]["mean_velocity"] for name in history["pair"])
    if one.ndim == 1:
        return None
    return int(np.argmax(np.abs(one[0] - other[0])))


def along(values, axis):
    return values if axis is None else values[:, axis]


def numbers(options, name):
    return np.array([float(number) for number in options[name].split(",")])


def bar(history, name, axis):
    """A bar of the pair: material and size from the options, position and velocity as the run starts."""
    options, body = history["options"], history["bodies"][name]
    density, modulus = (float(options[f"-{name}_{key}"]) for key in ("density", "youngs_modulus"))
    lengths = numbers(options, f"-{name}_dm_plex_box_upper") - numbers(options, f"-{name}_dm_plex_box_lower")
    length = lengths[axis or 0]
    area = float(options.get(f"-{name}_cross_section", 1)) if axis is None else np.prod(np.delete(lengths, axis))
    return {
        "impedance": np.sqrt(density * modulus) * area,
        "period": 2 * length * np.sqrt(density / modulus),
        "velocity": along(body["mean_velocity"], axis)[0],
        "position": along(body["contact_position"], axis)[0],
    }


def exact_solution(history, axis):
    """By characteristics, which for two equal bars is what -exact impact has; None where the options do not tell."""
    time = history["time"]
    if history["options"].get("-exact") not in ("impact", "characteristics"):
        return None
    try:
        bars = [bar(history, name, axis) for name in history["pair"]]
    except (KeyError, ValueError) as error:
        print(f"no exact solution: the options in the file do not give {error}", file=sys.stderr)
        return None
    sign = 1 if bars[1]["position"] > bars[0]["position"] or bars[0]["velocity"] > bars[1]["velocity"] else -1
    gap = sign * (bars[1]["position"] - bars[0]["position"])
    impact = Impact([{**each, "velocity": sign * each["velocity"]} for each in bars], gap, time[0], time[-1])
    averages = [impact.averages(side, time) for side in (0, 1)]
    kinetic, potential, _ = averages[0]
    sides = dict(enumerate(history["pair"]))
    return {
        "position": {name: bars[side]["position"] + sign * impact.travelled(side, time) for side, name in sides.items()},
        "velocity": {name: sign * impact.velocity(side, time) for side, name in sides.items()},
        "mean_velocity": {name: sign * averages[side][2] for side, name in sides.items()},
        "force": impact.force(time),
        "kinetic": kinetic,
        "potential": potential,
    }


def draw_positions(axes, history, exact, axis, time):
    positions = {name: along(history["bodies"][name]["contact_position"], axis) for name in history["pair"]}
    factor, unit = scale(max(np.abs(values).max() for values in positions.values()), history["units"][f"body/{history['pair'][0]}/contact_position"])
    for colour, (name, values) in zip(COLOURS, positions.items()):
        axes.plot(time, factor * values, color=colour, label=name)
        if exact:
            axes.plot(time, factor * exact["position"][name], **DASHED)
    axes.set_title("contact position")
    axes.set_ylabel(labelled("position", unit))


def draw_forces(axes, history, exact, time):
    forces = history["forces"]
    factor, unit = scale(max(np.abs(values).max() for values in forces.values()), history["units"][f"contact/{next(iter(forces))}/force"])
    for colour, (name, values) in zip(COLOURS, forces.items()):
        axes.plot(time, factor * values, color=colour, label=name.replace(":", " : "))
    if exact:
        axes.plot(time, factor * exact["force"], **DASHED)
    axes.set_title("contact force")
    axes.set_ylabel(labelled("force", unit))


def draw_energies(axes, history, exact, time):
    name = history["pair"][0]
    body = history["bodies"][name]
    factor, unit = scale(max(body["kinetic"].max(), body["potential"].max()), history["units"]["energy/change"])
    for colour, key in ((BLUE, "kinetic"), (ORANGE, "potential")):
        axes.plot(time, factor * body[key], color=colour, label=key)
        if exact:
            axes.plot(time, factor * exact[key], **DASHED)
    axes.set_title(f"energy of {name}; error of the system")
    axes.set_ylabel(labelled("energy", unit))
    axes.tick_params(labelbottom=False)


def draw_energy_error(axes, history, time):
    axes.plot(time, history["energy_error"], color=GREEN)
    axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)
    axes.set_ylabel("rel. error [1]")


def draw_sweeps(axes, history, time):
    sweeps = history["sweeps"]
    axes.plot(time, sweeps, color=BLUE, linestyle="none", marker=".", markersize=3)
    axes.set_ylim(-0.3, max(1, sweeps.max()) * 1.1 + 0.3)
    axes.yaxis.get_major_locator().set_params(integer=True)
    axes.set_title("sweeps in each controller step")
    axes.set_ylabel("sweeps [1]")


def draw(file, path):
    history = read(file)
    matplotlib.rcParams.update({"font.size": 9, "axes.titlesize": 10, "lines.linewidth": 1.4, "axes.axisbelow": True})
    axis = contact_axis(history)
    exact = exact_solution(history, axis)
    factor, unit = time_scale(history["time"], history["units"]["time"])
    time = factor * history["time"]

    figure = Figure(figsize=(10, 7), layout="constrained")
    grid = figure.add_gridspec(2, 2, wspace=0.04, hspace=0.04)
    position, force, sweeps = (figure.add_subplot(grid[at]) for at in ((0, 0), (0, 1), (1, 1)))
    halves = grid[1, 0].subgridspec(2, 1, height_ratios=(2, 1))
    energy = figure.add_subplot(halves[0])
    error = figure.add_subplot(halves[1], sharex=energy)

    draw_positions(position, history, exact, axis, time)
    draw_forces(force, history, exact, time)
    draw_energies(energy, history, exact, time)
    draw_energy_error(error, history, time)
    draw_sweeps(sweeps, history, time)
    for axes in figure.axes:
        axes.grid(color="0.9", linewidth=0.6)
        axes.margins(x=0.01)
        if axes is not energy:
            axes.set_xlabel(labelled("time", unit))
    for axes in (position, force, energy):
        if exact:
            axes.plot([], [], label="exact", **DASHED)
        axes.legend(frameon=True, framealpha=0.9, edgecolor="0.8")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    sys.exit(command_line("history.h5 figure.png", draw))
