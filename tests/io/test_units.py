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


NUMBER_WITH_UNIT = re.compile(r"(?:\d\.?|\)) (kg|t|m|mm|s|kg m\^2|t mm\^2)(?=[,;\n])")


@pytest.mark.parametrize(
    "units, expected",
    [("SI", {"kg", "kg m^2", "m", "s"}), ("mm-t-s", {"t", "t mm^2", "mm", "s"}), ("none", set())],
)
def test_forecast_follows(units, expected, impakt):
    """What -check expects, and the warning of an element that bounds the step of a mesh from a file; the wall time is in seconds always."""
    run = impakt(f"{MM} -units {units} -block_ts_type centraldifference -check")
    forecast = run.stdout.split("check of body block")[1].split("check of the run")[0]
    assert set(NUMBER_WITH_UNIT.findall(forecast)) == expected
    assert ", centre (50, 51, 0)" in forecast


# Wrong options, and what the message says of their numbers
WRONG = {
    "-block_density 0": "is 0.{density};",
    "-block_youngs_modulus -1": "is -1.{stress};",
    "-block_material_type j2 -block_yield_stress -1": "is -1.{stress};",
    "-block_material_type j2": "begins to yield{in_stress}",
    "-block_thickness 0": "is 0.{length};",
    "-block_translate 0,-6": "is 5.{length} inside",
    "-block_translate 1e20,0": "is 100.{length} large and lies 1e+20{length} from",
    "-block_axisymmetric true -block_translate -50,0": "from x = -50. to 50.{length};",
    "-block_probe 0,0": "(0., 0., 0.){length} lies outside the mesh of body 'block', about 1{length} from",
    "-time_step 0": "-time_step 0.{time} must",
    "-time_end -1": "-time_end -1.{time} must be later than -time_start 0.{time}",
    "-time_step 1e-10 -time_end 1e20": "-time_step 1e-10{time} is too small for 1e+20{time} of",
    "-contact_law tied": "is apart by 1.{length}, which",
    "-schwarz_snes_max_it 0 -controller_step_cuts 0": "{length} are allowed",
    "-contact_type augmented_lagrangian -contact_augmentation_max_it 1 -controller_step_cuts 0": "augmentations the gap is off by 0.000906771{length}. Raise",
}
LABELS = {
    "SI": {"density": " kg/m^3", "stress": " Pa", "force": " N", "in_stress": " in Pa", "length": " m", "time": " s"},
    "mm-t-s": {"density": " t/mm^3", "stress": " MPa", "force": " N", "in_stress": " in MPa", "length": " mm", "time": " s"},
    "none": {"density": "", "stress": "", "force": "", "in_stress": "", "length": "", "time": ""},
}


@pytest.mark.parametrize("units", list(LABELS))
@pytest.mark.parametrize("wrong", list(WRONG))
def test_errors_follow(wrong, units, impakt):
    """Errors name the units that the user counts in."""
    check_message(impakt(f"{MM} -units {units} {wrong}", expect_failure=True), [WRONG[wrong].format(**LABELS[units])])


@pytest.mark.parametrize("option, unit", [("density", "t/mm^3"), ("youngs_modulus", "MPa")])
def test_missing_numbers_are_asked_for(option, unit, impakt):
    """In the units that are set: who is asked for kg/m^3 gives 7850."""
    without = re.sub(rf"-block_{option} \S+", "", MM)
    for units, asked in (("mm-t-s", f" in {unit}"), ("none", None)):
        run = impakt(f"{without} -units {units}", expect_failure=True)
        assert re.fullmatch(rf"impakt: error: -block_{option} is missing; give [^;]*?(?P<unit> in \S+)?\n", run.stderr)["unit"] == asked


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
        (f"{MM} -units mm-t-s -block_gravity 0,-9810", []),
        (f"{MM} -units mm-t-s -block_gravity 0,-9.81", ["-block_gravity 9.81 mm/s^2 is implausible and would fit m/s^2"]),
        (f"{BLOCK} -block_density 7850 -block_youngs_modulus 2.1e11 -block_gravity 3,-9810", ["-block_gravity 9810. m/s^2 is implausible and would fit mm/s^2"]),
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
