"""Words of the command line and values of options: what is not understood ends the run in a line that names the option and where it stands."""

import os
import re

import h5py
import pytest
from cases import long, validate
from conftest import IMPAKT, ROOT, complaints
from messages import check_message

BLOCKS = "options/blocks.opts"
SHORT = ["-time_end", "1e-6"]
FLOOR = ["-obstacles", "floor", "-floor_obstacle_type", "plane", "-floor_point", "0,-9,0", "-floor_normal", "0,1,0"]


@pytest.fixture
def words(launch, tmp_path):
    """Runs the program with these words, in a folder of its own."""
    (tmp_path / "options").symlink_to(ROOT / "options")

    def run(*words, ranks=1, timeout=60):
        return launch([IMPAKT, *words], ranks, timeout=timeout, cwd=tmp_path)

    return run


def refused(run, named):
    assert run.returncode > 0
    check_message(run, named)
    assert "options.c" not in run.stderr  # of PETSc


def steps(run):
    assert run.returncode == 0, run.stderr
    return int(re.search(r"(\d+) controller steps", run.stdout).group(1))


# Words, and what is told of them
WRONG = {
    "word": ([BLOCKS, "foo"], ["'foo'", "no option", ".opts"]),
    "second value": ([BLOCKS, "-left_density", "3", "4"], ["'4'", "-left_density", "'3'"]),
    "blank in a list": ([BLOCKS, "-left_initial_velocity", "1,", "2"], ["'2'", "-left_initial_velocity", "commas without blanks"]),
    "empty value": ([BLOCKS, "-left_density", ""], ["-left_density", "empty"]),
    "empty word": ([BLOCKS, ""], ["empty word"]),
    "no file": (["nowhere.opts"], ["'nowhere.opts'", "No such file"]),
    "file without name": (["-options_file", "-left_density", "3"], ["-options_file", "path"]),
    "folder": (["-options_file", "options"], ["'options'", "directory"]),
    "device": (["-options_file", "/dev/zero"], ["'/dev/zero'", "device"]),
    "open variable": (["-options_file", "a${b"], ["'a${b'", "without its }"]),
    "unknown variable": (["-options_file", "${IMPAKT_NOWHERE}/b"], ["${IMPAKT_NOWHERE}", "not set"]),
    "open variable of a viewer": ([BLOCKS, "-contact_view", "ascii:${b"], ["-contact_view", "'ascii:${b'", "without its }"]),
    "comma": ([BLOCKS, "-left_density", "7,850"], ["-left_density (the command line)", "'7,850'", "rho", "not a comma"]),
    "unit": ([BLOCKS, "-left_density", "7850kg"], ["-left_density", "'7850kg'", "without units"]),
    "fraction": ([BLOCKS, "-left_dm_plex_box_faces", "2.5,2"], ["-left_dm_plex_box_faces", "'2.5'", "whole number"]),
    "switch": ([BLOCKS, "-contact_facing", "perhaps"], ["-contact_facing", "'perhaps'", "true or false"]),
    "of PETSc": ([BLOCKS, "-left_snes_rtol", "tight"], ["-left_snes_rtol", "'tight'", "not a number"]),
    "of PETSc without value": ([BLOCKS, "-left_snes_rtol", "-time_end", "1e-6"], ["-left_snes_rtol", "no value"]),
    "not finite": ([BLOCKS, "-left_density", "nan"], ["-left_density (the command line)", "'nan'", "no finite number"]),
    "too large": ([BLOCKS, "-left_youngs_modulus", "1e400"], ["-left_youngs_modulus", "'1e400'", "no finite number"]),
    "large whole number": ([BLOCKS, "-monitor_interval", "9223372036854775809"], ["-monitor_interval", "9223372036854775809", "whole numbers go to"]),
    "large in a list": ([BLOCKS, "-left_dm_plex_box_faces", "2,-99999999999999999999"], ["-left_dm_plex_box_faces", "-99999999999999999999"]),
    "far away": ([BLOCKS, "-left_translate", "1e20,0"], ["'left'", "1e+20 m from the origin", "-left_translate"]),
    "point of a formula": ([BLOCKS, "-left_probe", "0,inf"], [": -left_probe: the formula 'inf'"]),
    "type of PETSc's": ([BLOCKS, "-left_snes_type", "bogus"], ["-left_snes_type (the command line)", "no SNES of type 'bogus'"]),
    "Newton's method of a linear body": ([BLOCKS, "-left_snes_max_it", "3"], ["-left_snes_max_it has no effect", "'left'", "linear"]),
    "and of an explicit one": ([BLOCKS, "-left_ts_type", "centraldifference", "-left_snes_monitor"], ["-left_snes_monitor has no effect", "explicit"]),
    "table of a device": ([BLOCKS, "-left_body_force", "table:/dev/zero,0"], ["-left_body_force", "'/dev/zero'", "a device"]),
    "viewer": ([BLOCKS, "-contact_view", "paper"], ["-contact_view", "'paper'", "viewer"]),
}


@pytest.mark.parametrize(("case", "ranks"), [*((case, 1) for case in WRONG), ("word", 2), ("comma", 2)])
def test_wrong_words(case, ranks, words, tmp_path):
    given, named = WRONG[case]
    refused(words(*given, ranks=ranks), named)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["options"]


# Lines of an options file, and what is told of them
LINES = {
    "prefix without value": ("-prefix_push", ["line 1", "-prefix_push needs the prefix"]),
    "prefix never pushed": ("-time_end 1\n-prefix_pop", ["line 2", "without a -prefix_push"]),
    "no prefix": ("-prefix_push 1", ['"1"', "first character must be a letter"]),
    "second value": ("-time_end 1 2", ["line 1", "'2' follows the value '1' of -time_end"]),
    "blank in a list": ("-left_gravity 0, -9.81 # m/s^2", ["line 1", "'-9.81' follows the value '0,' of -left_gravity", "without blanks"]),
    "two options with values": ("-time_end 1 -time_step 1", ["line 1", "'-time_step'", "a line of its own"]),
    "equals sign": ("-time_end = 1", ["line 1", "'1' follows the value '=' of -time_end"]),
    "two options": ("-time_end 1\n-left_density -right_density", ["line 2", "two options per line"]),
    "word": ("time_end 1", ["line 1", "'time_end' is no option", "dash"]),
    "byte-order mark": ("\ufeff-time_end 1", ["line 1", "byte-order mark"]),
    "line ends of old systems": ("-time_end 1\r-time_step 1", ["line 1", "carriage return"]),
    "zero byte": ("-time_end 1\n-time_\0", ["line 2", "zero byte"]),
    "option twice": ("-time_end 1\n\n-time_step 1 # s\n-time_end 2", ["line 4", "-time_end stands in line 1 already"]),
    "option twice by a prefix": ("-prefix_push left_\n-density 1\n-prefix_pop\n-density 1\n-LEFT_density 1", ["line 5", "-left_density stands in line 2 already"]),
}


@pytest.mark.parametrize("case", list(LINES))
def test_wrong_lines(case, words, tmp_path):
    text, named = LINES[case]
    (tmp_path / "wrong.opts").write_text(text + "\n", newline="")
    refused(words("wrong.opts"), ["wrong.opts" if "line" in str(named) else "", *named])


def test_file_that_includes_itself(words, tmp_path):
    for i in range(3):
        (tmp_path / f"{i}.opts").write_text(f"# comment\n-left_density 3 # another\n-options_file {(i + 1) % 3}.opts\n")
    refused(words("0.opts"), ["'2.opts' includes in line 3", "includes itself"])


def test_place_in_a_file(words, tmp_path):
    (tmp_path / "inner.opts").write_text("\n-prefix_push left_\n  -density abc # no number\n-prefix_pop\n")
    (tmp_path / "outer.opts").write_text(f"-options_file {BLOCKS}\n-options_file inner.opts\n")
    refused(words("outer.opts"), ["-left_density (inner.opts, line 3)", "'abc'"])
    (tmp_path / "inner.opts").write_text("-prefix_push left_\n  -poissons_ratio\n-prefix_pop\n")
    refused(words("outer.opts"), ["-left_poissons_ratio (inner.opts, line 2)", "no value"])


def test_option_twice_in_an_included_file(words, tmp_path):
    """The file that has both is named; another file, or the command line, may repeat an option, and the last one counts."""
    (tmp_path / "inner.opts").write_text("-time_step 1e-6\n-time_end 1e-6\n-time_step 1e-6\n")
    (tmp_path / "outer.opts").write_text(f"-time_end 7\n-options_file {BLOCKS}\n-options_file inner.opts\n")
    refused(words("outer.opts", ranks=3), ["'inner.opts', line 3", "-time_step stands in line 1 already"])
    (tmp_path / "inner.opts").write_text("-time_step 1e-6\n-time_end 3e-6\n")
    assert steps(words("outer.opts")) == 3
    assert steps(words("outer.opts", "-time_end", "2e-6")) == 2


def test_no_file_repeats_an_option(words, tmp_path):
    """All options files of options/ and tests/, which one file includes here: it is read to its end, which the last line shows."""
    files = sorted(path for folder in ("options", "tests") for path in (ROOT / folder).rglob("*.opts"))
    assert len(files) > 100
    (tmp_path / "every.opts").write_text("".join(f"-options_file {file.relative_to(ROOT)}\n" for file in files) + "-prefix_pop\n")
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    refused(words("every.opts"), [f"'every.opts', line {len(files) + 1}", "without a -prefix_push"])


# Options that are gone, with a value, and what the warning says that happens instead
GONE = {
    "-schwarz_sweep": ("additive", "the second body of a pair takes the reactions of the first"),
    "-left_mesh_bricks": ("3", "a box is cut such that a step costs least"),
    "-all_mesh_bricks": ("3", "a box is cut such that a step costs least"),
}


@pytest.mark.parametrize("option", list(GONE))
@pytest.mark.parametrize(("method", "ranks"), [("schwarz", 1), ("schwarz", 3), ("penalty", 1)])
def test_option_that_is_gone(option, method, ranks, impakt):
    """One warning, and the same run as without the option, to the last bit, whatever the method."""
    value, now = GONE[option]
    options = f"-options_file options/impact-high-speed.opts -exact none -time_end 2e-5 -contact_type {method}"
    without, run = impakt(options, ranks), impakt(f"{options} {option} {value}", ranks)
    told = [line for line in run.stderr.splitlines() if option in line]
    assert len(told) == 1
    assert told[0].startswith(f"impakt: warning: {option} {value} has no effect any more: ")
    assert now in told[0]
    assert option not in without.stderr
    for name in ("contact/left:right/force", "body/left/kinetic", "body/right/momentum"):
        values = [r.history[name][()] for r in (without, run)]
        assert values[0].any()
        assert (values[0] == values[1]).all(), name


TWO = """-bodies a,b
-obstacles floor,wall
-contact_pairs a:b,b:floor
-contact_law coulomb
-contact_friction 0.2
-contact_friction_a:b 0.3
-time_end 1e-5
-time_step 1e-6
-all_dm_plex_dim 2
-all_dm_plex_box_faces 4,4
-all_material steel
-all_gravity 0,-9.81
-material_steel_youngs_modulus 210e9
-material_steel_density 7800
-material_steel_poissons_ratio 0.3
-b_translate 0,1.1
-b_youngs_modulus 1e9
-floor_obstacle_type plane
-floor_point 0,-0.1
-floor_normal 0,1
-wall_obstacle_type plane
-wall_point 5,-0.1
-wall_normal -1,0
-b_boundary_displacement ymax,xmax
-b_boundary_displacement_ymax 0,0
-b_boundary_displacement_xmax 0,0
"""
# What overrides a list, and what is told of the options that are left over
LISTS = {
    "bodies": (["-bodies", "a", "-contact_pairs", "none"], ["-b_translate 0,1.1, -b_youngs_modulus 1e9 (of 'b', which -bodies a,b (two.opts, line 1) names; -bodies a (the command line)"]),
    "obstacles": (["-obstacles", "floor"], ["-wall_normal -1,0, -wall_obstacle_type plane, -wall_point 5,-0.1 (of 'wall', which -obstacles floor,wall (two.opts, line 2) names"]),
    "pairs": (["-contact_pairs", "b:floor"], ["-contact_friction_a:b 0.3 (of 'a:b', which -contact_pairs a:b,b:floor (two.opts, line 3) names; -contact_pairs b:floor (the command line)"]),
    "boundary": (["-b_boundary_displacement", "ymax"], ["-b_boundary_displacement_xmax 0,0 (of 'xmax', which -b_boundary_displacement ymax,xmax (two.opts, line 24) names"]),
}


@pytest.mark.parametrize(("case", "ranks"), [*((case, 1) for case in LISTS), ("bodies", 3)])
def test_lists_that_are_overridden(case, ranks, words, tmp_path):
    given, named = LISTS[case]
    (tmp_path / "two.opts").write_text(TWO)
    run = words("two.opts", *given, ranks=ranks)
    refused(run, named)
    assert "nearest" not in run.stderr


def test_list_overridden_by_a_file(words, tmp_path):
    (tmp_path / "two.opts").write_text(TWO)
    (tmp_path / "one.opts").write_text("-options_file two.opts\n-obstacles floor\n")
    refused(words("one.opts"), ["which -obstacles floor,wall (two.opts, line 2) names; -obstacles floor (one.opts, line 2) overrides that list"])


# What is wrong with an option that bodies share, and what is told of it
SHARED = {
    "number": (["-material_steel_density", "abc"], ["-a_density", "'abc' is not a number", "here -a_density is -material_steel_density (the command line)"]),
    "sign": (["-material_steel_density", "-3"], ["a density must be positive", "here -a_density is -material_steel_density (the command line)"]),
    "gravity": (["-all_gravity", "1,2,3"], ["-a_gravity", "here -a_gravity is -all_gravity (the command line)"]),
    "no value": (["-material_steel_density"], ["-material_steel_density (the command line) has no value"]),
    "misspelt": (["-all_densty", "3"], ["-all_densty 3 (the nearest known one is -all_density)"]),
    "meaning": (["-material_steel_E", "3"], ["-material_steel_E 3 (the nearest known one is -material_steel_youngs_modulus)"]),
    "for no body": (["-all_cross_section", "3"], ["-all_cross_section 3 (goes with another method or type"]),
    "block": (["-all_skin_density", "3"], ["-all_skin_density 3"]),
    "Newton's method": (["-all_snes_rtol", "1e-9"], ["-a_snes_rtol has no effect", "here -a_snes_rtol is -all_snes_rtol (the command line)"]),
    "unknown material": (["-b_material", "stel"], ["-b_material stel: there is no material 'stel'", "there are: steel"]),
    "unused material": (["-material_brass_density", "3"], ["-material_brass_density 3 (no body names this material, as in -a_material brass)"]),
}


@pytest.mark.parametrize(("case", "ranks"), [*((case, 1) for case in SHARED), ("sign", 3), ("for no body", 3)])
def test_wrong_shared_options(case, ranks, words, tmp_path):
    given, named = SHARED[case]
    (tmp_path / "two.opts").write_text(TWO)
    refused(words("two.opts", *given, ranks=ranks), named)


def contents(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return found


def test_shared_options_are_those_of_bodies(words, tmp_path):
    """The same bits as with options of each body; a run goes on from one that has the same values by other options, and is refused with others."""
    own = {"dm_plex_dim": 2, "dm_plex_box_faces": "4,4", "gravity": "0,-9.81", "density": 7800, "poissons_ratio": 0.3}
    plain = [line for line in TWO.splitlines() if not re.match("-(all|material)_", line)]
    plain += [f"-{body}_{option} {value}" for body in "ab" for option, value in own.items()] + ["-a_youngs_modulus 210e9"]
    (tmp_path / "two.opts").write_text(TWO)
    (tmp_path / "plain.opts").write_text("\n".join(plain))
    (tmp_path / "all.opts").write_text("\n".join(line for line in plain if "density" not in line) + "\n-all_density 7800\n")
    for name, ranks in (("two", 1), ("two", 3), ("plain", 1), ("plain", 3)):
        run = words(f"{name}.opts", "-output_history", f"{name}{ranks}.h5", "-checkpoint", f"{name}{ranks}.c.h5", "-malloc_dump", ranks=ranks)
        assert steps(run) == 10 and not complaints(run.stdout + run.stderr)
    for ranks in (1, 3):
        found, expected = (contents(tmp_path / f"{name}{ranks}.h5") for name in ("two", "plain"))
        assert found.keys() == expected.keys() and len(found) > 20
        assert all(found[key].tobytes() == expected[key].tobytes() for key in found if found[key].dtype.kind == "f")
    assert steps(words("all.opts", "-restart", "plain1.c.h5", "-time_end", "2e-5")) == 20
    changed = ["-restart", "two1.c.h5", "-time_end", "2e-5", "-material_steel_density", "7900"]
    refused(words("two.opts", *changed), ["-a_density 7900 (it had 7800), -b_density 7900 (it had 7800)", "-b_density is -material_steel_density (the command line)"])


def test_bodies_come_first(words, tmp_path):
    """A body's own option, then its material's, then that of all bodies; what only one body can use is no error."""
    (tmp_path / "two.opts").write_text(TWO)
    more = ["-all_density", "1", "-b_density", "2", "-all_snes_rtol", "1e-9", "-a_material_type", "neo_hookean"]
    run = words("two.opts", *more, "-output_summary", "s.json", "-a_body_view", "ascii:a.txt", "-b_body_view", "ascii:b.txt", "-malloc_dump")
    assert steps(run) == 10 and not complaints(run.stdout + run.stderr)
    masses = {name: float(re.search(r"mass (\S+) kg", (tmp_path / f"{name}.txt").read_text())[1]) for name in "ab"}
    assert masses == pytest.approx({"a": 7800, "b": 2})  # blocks of 1 m x 1 m x 1 m


def test_command_line_overrules_files(words):
    """On whichever side of the file an option stands; a file may stand alone, before or after."""
    end = ["-time_end", "3e-6"]
    counts = [steps(words(*given)) for given in ([BLOCKS, *end], [*end, BLOCKS], [*end, "-options_file", BLOCKS], ["-options_file", BLOCKS, *end])]
    assert counts == [counts[0]] * 4 and 0 < counts[0] < steps(words(BLOCKS, "-time_end", "6e-6"))
    assert steps(words(*end, BLOCKS, "-time_end", "6e-6")) == 2 * counts[0]  # the last one holds


def test_many_unknown_options(words):
    """More than a message can hold: it ends in dots."""
    refused(words(BLOCKS, *(word for i in range(100) for word in (f"-unknown_option_number_{i}", "3"))), ["-unknown_option_number_0 3", " ..."])


def known_options():
    table = (ROOT / "src/sys/optiontable.c").read_text()
    for owner, name, value in re.findall(r'OPTION_OF_([A-Z]+), "([^"]+)",\s*"((?:[^"\\]|\\.)*)"', table):
        if owner == "OBSTACLE":
            yield "hertz-impact", "plane_" + name, value
        else:
            yield "blocks", {"RUN": "", "BODY": "left_"}[owner] + name.replace("<surface>", "xmin"), value


KNOWN = [known for known in known_options() if known[1] not in ("options_file", "example")]
TEXTS = re.compile(r"^(file|\[viewer\])|filename")  # any text will do, or is found wrong when it is used


@pytest.mark.parametrize("known", [KNOWN[::15], *long(KNOWN[1::3]), *validate(KNOWN)], ids=["some", "more", "all"])
def test_missing_values(known, words):
    """Nothing but what can be true or false, and viewers, may stand alone."""
    for case, option, value in known:
        if value in ("true|false", "true|false|auto") or value.startswith("["):
            continue
        refused(words(f"options/{case}.opts", f"-{option}", *SHORT), [f"-{option} (the command line) has no value"])


@pytest.mark.parametrize("known", [KNOWN[7::15], *validate(KNOWN)], ids=["some", "all"])
def test_values_of_no_sense(known, words):
    """Whatever an option takes, the message names it."""
    for case, option, value in known:
        if option == "obstacles" or TEXTS.search(value):
            continue
        run = words(f"options/{case}.opts", *SHORT, f"-{option}", "zzz")
        assert run.returncode > 0, option
        check_message(run, [f"-{option}"])


def without_remarks(text):
    return [line.split("#")[0].split() for line in text.splitlines() if line.split("#")[0].strip()]


def test_example(words, tmp_path):
    """Nothing that is there is overwritten, on several ranks neither; what is written can be run."""
    listed = dict(re.findall(r"^  (\S+) +(.*)", words("-example").stdout, re.MULTILINE))
    assert listed["sliding-flat-3d"] == "The block of sliding-flat.opts in three dimensions, on hexahedra"  # a full stop amid it
    assert listed["bouncing-bar"].endswith("SIAM Journal on Scientific Computing 33 (2011)")  # initials, and two lines
    assert listed["taylor-bar-axisymmetric-wall"].startswith("Taylor's impact test")
    (tmp_path / "blocks.opts").write_text("mine")
    refused(words("-example", "blocks"), ["'blocks.opts' exists already"])
    assert (tmp_path / "blocks.opts").read_text() == "mine"
    refused(words("-example", "block"), ["-example block", "blocks", "two-walls"])
    assert words("-example", "two-walls", ranks=2).stdout.count("two-walls.opts is written") == 1
    assert steps(words("two-walls.opts", "-time_end", "6.245e-6", "-output_history", "h.h5", "-output_summary", "s.json")) == 10


@pytest.mark.parametrize("every", [8, *long(1)])
def test_examples(every, words, tmp_path):
    """What is written is the file of options/, each option with what it means."""
    names = re.findall(r"^  (\S+)", words("-example").stdout, re.MULTILINE)
    assert len(names) > 20
    for name in names[::every]:
        assert words("-example", name).returncode == 0
        text, original = ((folder / f"{name}.opts").read_text() for folder in (tmp_path, ROOT / "options"))
        assert without_remarks(text) == without_remarks(original)
        assert text.count("#") > original.count("#")


# What was computed without a word, or blamed on something else
SENSELESS = {
    "body with digit": (["-bodies", "1a,b"], ["-bodies", "'1a'", "letter"]),
    "option with digit": (["-bodies", "1a", "-1a_dm_plex_dim", "1"], ["'-1a_dm_plex_dim'", "letter"]),
    "body not ASCII": (["-bodies", "block,kl\u00f6tz"], ["-bodies", "kl\u00f6tz", "letters"]),
    "obstacle": ([BLOCKS, "-obstacles", "2nd"], ["-obstacles", "'2nd'"]),
    "strength of an elastic body": ([BLOCKS, "-left_yield_stress", "3e8"], ["-left_yield_stress 3e8 (needs -left_material_type j2|j2_small|johnson_cook)"]),
    "strength of an elastic material": ([BLOCKS, "-left_material", "steel", "-material_steel_yield_stress", "3e8"], ["(needs -material_steel_material_type j2|"]),
    "exponent of j2": ([BLOCKS, "-left_material_type", "j2", "-left_yield_stress", "3e8", "-left_hardening_exponent", "2"], ["(needs -left_material_type johnson_cook)"]),
    "saturation of linear hardening": ([BLOCKS, "-left_material_type", "j2", "-left_yield_stress", "3e8", "-left_saturation_stress", "4e8"], ["(needs -left_hardening voce)"]),
    "radius of a box": ([BLOCKS, "-left_ball_radius", "2"], ["-left_ball_radius 2 (needs -left_dm_plex_shape ball)"]),
    "surface without components": ([BLOCKS, "-left_boundary_displacement", "xmin"], ["names 'xmin'", "as in -left_boundary_displacement_xmin 0,0"]),
    "misspelt body of a pair": ([BLOCKS, "-contact_pairs", "left:rigth"], ["left:rigth", "no body 'rigth'; -bodies has left, right"]),
    "misspelt obstacle of a pair": ([BLOCKS, *FLOOR, "-contact_pairs", "left:flor"], ["no body 'flor'; -bodies has left, right; -obstacles has floor (obstacles stand second"]),
    "obstacle first": ([BLOCKS, *FLOOR, "-contact_pairs", "floor:left"], ["no body 'floor'", "-obstacles has floor (obstacles stand second"]),
    "surfaces that look away": ([BLOCKS, "-contact_pairs", "left.xmin:right.xmax"], ["do not face each other", "-left_dm_plex_box_lower", "-right_dm_plex_box_lower", "-contact_facing false"]),
    "far away": ([BLOCKS, "-left_translate", "1e12,0"], ["'left'", "-left_translate", "digits"]),
    "tiny": ([BLOCKS, "-left_scale", "1e-80"], ["'left'", "-left_scale"]),
    "large step of bars": (["options/impact-high-speed.opts", "-time_step", "1e20"], ["-time_step 1e+20 s", "resolve contact", "masses"]),
    "small step": ([BLOCKS, "-time_step", "1e-300", "-time_end", "1e-299"], ["-time_step 1e-300 s", "1e-60"]),
    "late end": ([BLOCKS, "-time_end", "1e300"], ["-time_end 1e+300 s", "1e+60"]),
    "heavy": ([BLOCKS, "-left_density", "1e300"], ["-left_density is 1e+300 kg/m^3", "1e+60"]),
    "soft": ([BLOCKS, "-left_youngs_modulus", "1e-300"], ["-left_youngs_modulus is 1e-300 Pa", "1e-60"]),
    "bar with a large section": (["options/impact-high-speed.opts", "-left_cross_section", "1e300"], ["-left_cross_section is 1e+300 m^2", "1e+60"]),
    "beyond all speeds": ([BLOCKS, "-left_initial_velocity", "1e300,0"], ["-left_initial_velocity is up to 1e+300 m/s", "1e+60"]),
    "beyond all places": ([BLOCKS, "-left_initial_displacement", "-1e300,0"], ["-left_initial_displacement is up to 1e+300 m", "1e+22"]),
    "energy beyond all numbers": ([BLOCKS, "-left_body_force", "1e200,0"], ["energy of body 'left' is not a number at time", "its loads"]),
    "sizes of bodies": ([BLOCKS, "-right_scale", "1e9"], ["body 'left' is 0.25", "'right' 2.5", "+08 m", "-right_scale"]),
    "alpha beyond all schemes": ([BLOCKS, "-left_ts_alpha_beta", "1e300"], ["-left_ts_alpha_", "beta 1e+300"]),
    "radius of PETSc's": ([BLOCKS, "-left_ts_alpha_radius", "7"], ["-left_ts_alpha_radius (the command line) 7: Radius 7", "[0,1]"]),
    "tolerance of PETSc's": ([BLOCKS, "-schwarz_snes_rtol", "7"], ["-schwarz_snes_rtol (the command line) 7: Relative tolerance 7"]),
    "angle": ([BLOCKS, "-left_rotate", "1e9"], ["-left_rotate", "1e+09", "360"]),
    "exact in two dimensions": ([BLOCKS, "-exact", "impact", "-left_poissons_ratio", "0.3"], ["-exact", "'left'", "-left_poissons_ratio 0"]),
    "exact beside each other": (["options/impact-solids.opts", "-exact", "impact", "-right_translate", "0,0.005,0"], ["-exact", "'right'", "end faces"]),
    "exact and never apart": (["options/impact-solids.opts", "-exact", "impact", "-contact_law", "bonded"], ["-exact", "-contact_law bonded", "part again"]),
    "exact and held together": (["options/impact-high-speed.opts", "-exact", "impact", "-contact_separation", "false"], ["-exact", "-contact_separation false", "part again"]),
    "exact with loads": (["options/impact-high-speed.opts", "-right_body_force", "1e3"], ["-exact", "'right'", "body forces"]),
}


@pytest.mark.parametrize(("case", "ranks"), [*((case, 1) for case in SENSELESS), ("radius of PETSc's", 3), *long(("large step of bars", 3), ("heavy", 3))])
def test_input_without_sense(case, ranks, words):
    """Once, and on the first rank, where PETSc's setters complain too."""
    given, named = SENSELESS[case]
    run = words(*given, ranks=ranks)
    refused(run, named)
    assert run.stderr.count("impakt: error") == 1, run.stderr


def test_tables_from_pipes(words, tmp_path):
    """What may never begin is not waited for: tables, options files and checkpoints."""
    os.mkfifo(tmp_path / "pipe.opts")
    refused(words(BLOCKS, "-left_body_force", "table:pipe.opts,0"), ["-left_body_force", "'pipe.opts'", "a pipe"])
    refused(words("pipe.opts"), ["'pipe.opts'", "a pipe"])
    refused(words(BLOCKS, "-restart", "pipe.opts"), ["-restart pipe.opts", "it is no file"])
    refused(words(BLOCKS, "-restart_state", "nowhere.h5"), ["-restart_state nowhere.h5", "No such file"])


def test_line_ends_of_tables(words, tmp_path):
    for ends in ("\n", "\r\n"):
        (tmp_path / "t.txt").write_bytes(f"0 0{ends}# comment{ends}{ends}1e-6,1e12{ends}2e-6 2e12".encode())
        run = words(BLOCKS, "-left_body_force", "table:t.txt,0", "-output_history", "h.h5", "-output_summary", "s.json", "-time_end", "2e-6")
        assert run.returncode == 0, run.stderr
        with h5py.File(tmp_path / "h.h5") as history:
            # the force grows to f = 2e12 N/m^3 in t = 2e-6 s, and the momentum to V f t / 2; contact takes 0.4 % of it
            momentum = history["body/left/momentum"][:, 0]
        assert momentum[-1] - momentum[0] == pytest.approx(0.25 * 0.05 * 2e12 * 2e-6 / 2, rel=0.01)
