"""Runs that are killed, or asked to end, at any moment: continued by the same command they end with the bits of one that was not interrupted."""

import json
import os
import random
import re
import signal
import time

import h5py
import pytest
from cases import long, validate
from conftest import ROOT, start
from held import handles, held, wait_for
from pace import paced, paced_steps
from restarts import command

# Contact from the start on, fields of two dimensions
STEPS = paced_steps(1500)
CASE = f"-options_file options/blocks.opts {paced(4e-7)} -left_dm_plex_box_faces 10,2 -right_dm_plex_box_faces 6,3"
CHECKPOINTS = ("-checkpoint", "c.h5", "-restart", "c.h5")
SELDOM = (*CHECKPOINTS, "-checkpoint_interval", 100000)
# mpiexec, where a rank has gone, kills the others without giving them a second to end
AT_ONCE = {"OMPI_MCA_odls_base_sigkill_timeout": "0"}
AMID = STEPS // 20  # a step from which there is a long way to the end


def hold(where, ranks, *more, **env):
    return held(command(CASE, 1, *more), where, ranks, **env)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """whole(ranks): the folder of a run that was not interrupted."""
    done = {}

    def run(ranks=1):
        if ranks not in done:
            done[ranks] = tmp_path_factory.mktemp("whole")
            (done[ranks] / "options").symlink_to(ROOT / "options")
            finished = start(command(CASE, 1), ranks, cwd=done[ranks])
            assert finished.returncode == 0, finished.stderr
        return done[ranks]

    return run


def kill_often(where, kills, ranks, interval, seed):
    """Continues a run that is killed again and again, then to its end; how many times there was something to continue. Each run is killed from 0 to 20 ms
    after it has begun to set up, or after one of its first steps; it stands still before its end as nobody reads what it prints."""
    chance, told = random.Random(seed), []
    for link in range(kills):
        with hold(where, ranks, *CHECKPOINTS, "-checkpoint_interval", interval, **AT_ONCE) as run:
            if link and chance.random() < 0.25:
                run.processes()
            else:
                run.print_lines(interval + chance.randint(2, 2 + AMID))  # there is a checkpoint
            time.sleep(chance.uniform(0, 0.02))
            run.kill(one=chance.random() < 0.5)
            told.append(run.stderr())
    with hold(where, ranks, *SELDOM) as last:
        code, stderr = last.finish()
    assert code == 0, stderr
    return sum("continued from" in text for text in [*told, stderr])


def readable(where):
    """Whatever is there after a kill can be read, and ends with whole records."""
    if (where / "h.h5").exists():
        with h5py.File(where / "h.h5") as history:
            assert len(history["time"]) == len(history["schwarz/iterations"])


@pytest.mark.parametrize(
    ("ranks", "interval", "kills", "seed"),
    [
        (1, 1, 3, 1),  # most of the time goes into checkpoints: kills come while one is written
        *long((1, 20, 6, 2), (1, 1, 3, 3), (2, 20, 3, 4), (2, 1, 3, 5)),
        *validate((1, 30, 15, 6), (1, 1, 15, 7), (2, 20, 6, 8), (2, 1, 4, 9), (3, 20, 6, 10), (3, 1, 4, 11)),  # 50 kills
    ],
)
def test_many_kills(folder, same_runs, whole, ranks, interval, kills, seed):
    """By chains of three: the fastest machine does not come to the end of the run either, when each link makes its steps and a page of lines."""
    interval, chance = interval if interval == 1 else paced_steps(interval), random.Random(seed)
    for left in range(kills, 0, -3):
        other = folder(f"killed-{left}")
        assert kill_often(other, min(left, 3), ranks, interval, chance.random()) > 0
        readable(other)
        same_runs(whole(ranks), other)


def end_by(where, number, *more):
    """Sends a signal to a run that is amid its steps."""
    with hold(where, 1, *more) as run:
        run.until(AMID)
        run.process.send_signal(number)
        return run.finish()


@pytest.mark.parametrize("number", [signal.SIGTERM, *long(signal.SIGINT, signal.SIGHUP)])
def test_end_in_good_order(run_in, folder, same_runs, whole, number):
    other = folder("ended")
    code, stderr = end_by(other, number, *SELDOM)
    assert code == 75, stderr
    found = re.search(rf"^impakt: ended by {number.name} after controller step (\d+) of {STEPS}; to continue, give the same command with -restart c.h5$", stderr, re.MULTILINE)
    assert found
    with h5py.File(other / "h.h5") as history:
        assert len(history["time"]) == int(found[1]) + 1
    figures = json.loads((other / "s.json").read_text())["run"]
    assert figures["complete"] is False
    assert figures["controller_steps"] == int(found[1])
    with h5py.File(other / "h.h5") as history:
        assert figures["time"] == pytest.approx(history["time"][-1], rel=1e-14)  # the same product, added up in other places
    run_in(CASE, other, 1, "-restart", "c.h5", "-checkpoint", "c.h5")
    assert json.loads((other / "s.json").read_text())["run"] == json.loads((whole() / "s.json").read_text())["run"]
    same_runs(whole(), other)


def test_checkpoint_by_signal(run_in, folder, same_runs, whole):
    other = folder("asked")
    code, stderr = end_by(other, signal.SIGUSR1, *SELDOM)
    assert code == 0, stderr
    same_runs(whole(), other)
    with h5py.File(other / "c.prev.h5") as asked:
        assert 0 < asked.attrs["step"] < STEPS
    run_in(CASE, other, 1, "-restart", "c.prev.h5")
    same_runs(whole(), other)


def test_second_interrupt(folder):
    """Ends the run at once, though its step may take long: here for ever, as nobody reads what it prints."""
    with hold(folder("interrupted"), 1, *CHECKPOINTS) as run:
        run.until(AMID)
        run.process.send_signal(signal.SIGINT)
        wait_for("the first one", lambda: not handles(run.process.pid, signal.SIGINT), run.process)  # the second one is sent when it has been taken
        run.process.send_signal(signal.SIGINT)
        wait_for("the end", lambda: run.process.poll() is not None)
        assert run.process.returncode == -signal.SIGINT


def test_wall_time(run_in, folder, same_runs, whole):
    """The time passes while the run stands still."""
    other = folder("limited")
    with hold(other, 1, *CHECKPOINTS, "-max_wall_time", "0:00:00.2") as run:
        wait_for("the first step", (other / "h.h5").exists, run.process)
        time.sleep(0.2)
        code, stderr = run.finish()
    assert code == 75, stderr
    found = re.search(r"^impakt: ended by -max_wall_time after controller step (\d+) of", stderr, re.MULTILINE)
    with h5py.File(other / "c.h5") as checkpoint:
        assert checkpoint.attrs["step"] == int(found[1])
    run_in(CASE, other, 1, "-restart", "c.h5")
    same_runs(whole(), other)


def test_without_checkpoint(folder):
    """The files are whole all the same, and it is said that the run cannot be continued."""
    where = folder("run")
    code, stderr = end_by(where, signal.SIGTERM)
    assert code == 75
    assert "without -checkpoint the run cannot be continued" in stderr
    readable(where)
    assert (where / "s.json").exists()


LAUNCHED = "impakt: ended by SIGTERM (mpiexec sends it for SIGINT too)"


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_mpiexec(run_in, folder, same_runs, whole, number):
    """Open MPI's mpiexec ends the ranks by SIGTERM, whichever signal it gets, and with a code of its own. Nobody reads what the first rank prints: the run
    ends all the same before SIGKILL comes, with its message and a checkpoint."""
    other = folder("ended")
    with hold(other, 2, *SELDOM, OMPI_MCA_odls_base_sigkill_timeout="2") as run:
        run.until(AMID)
        run.process.send_signal(number)
        assert run.process.wait() not in (0, 75)
        stderr = run.stderr()
    found = re.search(rf"^{re.escape(LAUNCHED)} after controller step (\d+) of {STEPS}; to continue, give the same command with -restart c.h5$", stderr, re.MULTILINE)
    assert found, stderr
    with h5py.File(other / "c.h5") as checkpoint:
        assert checkpoint.attrs["step"] == int(found[1])
    run_in(CASE, other, 2, "-restart", "c.h5")
    same_runs(whole(2), other)


@pytest.mark.long
def test_signal_to_a_rank(folder):
    """All ranks end in good order, and mpiexec hands their code on."""
    with hold(folder("ended"), 2, *SELDOM) as run:
        run.until(AMID)
        os.kill(run.processes()[1], signal.SIGINT)
        code, stderr = run.finish()
    assert code == 75, stderr
    assert re.search(rf"^impakt: ended by SIGINT after controller step \d+ of {STEPS}; to continue, give the same command with -restart c.h5$", stderr, re.MULTILINE), stderr


@pytest.fixture
def in_setup(folder, tmp_path):
    """A folder, and a run that waits there amid its set-up, on some ranks: its mesh is to be written to a pipe that nobody reads."""
    os.mkfifo(tmp_path / "mesh")
    return folder("run"), lambda where, ranks, *more: hold(where, ranks, *SELDOM, "-left_dm_view", f"ascii:{tmp_path}/mesh", *more)


def end_setup(run, number, victim):
    """Sends a signal to a rank, or to mpiexec (None)."""
    os.kill(run.process.pid if victim is None else run.processes()[victim], number)
    return run.finish()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, *long(signal.SIGHUP)])
def test_end_of_setup(in_setup, number):
    """Before the first step: one line, and no file is left."""
    where, begin = in_setup
    there = set(where.iterdir())
    with begin(where, 1) as run:
        code, stderr = end_setup(run, number, 0)
    assert code == 75, stderr
    assert stderr == f"impakt: ended by {number.name} during the set-up, before the first step: there is nothing to continue, the same command begins anew\n"
    assert set(where.iterdir()) == there


@pytest.mark.long
@pytest.mark.parametrize("victim", [0, 1, None])
def test_end_of_setup_on_ranks(in_setup, victim):
    """The first rank says so, also where another one has ended, or the signal is for mpiexec itself, and mpiexec ends it."""
    where, begin = in_setup
    there = set(where.iterdir())
    with begin(where, 2) as run:
        run.processes()
        code, stderr = end_setup(run, signal.SIGTERM, victim)
    assert code != 0 if victim is None else code == 75, stderr
    assert stderr.count(f"{LAUNCHED} during the set-up, before the first step: there is nothing to continue, the same command begins anew\n") == 1, stderr
    assert set(where.iterdir()) == there


def test_checkpoint_asked_in_setup(in_setup, tmp_path):
    """SIGUSR1 in the set-up does not end the run: the checkpoint is written as soon as there is a step."""
    where, begin = in_setup
    with begin(where, 1, "-time_end", "2e-5") as run:
        os.kill(*run.processes(), signal.SIGUSR1)
        (tmp_path / "mesh").read_text()  # the run goes on
        code, stderr = run.finish()
    assert code == 0, stderr
    with h5py.File(where / "c.prev.h5") as asked:
        assert asked.attrs["step"] == 0
