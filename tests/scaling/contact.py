"""What contact costs: two bars of hexahedra that meet, implicit and explicit, beside none, and contact alone for surfaces from 10^2 to 10^5 facets.

    python tests/scaling/contact.py --build build [--largest 100000]

The share of contact is that of everything in a controller step but the bodies' own work: search, transfer, active set, outer iteration. The
times of CalculiX 2.20 beside the bars are not measured here: they are those of the same problem on a machine of this kind, 1270 s with
implicit and 256 s with explicit steps.
"""

import csv
import sys
import tempfile
from collections import Counter
from pathlib import Path

from bench import (
    ROOT,
    command_line,
    execute,
    measured,
    print_table,
    read_summary,
    report,
)

CALCULIX = {"implicit": 1270.0, "explicit": 256.0}  # s
FASTER = {"implicit": 20.0, "explicit": 50.0}
SHARE = {"implicit": 0.10, "explicit": 0.15}
DEARER = 1.25  # a run in contact beside one without, at most


def bars(faces, length, speed, gap, more):
    """Options of two equal bars with square ends of 0.1 m, along z."""
    options = {"bodies": "a,b", "contact_pairs": "a.zmax:b.zmin", "progress": 0, **more}
    for name, low, high, velocity in (("a", -length - gap / 2, -gap / 2, speed), ("b", gap / 2, length + gap / 2, -speed)):
        options |= {
            f"{name}_dm_plex_dim": 3,
            f"{name}_dm_plex_box_faces": ",".join(map(str, faces)),
            f"{name}_dm_plex_box_lower": f"0,0,{low}",
            f"{name}_dm_plex_box_upper": f"0.1,0.1,{high}",
            f"{name}_density": 1000,
            f"{name}_youngs_modulus": 1e9,
            f"{name}_poissons_ratio": 0.25,
            f"{name}_initial_velocity": f"0,0,{velocity}",
        }
    return options


def run(build, options, limit):
    """Summary of a run, and the seconds of PETSc's log events by name."""
    with tempfile.TemporaryDirectory() as directory:
        summary, log = Path(directory) / "summary.json", Path(directory) / "log.csv"
        words = [word for name, value in options.items() for word in (f"-{name}", str(value))]
        execute([build / "impakt", *words, "-output_summary", summary, "-log_view", f":{log}:ascii_csv"], limit)
        with log.open(encoding="utf-8") as file:
            seconds = Counter()  # of all stages
            for row in csv.DictReader(file):
                if row["Rank"] == "0":
                    seconds[row["Event Name"]] += float(row["Time"])
        return read_summary(summary, "two bars"), seconds


def contact_seconds(events):
    """Of controller steps without the bodies' own work."""
    return events["ContactStep"] - events["BodyIntegrate"] - events.get("BodyCompliance", 0.0)


def whole_runs(arguments, build, limit):
    """Rows of the table of the two whole runs."""
    cases = {
        "implicit": {"time_step": 1e-6, "time_end": 2e-4},
        "explicit": {"time_step": 2e-7, "time_end": 2e-4, "a_ts_type": "centraldifference", "b_ts_type": "centraldifference"},
    }
    for name, more in cases.items():
        summary, events = run(build, bars((10, 10, 100), 1.0, 100, 1e-3, more), limit)
        timing = summary["timing"]
        cpu = timing["cpu"] + timing["wall_setup"]  # set-up is one thread's work
        share = contact_seconds(events) / timing["wall"]
        ratio = CALCULIX[name] / cpu
        held = "held" if ratio >= FASTER[name] and share <= SHARE[name] else "not held"
        measured(arguments, f"two bars of hexahedra, {name}", "s", [cpu], [CALCULIX[name]], "CalculiX 2.20, not measured here")
        measured(arguments, f"contact beside all of the time loop, two bars of hexahedra, {name}", "1", [share])
        yield [name, f"{cpu:.2f}", f"{CALCULIX[name]:g}", f"{ratio:.0f}", f"{100 * share:.1f} %", f"{FASTER[name]:g} times, {100 * SHARE[name]:g} %: {held}"]


def many_elements(arguments, build, limit):
    """Row of the table of options/bars-hex.opts, in contact and with the bars apart."""
    words = {"options_file": ROOT / "options" / "bars-hex.opts", "progress": 0}
    seconds, counts = [], []
    for more in ({}, {"right_translate": "0.01,0,0"}):
        summary, events = run(build, words | more, limit)
        seconds.append(summary["timing"]["cpu"])
        counts.append(events)
    ratio = seconds[0] / seconds[1]
    measured(arguments, "two bars of 3.5e5 hexahedra, explicit, in contact", "s", [seconds[0]], [seconds[1]], "the same bars apart")
    shares = [f"{100 * counts[0].get(name, 0) / counts[0]['ContactStep']:.1f} %" for name in ("BodyForce", "MatSolve", "ContactUpdate")]
    return [f"{seconds[0]:.1f}", f"{seconds[1]:.1f}", f"{ratio:.2f}", *shares, f"{DEARER} times: {'held' if ratio <= DEARER else 'not held'}"]


def surfaces(arguments, build, largest, limit):
    """Rows of the table of growing surfaces: microseconds of contact per facet and step, in steps that all are in contact, the first of them with
    whatever is made once: the bars part after 20."""
    steps = 18
    for side in (10, 32, 100, 316):
        if side**2 > largest:
            return
        size = 0.1 / side
        step = 0.2 * size / 1100
        more = {"time_step": step, "time_end": steps * step, "a_ts_type": "centraldifference", "b_ts_type": "centraldifference"}
        summary, events = run(build, bars((side, side, 2), 2 * size, 10, 0.0, more), limit)
        per_facet = 1e6 / steps / side**2
        outer = contact_seconds(events) - events["ContactUpdate"]
        measured(arguments, f"search and transfer, {side**2} facets, per facet and step", "us", [events["ContactUpdate"] * per_facet])
        measured(arguments, f"active set and sweeps, {side**2} facets, per facet and step", "us", [outer * per_facet])
        yield [f"{side**2}", f"{events['ContactUpdate'] * per_facet:.2f}", f"{outer * per_facet:.2f}", f"{(events['BodyIntegrate'] + events.get('BodyCompliance', 0)) * per_facet:.1f}", f"{summary['schwarz']['mean_contact_steps']:.2f}"]


def print_tables(arguments):
    """Run everything and print the tables."""
    build, limit = arguments.build, arguments.time_limit
    print("\nTwo bars of 10 x 10 x 100 hex8, 200 implicit or 1000 explicit steps: CPU time with set-up [s].\n")
    print_table([["steps", "Impakt", "CalculiX 2.20", "ratio", "contact", "bounds"], *whole_runs(arguments, build, limit)])
    print("\nTwo bars of 96 x 48 x 48 and 80 x 40 x 40 hex8, 200 explicit steps in contact and apart: CPU time [s], and shares of the steps in contact.\n")
    print_table([["in contact", "apart", "ratio", "elements", "layers and interface", "search", "bound"], many_elements(arguments, build, limit)])
    print("\nContact of two square surfaces, explicit bodies: microseconds per facet and step.\n")
    print_table([["facets", "search and transfer", "active set, sweeps", "bodies", "sweeps"], *surfaces(arguments, build, arguments.largest, limit)])


if __name__ == "__main__":
    sys.exit(report(print_tables, command_line(__doc__, "impakt", 600, largest=(100000, "facets of the largest surface"))))
