"""What the tests share: starting programs under MPI, running Impakt, long tests, and the tally that ends `make test`."""

import fcntl
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace

import h5py
import pytest

ROOT = Path(__file__).resolve().parent.parent
# What tests share, and the programs that make pictures and reports
sys.path[:0] = [str(ROOT / "tests/support"), str(ROOT / "plots")]
pytest_plugins = ["shared_runs", "restarts"]

BUILD = Path(os.environ.get("IMPAKT_BUILD", ROOT / "build"))
IMPAKT = Path(os.environ.get("IMPAKT", BUILD / "impakt"))
MPIEXEC = shlex.split(os.environ.get("MPIEXEC") or "mpiexec")
CORES = len(os.sched_getaffinity(0))

LEAK = re.compile(r"^\[ *\d+\] *\d+ bytes .*|^.*Total space allocated.*", re.MULTILINE)
LEFTOVER = re.compile(r"^WARNING! There are options you set that were not used[\s\S]*", re.MULTILINE)


def complaints(output):
    """What PETSc found wrong at the end of a run with -malloc_dump: unfreed memory (its first few lines), unused options."""
    found = LEAK.findall(output)[:5]
    leftover = LEFTOVER.search(output)
    if leftover:
        found += [line for line in leftover.group().splitlines() if "ption left" in line]
    return found


def is_locked_now(file):
    """Whether the lock of a file could be had; it is given back when the file is closed."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


@contextmanager
def cores(wanted):
    """Waits until so many cores are free, or all where there are fewer, of those that the tests of this build share. A rank that waits for others
    leaves its core to any process that computes: beside one, two ranks on two cores took 11 s for what they do in 2.4 s by themselves."""
    folder = BUILD / "cores"
    folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as held:
        with open(folder / "turn", "w") as turn:  # whoever needs several gets one after the other, and nobody else takes any meanwhile
            fcntl.flock(turn, fcntl.LOCK_EX)
            files, taken = [held.enter_context(open(folder / str(core), "w")) for core in range(CORES)], []
            while len(taken) < min(wanted, CORES):
                file = next((file for file in files if file not in taken and is_locked_now(file)), None)
                if file:
                    taken.append(file)
                else:
                    time.sleep(0.002)
        yield


def start(command, ranks=1, timeout=120, **more):
    """Runs a command on some ranks; one that outlives `timeout` seconds is ended, and the test fails with its output."""
    with cores(ranks):
        return run_command(command, ranks, timeout, **more)


# A process on its own needs neither Open MPI's daemon beside it, which takes 0.1 s to start, nor a folder to meet others in
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_orte_create_session_dirs": "0"}


def run_command(command, ranks, timeout, env=None, **more):
    command = [str(word) for word in command]
    env = dict(os.environ if env is None else env)
    if ranks > 1:
        command = MPIEXEC + ["-n", str(ranks)] + command
    elif BUILD in Path(command[0]).parents:
        env |= ALONE
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
        env=env,
        **more,
    )
    late = False
    try:
        stdout, stderr = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        late = True
        os.killpg(process.pid, signal.SIGTERM)  # mpiexec ends its ranks, which are not in its process group
        try:
            stdout, stderr = process.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            stdout, stderr = process.communicate()
    if late:
        fail(f"still running after {timeout} s", command, stdout, stderr)
    return SimpleNamespace(command=command, returncode=process.returncode, stdout=stdout, stderr=stderr)


def fail(what, command, stdout, stderr):
    ends = "".join(f"\n--- {name}\n{text[-8000:].rstrip()}" for name, text in (("stdout", stdout), ("stderr", stderr)) if text.strip())
    pytest.fail(f"{what}\n$ {shlex.join(command)}{ends}", pytrace=False)


class Run:
    """A finished run of Impakt. `summary` is the parsed JSON, `history` the open HDF5 file; both are read when asked for."""

    def __init__(self, process, folder):
        self.command, self.returncode = process.command, process.returncode
        self.stdout, self.stderr = process.stdout, process.stderr
        self.folder = folder

    @cached_property
    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    @cached_property
    def history(self):
        return h5py.File(self.folder / "history.h5", "r")


@pytest.fixture
def take_cores():
    """take_cores(n), for the rest of a test that starts processes in a way of its own."""
    with ExitStack() as held:
        yield lambda wanted: held.enter_context(cores(wanted))


@pytest.fixture
def launch():
    """start(command, ranks=1, timeout=120, ...), for programs other than Impakt."""
    return start


@pytest.fixture
def impakt(tmp_path):
    """Runs Impakt: impakt("-options_file options/x.opts -time_end 1e-4", ranks=2) -> Run.

    Each call has a folder of its own as working directory, in which options/ and tests/ are the repository's; history and
    summary go there. The run must succeed, free its memory and use all its options; with expect_failure it must end with
    an exit code of its own other than 0 (not by a signal), whatever it leaves. `env` is added to the environment.
    """
    runs = []

    def run(options, ranks=1, expect_failure=False, timeout=300, env=None):
        words = shlex.split(options) if isinstance(options, str) else [str(word) for word in options]
        folder = tmp_path / f"run-{len(runs)}"
        folder.mkdir()
        for name in ("options", "tests"):
            (folder / name).symlink_to(ROOT / name)
        words += ["-output_history", folder / "history.h5", "-output_summary", folder / "summary.json", "-malloc_dump"]
        done = Run(start([IMPAKT, *words], ranks, timeout, cwd=folder, env={**os.environ, **(env or {})}), folder)
        runs.append(done)

        def reject(what):
            fail(what, done.command, done.stdout, done.stderr)

        if expect_failure:
            if done.returncode == 0:
                reject("succeeded, but was expected to fail")
            if done.returncode < 0 or "Segmentation" in done.stderr:
                reject("crashed, but was expected to fail with a message")
            return done
        if done.returncode != 0:
            reject(f"exit code {done.returncode}")
        found = complaints(done.stdout + done.stderr)
        if found:
            reject("memory not freed or options not used:\n" + "\n".join(found))
        return done

    yield run
    for done in runs:
        if "history" in done.__dict__:
            done.history.close()


def pytest_configure(config):
    config.addinivalue_line("markers", "long: what `make test` leaves to `make test-all`: a test that takes more than 2 s of a core, or a further mesh, pairing or number of ranks.")
    config.addinivalue_line("markers", "validate: what both leave to `make validate`: comparisons at full length, and random variants.")


def tally(config):
    """Passed, failed (with errors, of which collecting and fixtures have some too), skipped."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    count = {key: len(reports) for key, reports in reporter.stats.items()} if reporter else {}
    return count.get("passed", 0), count.get("failed", 0) + count.get("error", 0), count.get("skipped", 0) + count.get("xfailed", 0)


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session):
    passed, failed, _ = tally(session.config)
    if not hasattr(session.config, "workerinput") and passed + failed == 0:
        session.exitstatus = pytest.ExitCode.NO_TESTS_COLLECTED  # all skipped is no success


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """The last line: N passed, N failed[, N skipped]. Kept in the build folder as well."""
    if hasattr(config, "workerinput"):
        return
    passed, failed, skipped = tally(config)
    line = f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else "")
    BUILD.mkdir(parents=True, exist_ok=True)
    (BUILD / "tally").write_text(line + "\n")
    print(line, flush=True)
