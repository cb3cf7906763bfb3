"""Time of explicit tri3, quad4, tet4 and hex8 beside plain C loops of each, and beside the roofline of the machine.

    python tests/scaling/shapes.py --build build [--largest 1000000]

The program's quad4 and hex8 make a disc and a ball, where they are no parallelograms: those have loops of their own, which the C loops have not.

Program and yardstick run in turn, as in bench.py, whose exit code has the same meaning: whether all runs worked. The roofline is the time that the plain
C loop's operations and bytes would take at the bandwidth and at the rate of operations that yardstick_solids.c measures, whichever is longer.
"""

import json
import re
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

STEPS = 2e7  # elements times steps of a run: some tenths of a second
BOUND = 1.2
SHAPES = {
    "tri3": (2, 2),
    "quad4": (2, 1),
    "tet4": (3, 6),
    "hex8": (3, 1),
}  # dimension, elements of a cell
MATERIALS = {"linear": "linear_elastic", "neo_hookean": "neo_hookean"}
# operations of yardstick_hex8.c for an element in a step: 8 points of 579 and 632, 24 for the nodal sums, 15 for its one node; bytes: 8 nodes'
# numbers, and as in yardstick_solids.c 11 passages of 3 numbers of a node
HEX8 = {"linear": (4671, 296), "neo_hookean": (5095, 296)}


def mesh(shape, cells):
    """Options of a mesh of about as many elements as the yardstick's box of so many cells along an edge, which are 1 cm wide at least."""
    dim = SHAPES[shape][0]
    if shape in ("tri3", "tet4"):
        return {
            "box_dm_plex_simplex": 1,
            "box_dm_plex_box_faces": ",".join([f"{cells}"] * dim),
            "box_dm_plex_box_upper": ",".join([f"{cells * 0.01:g}"] * dim),
        }
    # n^2 and 4 n of n / 2 layers, n^3 and 6 n^2 of them
    divisions = max(2, 2 * round((cells**dim / (3 if dim == 2 else 4)) ** (1 / dim) / 2))
    return {
        "box_dm_plex_shape": "ball",
        "box_ball_divisions": divisions,
        "box_ball_radius": f"{divisions * 0.02:g}",
    }


def case(shape, cells, material, steps):
    """Options of a free body with a velocity field, as the yardstick has, in controller steps of 100 substeps."""
    dim = SHAPES[shape][0]
    step = 1e-6  # under half the stable step of E = 1e9 Pa, nu = 0.3, rho = 1000 kg/m^3, h = 1 cm
    options = {
        "bodies": "box",
        "box_dm_plex_dim": dim,
        **mesh(shape, cells),
        "box_material_type": MATERIALS[material],
        "box_density": 1000,
        "box_youngs_modulus": 1e9,
        "box_poissons_ratio": 0.3,
        "box_initial_velocity": ",".join(["10*sin(x/0.1)", "0", "0"][:dim]),
        "box_ts_type": "centraldifference",
        "box_ts_time_step": step,
        "time_step": 100 * step,
        "time_end": steps * step,
        "progress": 0,
    }
    return [
        word for name, value in options.items() for word in (f"-{name}", str(value))
    ]


def run_program(build, options, limit):
    """Microseconds of processor time for an element and step, and how many elements there are."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "summary.json"
        output = execute([build / "impakt", *options, "-output_summary", path], limit)
        summary = read_summary(path, "a free body")
    elements = int(re.search(r"(\d+) cells of shape", output)[1])
    return 1e6 * summary["timing"]["cpu"] / summary["bodies"]["box"][
        "substeps"
    ] / elements, elements


def run_yardstick(build, shape, cells, material, steps, limit):
    """Microseconds for an element and step, floating point operations and bytes."""
    size = (
        ["--elements", cells**3]
        if shape == "hex8"
        else ["--shape", shape, "--cells", cells]
    )
    program = build / ("yardstick_hex8" if shape == "hex8" else "yardstick_solids")
    result = json.loads(
        execute(
            [program, *map(str, size), "--steps", str(steps), "--material", material],
            limit,
        )
    )
    counts = (
        HEX8[material]
        if shape == "hex8"
        else (result["flop_per_element_step"], result["bytes_per_element_step"])
    )
    return result["cpu_us_per_element_step"], *counts


def print_tables(arguments):
    """Run everything and print the tables."""
    build, limit = arguments.build, arguments.time_limit
    machine = json.loads(
        execute(
            [build / "yardstick_solids", "--shape", "machine", "--cells", "40"], limit
        )
    )
    bandwidth, rate = machine["bandwidth_GB_per_s"], machine["GFLOP_per_s"]
    print(
        f"\nOne core: {bandwidth:.1f} GB/s (triad of 40 million numbers), {rate:.1f} GFLOP/s (fused multiplications and additions in registers).\n"
    )
    print(
        "Explicit elements: CPU time per element and step [us], median [minimum maximum]; fraction reached of the roofline.\n"
    )
    rows = [
        [
            "shape",
            "material",
            "elements",
            "program",
            "yardstick",
            "ratio",
            f"bound {BOUND}",
            "roofline",
            "fraction",
        ]
    ]
    for shape, (dim, parts) in SHAPES.items():
        for target in [t for t in (1e4, 1e5) if t <= arguments.largest]:
            for material in MATERIALS:
                cells = max(2, round((target / parts) ** (1 / dim)))
                steps = max(100, int(STEPS / target) // 100 * 100)
                times, references = [], []
                for _ in range(arguments.repeats):
                    time, flop, size = run_yardstick(
                        build, shape, cells, material, steps, limit
                    )
                    references.append(time)
                    time, elements = run_program(
                        build, case(shape, cells, material, steps), limit
                    )
                    times.append(time)
                roofline = 1e-3 * max(flop / rate, size / bandwidth)
                ratio = median(
                    time / reference for time, reference in zip(times, references)
                )
                name = f"explicit {shape}, {material}, {elements} elements, per element and step"
                if shape != "hex8":  # solids.py has it
                    measured(
                        arguments, name, "us", times, references, "yardstick_solids.c"
                    )
                beside = f"roofline: {flop:.0f} operations at {rate:.1f} GFLOP/s, {size:.0f} bytes at {bandwidth:.1f} GB/s; fraction {roofline / median(times):.2f}"
                measured(
                    arguments,
                    f"{name}, beside the roofline",
                    "us",
                    times,
                    [roofline],
                    beside,
                )
                verdict = "within the bound" if ratio <= BOUND else "above the bound"
                rows.append(
                    [
                        shape,
                        material,
                        f"{elements}",
                        spread(times, 4),
                        spread(references, 4),
                        f"{ratio:.2f}",
                        verdict,
                        f"{roofline:.4f}",
                        f"{roofline / median(times):.2f}",
                    ]
                )
    print_table(rows)


if __name__ == "__main__":
    options = {
        "repeats": (3, "runs of each case"),
        "largest": (1000000, "elements of the largest body"),
    }
    sys.exit(
        report(
            print_tables,
            command_line(
                __doc__, "impakt, yardstick_solids and yardstick_hex8", 600, **options
            ),
        )
    )
