"""What the program says about itself: -help, -help TOPIC, -version, and nothing at all."""

import os
import re

import pytest
from conftest import IMPAKT, ROOT, complaints

TOPICS = ["bodies", "meshes", "materials", "loads", "time", "contact", "obstacles", "schwarz", "alternation", "penalty", "lagrange", "files"]
ENTRY = re.compile(r"^  -(\S+) \S+\n      \S.*$", re.MULTILINE)

# Options that Impakt looks at, and that are PETSc's own: their table is PETSc's
OF_PETSC = {
    "options_file_yaml", "prefix_push", "prefix_pop", "pc_gamg_use_sa_esteig", "snes_type", "schwarz_snes_anderson_m", "schwarz_snes_anderson_beta",
    "snes_linesearch_damping", "snes_linesearch_type", "snes_vi_zero_tolerance", "snes_lag_jacobian_persists", "snes_lag_preconditioner_persists",
    "ts_view", "dm_view", "dm_distribute", "dm_distribute_overlap", "dm_plex_box_bd", "dm_plex_cell",
    "dm_plex_interpolate", "dm_plex_reorder", "dm_plex_separate_marker", "petscpartitioner_type", "help", "version", "h", "log_exclude",
}  # fmt: skip


@pytest.fixture
def say(launch):
    """say("-help", "contact") -> stdout, of a run that ends with exit code 0, says nothing else, and frees its memory"""

    def run(*words, ranks=1, stderr=""):
        done = launch([IMPAKT, *words], ranks, timeout=60, env={**os.environ, "PETSC_OPTIONS": "-malloc_dump"})
        assert done.returncode == 0, done.stderr
        assert not complaints(done.stdout + done.stderr)
        assert done.stderr == stderr
        return done.stdout

    return run


def in_table(text):
    """Names of the options that a screen lists."""
    return [match[1] for match in ENTRY.finditer(text)]


@pytest.mark.parametrize(("word", "ranks"), [("-help", 2), ("--help", 1)])
def test_help(word, ranks, say):
    """One screen, once on several ranks: how to start, and what to ask for; nothing of PETSc's."""
    text = say(word, ranks=ranks)
    assert len(text.splitlines()) <= 24
    assert max(map(len, text.splitlines())) <= 80
    assert text.count("impakt FILE.opts") == 2  # by itself and under mpiexec
    assert re.findall(r"^  (\w+) +\S", text, re.MULTILINE) == ["impakt", "mpiexec", *TOPICS, "all", "markdown"]
    assert re.search(r"^Impakt \d+\.\d+\.\d+ ", text)
    assert "PETSc Team" not in text


def test_version(say):
    """What it was built with; the program and CITATION.cff name one version."""
    lines = say("-version").splitlines()
    expected = [
        r"Impakt   \d+\.\d+\.\d+",
        r"PETSc    3\.\d+\.\d+(, with debugging)?",
        r"MPI      \S.*\d.*",
        r"HDF5     \d+\.\d+\.\d+",
        r"compiler (gcc|clang) \d.*, .*-O\d.*",
        r"scalars  real, 8 bytes",
        r"integers [48] bytes",
    ]
    assert len(lines) == len(expected)
    for line, pattern in zip(lines, expected, strict=True):
        assert re.fullmatch(pattern, line), line
    assert not re.search(r"[ =]/\w", "\n".join(lines))  # no path of a machine
    version = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)[1]
    assert lines[0].split() == ["Impakt", version]


def test_help_with_a_run(say):
    """Asked for beside other options, help comes alone: nothing is run."""
    assert say("-options_file", "options/impact-high-speed.opts", "-help") == say("-help")


SOME = {
    "bodies": {"bodies", "<body>_mass_redistribute"},
    "meshes": {"<body>_dm_plex_filename", "<body>_ball_part"},
    "materials": {"<body>_material_type", "<body>_thickness"},
    "loads": {"<body>_boundary_traction_<surface>", "<body>_gravity"},
    "time": {"time_end", "<body>_ts_type"},
    "contact": {"contact_pairs", "contact_type"},
    "obstacles": {"obstacles", "<obstacle>_normal"},
    "schwarz": {"schwarz_snes_type", "contact_rule", "law_snes_type", "law_snes_max_it", "law_nodes_snes_max_it"},
    "alternation": {"schwarz_transmission", "contact_swap_sides"},
    "penalty": {"contact_penalty", "contact_penalty_damping"},
    "lagrange": {"contact_augmentation_tolerance"},
    "files": {"options_file", "output_history"},
}


def test_topics(say):
    """Together they are the whole table, without an option twice; all options that the code reads are in it, and all of them in -help all, each once,
    before those that all programs of PETSc have, and those of integrators and solvers."""
    names = []
    for topic in TOPICS:
        text = say("-help", topic)
        assert text.startswith(f"{topic}: ")
        assert set(in_table(text)) >= SOME[topic]
        names += in_table(text)
    assert len(names) > 100
    assert len(set(names)) == len(names)
    read = set()
    for source in (ROOT / "src").rglob("*.c"):
        if "tutorials" not in source.parts:  # programs with options of their own
            read |= set(re.findall(r'"-([a-z][a-z_]*)"', source.read_text()))
    assert len(read) > 60
    assert read - OF_PETSC <= {re.sub(r"^<\w+>_", "", name) for name in names}
    text = say("-help", "all")
    assert in_table(text) == names
    for line in ("Options of Impakt", "Options for all PETSc programs", "  -<body>_ts_type <", "  -<body>_ksp_type <", "  -<body>_pc_type <", "  -schwarz_snes_type <"):
        assert text.count(line) == 1, line
    assert text.index("Options of Impakt") < text.index("Options for all PETSc programs") < text.index("  -<body>_ts_type <")


# A word, the options that come first, and some that come later since their text has the word
WORDS = {
    "velocity": (["<body>_initial_velocity", "<obstacle>_velocity"], {"<body>_probe", "output_fields"}),
    "friction": (["contact_friction"], {"contact_friction_kinetic", "contact_law"}),
    "gravity": (["<body>_gravity"], set()),
    "dt": (["time_step", "<body>_ts_time_step"], set()),
    "E": (["<body>_youngs_modulus"], set()),
    "nu": (["<body>_poissons_ratio"], set()),
    "output": (["output_history", "output_summary", "output_fields"], {"output_view"}),
    "Gmsh": (["<body>_dm_plex_filename"], {"<body>_<block>_material_type"}),
    "youngs_modulus": (["<body>_youngs_modulus"], set()),
    "glue": (["contact_law"], set()),
    "roller": (["<body>_boundary_displacement"], set()),
    "symmetry": (["<body>_boundary_displacement"], set()),
    "shear": (["<body>_boundary_traction"], set()),
    "preload": (["<body>_ts_type", "restart_state"], set()),
    "mm": (["units"], set()),
    "sheet": (["<body>_mass_redistribute", "contact_rule"], {"contact_type"}),
    "thin": (["<body>_mass_redistribute", "contact_rule"], set()),
    "plate": (["<body>_mass_redistribute", "contact_rule"], {"contact_type"}),
    "mass": (["<body>_density"], {"<body>_mass_redistribute", "contact_rule", "contact_type"}),
}


@pytest.mark.parametrize("word", list(WORDS))
def test_words(word, say):
    """What a word means comes first, though the names of the options be others; nothing comes twice."""
    first, later = WORDS[word]
    text = say("-help", word, ranks=2 if word == "dt" else 1)
    names = in_table(text)
    assert text.startswith(f"{word}: no topic")
    assert names[: len(first)] == first
    assert later <= set(names) - set(first)
    assert len(set(names)) == len(names)


def test_meanings_are_of_options(say):
    """The table of other words names options that exist."""
    table = (ROOT / "src/sys/optionwords.c").read_text().split("meanings[] = {")[1].split("};")[0]
    meant = re.findall(r'\{"(\w+)", "[^"]+"\}', table)
    names = {re.sub(r"^<\w+>_", "", name) for topic in TOPICS for name in in_table(say("-help", topic))}
    assert len(meant) > 30
    assert set(meant) <= names


def test_unknown_topic(launch):
    """Neither a topic nor a word of an option."""
    done = launch([IMPAKT, "-help", "frobnicate"], 2, timeout=60)
    assert done.returncode > 0
    lines = [line for line in done.stderr.splitlines() if line.startswith("impakt: error")]
    assert len(lines) == 1
    assert "-help frobnicate" in lines[0] and "no option with this word" in lines[0]
    assert lines[0].endswith("topics are " + ", ".join([*TOPICS, "all", "markdown"]))
    assert not done.stdout.strip()


def test_nothing_given(launch):
    """How it is used, where errors go, and an exit code of its own."""
    done = launch([IMPAKT], 1, timeout=60)
    assert done.returncode > 0
    assert done.stderr.count("  impakt FILE.opts") == 1
    assert "error" not in done.stderr
    assert not done.stdout.strip()


def test_nothing_on_the_command_line(launch, tmp_path):
    """A run may come as a whole from the variable that PETSc reads."""
    (tmp_path / "options").symlink_to(ROOT / "options")
    (tmp_path / "out").mkdir()
    options = "-options_file options/impact-penalty.opts -time_end -1.9e-4"
    done = launch([IMPAKT], cwd=tmp_path, timeout=60, env={**os.environ, "PETSC_OPTIONS": options})
    assert done.returncode == 0, done.stderr
    assert "FILE" not in done.stderr
