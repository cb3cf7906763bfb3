"""The progress bar on a terminal: its width, the set-up, messages beside it, and `mpiexec`; lines in a log."""

import contextlib
import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import termios
import time

import pytest
from conftest import IMPAKT, MPIEXEC, ROOT

RUN = [IMPAKT, "-options_file", ROOT / "options/bars-high-speed.opts", "-time_step", "2.5e-9"]  # of some seconds
BAR = re.compile(r"\[[#.]+\] +\d+ %  (\d+ h )?\d+ (s|min) to go")


def set_width(terminal, columns):
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))


@contextlib.contextmanager
def on_terminal(command, columns, stdout=subprocess.DEVNULL):
    """Starts a program with standard error on a terminal; yields this end of it. `stdout` None: that is there as well."""
    leader, follower = pty.openpty()
    set_width(leader, columns)
    process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=follower if stdout is None else stdout, stderr=follower)
    os.close(follower)
    try:
        yield leader
    finally:
        process.terminate()
        # mpiexec heeds the signal only while somebody reads what it writes: a full terminal that is waited beside keeps it for ever
        try:
            read_until(leader, lambda _: process.poll() is not None, 20)
        finally:
            process.kill()
            process.wait()
            os.close(leader)


def read_until(leader, found, seconds=60):
    """What the terminal was sent until `found(text)`, or the end of the run."""
    text, end = "", time.monotonic() + seconds
    while not found(text):
        assert time.monotonic() < end, text
        if select.select([leader], [], [], 0.1)[0]:
            try:
                text += os.read(leader, 65536).decode()
            except OSError:  # what Linux tells of a terminal that nobody has open any more
                break
    return text


def screen(text):
    """The lines that a terminal shows: what follows a carriage return stands over what was there."""
    lines = []
    for line in text.replace("\r\n", "\n").split("\n"):
        shown = ""
        for part in line.split("\r"):
            shown = part + shown[len(part) :]
        lines.append(shown.rstrip())
    return lines


def test_width(take_cores):
    """As wide as the terminal, also when that changes; the last column is left free."""
    take_cores(1)
    with on_terminal(RUN, 120) as leader:
        wide = read_until(leader, lambda text: text.count("to go") > 1)
        set_width(leader, 60)
        narrow = read_until(leader, lambda text: text.count("to go") > 2)
        set_width(leader, 30)
        none = read_until(leader, lambda text: text.count("to go") > 3)
    assert re.search(r"\[[#.]{80}\] ", wide)
    assert re.search(r"\[[#.]{20}\] ", narrow)
    assert "[" not in none.split("\r")[-2]
    for text, columns in ((wide, 120), (narrow.split("\r")[-1], 60), (none.split("\r")[-1], 30)):
        assert all(len(part) < columns for part in text.split("\r"))


def steps_per_second(run):
    """Of a run on this machine, as busy as it is now: beside other work one rank or two make a few times fewer of them."""
    with on_terminal([*run, "-monitor_interval", "100", "-progress", "false"], 150, stdout=None) as leader:
        read_until(leader, lambda text: "step " in text)
        begin = time.monotonic()
        text = read_until(leader, lambda text: "step " in text and time.monotonic() > begin + 0.5)
        return 100 * text.count("step ") / (time.monotonic() - begin)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.long)])
def test_messages_have_lines_of_their_own(ranks, take_cores):
    """The bar comes back where no message has come for 0.05 s, under `mpiexec` for 0.2 s: so messages are asked for every 0.4 s."""
    take_cores(ranks)
    run = [*(MPIEXEC + ["-n", str(ranks)] if ranks > 1 else []), *RUN]
    command = [*run, "-monitor_interval", str(int(0.4 * steps_per_second(run)))]
    with on_terminal(command, 150, stdout=None) as leader:
        text = read_until(leader, lambda text: len(text.split("energy error")) > 5 and "to go" in text.split("energy error")[-3])
    lines = screen(text[: text.rindex("\n") + 1])
    steps = [line for line in lines if line.startswith("step ")]
    assert len(steps) > 3
    pattern = r"step +\d+  time +\S+ s  energy error +\S+  gap +\S+ m  active \d+  force +\S+ N  sweeps \d+"
    assert not [line for line in steps if not re.fullmatch(pattern, line)]
    assert BAR.search(text)
    assert not [line for line in lines[:-1] if "to go" in line]


def test_setup(take_cores):
    """What is done before the first step is shown too: meshes, matrices, contact."""
    take_cores(1)
    command = [IMPAKT, "-options_file", ROOT / "options/blocks.opts", "-left_dm_plex_box_faces", "300,300", "-right_dm_plex_box_faces", "300,300"]
    with on_terminal(command, 80) as leader:
        text = read_until(leader, lambda text: "so far" in text)
    assert re.search(r"^\r((mesh|elements|matrices) of body (left|right)|contact (surfaces|method)|first state), [1-9]\d* s so far", text), text


@pytest.mark.longest
def test_lines_in_a_log(tmp_path):
    """Where there is no terminal: the first line after one minute."""
    with open(tmp_path / "log", "w") as log:
        process = subprocess.Popen([*RUN, "-time_step", "1e-10"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=log)
        time.sleep(62)
        process.terminate()
        process.wait()
    lines = [line for line in (tmp_path / "log").read_text().splitlines() if line.startswith("impakt: after ")]
    assert len(lines) == 1
    assert re.fullmatch(r"impakt: after 60 s: step \d+ of \d+, \d+ %, \d+ (s|min|h \d\d min) to go", lines[0])
