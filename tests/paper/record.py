"""Records the golden figures of the report's tables anew, tests/paper/golden.json, and tells what has changed.

    python tests/paper/record.py --program build/impakt [--out out/paper] [--changed]

For when a change of the figures is meant: look at what is printed before the file is committed. Runs of `make paper` are used
where they are there, and its own, in out/paper/shifted, are made once too. With --changed only those runs are recorded whose figures are not what they
were within their tolerances. How far a figure may be off is measured: each run is
made again with one bar shifted by some 1e-17 m, a few units in the last place of its coordinates. Runs that chatter amplify
such differences, others do not.
"""

import argparse
import dataclasses
import json
import math
import shlex
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "plots"), str(ROOT / "tests/support")]

from goldenfigures import FILE, GOLDEN, differences
from paper.experiments import Experiment, find
from paper.results import NoResult, Results
from paper.running import Runner, run_all

QUANTITIES = {
    "schwarz.max": "count",
    "schwarz.mean_all_steps": "mean of counts",
    "schwarz.mean_contact_steps": "mean of counts",
    "contact.onsets": "count",
    "force_scatter": "scatter",
    "system.energy_error_min": "energy",
    "system.energy_error_max": "energy",
    "errors.kinetic": "error",
    "errors.contact_position": "error",
    "errors.peak_potential": "error",
    "errors.release_time": "step",
}
REASONS = {
    "count": "a whole number; the floor is 0, and a run that does not chatter has the same one whatever the round-off",
    "mean of counts": "a quotient of whole numbers; the floor is one count in 1000 steps, for a step here and there that converges at the brink of the tolerance",
    "scatter": "floor: 1e-3 of the value, and 1e-8, since where it is nearly 0 it is made by outer iterations that stop at 1e-12 m, which is 1e-9 N of 100 N",
    "energy": "floor: 1e-3 of the value, and 1e-9: round-off of sums over 1e4 to 1e6 steps, 2e-10 at most in these runs",
    "error": "floor: 1e-6 of the value; the discretisation's errors, which round-off of 1e-16 does not reach",
    "step": "floor: one controller step, the resolution of the release time, relative to the time in contact",
    "spread": "where five times the spread among runs that differ by round-off only is more than the floor, that: chatter amplifies round-off",
}
SHIFTS = ((0, "1e-17"), (1, "-2e-17"), (0, "2e-17"), (1, "1e-17"), (0, "-3e-17"), (1, "3e-17"))  # number of the body, displacement [m]
MOST = 0.3  # of the value: where the tolerance were larger, the figure says nothing, and is left out
SLOW = 5.0  # s; such runs are made again with one shift only


def floor(kind, value, steps_of_contact):
    return {
        "count": 0,
        "mean of counts": 1e-3,
        "scatter": max(1e-3 * abs(value), 1e-8),
        "energy": max(1e-3 * abs(value), 1e-9),
        "error": 1e-6 * abs(value),
        "step": 1.01 / steps_of_contact,
    }[kind]


@dataclasses.dataclass(frozen=True)
class Shifted(Experiment):
    """An experiment with more options, and without a history."""

    words: str = ""
    keeps_history = False


def shifted(experiments, body, displacement):
    return {
        name: Shifted(
            *dataclasses.astuple(experiment),
            f"-{experiment.last('bodies').split(',')[body]}_initial_displacement {displacement}",
        )
        for name, experiment in experiments.items()
    }


class ShiftedRunner(Runner):
    def command(self, experiment):
        return [*super().command(experiment), *shlex.split(experiment.words)]


def figures_of(result):
    found = {}
    for quantity in QUANTITIES:
        try:
            value = result.figure(quantity)
        except (KeyError, TypeError, ZeroDivisionError):
            continue
        if value is not None:
            found[quantity] = value
    return found


def has_changed(name, result):
    return name not in GOLDEN["figures"] or bool(result.error) or bool(differences(name, result.summary))


def measure(program, runs, folder, changed):
    """Figures of all experiments, or of those that have changed: those of `runs`, and of runs that differ by round-off."""
    experiments = find()
    runner = Runner(program, runs)
    run_all(runner, list(experiments.values()))
    base = Results(runner, experiments)
    if changed:
        experiments = {name: experiment for name, experiment in experiments.items() if has_changed(name, base[name])}
        base = Results(runner, experiments)
    quick = {
        name: experiment
        for name, experiment in experiments.items()
        if not base[name].error and base[name].figure("timing.cpu") < SLOW
    }
    others = []
    for number, shift in enumerate(SHIFTS):
        chosen = shifted(experiments if number == 0 else quick, *shift)
        again = ShiftedRunner(program, folder / str(number))
        run_all(again, list(chosen.values()))
        others.append(Results(again, chosen))
    return base, others


def entry(result, others):
    """Golden figures of a run: value, tolerance, kind."""
    found = {}
    contact = result.summary["contact"]["steps_in_contact"] or 1
    more = [figures_of(other) for other in others]
    for quantity, value in figures_of(result).items():
        kind = QUANTITIES[quantity]
        spread = max((abs(one[quantity] - value) if quantity in one else math.inf for one in more), default=0)
        if not math.isfinite(spread):
            continue
        least = floor(kind, value, contact)
        wide = 5 * spread > least
        tolerance = math.ceil(5 * spread) if wide and kind == "count" else float(f"{max(least, 5 * spread):.1e}")
        if not wide or tolerance <= MOST * abs(value):
            found[quantity] = [value if kind == "count" else float(f"{value:.9g}"), tolerance, "spread" if wide else kind]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path("build/impakt"))
    parser.add_argument("--out", type=Path, default=Path("out/paper"))
    parser.add_argument("--changed", action="store_true", help="only runs whose figures have changed")
    chosen = parser.parse_args()
    old = GOLDEN["figures"]
    base, others = measure(chosen.program, chosen.out / "runs", chosen.out / "shifted", chosen.changed)
    figures = {name: entries for name, entries in old.items() if chosen.changed and name not in base.experiments}
    for name in base.experiments:
        try:
            again = [other[name] for other in others if name in other.experiments and not other[name].error]
            figures[name] = entry(base[name], again)
        except NoResult as error:
            print(f"left out: {error}")
    for name in sorted({*old, *figures}):
        for quantity in QUANTITIES:
            before, after = (book.get(name, {}).get(quantity, [None])[0] for book in (old, figures))
            if before != after:
                print(f"{name} {quantity}: {before} -> {after}")
    lines = ",\n".join(
        f"    {json.dumps(name)}: {{\n"
        + ",\n".join(f"      {json.dumps(q)}: {json.dumps(v)}" for q, v in entries.items())
        + "\n    }"
        for name, entries in sorted(figures.items())
    )
    FILE.write_text(
        f'{{\n  "reasons": {json.dumps(REASONS, indent=4)},\n  "figures": {{\n{lines}\n  }}\n}}\n',
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
