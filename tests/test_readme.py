"""What the READMEs say: every command in a fenced sh block is run, or, where it makes or installs things, its target is looked up; options
files in them are run; links lead somewhere; tests, files and functions that they name exist; the table of options is the program's.
"""

import os
import re
import shlex
import sys

import pytest
from cases import DEFAULTS
from conftest import IMPAKT, MPIEXEC, ROOT

# Beside `make`: what is not run here, and not looked up either, as it needs a network, root, or the installed library, with which
# tests/library makes and runs programs
ELSEWHERE = ("git clone ", "apt ", "apt-get ", "sudo apt", "cd ", "cc ", "./")
READMES = [path.relative_to(ROOT) for path in sorted(ROOT.rglob("README.md")) if path.relative_to(ROOT).parts[0] not in ("build", "out", ".git")]
TEXT = {str(path): (ROOT / path).read_text() for path in READMES}
PLACEHOLDERS = ("file.h5", "file.json")  # in the table of options
SOURCES = [path for folder in ("src", "include") for path in sorted((ROOT / folder).rglob("*.[ch]"))]


def commands(text):
    """Lines of ```sh blocks, continued ones as one, without comments."""
    for block in re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        for line in re.sub(r"\\\n\s*", "", block).splitlines():
            line = re.sub(r"(^|\s)#.*$", "", line).strip()
            if line:
                yield line


def options_files(text):
    """Contents of ```opts blocks by the name that stands before each."""
    blocks = re.finditer(r"`(\w[\w-]*\.opts)`[^`]*\n```opts\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return {match[1]: match[2] for match in blocks}


def kind(command):
    """make, elsewhere, or run; anything else is for whoever writes it to add here."""
    if re.match(r"([A-Z_]+=\S* )*make\b", command):
        return "make"
    if command.startswith(ELSEWHERE):
        return "elsewhere"
    if re.match(r"(mpiexec .*)?build/impakt\b", command) or re.search(r"(^|[ /)])(python3?|\$\(\.setup/python\)) plots/\w+\.py\b", f" {command}"):
        return "run"
    return "unknown"


COMMANDS = list(dict.fromkeys(command for text in TEXT.values() for command in commands(text)))
FILES = {name: content for text in TEXT.values() for name, content in options_files(text).items()}


def of_kind(name):
    return [command for command in COMMANDS if kind(command) == name]


def test_extraction():
    text = "a\n```sh\n# note\nbuild/impakt -a \\\n  -b  # why\n\nmake run\n```\n```c\nint x;\n```\n```sh\nmake\n```\nin `my.opts`:\n\n```opts\n-a 1\n```\n"
    assert list(commands(text)) == ["build/impakt -a -b", "make run", "make"]
    assert [kind(command) for command in commands(text)] == ["run", "make", "make"]
    assert options_files(text) == {"my.opts": "-a 1\n"}


def test_nothing_is_left_out():
    assert len(list(commands(TEXT["README.md"]))) >= 5
    assert not of_kind("unknown"), "say in kind() what to do with these"
    targets = [word for command in commands(TEXT["README.md"]) if kind(command) == "make" for word in command.split()]
    assert {"run", "test"} <= set(targets)  # the two commands of the set-up
    assert len(FILES) == sum(text.count("\n```opts\n") for text in TEXT.values()) >= 1


def test_make():
    """Targets and variables that are given to make."""
    makefile = (ROOT / "Makefile").read_text()
    words = {word for command in of_kind("make") for word in shlex.split(command)}
    given = {word.split("=")[0] for word in words if re.match(r"[A-Z_]+=", word)}
    targets = {word for word in words - {"make"} if not re.match(r"[A-Z_]+=|-", word)}
    assert not [name for name in given if name not in makefile]
    assert targets <= set(re.findall(r"^([\w-]+):.*##", makefile, re.MULTILINE))


def like_the_repository(folder):
    """Fills a folder with what a reader of the READMEs has."""
    for path in ROOT.iterdir():
        if path.name not in ("build", "out", ".git"):
            (folder / path.name).symlink_to(path)
    (folder / "build").mkdir()
    (folder / "build/impakt").symlink_to(IMPAKT)
    for name, content in FILES.items():
        (folder / name).write_text(content)


def run_that_writes(fields, folder):
    """Options of a run that writes these fields: of a command in a README, or of a file in options/."""
    for command in of_kind("run"):
        if command.startswith("build/impakt ") and f"-output_fields {fields}.h5" in command:
            options = command.removeprefix("build/impakt ")
            for name in FILES:
                options = options.replace(f" {name} ", f" {folder / name} ")
            return options
    return f"-options_file options/{fields.removeprefix('out/').removesuffix('-fields')}.opts"


def run_with_history(history):
    """Options of the run in a README that writes this history; of the default one otherwise."""
    commands = (command for command in of_kind("run") if f"-output_history {history}" in command)
    return next((command.removeprefix("build/impakt ") for command in commands), DEFAULTS)


PICTURES = [command for command in of_kind("run") if "plots/" in command and not command.endswith(("/two-blocks.png", "/history.png"))]


@pytest.mark.parametrize("command", [command if command not in PICTURES else pytest.param(command, marks=pytest.mark.long) for command in of_kind("run")])
def test_command(command, shared_run, launch, tmp_path):
    """As it stands, in a folder that looks like the repository; figures are made of a history or of fields that are there already."""
    like_the_repository(tmp_path)
    # not the folder of this interpreter before all: .setup/python would take it for the one to build on
    before = [os.path.dirname(MPIEXEC[0])] if os.path.dirname(MPIEXEC[0]) else []
    path = os.pathsep.join([*before, os.environ["PATH"]])
    command = re.sub(r"(^|(?<= ))python3?(?= plots/)", sys.executable, command)
    if command.startswith("mpiexec"):
        command += " -time_end -1e-4"  # a tenth of the run: ranks wait for each other where cores are few
    if "plots/" in command:
        (tmp_path / "out").mkdir()
        for word in re.findall(r"\bout/\S+\.h5\b", command):
            (tmp_path / word).symlink_to(shared_run(run_with_history(word)).folder / "history.h5")
        for fields in re.findall(r"\b(out/\S+-fields)\.xdmf\b", command):
            made = shared_run(run_that_writes(fields, tmp_path)).folder / "out"  # beside the history, which the run puts elsewhere
            for file in made.glob(f"{fields.removeprefix('out/')}.*"):
                (tmp_path / "out" / file.name).symlink_to(file)
    run = launch(["bash", "-euc", command], cwd=tmp_path, env={**os.environ, "PATH": path, "MPLBACKEND": "Agg"}, timeout=120)
    assert run.returncode == 0, run.stderr
    for word in re.findall(r"\bout/\S+\.(?:png|gif)\b", command):
        assert (tmp_path / word).stat().st_size > 10_000


@pytest.mark.parametrize("name", list(FILES))
def test_options_file(name, impakt, tmp_path):
    """About ten lines, and it shows what Impakt is good at: bodies meet once, momentum is kept, and energy (2.8e-5 measured, at release inside a step)."""
    (tmp_path / name).write_text(FILES[name])
    assert len(FILES[name].splitlines()) <= 11
    summary = impakt(f"-options_file {tmp_path / name}").summary
    assert summary["contact"]["onsets"] == 1
    assert summary["system"]["momentum_error_max"] <= 1e-10
    assert -1e-4 <= summary["system"]["energy_error_min"] <= summary["system"]["energy_error_max"] <= 1e-4


def test_sizes():
    """The first one is read in five minutes; those of folders are a page."""
    assert (ROOT / "README.md").stat().st_size <= 10_000
    for path in READMES:
        if path.parts[0] == "src":
            assert TEXT[str(path)].count("\n") <= (100 if len(path.parts) == 2 else 60), path


def test_every_folder_has_one():
    folders = {path.parent.relative_to(ROOT) for path in SOURCES if path.parts[len(ROOT.parts)] == "src"}
    folders |= {parent for folder in folders for parent in folder.parents if parent.parts[:1] == ("src",)}
    folders |= {path.relative_to(ROOT) for path in (ROOT / "options", ROOT / "plots", ROOT / "tests", ROOT / "tests/scaling")}
    assert len(folders) > 20
    missing = sorted(str(folder) for folder in folders if folder / "README.md" not in READMES)
    assert not missing


def headings(text):
    """Anchors as GitHub makes them of headings."""
    for line in re.findall(r"^#+ (.*)$", text, re.MULTILINE):
        yield re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-")


def test_links():
    """Those within the repository lead to something that is there, and from the first README to the others."""
    broken = []
    for name, text in TEXT.items():
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            if re.match(r"https?://", target):
                continue
            place, _, anchor = target.partition("#")
            path = (ROOT / name).parent / place if place else ROOT / name
            if not path.exists() or (anchor and anchor not in headings(path.read_text())):
                broken.append(f"{name}: {target}")
    assert not broken
    linked = set(re.findall(r"\]\(([^)#]+README\.md)", TEXT["README.md"]))
    assert {"options/README.md", "src/README.md", "tests/README.md", "tests/scaling/README.md", "plots/README.md"} <= linked


def functions_of(path):
    return set(re.findall(r"^(?:async )?def (test_\w+)", path.read_text(), re.MULTILINE))


def test_tests_that_are_named():
    """`file.py::function` is a test below tests/, in whichever folder."""
    files = {path.name: path for path in sorted((ROOT / "tests").rglob("test_*.py"))}
    named = {match for text in TEXT.values() for match in re.findall(r"`(test_\w+\.py)::(test_\w+)`", text)}
    assert len(named) > 50
    missing = sorted(f"{file}::{function}" for file, function in named if file not in files or function not in functions_of(files[file]))
    assert not missing


def test_every_figure_of_verification_has_a_test():
    """Each row of the tables of tests/README.md that have a column for it names a test, or says that there is none."""
    rows = [line for line in TEXT["tests/README.md"].splitlines() if line.startswith("|") and "---" not in line]
    tables = [row for row in rows if not row.startswith(("| files |", "| run |", "| case |", "| what |")) and row.count(" | ") in (2, 3)]
    assert len(tables) > 50
    without = [row for row in tables if "`test_" not in row.split(" | ")[-1] and not row.endswith("| no test |")]
    assert not without


def test_files_that_are_named():
    """`name.c` and its like are there, in whichever folder."""
    there = {path.name for path in ROOT.rglob("*") if path.relative_to(ROOT).parts[0] not in ("build", "out", ".git")}
    missing = []
    for name, text in TEXT.items():
        for word in re.findall(r"`([\w./-]+\.(?:c|h|py|opts|json|png|gif))`", text):
            if word not in FILES and word not in PLACEHOLDERS and os.path.basename(word) not in there:
                missing.append(f"{name}: {word}")
    assert not missing


def test_tables_of_files():
    """In a table of the files of a folder of src/, all sources of that folder are, and no others."""
    wrong = []
    for name in [name for name, text in TEXT.items() if name.startswith("src/") and "\n| file | holds |\n" in text]:
        table = TEXT[name].split("\n| file | holds |\n")[1].split("\n\n")[0]
        listed = {word for line in table.splitlines()[1:] for word in re.findall(r"`([\w.]+)`", line.split(" | ")[0])}
        here = {path.name for path in (ROOT / name).parent.glob("*.[ch]")}
        missing = {file for file in here if file.endswith(".c")} - listed
        wrong += [f"{name}: {file}" for file in sorted(missing | (listed - here))]
    assert not wrong


def test_functions_that_are_named():
    """`Function()` in a README of src/ is a function or macro of Impakt, or one of PETSc."""
    called = {word for path in SOURCES for word in re.findall(r"\b(\w+)\(", path.read_text())}
    petsc = re.compile(r"(TS|SNES|Petsc|DM|KSP|Mat|Vec|PC)[A-Z2]\w*|DMPlex\w+")
    named = {(name, word) for name, text in TEXT.items() if name.startswith("src/") for word in re.findall(r"`([A-Z]\w+)\(\)`", text)}
    assert len(named) > 80
    missing = sorted(f"{name}: {word}" for name, word in named if word not in called and not petsc.fullmatch(word) and not word.endswith(("Xxx", "_Xxx")))
    assert not missing


def test_table_of_options(launch):
    """`make docs` writes it from what the program prints."""
    block = TEXT["options/README.md"].split("written by `make docs` -->\n")[1].split("<!-- end of what")[0]
    printed = launch([IMPAKT, "-help", "markdown"]).stdout
    assert printed.count("\n| `-") > 100
    assert block == printed, "make docs"
