"""Every command in a fenced sh block of README.md: it is run, or, where it makes or installs things, its target is looked up."""

import os
import re
import shlex
import sys

import pytest
from cases import DEFAULTS
from conftest import IMPAKT, MPIEXEC, ROOT

# Beside `make`: what is not run here, and not looked up either, as it needs a network or root
ELSEWHERE = ("git clone ", "apt ", "apt-get ", "sudo apt", "cd ")


def commands(text):
    """Lines of ```sh blocks, continued ones as one, without comments."""
    for block in re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        for line in re.sub(r"\\\n\s*", "", block).splitlines():
            line = re.sub(r"(^|\s)#.*$", "", line).strip()
            if line:
                yield line


def kind(command):
    """make, elsewhere, or run; anything else is for whoever writes it to add here."""
    if re.match(r"([A-Z_]+=\S* )*make\b", command):
        return "make"
    if command.startswith(ELSEWHERE):
        return "elsewhere"
    if re.match(r"(mpiexec .*)?build/impakt\b", command) or re.search(r"(^|[ /)])(python3?|\$\(\.setup/python\)) plots/\w+\.py\b", f" {command}"):
        return "run"
    return "unknown"


README = ROOT / "README.md"
COMMANDS = list(dict.fromkeys(commands(README.read_text()))) if README.exists() else []


def of_kind(name):
    return [command for command in COMMANDS if kind(command) == name]


def test_extraction():
    text = "a\n```sh\n# note\nbuild/impakt -a \\\n  -b  # why\n\nmake run\n```\n```c\nint x;\n```\n```sh\nmake\n```\n"
    assert list(commands(text)) == ["build/impakt -a -b", "make run", "make"]
    assert [kind(command) for command in commands(text)] == ["run", "make", "make"]


def test_nothing_is_left_out():
    assert COMMANDS, "README.md has no commands"
    assert not of_kind("unknown"), "say in kind() what to do with these"
    targets = [word for command in of_kind("make") for word in command.split()]
    assert {"run", "test"} <= set(targets)  # the two commands of the set-up
    assert any(command.startswith("build/impakt") for command in of_kind("run"))


@pytest.mark.parametrize("command", of_kind("make"))
def test_make(command):
    makefile = (ROOT / "Makefile").read_text()
    assigned = re.compile(r"[A-Z_]+=")
    for word in shlex.split(command):
        if assigned.match(word):
            assert word.split("=")[0] in makefile, word
        elif word != "make" and not word.startswith("-"):
            assert re.search(rf"^{word}:.*##", makefile, re.MULTILINE), f"no target {word}"


@pytest.mark.parametrize("command", of_kind("run"))
def test_command(command, shared_run, launch, tmp_path):
    """As it stands, in a folder that looks like the repository; figures are made of a history that is there already."""
    for path in ROOT.iterdir():
        if path.name not in ("build", "out", ".git"):
            (tmp_path / path.name).symlink_to(path)
    (tmp_path / "build").mkdir()
    (tmp_path / "build/impakt").symlink_to(IMPAKT)
    # not the folder of this interpreter before all: .setup/python would take it for the one to build on
    before = [os.path.dirname(MPIEXEC[0])] if os.path.dirname(MPIEXEC[0]) else []
    path = os.pathsep.join([*before, os.environ["PATH"]])
    command = re.sub(r"(^|(?<= ))python3?(?= plots/)", sys.executable, command)
    if "plots/" in command:
        (tmp_path / "out").mkdir()
        for word in re.findall(r"\bout/\S+\.h5\b", command):
            (tmp_path / word).symlink_to(shared_run(DEFAULTS).folder / "history.h5")
        for name in re.findall(r"\bout/(\S+)-fields\.xdmf\b", command):
            fields = shared_run(f"-options_file options/{name}.opts").folder / "out"  # beside the history, which the run puts elsewhere
            for file in fields.glob(f"{name}-fields.*"):
                (tmp_path / "out" / file.name).symlink_to(file)
    run = launch(["bash", "-euc", command], cwd=tmp_path, env={**os.environ, "PATH": path, "MPLBACKEND": "Agg"}, timeout=120)
    assert run.returncode == 0, run.stderr
    for word in re.findall(r"\bout/\S+\.png\b", command):
        assert (tmp_path / word).stat().st_size > 10_000
