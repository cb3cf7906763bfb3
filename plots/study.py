"""Runs an options file with all combinations of the values of some options, several runs at a time, and shows their figures.

    python plots/study.py options/impact-high-speed.opts out/study.png --vary time_step=1e-7,2e-7,4e-7 --vary contact_type=schwarz,lagrange
    python plots/study.py my.opts out/study.png --vary "left_dm_plex_box_faces=10,10;20,20;40,40" --figure contact/impulse --options "-time_end 1e-3"

The last of the two names is that of the picture. The table is printed, and written beside it as out/study.csv; histories and summaries are
kept in the folder out/study, under the numbers of the table. Runs write neither fields nor checkpoints.

Values are separated by commas, or by semicolons where there is one, as values may have commas themselves (one such value: `name=10,10;`).
`--options` are given to all runs. `--figure` names a number of the summary; it may be given several times. Without it the largest errors of the
energy to both sides [1], the largest contact force [N], the impulse [N s] and the wall time [s] are shown.

The picture has a panel for each figure, over the values of the option that `--over` names, by default the first; runs that differ in other
options are lines of their own. A run that fails is a row with its message, and the exit code is 1.
"""

import argparse
import csv
import itertools
import os
import shlex
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np
from execute import execute
from figures import BLACK, COLOURS
from impakt_results import CannotRead, read
from matplotlib.figure import Figure

FIGURES = ("system/energy_error_max", "system/energy_error_min", "contact/force_peak", "contact/impulse", "timing/wall")
PLACES = ("../build/impakt", "../../../bin/impakt")  # of the program, from this folder: where it was built, and where both are installed
MARKERS = "osd^vP*X"


def varied(text):
    """Name and values of one --vary."""
    name, given, values = text.lstrip("-").partition("=")
    values = [value.strip() for value in values.split(";" if ";" in values else ",")]
    values = [value for value in values if value]
    if not name or not given or not values or len(set(values)) < len(values):
        raise argparse.ArgumentTypeError(f"'{text}' is not like time_step=1e-6,2e-6: a name and different values")
    return name, values


def program_of(asked):
    """The program that makes the runs."""
    if asked:
        return asked
    here = Path(__file__).absolute().parent
    found = next((here / place for place in PLACES if (here / place).is_file()), None) or shutil.which("impakt")
    if not found:
        raise CannotRead("there is no build/impakt; make it, or name the program with --program")
    return found


def make(run, options):
    """Makes a run, and reads its figures, or what went wrong."""
    varied = [word for name, value in run.values.items() for word in (f"-{name}", value)]
    files = ["-output_history", run.history, "-output_summary", run.summary, "-output_fields", "none", "-checkpoint", "none"]
    words = [options.program, "-options_file", options.options_file, *shlex.split(options.options), *varied, *files, "-progress", "false"]
    for path in (run.history, run.summary):
        path.unlink(missing_ok=True)
    run.failure = execute([str(word) for word in words])
    if not run.failure:
        try:
            results = read(run.history, summary=run.summary)
            run.figures = {name: results.figure(name) for name in options.figure}
        except CannotRead as error:
            run.failure = str(error)
    return run


def combinations(options, folder):
    """The runs of the study, not made yet, in the order of the table."""
    names = [name for name, _ in options.vary]
    for number, values in enumerate(itertools.product(*(values for _, values in options.vary)), 1):
        path = folder / f"{number:03d}"
        yield SimpleNamespace(number=number, values=dict(zip(names, values, strict=True)), history=path.with_suffix(".h5"), summary=path.with_suffix(".json"), figures={}, failure="")


def rows(runs, names):
    """The table: a row of names, and one for each run."""
    yield ["run", *runs[0].values, *names, "failure"]
    for run in runs:
        yield [run.number, *run.values.values(), *(run.figures.get(name) for name in names), run.failure]


def write_table(table, path):
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["" if cell is None else cell for cell in row] for row in table])


def print_table(table):
    head, *body = table
    shown = [[f"{cell:.6g}" if isinstance(cell, float) else "-" if cell is None else str(cell) for cell in row[:-1]] for row in (head, *body)]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    for cells, row in zip(shown, (head, *body), strict=True):
        failure = "" if row is head or not row[-1] else f"  failed: {row[-1]}"
        print("  ".join(f"{cell:>{width}}" for cell, width in zip(cells, widths, strict=True)) + failure)


def number_of(value):
    """The value of an option as a number: the first, where there are several."""
    try:
        return float(value.split(",")[0])
    except ValueError:
        return None


def places(values):
    """Where values of an option are drawn: at their numbers, where these differ, or side by side."""
    numbers = [number_of(value) for value in values]
    if None in numbers or len(set(numbers)) < len(numbers):
        return dict(zip(values, range(len(values)), strict=True)), False
    return dict(zip(values, numbers, strict=True)), True


def spread(numbers):
    """The scale of an axis: logarithmic for positive numbers of different orders."""
    return "log" if min(numbers) > 0 and max(numbers) >= 10 * min(numbers) else "linear"


def draw(runs, options, path):
    over, others = options.over, [name for name, values in options.vary if name != options.over and len(values) > 1]
    at, numeric = places(dict(options.vary)[over])
    lines = {}
    for run in sorted((run for run in runs if not run.failure), key=lambda run: at[run.values[over]]):
        lines.setdefault(", ".join(f"{name} {run.values[name]}" for name in others), []).append(run)
    matplotlib.rcParams.update({"font.size": 9, "lines.linewidth": 1.2, "axes.axisbelow": True})
    columns = min(3, len(options.figure))
    figure = Figure(figsize=(2 + 3.5 * columns, 3 * -(-len(options.figure) // columns)), layout="constrained")
    panels = figure.subplots(-(-len(options.figure) // columns), columns, squeeze=False).ravel()
    for axes, name in itertools.zip_longest(panels, options.figure):
        if name is None:
            axes.remove()
            continue
        for i, (label, line) in enumerate(lines.items()):
            y = [np.nan if run.figures[name] is None else run.figures[name] for run in line]
            axes.plot([at[run.values[over]] for run in line], y, color=(*COLOURS, BLACK)[i % 5], marker=MARKERS[i % len(MARKERS)], markersize=5, label=label)
        drawn = [run.figures[name] for line in lines.values() for run in line if run.figures[name] is not None]
        if drawn:
            axes.set_yscale(spread(drawn))
        if numeric:
            axes.set_xscale(spread(at.values()))
        else:
            axes.set_xticks(list(at.values()), list(at))
        axes.set(title=name, xlabel=over)
        axes.grid(color="0.9", linewidth=0.6, which="both")
    if others:
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper", frameon=False, fontsize=8)
    figure.savefig(path, dpi=150)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="plots/study.py", description="Runs an options file with all combinations of values of options; prints and draws figures.")
    parser.add_argument("options_file", metavar="FILE.opts")
    parser.add_argument("picture", metavar="FIGURE.png", help="the table is written beside it, as FIGURE.csv, and what the runs leave into the folder FIGURE")
    parser.add_argument("--vary", action="append", required=True, type=varied, metavar="NAME=VALUE,VALUE", help="an option and its values, with semicolons where values have commas")
    parser.add_argument("--figure", action="append", default=[], metavar="PATH", help="of a number in the summary, such as contact/impulse; may be repeated")
    parser.add_argument("--over", metavar="NAME", help="the option along the axis of the picture, default the first")
    parser.add_argument("--options", default="", metavar="'-NAME VALUE'", help="further options of all runs")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), metavar="N", help="runs at a time, default the number of processors")
    parser.add_argument("--program", metavar="PATH", help="default build/impakt, or the installed one")
    options = parser.parse_args(arguments)
    names = [name for name, _ in options.vary]
    options.over = options.over.lstrip("-") if options.over else names[0]
    options.figure = options.figure or list(FIGURES)
    if len(set(names)) < len(names):
        parser.error("an option is varied twice; give all its values at once")
    if options.over not in names:
        parser.error(f"--over {options.over} is not varied; {', '.join(names)} are")
    if Path(options.picture).suffix != ".png":
        parser.error(f"the second name is the picture to be drawn, as in study.png, and not {options.picture}")
    if options.jobs < 1:
        parser.error(f"--jobs {options.jobs}: at least one run is made at a time")
    return options


def main(arguments):
    options = parse(arguments)
    picture = Path(options.picture)
    try:
        options.program = program_of(options.program)
        folder = picture.with_suffix("")
        folder.mkdir(parents=True, exist_ok=True)
        picture.unlink(missing_ok=True)
        with ThreadPoolExecutor(options.jobs) as pool:
            runs = list(pool.map(lambda run: make(run, options), combinations(options, folder)))
        table = list(rows(runs, options.figure))
        print_table(table)
        write_table(table, picture.with_suffix(".csv"))
        print(picture.with_suffix(".csv"))
        failed = [run for run in runs if run.failure]
        if len(failed) < len(runs):
            draw(runs, options, picture)
            print(picture)
    except (CannotRead, OSError, ValueError) as error:
        print(f"plots/study.py: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("plots/study.py: interrupted; there is no table", file=sys.stderr)
        return 130
    if failed:
        print(f"plots/study.py: {len(failed)} of {len(runs)} runs failed", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
