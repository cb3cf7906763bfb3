"""The methods side by side on the high-speed impact: the figures that tests/README.md tells of them, each measured again."""

import math
import re

import pytest
from cases import long
from conftest import ROOT

SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
NUMBER = re.compile(r"(?P<sign>−?)(?P<digits>\d+(?:\.\d+)?)(?:·10(?P<power>[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+))?")


def table():
    """Rows of the first table under the heading: name of the run, options, cells with figures."""
    text = (ROOT / "tests/README.md").read_text()
    section = text.split("## Methods on the high-speed impact\n")[1].split("\n## ")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")]
    return [(name.replace("`", ""), options.strip("`"), cells) for name, options, *cells in rows[2:]]


ROWS = table()


def rounds_to(value, text):
    """Whether a value is what is printed, to its last digit."""
    match = NUMBER.fullmatch(text)
    assert match, text
    power = int((match["power"] or "0").translate(SUPERSCRIPTS))
    decimals = len(match["digits"].partition(".")[2])
    printed = float(match["digits"]) * 10.0**power * (-1 if match["sign"] else 1)
    return abs(value - printed) <= 0.5001 * 10.0 ** (power - decimals)


def summary_of(options, shared_run):
    return shared_run(f"-options_file options/{options}").summary


def test_reader():
    assert rounds_to(1.3666e-6, "1.4·10⁻⁶") and not rounds_to(1.46e-6, "1.4·10⁻⁶")
    assert rounds_to(-2.675e-2, "−2.7·10⁻²") and not rounds_to(2.675e-2, "−2.7·10⁻²")
    assert rounds_to(2.04, "2.0") and not rounds_to(2.06, "2.0")
    assert rounds_to(0.2726, "0.27") and not rounds_to(0.28, "0.27")
    assert rounds_to(5, "5") and not rounds_to(4, "5")
    assert len(ROWS) == 13


NAMED = {name: row for name, *row in ROWS}
# Variants of rows that `make test` measures
LONG = [name for name in NAMED if any(word in name for word in ("moving frame", "Robin", "explicit – explicit", "stabilized", "N/m, explicit"))]


@pytest.mark.parametrize("name", [*(name for name in NAMED if name not in LONG), *long(*LONG)])
def test_table(name, shared_run):
    options, cells = NAMED[name]
    summary = summary_of(options, shared_run)
    contact, schwarz, system = summary["contact"], summary["schwarz"], summary["system"]
    mean, most = cells[0].split(" / ")
    energy = max(system["energy_error_min"], system["energy_error_max"], key=abs)
    figures = {
        "sweeps, mean": (schwarz["mean_contact_steps"], mean),
        "sweeps, max": (schwarz["max"], most),
        "force scatter": (contact["force_std"] / contact["force_mean"], cells[1]),
        "energy error": (energy, cells[2]),
        "kinetic energy error": (summary["errors"]["kinetic"], cells[3]),
        "onsets": (contact["onsets"], cells[4]),
    }
    wrong = {name: pair for name, pair in figures.items() if not rounds_to(*pair)}
    assert not wrong


def test_spike_of_forward_increments(shared_run):
    """The contact nodes, 1/400 of the mass, are stopped within a step: m v / dt = 6.25e-7 kg 100 m/s / 1e-7 s = 625 N, of 100 N."""
    contact = summary_of("paper/high-speed/lagrange.opts", shared_run)["contact"]
    assert contact["force_peak"] == pytest.approx(6.25e-7 * 100 / 1e-7, rel=0.01)
    assert math.isclose(contact["force_mean"], 100, rel_tol=1e-3)


@pytest.mark.long
def test_consistent_mass_chatters(shared_run):
    """Bars that graze each other, massless contact nodes: one onset with averaged mass, many with consistent mass."""
    consistent = "-left_mass_type consistent -right_mass_type consistent"
    onsets = [summary_of(f"grazing.opts {more}", shared_run)["contact"]["onsets"] for more in ("", consistent)]
    assert onsets[0] == 1
    assert 40 <= onsets[1] <= 80  # chatter hangs on round-off: 60 measured
