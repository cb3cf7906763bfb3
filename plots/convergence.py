"""Draws errors against the step or the size of the mesh, over a set of runs, and prints the slopes.

    python plots/convergence.py coarse.h5 middle.h5 fine.h5 figure.png
    python plots/convergence.py *.h5 figure.png --against left_dm_plex_box_faces --figure contact/impulse

The files are histories; each run has its summary beside it. `--figure` names a number of the summary, system/energy_error_max, errors/kinetic,
bodies/left/displacement_error, ...; it may be given several times. What is called an error there is drawn as it is, its size without sign. Of other
figures, contact/impulse or contact/release_time, the error is the relative difference from the run with the smallest step or size, which itself
is left out. Without `--figure` those of errors/ are drawn, or, where there are none, the difference of the energies and of the impulse.

`--against` names the option that changes from run to run, time_step by default; numbers of elements (..._faces, ..._divisions, ..._layers) count
as 1 / number. The slope of an error is that of a line fitted to its logarithm: 2 for an error that falls by 4 where the step is halved.
"""

import argparse
import sys
from pathlib import Path

import matplotlib
import numpy as np
from figures import BLACK, COLOURS, CannotDraw, labelled
from impakt_results import CannotRead, figures, read
from matplotlib.figure import Figure

COUNTS = ("_faces", "_divisions", "_layers", "_refine")
DEFAULTS = ("contact/impulse", "contact/force_mean", "contact/release_time")
MOST = 8  # figures; more would fill the picture with their names
MARKERS = "osd^vP*X"


def is_error(name):
    return "error" in name


def size(run, option):
    """What the run was made with: a step, or the inverse of a number of elements."""
    value = run.options.get(f"-{option}")
    if value is None:
        raise CannotDraw(f"{run.path}: the run was not given -{option}")
    try:
        number = float(value.split(",")[0])
    except ValueError:
        raise CannotDraw(f"{run.path}: -{option} {value} is not a number") from None
    return 1 / number if option.endswith(COUNTS) else number


def chosen(runs, asked):
    """Names of figures to draw."""
    if asked:
        return asked
    errors = [name for name in figures(runs[0].summary or {}) if name.startswith("errors/") and name.count("/") == 1]
    errors += [name for name in figures(runs[0].summary or {}) if name.endswith("/displacement_error")]
    return (errors or [name for name in DEFAULTS if runs[0].figure(name) is not None])[:MOST]


def errors(runs, name):
    """The error of each run, not-a-number where there is none."""
    values = np.array([np.nan if value is None else value for value in (run.figure(name) for run in runs)], dtype=float)
    if is_error(name):
        return np.abs(values)
    best = values[0]
    return np.append(np.nan, np.abs(values[1:] - best) / (abs(best) or 1))


def slope(sizes, values):
    """Of a line through the logarithms; not-a-number where there are no two of them."""
    good = np.isfinite(values) & (values > 0)
    if len(set(sizes[good])) < 2:
        return np.nan
    return np.polyfit(np.log(sizes[good]), np.log(values[good]), 1)[0]


def measure(runs, against, asked):
    """Sizes in ascending order, and for each figure its errors and their slope."""
    sizes = np.array([size(run, against) for run in runs])
    order = np.argsort(sizes, kind="stable")
    runs, sizes = [runs[i] for i in order], sizes[order]
    if len(set(sizes)) < 2:
        raise CannotDraw(f"-{against} is the same in all runs; name the option that changes with --against")
    names = chosen(runs, asked)
    if not names:
        raise CannotDraw("the summaries have no errors; name a figure with --figure")
    found = {name: errors(runs, name) for name in names}
    return sizes, {name: (values, slope(sizes, values)) for name, values in found.items()}


def table(sizes, found, against):
    width = max(len(name) for name in found)
    lines = [f"{'-' + against:{width}}" + "".join(f" {each:11.4g}" for each in sizes) + "   slope"]
    for name, (values, power) in found.items():
        lines.append(f"{name:{width}}" + "".join(f" {each:11.3e}" if np.isfinite(each) else f" {'-':>11}" for each in values) + f" {power:7.2f}")
    return "\n".join(lines)


def guide(axes, sizes, found):
    """Lines of slope 1 and 2 that begin below the errors of the largest size."""
    last = [values[-1] for values, _ in found.values() if values[-1] > 0]
    if not last:
        raise CannotDraw("all errors of the largest step or size are zero")
    for power, style in ((1, ":"), (2, "--")):
        axes.loglog(sizes, 0.6 * min(last) * (sizes / sizes[-1]) ** power, color=BLACK, linewidth=0.8, linestyle=style, label=f"slope {power}")


def draw(sizes, found, against, time, path):
    matplotlib.rcParams.update({"font.size": 9, "lines.linewidth": 1.2, "axes.axisbelow": True})
    figure = Figure(figsize=(8.5, 5), layout="constrained")
    axes = figure.subplots()
    for i, (name, (values, power)) in enumerate(found.items()):
        axes.loglog(sizes, np.where(values > 0, values, np.nan), color=COLOURS[i % len(COLOURS)], marker=MARKERS[i % len(MARKERS)], markersize=5, label=f"{name}: {power:.2f}")
    guide(axes, sizes, found)
    axes.set_xlabel(f"1 / {against}" if against.endswith(COUNTS) else labelled(against, time) if against.endswith("time_step") else against)
    axes.set_ylabel("error [1]")
    axes.grid(color="0.9", linewidth=0.6, which="both")
    figure.legend(frameon=False, title="error: slope", fontsize=8, loc="outside right upper")
    figure.savefig(path, dpi=150)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="plots/convergence.py", description="Errors against the step or the size of the mesh over a set of runs.")
    parser.add_argument("histories", nargs="+", metavar="HISTORY.h5", help="of two runs or more, their summaries beside them")
    parser.add_argument("picture", metavar="FIGURE.png")
    parser.add_argument("--against", default="time_step", metavar="OPTION", help="that changes from run to run, default time_step")
    parser.add_argument("--figure", action="append", default=[], metavar="PATH", help="of a number in the summary, such as contact/impulse; may be repeated")
    options = parser.parse_args(arguments)
    if options.picture.endswith(".h5"):
        parser.error(f"the last word is the figure to be drawn, as in convergence.png, and not {options.picture}")
    return options


def main(arguments):
    options = parse(arguments)
    try:
        runs = [read(path) for path in options.histories]
        sizes, found = measure(runs, options.against.lstrip("-"), options.figure)
        Path(options.picture).parent.mkdir(parents=True, exist_ok=True)
        draw(sizes, found, options.against.lstrip("-"), runs[0].units["time"], options.picture)
    except (CannotRead, OSError, ValueError) as error:
        print(f"plots/convergence.py: {error}", file=sys.stderr)
        return 1
    print(table(sizes, found, options.against.lstrip("-")))
    print(options.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
