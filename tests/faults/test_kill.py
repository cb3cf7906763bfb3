"""Runs that are killed, or asked to end, at any moment: continued by the same command they end with the bits of one that was not interrupted."""

import contextlib
import json
import os
import random
import re
import signal
import subprocess
import time

import h5py
import pytest
from conftest import ALONE, cores
from restarts import command

# Contact from the start on, fields of two dimensions, 600 steps in about a second
CASE = "-options_file options/blocks.opts"
# of a second or more on any machine, for what is to come amid the run
SLOW = CASE + " -left_dm_plex_box_faces 100,20 -right_dm_plex_box_faces 90,18"


def children(pid):
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        return [int(word) for word in file.read().split()]


def heed_interrupts():
    """Who starts the tests in the background, or by nohup, has them ignore SIGINT or SIGHUP, and what they start would too."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def begin(where, ranks, *more, case=CASE):
    return subprocess.Popen(
        command(case, ranks, "-checkpoint", "c.h5", "-restart", "c.h5", *more),
        cwd=where,
        env=os.environ | (ALONE if ranks == 1 else {}),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,  # noqa: PLW1509
    )


def caught(pid):
    """Whether a process handles SIGINT itself: from when PETSc has been started, until one has come."""
    with open(f"/proc/{pid}/status") as status:
        mask = int(re.search(r"SigCgt:\s*(\w+)", status.read())[1], 16)
    return bool(mask >> (signal.SIGINT - 1) & 1)


def await_begun(process, where):
    """Until the set-up has ended: the first record of the history is there."""
    while not (where / "h.h5").exists():
        assert process.poll() is None
        time.sleep(0.01)


def await_caught(process, expected=True):
    late = time.monotonic() + 30
    while caught(process.pid) != expected:
        assert process.poll() is None and time.monotonic() < late
        time.sleep(0.001)


def kill_after(process, seconds, ranks, chance):
    """Kills the run with signal 9: on several ranks one of them, as the kernel does where memory ends, or all."""
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        victims = [process.pid] if ranks == 1 else children(process.pid)
        for victim in victims if chance.random() < 0.5 else victims[-1:]:
            with contextlib.suppress(ProcessLookupError):  # mpiexec ends the others as soon as one is gone
                os.kill(victim, signal.SIGKILL)
        process.wait(60)
    return process.stderr.read()


def kill_often(where, kills, ranks, interval, longest, seed):
    """Continues a run that is killed again and again, then to its end; how many times there was something to continue."""
    chance = random.Random(seed)
    with cores(ranks):
        told = [kill_after(begin(where, ranks, "-checkpoint_interval", interval), chance.uniform(0, longest), ranks, chance) for _ in range(kills)]
        last = begin(where, ranks, "-checkpoint_interval", interval)
        told.append(last.communicate(timeout=200)[1])
    assert last.returncode == 0, told[-1]
    return sum("continued from" in text for text in told)


def readable(where):
    """Whatever is there after a kill can be read, and ends with whole records."""
    if (where / "h.h5").exists():
        with h5py.File(where / "h.h5") as history:
            assert len(history["time"]) == len(history["schwarz/iterations"])


@pytest.mark.parametrize(("interval", "seed"), [(40, 1), pytest.param(1, 2, marks=pytest.mark.long)])
def test_kill(run_in, folder, same_runs, interval, seed):
    """With an interval of one step most of the time goes into checkpoints: kills come while one is written."""
    whole, other = folder("whole"), folder("killed")
    run_in(CASE, whole)
    assert kill_often(other, 3, 1, interval, 0.9, seed) > 0
    readable(other)
    same_runs(whole, other)


@pytest.mark.long
@pytest.mark.parametrize(("ranks", "interval", "kills", "seed"), [(1, 30, 15, 3), (1, 1, 15, 4), (2, 20, 6, 5), (2, 1, 4, 6), (3, 20, 6, 7), (3, 1, 4, 8)])
def test_many_kills(run_in, folder, same_runs, ranks, interval, kills, seed):
    """50 kills in all. Ranks that share cores are slow to start, so that a kill comes later."""
    whole = folder("whole")
    run_in(CASE, whole, ranks)
    chance, continued = random.Random(100 + seed), 0
    while kills > 0:
        chain = min(kills, 5)
        other = folder(f"killed-{kills}")
        continued += kill_often(other, chain, ranks, interval, 0.9 if ranks == 1 else 3.0, chance.random())
        readable(other)
        same_runs(whole, other)
        kills -= chain
    assert continued > 0


def end_by(where, number, seconds, *more, ranks=1, case=CASE):
    with cores(ranks):
        process = begin(where, ranks, "-checkpoint_interval", 100000, *more, case=case)
        await_begun(process, where)
        time.sleep(seconds)
        os.kill(process.pid, number)
        stderr = process.communicate(timeout=60)[1]
    return process.returncode, stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.long), pytest.param(signal.SIGHUP, marks=pytest.mark.long)])
def test_end_in_good_order(run_in, folder, same_runs, number):
    whole, other = folder("whole"), folder("ended")
    run_in(SLOW, whole)
    code, stderr = end_by(other, number, 0.1, case=SLOW)
    assert code == 75, stderr
    found = re.search(rf"^impakt: ended by {number.name} after controller step (\d+) of 600; to continue, give the same command with -restart c.h5$", stderr, re.MULTILINE)
    assert found
    with h5py.File(other / "h.h5") as history:
        assert len(history["time"]) == int(found[1]) + 1
    figures = json.loads((other / "s.json").read_text())["run"]
    assert figures["complete"] is False
    assert figures["controller_steps"] == int(found[1])
    with h5py.File(other / "h.h5") as history:
        assert figures["time"] == pytest.approx(history["time"][-1], rel=1e-14)  # the same product, added up in other places
    run_in(SLOW, other, 1, "-restart", "c.h5", "-checkpoint", "c.h5")
    assert json.loads((other / "s.json").read_text())["run"] == json.loads((whole / "s.json").read_text())["run"]
    same_runs(whole, other)


@pytest.mark.long
def test_checkpoint_by_signal(run_in, folder, same_runs):
    whole, other = folder("whole"), folder("asked")
    run_in(SLOW, whole)
    with cores(1):
        process = begin(other, 1, "-checkpoint_interval", 100000, case=SLOW)
        await_begun(process, other)
        time.sleep(0.1)
        os.kill(process.pid, signal.SIGUSR1)
        process.communicate(timeout=60)
    assert process.returncode == 0
    same_runs(whole, other)
    with h5py.File(other / "c.prev.h5") as asked:
        assert 0 < asked.attrs["step"] < 600
    run_in(SLOW, other, 1, "-restart", "c.prev.h5")
    same_runs(whole, other)


@pytest.mark.long
def test_second_interrupt(folder):
    """Ends the run at once, though its step may take long."""
    other = folder("interrupted")
    with cores(1):
        process = begin(other, 1, case="-options_file options/hertz-sphere.opts")
        await_begun(process, other)
        os.kill(process.pid, signal.SIGINT)
        await_caught(process, False)  # the second one is sent when the first has been taken
        os.kill(process.pid, signal.SIGINT)
        process.communicate(timeout=20)
    assert process.returncode == -signal.SIGINT


def test_wall_time(run_in, folder, same_runs):
    whole, other = folder("whole"), folder("limited")
    run_in(SLOW, whole)
    options = ("-checkpoint", "c.h5", "-restart", "c.h5", "-max_wall_time", "0:00:00.5")
    done = run_in(SLOW, other, 1, *options, code=75)
    assert "impakt: ended by -max_wall_time after controller step" in done.stderr
    run_in(SLOW, other, 1, "-restart", "c.h5")
    same_runs(whole, other)


@pytest.mark.long
def test_without_checkpoint(folder):
    """The files are whole all the same, and it is said that the run cannot be continued."""
    where = folder("run")
    with cores(1):
        process = subprocess.Popen(
            command(SLOW, 1),
            cwd=where,
            env=os.environ | ALONE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=heed_interrupts,  # noqa: PLW1509
        )
        await_begun(process, where)
        process.send_signal(signal.SIGTERM)
        stderr = process.communicate(timeout=30)[1]
    assert process.returncode == 75
    assert "without -checkpoint the run cannot be continued" in stderr
    readable(where)
    assert (where / "s.json").exists()


@pytest.mark.long
def test_mpiexec(run_in, folder, same_runs):
    """Open MPI's mpiexec hands the signal on, and ends with a code of its own. What ranks say then it may hand on or not; their checkpoint is there."""
    whole, other = folder("whole"), folder("ended")
    case = SLOW + " -time_step 2e-7"  # 3000 steps: seconds also on quiet cores
    run_in(case, whole, 2)
    code, _ = end_by(other, signal.SIGTERM, 0.3, ranks=2, case=case)
    assert code != 0
    with h5py.File(other / "c.h5") as asked:
        assert 0 < asked.attrs["step"] < 3000
    run_in(case, other, 2, "-restart", "c.h5")
    same_runs(whole, other)


# Three million degrees of freedom: set up for many seconds
SETUP = CASE + " -left_dm_plex_box_faces 1000,1000"


def await_setup(pid):
    late = time.monotonic() + 30
    while not caught(pid):
        assert time.monotonic() < late
        time.sleep(0.001)


def end_setup(where, number, ranks, victim):
    """Sends a signal to a rank amid the set-up, or to mpiexec (None)."""
    with cores(ranks):
        process = begin(where, ranks, case=SETUP)
        while ranks > 1 and len(children(process.pid)) < ranks:
            assert process.poll() is None
            time.sleep(0.01)
        processes = children(process.pid) if ranks > 1 else [process.pid]
        for pid in processes:
            await_setup(pid)
        os.kill(process.pid if victim is None else processes[victim], number)
        stderr = process.communicate(timeout=30)[1]
    return process.returncode, stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, pytest.param(signal.SIGHUP, marks=pytest.mark.long)])
def test_end_of_setup(folder, number):
    """Before the first step: one line, and no file is left."""
    where = folder("run")
    there = set(where.iterdir())
    code, stderr = end_setup(where, number, 1, 0)
    assert code == 75, stderr
    assert stderr == f"impakt: ended by {number.name} during the set-up, before the first step: there is nothing to continue, the same command begins anew\n"
    assert set(where.iterdir()) == there


@pytest.mark.long
@pytest.mark.parametrize(("ranks", "victim"), [(2, 0), (2, 1), (3, 2), (2, None), (3, None)])
def test_end_of_setup_on_ranks(folder, ranks, victim):
    """The first rank says so, also where another one has ended and mpiexec ends it; where mpiexec itself is told, it may hand that on or not."""
    where = folder("run")
    there = set(where.iterdir())
    code, stderr = end_setup(where, signal.SIGTERM, ranks, victim)
    assert code != 0 if victim is None else code == 75, stderr
    told = stderr.count("impakt: ended by SIGTERM during the set-up, before the first step: there is nothing to continue, the same command begins anew")
    assert told <= 1 if victim is None else told == 1, stderr
    assert set(where.iterdir()) == there


def test_checkpoint_asked_in_setup(folder):
    """SIGUSR1 in the set-up does not end the run: the checkpoint is written as soon as there is a step."""
    where = folder("run")
    with cores(1):
        process = begin(where, 1, "-checkpoint_interval", 100000, "-time_end", "2e-5")
        await_setup(process.pid)
        os.kill(process.pid, signal.SIGUSR1)
        stderr = process.communicate(timeout=60)[1]
    assert process.returncode == 0, stderr
    with h5py.File(where / "c.prev.h5") as asked:
        assert asked.attrs["step"] == 0
