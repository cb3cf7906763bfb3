"""Experiments: each is an options file below options/paper, and its name is the file's path there.

What the program is told stands in the options files alone; here is what the report and the runner have to know beside it.
"""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path("options/paper")
SHARED = "shared"  # files that others include; not experiments

PAIRINGS = {"ii": "Implicit-Implicit", "ie": "Implicit-Explicit", "ee": "Explicit-Explicit"}
MESHES = (50, 100, 200, 400)
HIGH_SPEED = {
    "high-speed/lagrange": "Lagrange multiplier, explicit",
    "high-speed/penalty-implicit": "penalty, implicit",
    "high-speed/penalty-explicit": "penalty, explicit",
    "high-speed/ii": "Schwarz, Implicit-Implicit",
    "high-speed/ie": "Schwarz, Implicit-Explicit",
    "high-speed/ee": "Schwarz, Explicit-Explicit",
}

# Steps in a run beyond which a history is of no use: it would be 10^6 records long
LONGEST_HISTORY = 200_000
SECONDS_PER_SUBSTEP = (
    1e-5  # roughly, with the sweeps that it is repeated for; only for the order of the runs and the estimate of what is left
)


class BadOptions(Exception):
    """An options file cannot be read; the message says which and why."""


@dataclass(frozen=True)
class Experiment:
    name: str  # e.g. mesh/ii-200
    title: str  # first comment of the options file
    options: str  # all of them, of included files too, without comments

    @property
    def group(self):
        return self.name.rpartition("/")[0]

    @property
    def pairing(self):
        """ii, ie, ee, or none in the name."""
        found = set(re.split(r"[-/]", self.name)) & set(PAIRINGS)
        return found.pop() if len(found) == 1 else None

    @property
    def variant(self):
        """The name within its group, without the pairing."""
        name = self.name.rpartition("/")[2]
        return name.removesuffix(f"-{self.pairing}")

    @property
    def file(self):
        return FOLDER / f"{self.name}.opts"

    @property
    def duration(self):
        return float(self.last("time_end", "0")) - float(self.last("time_start", "0"))

    @property
    def steps(self):
        return round(self.duration / float(self.last("time_step", "inf")))

    @property
    def keeps_history(self):
        return self.steps <= LONGEST_HISTORY

    @property
    def cost(self):
        """Seconds it may take, for the order of the runs."""
        steps = [self.last(f"{body}_ts_time_step", self.last("time_step", "inf")) for body in ("left", "right")]
        return 0.3 + SECONDS_PER_SUBSTEP * sum(self.duration / float(step) for step in steps)

    def last(self, name, default=None):
        """The value that holds: an option that is given again replaces what was given before."""
        found = re.findall(rf"^-{name}[ \t]+(\S+)", self.options, re.MULTILINE)
        return found[-1] if found else default


def lines_of(path, root):
    try:
        return (root / path).read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise BadOptions(f"{path}: {error.strerror}") from error


def resolve(path, root=ROOT, within=()):
    """The options of a file, those of files that it includes in their place, without comments and empty lines."""
    if path in within:
        raise BadOptions(f"{path} includes itself")
    lines = []
    for line in lines_of(path, root):
        line = line.partition("#")[0].strip()
        if line.startswith("-options_file"):
            included = line.split(None, 1)[1:]
            if not included:
                raise BadOptions(f"{path}: -options_file without a file")
            lines += resolve(included[0], root, (*within, path)).splitlines()
        elif line:
            lines.append(line)
    return "\n".join(lines)


def read(path, root=ROOT):
    """An experiment from its options file, whose first line is its title."""
    first = (lines_of(path, root) or [""])[0]
    if not first.startswith("#"):
        raise BadOptions(f"{path}: the first line is not a comment that says what is run")
    name = str(Path(path).relative_to(FOLDER).with_suffix(""))
    return Experiment(name, first.lstrip("# ").rstrip(), resolve(str(path), root))


def find(root=ROOT):
    """All experiments, by name."""
    paths = sorted(path.relative_to(root) for path in (root / FOLDER).rglob("*.opts"))
    found = [read(path, root) for path in paths if SHARED not in path.parts]
    return {experiment.name: experiment for experiment in found}
