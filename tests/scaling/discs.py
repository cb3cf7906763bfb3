"""What many bodies cost that press on each other: five rows of soft discs that fall on each other in a box and come to rest.

    python tests/scaling/discs.py --build build [--columns 200 --film out/pile.gif]

Two hundred columns are 1000 discs.
"""

import re
import subprocess
import sys
import tempfile
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

sys.path.insert(1, str(ROOT / "tests/support"))
from pile import END, STEP, pile

ROWS = 5
FRAMES = 25


def run(build, columns, words, limit):
    """Summary of a run, and its kinetic energy over time [J]."""
    import h5py  # the others of this folder do without

    with tempfile.TemporaryDirectory() as directory:
        options, summary, history = (Path(directory) / name for name in ("pile.opts", "summary.json", "history.h5"))
        options.write_text(re.sub(" -(?=[a-z])", "\n-", pile(ROWS, columns)), encoding="utf-8")
        execute([build / "impakt", "-options_file", options, "-progress", "0", "-output_summary", summary, "-output_history", history, *words], limit)
        with h5py.File(history) as file:
            kinetic = sum(body["kinetic"][()] for body in file["body"].values())
        return read_summary(summary, "a pile of discs"), kinetic


def print_tables(arguments):
    """Run everything and print the table."""
    discs = ROWS * arguments.columns
    film = Path(arguments.film).absolute() if arguments.film else None
    words = []
    if film:
        film.parent.mkdir(parents=True, exist_ok=True)
        words = ["-output_fields", film.with_suffix(".h5"), "-output_fields_interval", f"{END / STEP / FRAMES:.0f}"]
    summary, kinetic = run(arguments.build, arguments.columns, words, arguments.time_limit)
    steps, timing = len(kinetic) - 1, summary["timing"]
    each = 1e6 * timing["cpu"] / steps / discs
    measured(arguments, f"{discs} soft discs that settle in a box, per disc and step", "us", [each])
    print(f"\n{discs} soft discs that settle in a box, {steps} explicit steps.\n")
    print_table([
        ["CPU time, s", "wall, s", "per disc and step, us", "sweeps a step in contact", "kinetic energy at the end / largest"],
        [f"{timing['cpu']:.1f}", f"{timing['wall'] + timing['wall_setup']:.1f}", f"{each:.1f}", f"{summary['schwarz']['mean_contact_steps']:.2f}", f"{kinetic[-1] / kinetic.max():.1e}"],
    ])
    if film:
        subprocess.run([sys.executable, ROOT / "plots/render.py", film.with_suffix(".xdmf"), film, "--field", "von_mises", "--fps", "8", "--size", "1600x240"], check=True)


if __name__ == "__main__":
    sys.exit(report(print_tables, command_line(__doc__, "impakt", 1800, {"film": ("", "picture or film of the discs to draw")}, columns=(20, "discs side by side, of which there are five rows"))))
