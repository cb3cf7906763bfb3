"""Compare the CPU time of Impakt with the yardstick, a plain C program for the same problem.

    python tests/scaling/bench.py --build build

Program and yardstick run in turn, several times: on a shared machine one measurement says little, and the ratio of two
runs made one after the other says more than either time. The exit code tells whether all runs worked, not whether they
were fast.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[2]

# name, options of the program, bound on (CPU time of the program) / (CPU time of the yardstick)
CASES = (
    ("II", "options/paper/high-speed/ii.opts", 3.5),
    ("EE", "options/paper/high-speed/ee.opts", 3.5),
    ("IE", "options/paper/high-speed/ie.opts", None),
)
DEFAULT_RUN = "options/impact-high-speed.opts"
DEFAULT_BOUND = 3.0
STRIKER = "options/striker.opts"  # a mesh ratio of 10, with substeps of one body
COMMON_STEP = ("-time_step", "1.6e-7")  # of both bodies, in place of them
PHASES = (("alpha2", "substeps"), ("centraldifference", "substeps"), ("sweeps", "count"))


class RunError(Exception):
    """A run that gave no usable result."""


def execute(command, time_limit):
    """Run a command in the top directory and return its standard output."""
    # Open MPI refuses to start as root, as in a container, unless told twice
    environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    line = " ".join(map(str, command))
    try:
        done = subprocess.run(
            command, cwd=ROOT, env=environment, timeout=time_limit, capture_output=True, text=True, check=False
        )
    except subprocess.TimeoutExpired:
        raise RunError(f"{line}\nno result within {time_limit:g} s") from None
    except OSError as error:
        raise RunError(f"{line}\n{error}") from None
    if done.returncode:
        tail = "\n".join((done.stdout + done.stderr).splitlines()[-20:])
        raise RunError(f"{line}\nexit code {done.returncode}\n{tail}")
    return done.stdout


def read_summary(path, run):
    """The summary that a run wrote."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RunError(f"summary of {run}: {error}") from None


def run_yardstick(build, mode, time_limit):
    """Return the yardstick's results for a mode."""
    output = execute([build / "yardstick", "--mode", mode], time_limit)
    try:
        return json.loads(output)
    except ValueError as error:
        raise RunError(f"yardstick --mode {mode}: {error}") from None


def run_program(build, options, time_limit, more=()):
    """Return the program's summary of a run of an options file, with more options."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "summary.json"
        command = [build / "impakt", "-options_file", options, "-output_summary", path, "-progress", "0", *more]
        execute(command, time_limit)
        summary = read_summary(path, options)
    try:
        float(summary["timing"]["cpu"])
    except (KeyError, TypeError, ValueError):
        raise RunError(f"summary of {options}: no number timing.cpu") from None
    return summary


def spread(values, digits=3):
    """Median, with minimum and maximum in brackets."""
    values = [value for value in values if value is not None]
    if not values:
        return "-"
    return f"{median(values):.{digits}f} [{min(values):.{digits}f} {max(values):.{digits}f}]"


def microseconds(summary, phase, count):
    """CPU time of a phase for each of its substeps or sweeps; None if the run has none."""
    entry = summary["timing"].get("per_phase", {}).get(phase, {})
    return 1e6 * entry["seconds"] / entry[count] if entry.get("seconds") and entry.get(count) else None


def sweeps(summary):
    """Largest and mean number of sweeps, of the program or of the yardstick."""
    schwarz = summary.get("schwarz", summary)
    largest, mean = schwarz.get("max", schwarz.get("max_sweeps")), schwarz.get("mean_all_steps")
    return "-" if largest is None or mean is None else f"{largest:g} / {mean:.4f}"


def print_table(rows):
    """Print rows of text, the first of them the header, in aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    for number, row in enumerate(rows):
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip())
        if number == 0:
            print("  ".join("-" * width for width in widths))


def ratio_row(name, bound, yardsticks, summaries):
    """One case as a row of the first table."""
    times = [summary["timing"]["cpu"] for summary in summaries]
    references = [result["cpu"] for result in yardsticks]
    ratios = [time / reference for time, reference in zip(times, references)]
    if bound is None:
        limit, verdict = "-", "no bound"
    else:
        limit, verdict = f"{bound:g}", "above the bound" if median(ratios) > bound else "within the bound"
    return [
        name,
        spread(times),
        spread([summary["timing"].get("wall_setup") for summary in summaries]),
        spread(references),
        spread(ratios, 2),
        limit,
        verdict,
        sweeps(summaries[-1]),
        sweeps(yardsticks[-1]),
    ]


def command_line(description, programs, time_limit, texts=(), **more):
    """What the options of a comparison say: a directory with programs, seconds for one run, and numbers and texts with their default and meaning."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build", help=f"directory of {programs}")
    parser.add_argument("--time-limit", type=float, default=time_limit, help=f"for one run, in s (default: {time_limit:g})")
    for name, (default, meaning) in more.items():
        parser.add_argument(f"--{name}", type=int, default=default, help=f"{meaning} (default: {default})")
    for name, (default, meaning) in dict(texts).items():
        parser.add_argument(f"--{name}", default=default, help=f"{meaning} (default: {default})")
    parser.add_argument("--json", type=Path, help="file for the figures, from which benchreport.py makes a report")
    arguments = parser.parse_args()
    arguments.measured = []
    if any(getattr(arguments, name) < 1 for name in more):
        parser.error(f"{' and '.join(f'--{name}' for name in more)} must be at least 1")
    arguments.build = arguments.build.resolve()
    return arguments


def measured(arguments, name, unit, values, yardstick=(), what=""):
    """Keeps repeats of a figure, of which less is better, and of what it is beside: `what`, measured in turn with it or known."""
    arguments.measured.append({"name": name, "unit": unit, "values": list(values), "yardstick": list(yardstick), "beside": what})


def report(print_tables, arguments):
    """The exit code of a comparison whose tables are printed as its runs go: whether all of them worked."""
    try:
        print_tables(arguments)
    except RunError as error:
        print(f"{Path(sys.argv[0]).name}: a run failed: {error}", file=sys.stderr)
        return 1
    if arguments.json:
        arguments.json.parent.mkdir(parents=True, exist_ok=True)
        arguments.json.write_text(json.dumps(arguments.measured, indent=1), encoding="utf-8")
    return 0


def print_substeps(arguments):
    """A body of fine elements with substeps of its own, beside one common step of both bodies."""
    own, common = [], []
    for _ in range(arguments.repeats):
        own.append(run_program(arguments.build, STRIKER, arguments.time_limit)["timing"]["cpu"])
        common.append(run_program(arguments.build, STRIKER, arguments.time_limit, COMMON_STEP)["timing"]["cpu"])
    measured(arguments, "striker.opts, 10 substeps of the fine body", "s", own, common, "one common step of both bodies")
    print(f"\nMesh ratio of 10: {spread(own)} s with substeps of the fine body, {spread(common)} s with one common step, {median(common) / median(own):.1f} times.")


def print_tables(arguments):
    """Run everything and print the tables."""
    build, limit = arguments.build, arguments.time_limit
    cases = (*CASES, ("default", DEFAULT_RUN, DEFAULT_BOUND))
    yardsticks = {name: [] for name, _, _ in cases}
    summaries = {name: [] for name in yardsticks}
    for _ in range(arguments.repeats):
        for name, options, _ in CASES:
            yardsticks[name].append(run_yardstick(build, name, limit))
            summaries[name].append(run_program(build, options, limit))
        yardsticks["default"].append(run_yardstick(build, "default", limit))
        summaries["default"].append(run_program(build, DEFAULT_RUN, limit))

    print(f"Median [minimum maximum] of {arguments.repeats} runs; CPU time of the time loop only, set-up apart.\n")
    for name, _, _ in cases:
        times, references = [run["timing"]["cpu"] for run in summaries[name]], [run["cpu"] for run in yardsticks[name]]
        measured(arguments, f"bars in 1-D, {name}" + (" run" if name == "default" else ""), "s", times, references, "yardstick.c")
    header = ["case", "program, s", "set-up, s", "yardstick, s", "ratio", "bound", "verdict"]
    header += ["sweeps max / mean", "yardstick's"]
    rows = [ratio_row(name, bound, yardsticks[name], summaries[name]) for name, _, bound in cases]
    print_table([header, *rows])

    print("\nMicroseconds per substep of an integrator, and per sweep with all its substeps:\n")
    rows = [["case", *(f"{phase}, per {count[:-1] if count == 'substeps' else 'sweep'}" for phase, count in PHASES)]]
    rows[0].append("yardstick, time loop per substep")
    for name, runs in summaries.items():
        cells = [spread([microseconds(run, phase, count) for run in runs], 2) for phase, count in PHASES]
        cells.append(spread([1e6 * run["cpu"] / run["substeps"] for run in yardsticks.get(name, [])], 2))
        rows.append([name, *cells])
    print_table(rows)
    print_substeps(arguments)


if __name__ == "__main__":
    sys.exit(report(print_tables, command_line(__doc__, "impakt and yardstick", 120, repeats=(5, "runs of each case"))))
