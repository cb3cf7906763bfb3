"""Runs that stand still where a test wants them to, on fast machines and slow ones, until it lets them go on.

A program that prints into a pipe waits when the pipe is full. The pipe of these runs has room for one page, 34 lines of -monitor_interval 1 where a page
has 4 kB, and the test reads no further than the step that it waits for: so the run is amid its steps for as long as the test likes."""

import contextlib
import fcntl
import os
import re
import resource
import select
import signal
import subprocess
import tempfile
import time
from pathlib import Path

import pytest
from conftest import ALONE, IMPAKT, MPIEXEC, cores

PATIENCE = 120  # s: what is awaited so long does not come at all
LINE = 120  # characters of a line of -monitor_interval, or a few more


def heed_signals():
    """Who starts the tests in the background, or by nohup, has them ignore SIGINT or SIGHUP, and what they start would too."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def wait_for(what, found, process=None):
    """Until found() is true. The clock only tells when to give up; a process that has ended meanwhile will not bring it about."""
    late = time.monotonic() + PATIENCE
    while not found():
        if process and process.poll() is not None and not found():
            pytest.fail(f"the run has ended with {process.returncode} before {what}")
        if time.monotonic() > late:
            pytest.fail(f"{what} has not come within {PATIENCE} s")
        time.sleep(0.001)


def children(pid):
    return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def handles(pid, number):
    """Whether a process is Impakt, and handles a signal itself."""
    try:
        mask = int(re.search(r"SigCgt:\s*(\w+)", Path(f"/proc/{pid}/status").read_text())[1], 16)
        return os.readlink(f"/proc/{pid}/exe") == str(IMPAKT.resolve()) and bool(mask >> (number - 1) & 1)
    except FileNotFoundError:  # it has ended
        return False


class Held:
    """`process` is the run, or mpiexec; `lines` how many steps it has printed, `step` the number of the last one that the test has read."""

    def __init__(self, words, where, ranks, stderr, env):
        self.ranks, self.step, self.lines, self.rest = ranks, -1, 0, ""
        self.pipe, inlet = os.pipe()
        fcntl.fcntl(inlet, fcntl.F_SETPIPE_SZ, resource.getpagesize())
        self.told = tempfile.TemporaryFile("w+")  # noqa: SIM115
        words = [str(word) for word in words]
        if ranks > 1:  # mpiexec itself would read what the ranks print, and keep it until somebody asks
            words = [*MPIEXEC, "-n", str(ranks), "sh", "-c", 'exec "$@" >"$0"', f"/proc/{os.getpid()}/fd/{inlet}", *words]
        self.process = subprocess.Popen(
            words,
            cwd=where,
            env=os.environ | (ALONE if ranks == 1 else {}) | env,
            stdin=subprocess.DEVNULL,
            stdout=inlet if ranks == 1 else subprocess.DEVNULL,
            stderr=self.told if stderr is None else stderr,
            start_new_session=True,
            preexec_fn=heed_signals,  # noqa: PLW1509
        )
        self.inlet = inlet  # kept open, or ranks that have not begun yet would not find the pipe

    def stderr(self):
        self.told.seek(0)
        return self.told.read()

    def processes(self):
        """The processes of all ranks, once they handle signals."""
        if self.ranks > 1:
            wait_for("all ranks", lambda: len(children(self.process.pid)) == self.ranks, self.process)
        pids = children(self.process.pid) if self.ranks > 1 else [self.process.pid]
        wait_for("handlers of signals", lambda: all(handles(pid, signal.SIGUSR1) for pid in pids), self.process)  # the one that it begins with last
        return pids

    def read(self, most):
        """Reads on; whether there was anything, which there is not when the run has ended."""
        late = time.monotonic() + PATIENCE
        while time.monotonic() < late:
            over = self.process.poll() is not None
            if select.select([self.pipe], [], [], 0 if over else 0.05)[0]:
                *lines, self.rest = (self.rest + os.read(self.pipe, most).decode(errors="replace")).split("\n")
                steps = [int(line.split()[1]) for line in lines if line.startswith("step ")]
                self.step, self.lines = (steps or [self.step])[-1], self.lines + len(steps)
                return True
            if over:
                return False
        pytest.fail(f"the run stands still after step {self.step}\n{self.stderr()}")

    def until(self, step):
        """Has the run go on to a step, or a few further."""
        while self.step < step:
            assert self.read(LINE), f"ended after step {self.step}, before {step}: {self.stderr()}"

    def print_lines(self, number):
        """Has it print so many lines since its start, or a few more."""
        while self.lines < number:
            assert self.read(LINE), f"ended after {self.lines} lines: {self.stderr()}"

    def finish(self):
        """Has it go on to its end; the exit code, and what it has said on standard error."""
        while self.read(1 << 16):
            pass
        return self.process.wait(), self.stderr()

    def kill(self, one=True):
        """Kills the run with signal 9: on several ranks the last of them, as the kernel does where memory ends, or all."""
        assert self.process.poll() is None, self.stderr()
        victims = [self.process.pid] if self.ranks == 1 else children(self.process.pid)
        for victim in victims[-1:] if one else victims:
            with contextlib.suppress(ProcessLookupError):  # mpiexec ends the others as soon as one is gone
                os.kill(victim, signal.SIGKILL)
        self.process.wait(PATIENCE)

    def clean(self):
        """Whatever became of the test, the run ends with it."""
        if self.process.poll() is None:
            with contextlib.suppress(FileNotFoundError):
                for victim in [*(children(self.process.pid) if self.ranks > 1 else []), self.process.pid]:
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(victim, signal.SIGKILL)
            self.process.wait()
        self.told.close()
        os.close(self.pipe)
        os.close(self.inlet)


@contextlib.contextmanager
def held(words, where, ranks=1, stderr=None, **env):
    """held(words of the program, folder) -> Held. `stderr`: where that goes, in place of a file; `env`: added to the environment."""
    with cores(ranks):
        run = Held([*words, "-monitor_interval", "1"], where, ranks, stderr, env)
        try:
            yield run
        finally:
            run.clean()
