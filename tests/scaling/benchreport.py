"""One report of what `make bench` has measured, and what got slower since another one.

    python tests/scaling/benchreport.py --program build/impakt --out out/bench out/bench/bars.json ...
    python tests/scaling/benchreport.py --compare OLD.json --out out/bench

The report is report.md, report.json and report.png in --out. Each figure is a median with smallest and largest of its repeats, beside its yardstick.
Two reports are compared by the ratio of program to yardstick where both have one, so that another machine, or a busier one, matters less.
"""

import argparse
import json
import sys
from pathlib import Path
from statistics import median

from reporting import build, heading, machine, number, spread, table

CHANGE = 1.05  # a smaller change is none


def relative(figure):
    """The repeats of a figure in parts of its yardstick's: one by one where there are as many, else of its median. None where it has none."""
    values, yardstick = figure["values"], figure["yardstick"]
    if not yardstick:
        return None
    return [v / y for v, y in zip(values, yardstick)] if len(values) == len(yardstick) else [v / median(yardstick) for v in values]


def read(path):
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        sys.exit(f"benchreport.py: {path}: {error}")


def draw(figures, path):
    """Ratios to yardsticks, with their spread."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    shown = [(figure["name"], relative(figure)) for figure in figures if len(figure["yardstick"]) > 1]
    if not shown:
        return False
    figure, axis = plt.subplots(figsize=(9, 1 + 0.35 * len(shown)), layout="constrained")
    middle = [median(ratios) for _, ratios in shown]
    reach = [[m - min(r) for m, (_, r) in zip(middle, shown)], [max(r) - m for m, (_, r) in zip(middle, shown)]]
    axis.barh([name for name, _ in shown], middle, xerr=reach, color="tab:blue", capsize=3)
    axis.axvline(1, color="black", linewidth=1)
    axis.invert_yaxis()
    axis.set_xlabel("time of Impakt / time of the plain C program")
    figure.savefig(path, dpi=120)
    plt.close(figure)
    return True


def write(arguments):
    """The report of all figures."""
    figures = [figure for path in arguments.figures for figure in read(path)]
    about = {"machine": machine(), "build": build(arguments.program)}
    lines = heading("What runs cost", about)
    lines += ["Median [smallest largest] of the repeats; less is better. A ratio is that of runs made in turn.", ""]
    rows = [["", "unit", "Impakt", "yardstick", "ratio", "yardstick is"]]
    for figure in figures:
        rows.append([figure["name"], figure["unit"], spread(figure["values"]), spread(figure["yardstick"]), spread(relative(figure) or []), figure["beside"] or "-"])
    lines += table(rows)
    if draw(figures, arguments.out / "report.png"):
        lines += ["![ratios](report.png)", ""]
    (arguments.out / "report.json").write_text(json.dumps({"about": about, "figures": figures}, indent=1), encoding="utf-8")
    (arguments.out / "report.md").write_text("\n".join(lines), encoding="utf-8")
    print(f"report   {arguments.out / 'report.md'}")


def verdict(old, new):
    """Whether a figure got slower, as a word, and by how much. Repeats that overlap, or a change below 5 %, are no change."""
    before, after = (relative(figure) for figure in (old, new))
    if before is None or after is None:
        before, after = old["values"], new["values"]
    ratio = median(after) / median(before) if median(before) else float("inf" if median(after) else 1)
    if ratio > CHANGE and min(after) > max(before):
        return "slower", ratio
    if ratio < 1 / CHANGE and max(after) < min(before):
        return "faster", ratio
    return "same", ratio


def compare(arguments):
    """What got slower comes first."""
    old, new = read(arguments.compare), read(arguments.out / "report.json")
    known = {figure["name"]: figure for figure in old["figures"]}
    rows = []
    for figure in new["figures"]:
        if figure["name"] in known:
            word, ratio = verdict(known[figure["name"]], figure)
            rows.append((word, ratio, figure["name"], f"{spread(known[figure['name']]['values'])} {figure['unit']}", f"{spread(figure['values'])} {figure['unit']}"))
    rows.sort(key=lambda row: ({"slower": 0, "same": 1, "faster": 2}[row[0]], -row[1]))
    print(f"old: {old['about']['machine']['date']}, {old['about']['build']['commit']}; new: {new['about']['machine']['date']}, {new['about']['build']['commit']}\n")
    print("\n".join(table([["", "new / old", "figure", "old", "new"], *((row[0], number(row[1]), *row[2:]) for row in rows)])))
    print(f"{sum(row[0] == 'slower' for row in rows)} of {len(rows)} figures got slower")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("figures", nargs="*", type=Path, help="what bench.py, solids.py and contact.py wrote with --json")
    parser.add_argument("--program", type=Path, help="the program that was measured")
    parser.add_argument("--out", type=Path, required=True, help="directory of the report")
    parser.add_argument("--compare", type=Path, help="the report.json of an earlier report")
    arguments = parser.parse_args()
    if arguments.compare:
        compare(arguments)
    elif arguments.figures and arguments.program:
        write(arguments)
    else:
        parser.error("give --program and files with figures, or --compare with an earlier report")


if __name__ == "__main__":
    main()
