"""-units: labels follow it, numbers do not; what is implausible in it is a warning that names the option, the value and the unit that would fit."""

import re

import numpy as np
import pytest
from cases import long
from conftest import IMPAKT, ROOT
from impakt_results import read
from messages import check_message

# A steel block of 100 mm on a floor, in mm, t, s
BLOCK = (
    "-bodies block -obstacles floor -floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1 -contact_pairs block.ymin:floor -block_dm_plex_box_faces 3,3 "
    "-block_dm_plex_box_lower 0,1 -block_dm_plex_box_upper 100,101 -block_initial_velocity 0,-1e4 -time_step 1e-6 -time_end 2e-4 -monitor_interval 100"
)
MM = f"{BLOCK} -block_density 7.85e-9 -block_youngs_modulus 210000"
# Whatever is a label in one set, by what it is in the other
TO_MM = {"m": "mm", "m^2": "mm^2", "s": "s", "m/s": "mm/s", "N": "N", "N m": "N mm", "N s": "N s", "J": "mJ", "kg m/s": "t mm/s", "kg m^2/s": "t mm^2/s", "Pa": "MPa", "1": "1"}


def labels(units, shared_run):
    run = shared_run(f"{MM} -units {units} -output_fields fields.h5 -block_probe 50,51")
    results = read(run.folder / "history.h5")
    fields = results.fields
    return run, results, results.units | {name: fields.units(name) for name in fields.names_of_fields}


def test_labels_follow(shared_run):
    """Of the history, fields and summary; of what is printed: no unit of another set is left. All numbers are the same."""
    si, mm, none = (labels(units, shared_run) for units in ("SI", "mm-t-s", "none"))
    assert {name: TO_MM[label] for name, label in si[2].items()} == mm[2]
    assert {"mm", "mJ", "MPa", "t mm/s", "N mm"} <= set(mm[2].values())
    assert set(none[2].values()) == {"", "1"}
    for (run, results, _), units in zip((si, mm, none), ("SI", "mm-t-s", "none"), strict=True):
        assert results.unit_system == results.fields.file.attrs["units"] == run.summary["units"] == units
        np.testing.assert_array_equal(results.pairs["block.ymin:floor"]["force"], si[1].pairs["block.ymin:floor"]["force"])
    found = [set(re.findall(r"\d\.? (kg|t|m|mm|s|m/s|N|N m|N mm|N s|J|mJ|N/m)\b(?!/)", re.sub(r"\S+ s wall, \S+ s processor", "", run.stdout))) for run, _, _ in (si, mm, none)]
    assert found[0] >= {"kg", "m", "s", "N", "J"} and not found[0] & {"t", "mm", "mJ"}
    assert found[1] >= {"t", "mm", "s", "N", "mJ"} and not found[1] & {"kg", "m", "J"}
    assert not found[2]


@pytest.mark.parametrize(("units", "expected"), [("SI", {"kg", "m", "s", "kg m^2"}), ("mm-t-s", {"t", "mm", "s", "t mm^2"}), ("none", set())])
def test_labels_of_a_check_follow(units, expected, impakt):
    """Of what -check adds to the start, for an explicit body, but for the seconds that the run itself takes."""
    text = impakt(f"{MM} -block_ts_type centraldifference -block_ts_time_step auto -check -units {units}").stdout
    text = re.sub(r"^  wall time .*", "", text[text.index("check of body") :], flags=re.MULTILINE)
    assert set(re.findall(r"[\d)] (kg m\^2|t mm\^2|kg|t|mm|m|s)\b", text)) == expected


def test_nothing_is_read_by_the_way(impakt):
    """A size that the mesh does not take is an option that nobody reads, as ever."""
    check_message(impakt(f"{BLOCK} -block_density 7850 -block_youngs_modulus 2.1e11 -block_ball_radius 1", expect_failure=True), ["-block_ball_radius"])


def test_wrong_word(impakt):
    check_message(impakt(f"{MM} -units imperial", expect_failure=True), ["-units", "imperial"])


@pytest.mark.parametrize(
    "options, words",
    [
        (f"{MM} -units mm-t-s", []),
        (f"{MM} -units none -block_density 1e20", []),
        (MM, ["-block_density 7.85e-09 kg/m^3 is implausible and would fit t/mm^3"]),
        (f"{BLOCK} -units mm-t-s -block_density 7850 -block_youngs_modulus 2.1e11", ["-block_density 7850. t/mm^3 is implausible and would fit kg/m^3", "-block_youngs_modulus 2.1e+11 MPa is implausible and would fit Pa"]),
        (f"{BLOCK} -block_density 7850 -block_youngs_modulus 210 -time_step 1e-3 -time_end 2e-3", ["-block_youngs_modulus 210. Pa is implausible and would fit GPa"]),
        (f"{BLOCK} -block_density 7850 -block_youngs_modulus 2.1e11 -block_scale 100", ["-block_scale 10000. m is implausible and would fit mm"]),
        (f"{BLOCK} -block_density 7850 -block_youngs_modulus 2.1e11 -block_dm_plex_box_upper 10000,101", ["-block_dm_plex_box_upper 10000. m is implausible and would fit mm"]),
    ],
)
@pytest.mark.parametrize("ranks", [1, 3])
def test_implausible(options, words, ranks, impakt):
    """Once as the run is set up, once at its end, and in the summary; each line once, whatever the ranks."""
    run = impakt(options, ranks)
    lines = [line for line in run.stderr.splitlines() if "implausible" in line]
    assert len(lines) == (2 if words else 0)
    for line in lines:
        assert all(word in line for word in words)
        assert line.count("implausible") == len(words)
    assert [text for text in run.summary["warnings"] if "implausible" in text] == [line.removeprefix("impakt: warning: ") for line in lines[1:]]


CASES = sorted({path.name for path in (ROOT / "options").glob("*.opts")} - {"bar.opts"})  # which others include


@pytest.mark.parametrize("case", [*CASES[::12], *long(*(case for i, case in enumerate(CASES) if i % 12))])
def test_cases_are_plausible(case, impakt):
    """None of options/ is warned of in its set-up, after which a wrong word ends the run."""
    run = impakt(f"-options_file options/{case} -exact zzz", expect_failure=True)
    check_message(run, ["-exact", "zzz"])
    assert "implausible" not in run.stderr


def test_angles_and_times_name_their_unit(launch):
    """Each option whose name or meaning is of angles or times says in what it takes them."""
    table = re.findall(r"^\| `-([^`]+)` \| `([^`]*)` \| (.*) \|$", launch([IMPAKT, "-help", "markdown"]).stdout, re.MULTILINE)
    assert len(table) > 100
    of_angles = re.compile(r"\b(angle|rotation|turn)\b")
    of_times = re.compile(r"^time_(start|end|step)$|ts_time_step|wall|damping_|_rate$|_decay$")
    wrong = []
    for name, takes, text in table:
        takes = takes.replace("\\|", "|")
        if of_angles.search(text) and not re.search(r"\[rad\]|degrees", text + takes) and takes not in ("true|false", "true|false|near") and not name.endswith(("_view", "_centre", "translate")):
            wrong.append(name)
        if of_times.search(name) and not re.search(r"\[[^\]]*\bs\b[^\]]*\]|minutes|per plastic strain", text + takes):
            wrong.append(name)
    assert not wrong
