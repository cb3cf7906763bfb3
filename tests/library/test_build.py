"""What `make` prints while it builds: one line for each folder, or whole commands with V=1; and what it hands to pytest."""

import shlex

import pytest
from conftest import ROOT
from installed import environment, run

SOURCES = ("src/sys/names.c", "src/sys/package.c", "src/ts/rigid.c")


@pytest.fixture
def make(tmp_path):
    """make(*variables) -> lines, of some objects in a build folder of their own."""
    objects = [str(tmp_path / source.replace(".c", ".o")) for source in SOURCES]
    return lambda *variables: run(["make", "--no-print-directory", "-j2", f"BUILD={tmp_path}", "OPTIMISE=-O0", *variables, *objects], cwd=ROOT, env=environment).splitlines()


def told(lines):
    return sorted(line for line in lines if line.startswith("  "))


def test_a_line_for_each_folder(make, tmp_path):
    assert told(make()) == ["  CC src/sys", "  CC src/ts"]
    assert all((tmp_path / source.replace(".c", ".o")).exists() for source in SOURCES)
    assert told(make()) == []  # there is nothing to be made
    (tmp_path / SOURCES[1].replace(".c", ".o")).unlink()
    assert told(make()) == ["  CC src/sys"]


def test_whole_commands(make, tmp_path):
    printed = make("V=1")
    assert not told(printed)
    for source in SOURCES:
        assert [line for line in printed if line.endswith(f" -c -o {tmp_path / source.replace('.c', '.o')} {source}")]


def test_validate_finds_the_figures_of_the_paper(tmp_path):
    """Their file has another name than those of tests, and pytest 9 drops a file that is named beside its folder, here tests/paper in place of tests."""
    printed = run(["make", "--no-print-directory", "-n", "validate"], cwd=ROOT, env=environment).splitlines()
    (line,) = [line for line in printed if "-m pytest" in line]
    words = shlex.split(line[: line.index("||")])
    first = next(at for at, word in enumerate(words) if "=" not in word)
    command = ["tests/paper" if word == "tests" else word for word in words[first:]]
    found = run([*command, "-n", "0", "-k", "nothing_is_left_out"], cwd=ROOT, env=environment | {"IMPAKT_BUILD": str(tmp_path), "PAPER": str(tmp_path)})
    assert "1 passed, 207 deselected" in found
