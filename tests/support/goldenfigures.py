"""The golden figures of the report's tables, tests/paper/golden.json: what our runs gave when they were recorded, with a tolerance for each.
Published values have no part in it.

An experiment has, for each quantity, its value, the tolerance and the reason for it, which is written out under "reasons".
tests/paper/record.py writes the file.
"""

import json
from pathlib import Path

from paper.results import figure

FILE = Path(__file__).resolve().parents[1] / "paper/golden.json"
GOLDEN = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {"figures": {}, "reasons": {}}


def differences(name, summary):
    """Figures of a summary that are not what they were, as texts."""
    found = []
    for quantity, (value, tolerance, reason) in GOLDEN["figures"][name].items():
        now = figure(summary, quantity)
        if now is None or not abs(now - value) <= tolerance:
            found.append(f"{quantity}: {now!r} instead of {value!r} within {tolerance!r} ({GOLDEN['reasons'][reason]})")
    return found
