"""No two files of src call each other in a circle: whoever reads one need not know those that stand above it."""

import graphlib
import subprocess

from conftest import BUILD

DEFINES, ASKS = set("TDBRC"), "U"


def test_no_circles():
    """By the symbols of the object files; the order of the files from below is what the standard library's sort finds."""
    objects = sorted((BUILD / "src").rglob("*.o"))
    lines = subprocess.run(["nm", "-A", *objects], capture_output=True, text=True, check=True).stdout.splitlines()
    symbols = [(line.split(":")[0], *line.split()[-2:]) for line in lines]
    owner = {name: path for path, kind, name in symbols if kind in DEFINES}
    below = {path: set() for path in owner.values()}
    for path, kind, name in symbols:
        if kind == ASKS and name in owner:
            below.setdefault(path, set()).add(owner[name])
    assert len(below) > 100
    assert sum(map(len, below.values())) > 500
    assert len(list(graphlib.TopologicalSorter(below).static_order())) == len(below)  # CycleError names the files of a circle
