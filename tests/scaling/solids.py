"""Time and memory of bodies in three dimensions: explicit hex8 beside the yardstick, set-up, field output, multigrid.

    python tests/scaling/solids.py --build build [--largest 1000000]

The yardstick takes no advantage of elements that are boxes; the program does, so that it has a ball, whose elements are none, as well as a cube.

Program and yardstick run in turn, as in bench.py, whose exit code has the same meaning: whether all runs worked.
"""

import json
import re
import resource
import sys
import tempfile
from pathlib import Path
from statistics import median

from bench import (
    command_line,
    execute,
    measured,
    print_table,
    read_summary,
    report,
    spread,
)

STEPS = 2e7  # elements times steps of a run: some seconds
SPEED_BOUND = 1.5
MEMORY_BOUND = 3.0  # kB per element
SETUP_BOUND = 60.0  # s
FRAME_BOUND = 20.0  # explicit steps
MATERIALS = ("linear", "neo_hookean")
TYPES = {"linear": "linear_elastic", "neo_hookean": "neo_hookean"}


def mesh(shape, per_side):
    """Options of a cube of so many elements along an edge, or of a ball of as many elements but for a rest, which are 1 cm wide at least."""
    if shape == "box":
        length = per_side * 0.01
        return {"box_dm_plex_box_faces": f"{per_side},{per_side},{per_side}", "box_dm_plex_box_upper": f"{length},{length},{length}"}
    divisions = max(2, 2 * round(per_side / 4 ** (1 / 3) / 2))  # n^3 elements in the middle, and six times n^2 in n / 2 layers
    return {"box_dm_plex_shape": "ball", "box_ball_divisions": divisions, "box_ball_radius": f"{0.02 * divisions:g}"}


def box(per_side, material, steps, shape="box"):
    """Options of the problem that the yardstick solves: a free body with a velocity field, in controller steps of 100 substeps at most."""
    step = 0.5 * 0.01 / 1160 / 2  # under half the stable step of E = 1e9 Pa, nu = 0.3, rho = 1000 kg/m^3, h = 1 cm
    inner = min(steps, 100)
    options = {
        "bodies": "box",
        "box_dm_plex_dim": 3,
        **mesh(shape, per_side),
        "box_material_type": TYPES[material],
        "box_density": 1000,
        "box_youngs_modulus": 1e9,
        "box_poissons_ratio": 0.3,
        "box_initial_velocity": "10*sin(x/0.1),0,0",
        "box_ts_type": "centraldifference",
        "box_ts_time_step": step,
        "time_step": inner * step,
        "time_end": max(1, round(steps / inner)) * inner * step,
        "progress": 0,
    }
    return [word for name, value in options.items() for word in (f"-{name}", str(value))]


def run(build, options, limit):
    """Summary, wall time [s] and peak memory [kB] of a run."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "summary.json"
        output = execute([build / "impakt", *options, "-output_summary", path], limit)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss  # of the largest child so far: cases go from small to large
        return read_summary(path, "a cube"), peak, output


def explicit(build, per_side, material, shape, repeats, limit):
    """Rows of the table of explicit runs: times per element and step of both programs, and what the body cost beside."""
    elements = per_side**3
    steps = max(20, int(STEPS / elements))
    steps = steps if steps < 100 else steps // 100 * 100
    times, references = [], []
    for _ in range(repeats):
        line = execute([build / "yardstick_hex8", "--elements", str(elements), "--steps", str(steps), "--material", material], limit)
        references.append(json.loads(line)["cpu_us_per_element_step"])
        summary, peak, output = run(build, box(per_side, material, steps, shape), limit)
        made = summary["bodies"]["box"]["substeps"]
        times.append(1e6 * summary["timing"]["cpu"] / made / int(re.search(r"(\d+) cells of shape", output)[1]))
    ratio = median(times) / median(references)
    return {
        "row": [shape, material, f"{elements}", spread(times), spread(references), f"{ratio:.2f}", "within the bound" if ratio <= SPEED_BOUND else "above the bound"],
        "peak": peak,
        "setup": summary["timing"]["wall_setup"],
        "elements": elements,
        "times": times,
        "references": references,
    }


def frame_cost(build, per_side, limit):
    """Seconds of one frame of fields, and of one explicit step, from runs with and without them."""
    options = box(per_side, "linear", 20)
    plain, _, _ = run(build, options, limit)
    with tempfile.TemporaryDirectory() as directory:
        written, _, _ = run(build, [*options, "-output_fields", f"{directory}/fields.h5"], limit)
    step = plain["timing"]["wall"] / plain["bodies"]["box"]["substeps"]
    return (written["timing"]["wall"] - plain["timing"]["wall"]) / 2, step  # two frames: the first state and the last


def multigrid(build, per_side, limit):
    """Unknowns and CG iterations of a static cube, held below and pulled above, with GAMG."""
    options = {
        "bodies": "box",
        "box_dm_plex_dim": 3,
        "box_dm_plex_box_faces": f"{per_side},{per_side},{per_side}",
        "box_density": 1000,
        "box_youngs_modulus": 1e9,
        "box_poissons_ratio": 0.3,
        "box_ts_type": "static",
        "box_boundary_displacement": "zmin",
        "box_boundary_displacement_zmin": "0,0,0",
        "box_boundary_traction": "zmax",
        "box_boundary_traction_zmax": "1e5,0,1e5",
        "box_ksp_type": "cg",
        "box_pc_type": "gamg",
        "box_ksp_converged_reason": None,
        "time_step": 1,
        "time_end": 1,
        "progress": 0,
    }
    words = [word for name, value in options.items() for word in ((f"-{name}", str(value)) if value is not None else (f"-{name}",))]
    summary, _, output = run(build, words, limit)
    iterations = [int(line.split("iterations")[1]) for line in output.splitlines() if "iterations" in line and "CONVERGED" in line]
    return summary["bodies"]["box"]["dofs"], max(iterations), summary["timing"]


def print_tables(arguments):
    """Run everything and print the tables."""
    build, limit = arguments.build, arguments.time_limit
    sides = [side for side in (10, 22, 46, 100) if side**3 <= arguments.largest]
    print("\nExplicit hex8, full integration: CPU time per element and step [us], median [minimum maximum].\n")
    results = [explicit(build, side, material, shape, arguments.repeats, limit) for side in sides for material in MATERIALS for shape in ("ball", "box")]
    for result in results:
        name = f"explicit hex8, {result['row'][1]}, {result['elements']} elements{', ball' if result['row'][0] == 'ball' else ''}, per element and step"
        measured(arguments, name, "us", result["times"], result["references"], "yardstick_hex8.c")
    print_table([["shape", "material", "elements", "program", "yardstick", "ratio", f"bound {SPEED_BOUND}"], *(result["row"] for result in results)])
    last = results[-1]
    memory = last["peak"] / last["elements"]
    print(f"\nmemory at {last['elements']} elements: {memory:.2f} kB per element (bound {MEMORY_BOUND})")
    print(f"set-up of {last['elements']} elements: {last['setup']:.1f} s (bound {SETUP_BOUND:g} s)")
    measured(arguments, f"memory of an element, of {last['elements']}", "kB", [memory])
    measured(arguments, f"set-up of {last['elements']} hex8", "s", [last["setup"]])
    frame, step = frame_cost(build, sides[-1], limit)
    print(f"a frame of fields of {last['elements']} elements: {frame:.2f} s, {frame / step:.1f} explicit steps (bound {FRAME_BOUND:g})")
    measured(arguments, f"a frame of fields of {last['elements']} hex8", "s", [frame], [step], "an explicit step")
    print("\nCG with GAMG and rigid-body near-null space, a static cube held below, pulled and sheared above:\n")
    rows = [["unknowns", "iterations", "set-up, s", "time loop, s"]]
    for side in [side for side in (14, 21, 31, 45) if side == 14 or side**3 <= arguments.largest]:
        unknowns, iterations, timing = multigrid(build, side, limit)
        measured(arguments, f"CG with GAMG, {unknowns} unknowns, iterations", "1", [iterations])
        rows.append([f"{unknowns}", f"{iterations}", f"{timing['wall_setup']:.1f}", f"{timing['wall']:.1f}"])
    print_table(rows)


if __name__ == "__main__":
    options = {"repeats": (3, "runs of each case"), "largest": (1000000, "elements of the largest box")}
    sys.exit(report(print_tables, command_line(__doc__, "impakt and yardstick_hex8", 600, **options)))
