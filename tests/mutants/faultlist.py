"""The deliberate faults of faults.json: each is a search-and-replace of one expression in one file of src."""

import json
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Fault:
    """`search` stands once in `file`; with `replace` in its place a user sees `effect`."""

    name: str
    file: str
    search: str
    replace: str
    effect: str

    def apply(self, text):
        return text.replace(self.search, self.replace)


def read_faults():
    return [Fault(**fault) for fault in json.loads(Path(__file__).with_name("faults.json").read_text())]


def misplaced(faults):
    """Faults whose expression is not there, or not once, as messages."""
    found = []
    for fault in faults:
        path = ROOT / fault.file
        times = path.read_text().count(fault.search) if path.exists() else 0
        if times != 1:
            found.append(f"tests/mutants/faults.json: fault {fault.name}: its expression stands {times} times in {fault.file}, not once: write another fault for that folder")
    return found
