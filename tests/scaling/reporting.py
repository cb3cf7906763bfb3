"""What reports of measurements share: the machine and the build, tables in Markdown, spread of repeats."""

import os
import platform
import subprocess
from datetime import UTC, datetime
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[2]


def first_line(command):
    """The first line that a command prints; empty if there is no such command."""
    try:
        lines = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout.splitlines()
    except OSError:
        return ""
    return lines[0].strip() if lines else ""


def machine():
    """What the figures were measured on."""
    cpu = [line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines() if line.startswith("model name")]
    memory = [line.split()[1] for line in Path("/proc/meminfo").read_text(encoding="utf-8").splitlines() if line.startswith("MemTotal")]
    return {
        "processor": cpu[0] if cpu else platform.machine(),
        "cores": len(os.sched_getaffinity(0)),
        "memory_GB": round(int(memory[0]) / 1e6, 1) if memory else None,
        "system": f"{platform.system()} {platform.release()}",
        "load": round(os.getloadavg()[0], 2),
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
    }


def build(program):
    """What was measured."""
    try:
        version = subprocess.run([program, "-version"], capture_output=True, text=True, check=False).stdout.split("\n")
    except OSError:
        version = []
    return {"version": [line.strip() for line in version if line.strip()], "commit": first_line(["git", "describe", "--always", "--dirty"])}


def heading(title, about):
    """The head of a report: machine and build."""
    lines = [f"# {title}", ""]
    for part in ("machine", "build"):
        for key, value in about[part].items():
            lines.append(f"- {key.replace('_', ', ')}: {'; '.join(value) if isinstance(value, list) else value}")
    if about["machine"]["load"] > 0.5:
        lines += ["", f"**Other programs ran as well** (load {about['machine']['load']:g} at the start): times say little, ratios of runs made in turn more, counts all."]
    return [*lines, ""]


def table(rows):
    """Rows of text, the first of them the header, in Markdown."""
    head, *body = [[str(cell) for cell in row] for row in rows]
    return ["| " + " | ".join(head) + " |", "| " + " | ".join("---" for _ in head) + " |", *("| " + " | ".join(row) + " |" for row in body), ""]


def number(value, digits=3):
    """A number as text; a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}g}"


def spread(values, digits=3):
    """Median, with minimum and maximum in brackets."""
    values = [value for value in values if value is not None]
    if not values:
        return "-"
    return f"{number(median(values), digits)} [{number(min(values), digits)} {number(max(values), digits)}]"
