"""What the programs that draw runs share: colours, units, the way into a history file, and what a program says on the command line."""

import sys
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
from impakt_results import CannotRead

# Okabe and Ito's colours, told apart with any colour vision
BLUE, ORANGE, GREEN, PURPLE, BLACK = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000"
COLOURS = (BLUE, ORANGE, GREEN, PURPLE)
DASHED = {"color": BLACK, "linestyle": (0, (4, 3)), "linewidth": 1.2, "zorder": 3}
PREFIXED = ("mm", "mJ", "MPa", "t mm")  # units that take no more prefixes
PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


class CannotDraw(CannotRead):
    """What is in the file cannot be drawn; the message says why."""


def scale(largest, unit):
    """A factor and a unit in which `largest` is a number from 1 to 1000; 1 and the same unit where it takes no prefix: a number, mm, none at all."""
    if unit in ("", "1") or unit.startswith(PREFIXED):
        return 1.0, unit
    for size, prefix in PREFIXES:
        if largest >= size:
            return 1 / size, prefix + unit
    return 1.0, unit


def time_scale(time, unit="s"):
    """A factor and a unit for the axis of times, by how long they take."""
    span = np.ptp(time)
    if unit != "s":
        return 1, unit
    return (1e6, "µs") if span < 5e-3 else (1e3, "ms") if span < 5 else (1, unit)


def labelled(quantity, unit):
    """What stands beside an axis: without brackets where the run has no units (-units none)."""
    return f"{quantity} [{unit}]" if unit else quantity


@contextmanager
def history_file(path):
    """The history of a run, open; a name that is not in it is one that every run with contact has."""
    if not Path(path).is_file():
        raise CannotDraw(f"there is no file {path}")
    try:
        with h5py.File(path, "r") as file:
            yield file
    except (KeyError, IndexError, StopIteration) as error:
        raise CannotDraw(f"{path} is not the history of an Impakt run with contact: {error}") from error
    except OSError as error:
        raise CannotDraw(f"{path} cannot be read as HDF5: {error}") from error


def command_line(usage, draw):
    """Draw from the files that the command line names into the last of them, and give the exit code."""
    program, arguments = Path(sys.argv[0]).name, sys.argv[1:]
    if len(arguments) < 2 or (len(arguments) > 2 and "..." not in usage):
        print(f"usage: python plots/{program} {usage}", file=sys.stderr)
        return 1
    *files, figure = arguments
    try:
        Path(figure).parent.mkdir(parents=True, exist_ok=True)
        draw(*files, path=figure)
    except (CannotRead, OSError, ValueError) as error:
        print(f"plots/{program}: {error}", file=sys.stderr)
        return 1
    print(figure)
    return 0
