"""Runs all experiments of the paper and writes the report; see the package's text for what is where."""

import argparse
import sys
import time
from pathlib import Path

from . import figures, html, text
from .experiments import BadOptions, find
from .results import NoResult, Results
from .running import Runner, clock, run_all


def draw_all(results, folder):
    """Draws all figures; returns those that could not be drawn, and why."""
    failed = {}
    for number in figures.FIGURES:
        try:
            figures.draw(number, results, folder)
        except NoResult as error:
            failed[number] = str(error)
    return failed


def write(results, out):
    """The report from what has been run."""
    page = text.report(results, draw_all(results, out / "figures"))
    (out / "report.md").write_text(page, encoding="utf-8")
    (out / "report.html").write_text(html.convert(page, out), encoding="utf-8")


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="paper", description=__doc__)
    parser.add_argument("--program", type=Path, default=Path("build/impakt"), help="default %(default)s")
    parser.add_argument("--out", type=Path, default=Path("out/paper"), help="default %(default)s")
    parser.add_argument("--jobs", type=int, help="runs at a time; default: one for each core")
    chosen = parser.parse_args(arguments)
    begin = time.monotonic()
    try:
        experiments = find()
        runner = Runner(chosen.program, chosen.out / "runs")
    except (BadOptions, OSError) as error:
        print(f"paper: {error}", file=sys.stderr)
        return 1
    errors = run_all(runner, list(experiments.values()), chosen.jobs)
    write(Results(runner, experiments), chosen.out)
    for name, error in errors.items():
        print(f"FAILED {name}: {error}", file=sys.stderr)
    print(
        f"{chosen.out / 'report.md'}, {chosen.out / 'report.html'}: {len(experiments) - len(errors)} of {len(experiments)} runs, {clock(time.monotonic() - begin)}"
    )
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
