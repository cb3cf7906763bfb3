"""Draws two runs over each other, and prints how far they differ: contact forces, gaps, energies and their error.

    python plots/compare.py a.h5 b.h5
    python plots/compare.py a.h5 b.h5 figure.png

The files are histories. Series are compared over the time that both runs have, at the times of the run with fewer steps; the other one is
interpolated. A difference is relative to the largest number of the series in either run; rows are in the order of that.
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np
from figures import BLUE, ORANGE, CannotDraw, labelled, scale, time_scale
from impakt_results import CannotRead, read
from matplotlib.figure import Figure

STYLES = ({"color": BLUE, "linewidth": 2.2, "alpha": 0.6}, {"color": ORANGE, "linewidth": 1.0, "linestyle": (0, (4, 2))})
MOST_ROWS = 40


def common(a, b):
    """The times at which two runs are compared."""
    begin, end = max(a.time[0], b.time[0]), min(a.time[-1], b.time[-1])
    coarse = a if len(a.time) <= len(b.time) else b
    times = coarse.time[(coarse.time >= begin) & (coarse.time <= end)]
    if not times.size:
        raise CannotDraw(f"{a.path} and {b.path} have no time in common")
    return times


def at(run, times, values):
    """A series at other times; one component after the other."""
    columns = values.reshape(len(run.time), -1).T
    return np.array([np.interp(times, run.time, column) for column in columns])


def differences(a, b):
    """For each series that both runs have: its name, unit, largest number, largest difference and when, and the difference at the end."""
    times, rows = common(a, b), []
    for name in ["system/energy", *(name for name in a.names if name in b.names)]:
        one, other = (at(run, times, run.series(name).astype(float)) for run in (a, b))
        if one.shape != other.shape:
            continue
        known = np.isfinite(one) & np.isfinite(other) & (np.abs(one) < 1e20) & (np.abs(other) < 1e20)
        largest = max(np.abs(values[known]).max(initial=0) for values in (one, other))
        off = np.where(known, np.abs(one - other), 0).max(axis=0)
        when = off.argmax()
        rows.append((name, a.units["energy/change"] if name == "system/energy" else a.units[name], largest, off[when], times[when], off[-1]))
    return sorted(rows, key=lambda row: -(row[3] / row[2] if row[2] else 0))


def table(rows, time="s"):
    """As text; `time`: its unit."""
    width = max(len(row[0]) for row in rows)
    lines = [f"{'series':{width}}  {'unit':8} {'largest':>12} {'difference':>12} {'relative':>9} {labelled('at time', time):>12} {'at the end':>12}"]
    for name, unit, largest, off, when, end in rows[:MOST_ROWS]:
        lines.append(f"{name:{width}}  {unit:8} {largest:12.5g} {off:12.3e} {off / largest if largest else 0:9.1e} {when:12.5g} {end:12.3e}")
    if len(rows) > MOST_ROWS:
        lines.append(f"and {len(rows) - MOST_ROWS} series that differ less")
    return "\n".join(lines)


def settings(a, b):
    """Options in which the runs differ, but for the names of their files."""
    names = sorted(name for name in set(a.options) | set(b.options) if not name.startswith("-output_"))
    return [f"{name}: {a.options.get(name, 'not given')} | {b.options.get(name, 'not given')}" for name in names if a.options.get(name) != b.options.get(name)]


def panel(axes, runs, series, title, quantity, unit, factor):
    """One quantity of both runs; `series(run)` gives a line or several."""
    drawn = [[np.asarray(values, dtype=float) for values in series(run)] for run in runs]
    size, unit = scale(max((np.nanmax(np.abs(values)) for lines in drawn for values in lines if np.isfinite(values).any()), default=0), unit)
    for run, lines, style in zip(runs, drawn, STYLES, strict=True):
        for i, values in enumerate(lines):
            axes.plot(factor * run.time, size * values, label=run.label if i == 0 else None, **style)
    axes.set_title(title)
    axes.set_ylabel(labelled(quantity, unit))
    axes.grid(color="0.9", linewidth=0.6)
    axes.margins(x=0.01)


def draw(a, b, path):
    runs = (a, b)
    a.label, b.label = (str(run.path) for run in runs) if a.path.stem == b.path.stem else (run.path.stem for run in runs)
    pairs = [name for name in a.pairs if name in b.pairs]
    factor, unit = time_scale(max((run.time for run in runs), key=np.ptp), a.units["time"])
    newton, metre, joule = (next((unit for name, unit in a.units.items() if name.endswith(end)), "") for end in ("force", "contact_position", "energy/change"))
    matplotlib.rcParams.update({"font.size": 9, "axes.titlesize": 10, "axes.axisbelow": True})
    figure = Figure(figsize=(10, 7), layout="constrained")
    (force, energy), (gap, error) = figure.subplots(2, 2, sharex=True)
    panel(force, runs, lambda run: [run.pairs[name]["force"] for name in pairs], "contact force", "force", newton, factor)
    panel(gap, runs, lambda run: [run.gap(name) for name in pairs], "smallest gap", "gap", metre, factor)
    panel(energy, runs, lambda run: [run.total("kinetic"), run.total("potential")], "kinetic and potential energy", "energy", joule, factor)
    panel(error, runs, lambda run: [run.energy_error], "error of the energy", "rel. error", "1", factor)
    error.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)
    for axes in (gap, error):
        axes.set_xlabel(labelled("time", unit))
    figure.legend(*energy.get_legend_handles_labels(), loc="outside upper center", ncols=2, frameon=False)
    figure.savefig(path, dpi=150)


def main(arguments):
    if len(arguments) not in (2, 3):
        print("usage: python plots/compare.py a.h5 b.h5 [figure.png]", file=sys.stderr)
        return 1
    try:
        a, b = (read(path) for path in arguments[:2])
        for run in (a, b):
            if not run.bodies:
                raise CannotDraw(f"{run.path} holds fields; give the history of the run")
        if a.unit_system != b.unit_system:
            raise CannotDraw(f"{a.path} has the units {a.unit_system}, and {b.path} {b.unit_system}: numbers of different units cannot be compared")
        rows, other = differences(a, b), settings(a, b)
        if len(arguments) == 3:
            Path(arguments[2]).parent.mkdir(parents=True, exist_ok=True)
            draw(a, b, arguments[2])
    except (CannotRead, OSError, ValueError) as error:
        print(f"plots/compare.py: {error}", file=sys.stderr)
        return 1
    print(table(rows, a.units["time"]))
    if other:
        print("\noptions that differ\n  " + "\n  ".join(other))
    if len(arguments) == 3:
        print(f"\n{arguments[2]}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
