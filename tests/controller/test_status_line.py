"""The progress bar of the program on a terminal: as wide as that, with messages beside it, under mpiexec, in the set-up. Each run stands still meanwhile,
as long as the test likes. What is told when, also in a log, is tested with another clock, in tests/sys/status_line.c."""

import contextlib
import fcntl
import os
import pty
import re
import resource
import select
import signal
import struct
import subprocess
import termios
import time

import pytest
from conftest import IMPAKT, MPIEXEC, ROOT
from held import PATIENCE, held
from pace import paced, paced_steps

RUN = [IMPAKT, ROOT / "options/blocks.opts", *paced(4e-7).split(), "-left_dm_plex_box_faces", "10,2", "-right_dm_plex_box_faces", "6,3"]
AMID = paced_steps(1500) // 20
BAR = re.compile(r"\[[#.]+\] +\d+ %  (\d+ h )?\d+ (s|min) to go")


def set_width(terminal, columns):
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))


@contextlib.contextmanager
def terminal(columns):
    """Both ends of a terminal: the user's, and that of programs."""
    leader, follower = pty.openpty()
    set_width(leader, columns)
    try:
        yield leader, follower
    finally:
        os.close(leader)
        os.close(follower)


def read_until(leader, found):
    """What the terminal was sent until `found(text)`."""
    text, end = "", time.monotonic() + PATIENCE
    while not found(text):
        assert time.monotonic() < end, text
        if select.select([leader], [], [], 0.1)[0]:
            text += os.read(leader, 65536).decode()
    return text


def empty(pipe):
    """Takes what a pipe holds, which is nothing where steps take long."""
    with contextlib.suppress(BlockingIOError):
        os.read(pipe, resource.getpagesize())


def last(text):
    return text.split("\r")[-1]


def screen(text):
    """The lines that a terminal shows: what follows a carriage return stands over what was there."""
    lines = []
    for line in text.replace("\r\n", "\n").split("\n"):
        shown = ""
        for part in line.split("\r"):
            shown = part + shown[len(part) :]
        lines.append(shown.rstrip())
    return lines


def test_width(tmp_path):
    """As wide as the terminal, also when that changes; at the end it is erased."""
    with terminal(120) as (leader, follower), held(RUN, tmp_path, stderr=follower) as run:
        run.until(AMID)
        wide = read_until(leader, lambda text: "to go" in last(text))
        set_width(leader, 60)
        narrow = read_until(leader, lambda text: text.count("to go") > 1 and "to go" in last(text))  # the first of them may have been drawn before
        assert run.finish()[0] == 0
        end = read_until(leader, lambda text: text.endswith(" \r"))
    assert re.match(r"\[[#.]{80}\] ", last(wide)) and len(last(wide)) < 120
    assert re.match(r"\[[#.]{20}\] ", last(narrow)) and len(last(narrow)) < 60
    assert screen(last(narrow) + end) == [""]


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.long)])
def test_messages_have_lines_of_their_own(ranks, take_cores, tmp_path):
    """The run stands still whenever a pipe is full of what a solver tells of itself, a few steps further each time, until the bar has come back."""
    take_cores(ranks)
    os.mkfifo(tmp_path / "pipe")
    pipe = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, resource.getpagesize())
    command = [*(MPIEXEC + ["-n", str(ranks)] if ranks > 1 else []), *RUN, "-monitor_interval", "1", "-schwarz_snes_view", f"ascii:{tmp_path}/pipe"]
    text = ""
    with terminal(150) as (leader, follower):
        process = subprocess.Popen(command, cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=follower, stderr=follower)
        try:
            for _ in range(4):
                text += read_until(leader, lambda more: "energy error" in more and "to go" in more.split("energy error")[-1])
                empty(pipe)
        finally:
            process.terminate()
            # The run ends after its step, for which somebody reads the pipe: a writer that opens one without a reader waits for ever.
            # mpiexec heeds the signal only while somebody reads what it writes: a full terminal that is waited beside keeps it for ever.
            try:
                read_until(leader, lambda _: empty(pipe) or process.poll() is not None)
            finally:
                os.close(pipe)
                process.kill()
                process.wait()
    lines = screen(text)
    steps = [line for line in lines if line.startswith("step ")]
    assert len(steps) >= 4
    pattern = r"step +\d+  time +\S+ s  energy error +\S+  gap +\S+ m  active \d+  force +\S+ N  sweeps \d+"
    assert not [line for line in steps if not re.fullmatch(pattern, line)]
    assert BAR.search(text)
    assert not [line for line in lines[:-1] if "to go" in line]


def test_setup(tmp_path):
    """What is done before the first step is shown too, here a mesh that is to be written to a pipe that nobody reads; what a signal has it say has a line of its own."""
    os.mkfifo(tmp_path / "pipe")
    with terminal(80) as (leader, follower), held([*RUN, "-left_dm_view", f"ascii:{tmp_path}/pipe"], tmp_path, stderr=follower) as run:
        text = read_until(leader, lambda text: "so far" in text)
        run.process.send_signal(signal.SIGTERM)
        assert run.finish()[0] == 75
        text += read_until(leader, lambda text: text.endswith("anew\r\n"))
    assert re.match(r"\rmesh of body left, [1-9]\d* s so far", text), text
    assert screen(text)[-2].startswith("impakt: ended by SIGTERM during the set-up")
