"""How runs scale with the number of ranks: counts on many ranks, times on one and two, the same results on all.

    python tests/scaling/ranks.py --build build [--ranks 64] [--size 24] [--repeats 5] [--only counts,results,corner,memory,speed,model]

Two `hex8` boxes that meet, 2n x n x n and 5/6 of that along each axis, n being --size. The report is out/scaling/report.md, with its figures in
report.json and pictures beside it. Counts do not hang on a clock, so that they may be taken with many more ranks than cores. Messages, bytes and
reductions are those of PETSc's log of controller steps, on the rank that has most of them; the difference of two runs of different length leaves
out what is made once. The exit code tells whether all runs worked.
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

import model as performance
from bench import RunError, command_line, execute, read_summary
from reporting import ROOT, build, heading, machine, number, spread, table

PARTS = ("counts", "results", "corner", "memory", "speed", "model")
COUNTED = {"messages": "Num Messages", "bytes": "Message Length", "reductions": "Num Reductions"}
MPI = {
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_pml": "ob1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
}


def boxes(n, contact=True, integrator="centraldifference", corner=False):
    """Options of two boxes that meet from the first step on, or that never do; on a corner of the first alone."""
    faces = {"a": (n, n, 2 * n), "b": tuple(max(2, 5 * k // 6) for k in (n, n, 2 * n))}
    width = {"a": 0.1, "b": 0.1}
    if corner:
        faces["b"], width["b"] = tuple(max(2, n // 3) for _ in range(3)), 0.1 / 3
    length = {name: 2 * width[name] if name == "a" or not corner else width[name] for name in faces}
    gap = 1e-7 if contact else 1e-2
    options = {"bodies": "a,b", "contact_pairs": "a.zmax:b.zmin", "progress": 0}
    for name, low in (("a", -length["a"]), ("b", gap)):
        options |= {
            f"{name}_dm_plex_dim": 3,
            f"{name}_dm_plex_box_faces": ",".join(map(str, faces[name])),
            f"{name}_dm_plex_box_lower": f"0,0,{low}",
            f"{name}_dm_plex_box_upper": f"{width[name]},{width[name]},{low + length[name]}",
            f"{name}_density": 1000,
            f"{name}_youngs_modulus": 1e9,
            f"{name}_poissons_ratio": 0.25,
            f"{name}_initial_velocity": f"0,0,{10 if name == 'a' else -10}",
            f"{name}_ts_type": integrator,
        }
    return options | {"time_step": 0.3 * 0.1 / n / 1100}


def run(arguments, options, ranks, steps, more=(), launcher=()):
    """Summary of a run."""
    with tempfile.TemporaryDirectory() as directory:
        summary = Path(directory) / "summary.json"
        words = [word for name, value in options.items() for word in (f"-{name}", str(value))]
        words += ["-time_end", repr(steps * options["time_step"]), "-output_summary", str(summary), *more]
        execute([*arguments.mpiexec, *launcher, "-n", str(ranks), arguments.build / "impakt", *words], arguments.time_limit)
        return read_summary(summary, f"{ranks} ranks")


def run_logged(arguments, options, ranks, steps):
    """Summary of a run, and for each rank the counts of PETSc's log of controller steps, which 64 ranks on 2 cores take a minute to write."""
    with tempfile.TemporaryDirectory() as directory:
        log = Path(directory) / "log.csv"
        summary = run(arguments, options, ranks, steps, ("-log_view", f":{log}:ascii_csv"))
        with log.open(encoding="utf-8") as file:
            events = [row for row in csv.DictReader(file) if row["Event Name"] == "ContactStep" and row["Stage Name"] == "Main Stage"]
        return summary, [{name: float(row[column]) for name, column in COUNTED.items()} for row in events]


def run_counting(arguments, options, ranks, steps, event, column="Count"):
    """How often each rank has made an event of PETSc's log, or what else a column of it counts, in all stages."""
    with tempfile.TemporaryDirectory() as directory:
        log, made = Path(directory) / "log.csv", [0] * ranks
        run(arguments, options, ranks, steps, ("-log_view", f":{log}:ascii_csv"))
        with log.open(encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row["Event Name"] == event:
                    made[int(row["Rank"])] += int(float(row[column]))
        return made


def run_timing(arguments, options, steps, event):
    """Seconds of a step on one rank that an event of PETSc's log takes, in all stages."""
    seconds = []
    for n in steps:
        with tempfile.TemporaryDirectory() as directory:
            log = Path(directory) / "log.csv"
            run(arguments, options, 1, n, ("-log_view", f":{log}:ascii_csv"))
            with log.open(encoding="utf-8") as file:
                seconds.append(sum(float(row["Time"]) for row in csv.DictReader(file) if row["Event Name"] == event))
    return (seconds[1] - seconds[0]) / (steps[1] - steps[0])


def all_reductions(arguments, options, ranks, steps):
    """Reductions of a whole run on the rank with most of them, set-up and output included."""
    with tempfile.TemporaryDirectory() as directory:
        log, made = Path(directory) / "log.csv", [0] * ranks
        run(arguments, options, ranks, steps, ("-log_view", f":{log}:ascii_csv"))
        with log.open(encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row["Event Name"] == "summary":
                    made[int(row["Rank"])] += float(row["Num Reductions"])
        return max(made)


def exponent(ranks, values):
    """The power of the number of ranks with which a count grows, by least squares of logarithms; None where there are not two of them."""
    points = [(math.log(r), math.log(v)) for r, v in zip(ranks, values) if r > 1 and v and v > 0]
    if len(points) < 2:
        return None
    x, y = (sum(p[k] for p in points) / len(points) for k in (0, 1))
    return sum((p[0] - x) * (p[1] - y) for p in points) / sum((p[0] - x) ** 2 for p in points)


def counts_of(arguments, options, ranks, steps):
    """What each of these steps counts on the rank with most of it, and what lies on the largest rank."""
    short, before = run_logged(arguments, options, ranks, steps[0])
    long, after = run_logged(arguments, options, ranks, steps[1])
    made = steps[1] - steps[0]
    sweeps = long["timing"]["per_phase"]["sweeps"]["count"] - short["timing"]["per_phase"]["sweeps"]["count"]
    found = {"ranks": ranks, "sweeps": sweeps / made}
    for name in COUNTED:
        most = max(a[name] - b[name] for a, b in zip(after, before)) / made
        found[name] = most
        found[f"{name}_per_sweep"] = most * made / sweeps if sweeps else None
    for name, value in long["timing"]["ranks"].items():
        if isinstance(value, dict):
            found[name] = value["largest"]
            found[f"{name}_imbalance"] = value["largest"] / value["mean"] if value["mean"] else None
    found["steps_in_contact"] = long["contact"]["steps_in_contact"]
    return found


COLUMNS = ("messages", "bytes", "reductions", "sweeps", "messages_per_sweep", "reductions_per_sweep", "neighbours", "elements", "facets", "rows", "peak_memory")


def counts(arguments, found, lines):
    """Counts of each step of explicit and implicit bodies on 1, 2, 4, ... ranks."""
    ranks = [2**k for k in range(20) if 2**k <= arguments.ranks]
    for integrator, steps in (("centraldifference", (4, 12)), ("alpha2", (3, 6))):
        if integrator == "alpha2":
            ranks = [r for r in ranks if r <= arguments.implicit]
        size = arguments.size if integrator == "centraldifference" else max(4, arguments.size // 3)
        rows = [counts_of(arguments, boxes(size, integrator=integrator), r, steps) for r in ranks]
        powers = {name: exponent(ranks, [row[name] for row in rows]) for name in COLUMNS}
        found[integrator] = {"size": size, "rows": rows, "exponents": powers}
        lines += [f"## Counts: {integrator}, boxes of {size}x{size}x{2 * size} and 5/6 of that", ""]
        lines += ["Of one controller step, on the rank with most; elements, facets, rows, neighbours and memory of the largest rank.", ""]
        cells = [[row["ranks"], *(number(row[name], 4) for name in COLUMNS)] for row in rows]
        lines += table([["ranks", *(name.replace("_", " ") for name in COLUMNS)], *cells, ["exponent", *(number(powers[name], 2) for name in COLUMNS)]])
        names = ("elements", "facets", "rows", "work")
        lines += ["Largest by mean:", ""]
        lines += table([["ranks", *names], *([row["ranks"], *(number(row[f"{name}_imbalance"]) for name in names)] for row in rows)])


FIGURES = (("contact", "force_mean"), ("contact", "impulse"), ("contact", "max_penetration"), ("bodies", "a", "kinetic"), ("bodies", "a", "potential"), ("bodies", "b", "kinetic"), ("bodies", "b", "potential"))


def pick(summary, path):
    for key in path:
        summary = summary[key]
    return summary


def results(arguments, found, lines):
    """The same figures on 1 to 16 ranks."""
    size, rows = max(6, arguments.size // 3), []
    reference = run(arguments, boxes(size), 1, 60)
    scale = pick(reference, ("bodies", "a", "kinetic"))
    for ranks in [r for r in (2, 3, 5, 8, 16) if r <= arguments.ranks]:
        summary = run(arguments, boxes(size), ranks, 60)
        differences = {}
        for path in FIGURES:
            value, wanted = pick(summary, path), pick(reference, path)
            # energies are compared in parts of the kinetic energy, a depth in parts of an element, others in parts of themselves
            unit = 0.1 / size if path[-1] == "max_penetration" else scale if path[0] == "bodies" else abs(wanted)
            differences["/".join(path)] = abs(value - wanted) / unit if unit else abs(value)
        rows.append({"ranks": ranks, "differences": differences, "largest": max(differences.values())})
    found["results"] = {"size": size, "rows": rows}
    lines += [f"## The same results: {size}x{size}x{2 * size} and 5/6 of that, explicit, 60 steps", "", "Largest relative difference of a figure from that on one rank.", ""]
    lines += table([["ranks", "difference", "of"], *([row["ranks"], number(row["largest"], 2), max(row["differences"], key=row["differences"].get)] for row in rows)])


def corner(arguments, found, lines):
    """A small box on one corner of a large one: how facets and rows lie on 4 ranks, cut as if contact cost nothing, as by default, and as a graph."""
    size, rows = max(6, arguments.size // 2), []
    ways = {
        "elements alone": ("-a_mesh_contact_cost", "0", "-b_mesh_contact_cost", "0"),
        "default": (),
        "graph": ("-a_mesh_division", "graph", "-b_mesh_division", "graph"),
    }
    for name, more in ways.items():
        summary = run(arguments, boxes(size, corner=True), 4, 6, more)
        ranks = summary["timing"]["ranks"]
        rows.append({"division": name} | {key: ranks[key]["largest"] / ranks[key]["mean"] if ranks[key]["mean"] else None for key in ("elements", "facets", "rows", "work")})
    found["corner"] = {"size": size, "rows": rows}
    lines += ["## Contact on one corner, 4 ranks: largest by mean", ""]
    names = ("elements", "facets", "rows", "work")
    lines += table([["division", *names], *([row["division"], *(number(row[key]) for key in names)] for row in rows)])


def memory(arguments, found, lines):
    """Memory of a rank beyond what a process needs for itself, which boxes of a few elements show, and without its halo."""
    ranks = [r for r in (1, 2, 4, 8) if r <= arguments.ranks]
    size, rows = 2 * arguments.size, []
    for r in ranks:
        small, much = (run(arguments, boxes(n), r, 2)["timing"]["ranks"] for n in (4, size))
        by_itself, halo = small["peak_memory"]["mean"], much["halo"]["mean"] / much["nodes"]["mean"]
        rows.append({"ranks": r, "mean": much["peak_memory"]["mean"], "by_itself": by_itself, "halo": halo, "own": (much["peak_memory"]["mean"] - by_itself) * (1 - halo)})
    points = [(math.log(row["ranks"]), math.log(row["own"])) for row in rows]
    power = (points[-1][1] - points[0][1]) / (points[-1][0] - points[0][0]) if len(points) > 1 else None
    found["memory"] = {"size": size, "rows": rows, "exponent": power}
    lines += [f"## Memory of a rank: {size}x{size}x{2 * size} and 5/6 of that, explicit", ""]
    cells = [[row["ranks"], *(number(row[name] / 1e6, 4) for name in ("mean", "by_itself")), number(row["halo"]), number(row["own"] / 1e6, 4)] for row in rows]
    lines += table([["ranks", "mean (MB)", "of a process by itself (MB)", "part of nodes that are a halo", "what is left (MB)"], *cells, ["exponent", "", "", "", number(power, 2)]])


def bandwidth(arguments, processes):
    """GB/s of all of so many processes at a time, each on a core of its own."""
    cores = sorted(os.sched_getaffinity(0))
    command = [str(arguments.build / "yardstick_memory"), "100", "2"]
    running = [subprocess.Popen(["taskset", "-c", str(cores[k]), *command], stdout=subprocess.PIPE, text=True) for k in range(processes)]
    outputs = [process.communicate()[0] for process in running]
    if any(process.returncode for process in running):
        raise RunError("yardstick_memory failed")
    return sum(json.loads(output)["GB_per_s"] for output in outputs)


def speed(arguments, found, lines):
    """One rank against two, pinned to cores, in turn; beside the same without contact, and bandwidth of memory."""
    lines += ["## One rank against two", ""]
    if len(os.sched_getaffinity(0)) < 2:
        lines += ["This machine has one core: not measured.", ""]
        return
    steps = (4, 24)
    names = {"in contact": boxes(arguments.size), "without contact": boxes(arguments.size, contact=False)}
    times = {name: {1: [], 2: []} for name in (*names, "memory")}
    for _ in range(arguments.repeats):
        for ranks in (1, 2):
            times["memory"][ranks].append(bandwidth(arguments, ranks))
            for name, options in names.items():
                loops = [run(arguments, options, ranks, n, launcher=("--bind-to", "core"))["timing"]["wall"] for n in steps]
                times[name][ranks].append((loops[1] - loops[0]) / (steps[1] - steps[0]))
    ratios = {name: [a / b for a, b in zip(times[name][1], times[name][2])] for name in names}
    ratios["memory"] = [b / a for a, b in zip(times["memory"][1], times["memory"][2])]
    found["speed"] = {"size": arguments.size, "times": times, "ratios": ratios}
    ceiling = median(ratios["memory"])
    lines += [f"Boxes of {arguments.size}x{arguments.size}x{2 * arguments.size} and 5/6 of that, explicit; ms of a step, {arguments.repeats} repeats in turn, median [smallest largest].", ""]
    rows = [[name, *(spread([1e3 * t for t in times[name][r]]) for r in (1, 2)), spread(ratios[name]), number(median(ratios[name]) / ceiling)] for name in names]
    rows.append(["memory (GB/s)", *(spread(times["memory"][r]) for r in (1, 2)), spread(ratios["memory"]), "1"])
    lines += table([["", "1 rank", "2 ranks", "2 ranks are faster", "of memory's ceiling"], *rows])


def model(arguments, found, lines):
    """A model of a step's time, fitted to boxes of one size, beside runs of other sizes; what it says of many cores of a public machine."""
    if len(os.sched_getaffinity(0)) < 2:
        lines += ["## Model", "", "This machine has one core: not measured.", ""]
        return
    sizes = sorted({2 * arguments.size // 3, arguments.size, 4 * arguments.size // 3})
    steps, measured = (4, 44), {}
    for _ in range(arguments.repeats):
        for size in sizes:
            for contact in (False, True):
                for ranks in (1, 2):
                    runs = [run(arguments, boxes(size, contact=contact), ranks, n, launcher=("--bind-to", "none")) for n in steps]
                    measured.setdefault((size, contact, ranks), []).append([summary["timing"]["cpu"] for summary in runs])
    # other programs only make runs longer: the shortest of the long ones, less the shortest of the short ones
    times = {key: (min(v[1] for v in values) - min(v[0] for v in values)) / (steps[1] - steps[0]) for key, values in measured.items()}
    shapes = {}
    for size in sizes:
        small = max(2, 5 * size // 6)
        shapes[size] = (2 * size**3 + max(2, 5 * 2 * size // 6) * small**2, ((size + 1) ** 2, (small + 1) ** 2))
    of_size = {(contact, ranks): times[arguments.size, contact, ranks] for contact in (False, True) for ranks in (1, 2)}
    layers = min(run_timing(arguments, boxes(arguments.size, contact=False), steps, "MatSolve") for _ in range(arguments.repeats))
    rates = performance.fit(performance.messages(arguments), *shapes[arguments.size], of_size, layers)
    rows = []
    for (size, contact, ranks), time in times.items():
        guess = performance.predict(rates, *shapes[size], contact, ranks)
        rows.append({"size": size, "contact": contact, "ranks": ranks, "measured": time, "model": guess, "error": guess / time - 1})
    machine_rates = performance.moved(rates, bandwidth(arguments, 2) / 2, performance.ARCHER2)
    many = performance.large(machine_rates)
    found["model"] = {"rates": rates, "rows": rows, "machine": performance.ARCHER2, "machine_rates": machine_rates, "large": many}
    lines += [f"## Model, fitted to boxes of {arguments.size}x{arguments.size}x{2 * arguments.size} and 5/6 of that", ""]
    lines += [f"Processor time of the first rank, the least of {arguments.repeats} repeats. An element takes {number(1e6 * rates['element'])} us, {number(1e6 * rates['cache'])} us less with each halving of a rank's number, an entry of a layer's factors {number(1e9 * rates['layer'])} ns, of joined ones {number(1e9 * rates['joined'])} ns, {number(rates['solve_loss'])} times that on several ranks; a message {number(1e6 * rates['latency'])} us, a reduction {number(1e6 * rates['reduction'])} us.", ""]
    cells = [[row["size"], "yes" if row["contact"] else "no", row["ranks"], number(1e3 * row["measured"]), number(1e3 * row["model"]), f"{100 * row['error']:+.0f} %"] for row in rows]
    lines += table([["size", "contact", "ranks", "measured (ms)", "model (ms)", "error"], *cells])
    lines += [f"1e8 elements with 1e6 contact nodes on each side, on cores of {performance.ARCHER2['name']} ({performance.ARCHER2['source']}), ms of a step:", ""]
    names = performance.PARTS
    cells = [[row["ranks"], number(1e3 * row["step"]), *(number(1e3 * row[name]) for name in names), number(row["efficiency"], 2), row["bottleneck"]] for row in many]
    lines += table([["cores", "step", *names, "efficiency", "longest"], *cells])


def draw(found, directory):
    """Pictures of counts over ranks."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    for integrator in ("centraldifference", "alpha2"):
        if integrator not in found:
            continue
        rows = found[integrator]["rows"]
        figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
        for axis, names, title in ((axes[0], ("messages", "bytes", "reductions"), "of one step, largest rank"), (axes[1], ("elements", "facets", "rows", "neighbours"), "on the largest rank")):
            for name in names:
                points = [(row["ranks"], row[name]) for row in rows if row[name]]
                if points:
                    axis.loglog(*zip(*points), "o-", label=name, base=2)
            axis.set_yscale("log", base=10)
            axis.set_xlabel("ranks")
            axis.set_title(f"{integrator}: {title}")
            axis.grid(True, which="both", alpha=0.3)
            axis.legend()
        figure.savefig(directory / f"counts-{integrator}.png", dpi=120)
        plt.close(figure)
        yield f"counts-{integrator}.png"
    if "model" in found:
        rows = found["model"]["large"]
        figure, axis = plt.subplots(figsize=(6, 4), layout="constrained")
        for name in ("step", *performance.PARTS):
            axis.loglog([row["ranks"] for row in rows], [1e3 * row[name] for row in rows], "o-", label=name)
        axis.set_xlabel(f"cores of {found['model']['machine']['name']}")
        axis.set_ylabel("ms of a step")
        axis.grid(True, which="both", alpha=0.3)
        axis.legend()
        figure.savefig(directory / "model.png", dpi=120)
        plt.close(figure)
        yield "model.png"


def main():
    arguments = command_line(
        __doc__,
        "impakt, yardstick_memory and yardstick_mpi",
        900,
        ranks=(64, "most ranks"),
        implicit=(16, "most ranks of implicit bodies"),
        size=(24, "elements along the short edges of the first box"),
        repeats=(5, "repeats of what is timed"),
        texts={"only": (",".join(PARTS), "parts of the report"), "out": (str(ROOT / "out/scaling"), "directory of the report"), "mpiexec": ("mpiexec", "how to start a run on several ranks")},
    )
    os.environ.update({key: os.environ.get(key, value) for key, value in MPI.items()})
    arguments.mpiexec = arguments.mpiexec.split()
    wanted = arguments.only.split(",")
    unknown = set(wanted) - set(PARTS)
    if unknown:
        sys.exit(f"ranks.py: --only {','.join(sorted(unknown))}: there are {', '.join(PARTS)}")
    directory = Path(arguments.out)
    directory.mkdir(parents=True, exist_ok=True)
    about = {"machine": machine(), "build": build(arguments.build / "impakt")}
    found, lines = {"about": about}, heading("Ranks", about)
    try:
        for part in PARTS:
            if part in wanted:
                print(f"{part} ...", flush=True)
                globals()[part](arguments, found, lines)
    except RunError as error:
        print(f"ranks.py: a run failed: {error}", file=sys.stderr)
        return 1
    pictures = list(draw(found, directory))
    lines += [f"![{name}]({name})" for name in pictures]
    (directory / "report.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    (directory / "report.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
