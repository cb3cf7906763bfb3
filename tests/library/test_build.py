"""What `make` prints while it builds: one line for each folder, or whole commands with V=1."""

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
