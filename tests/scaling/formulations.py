"""Time of explicit hex8 by formulation and material, each beside another one of the same program.

    python tests/scaling/formulations.py --build build [--side 22]

All cases run in turn, as often as there are repeats; a ratio is that of the shortest times of two cases, which a busy machine disturbs least. The exit code
has the same meaning as that of bench.py: whether all runs worked.
"""

import sys
import tempfile
from pathlib import Path

from bench import command_line, execute, measured, print_table, read_summary, report

STEPS = 3e6  # elements times steps of a run: about a second
PLASTIC = "-box_yield_stress {} -box_hardening_modulus 1e7"
RATE = "-box_hardening_exponent 0.31 -box_rate_coefficient 0.025 -box_softening_exponent 1.09 -box_melting_temperature 1356 -box_specific_heat 383"
NEVER, SOON = PLASTIC.format(1e9), PLASTIC.format(1e5)  # strengths [Pa]: waves of 10 m/s have 1e7 Pa
FULL, MEAN, REDUCED = (f"-box_element_formulation {name}" for name in ("full", "mean_dilatation", "reduced"))
CASES = {
    "full, linear": f"{FULL} -box_material_type linear_elastic",
    "full, neo-Hookean": f"{FULL} -box_material_type neo_hookean",
    "mean dilatation, linear": f"{MEAN} -box_material_type linear_elastic",
    "mean dilatation, neo-Hookean": f"{MEAN} -box_material_type neo_hookean",
    "reduced, linear": f"{REDUCED} -box_material_type linear_elastic",
    "reduced, neo-Hookean": f"{REDUCED} -box_material_type neo_hookean",
    "j2, elastic": f"{MEAN} -box_material_type j2 {NEVER}",
    "j2, flows": f"{MEAN} -box_material_type j2 {SOON}",
    "Johnson-Cook, flows": f"{MEAN} -box_material_type johnson_cook {SOON} {RATE}",
}
# one case, another one, and the bound on the ratio of their times
RATIOS = (
    ("mean dilatation, linear", "full, linear", 1.4),
    ("mean dilatation, neo-Hookean", "full, neo-Hookean", 1.4),
    ("reduced, linear", "full, linear", 1 / 2.5),
    ("reduced, neo-Hookean", "full, neo-Hookean", 1 / 2.5),
    ("j2, elastic", "mean dilatation, neo-Hookean", 2.0),
    ("j2, flows", "mean dilatation, neo-Hookean", 2.0),
    ("Johnson-Cook, flows", "mean dilatation, neo-Hookean", None),
)


def run(build, case, side, limit):
    """Microseconds of processor time for an element and step of a free ball with a velocity field, as in solids.py: in a cube some formulations make use of
    elements that are boxes, and others do not."""
    divisions = max(2, 2 * round(side / 4 ** (1 / 3) / 2))  # n^3 elements in the middle, and six times n^2 in n / 2 layers
    elements = 4 * divisions**3
    steps = max(100, int(STEPS / elements) // 100 * 100)
    step = 0.5 * 0.01 / 1160 / 2  # under half the stable step of E = 1e9 Pa, nu = 0.3, rho = 1000 kg/m^3, h = 1 cm
    options = (
        f"-bodies box -box_dm_plex_dim 3 -box_dm_plex_shape ball -box_ball_divisions {divisions} -box_ball_radius {0.02 * divisions:g} -box_density 1000 "
        f"-box_youngs_modulus 1e9 -box_poissons_ratio 0.3 -box_initial_velocity 10*sin(x/0.1),0,0 -box_ts_type centraldifference -box_ts_time_step {step} "
        f"-time_step {100 * step} -time_end {steps * step} -progress 0 {CASES[case]}"
    )
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "summary.json"
        execute([build / "impakt", *options.split(), "-output_summary", path], limit)
        summary = read_summary(path, case)
    return 1e6 * summary["timing"]["cpu"] / summary["bodies"]["box"]["substeps"] / elements


def print_tables(arguments):
    times = {case: [] for case in CASES}
    for _ in range(arguments.repeats):
        for case, known in times.items():
            known.append(run(arguments.build, case, arguments.side, arguments.time_limit))
    print(f"\nExplicit hex8, about {arguments.side**3} elements of a ball: processor time per element and step, shortest of {arguments.repeats} runs in turn.\n")
    print_table([["case", "us"], *([case, f"{min(known):.3f}"] for case, known in times.items())])
    rows = [["case", "beside", "ratio", "bound"]]
    for case, other, bound in RATIOS:
        measured(arguments, f"explicit hex8, {case}, per element and step", "us", [min(times[case])], [min(times[other])], other)
        ratio = min(times[case]) / min(times[other])
        verdict = "-" if bound is None else f"{bound:.2f}: {'within' if ratio <= bound else 'above'}"
        rows.append([case, other, f"{ratio:.2f}", verdict])
    print()
    print_table(rows)


if __name__ == "__main__":
    options = {"repeats": (5, "runs of each case"), "side": (22, "elements along an edge of a cube of as many elements")}
    sys.exit(report(print_tables, command_line(__doc__, "impakt", 600, **options)))
