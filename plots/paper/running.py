"""Runs experiments, several at a time, each once: what has been run with the same options and program is not run again.

Beside history (NAME.h5) and summary (NAME.json) a run leaves its record, NAME.run, in JSON: a key, how it ended, seconds. The key
is a hash of the options, included files put in their place and comments left out, and of the program's file: another comment
is no reason to run again, another build is. The record is written last, so a run that was interrupted has none.
"""

import hashlib
import json
import os
import shlex
import sys
import time
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from pathlib import Path

from execute import execute

from .experiments import ROOT


class Runner:
    """Where the runs are, and what with: `program` is a path, `runs` the folder of what they leave."""

    def __init__(self, program, runs, root=ROOT, limit=900):
        self.program, self.runs, self.root, self.limit = Path(program).resolve(), Path(runs).resolve(), root, limit
        self.build = hashlib.sha256(self.program.read_bytes()).hexdigest()

    def path(self, experiment, ending):
        return self.runs / f"{experiment.name}{ending}"

    def key(self, experiment):
        text = f"{self.build}\n{experiment.keeps_history}\n{experiment.options}\n"
        return hashlib.sha256(text.encode()).hexdigest()

    def record(self, experiment):
        """What is known of the last run with this key; None if there is none."""
        try:
            record = json.loads(self.path(experiment, ".run").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return record if record.get("key") == self.key(experiment) else None

    def is_done(self, experiment):
        """It has succeeded, and what it left is still there. A failed one is tried again."""
        record = self.record(experiment)
        left = [".json"] + [".h5"] * experiment.keeps_history
        return record is not None and not record["error"] and all(self.path(experiment, ending).is_file() for ending in left)

    def command(self, experiment):
        words = [
            self.program,
            "-options_file",
            experiment.file,
            "-output_summary",
            self.path(experiment, ".json"),
            "-progress",
            "false",
        ]
        if experiment.keeps_history:
            words += ["-output_history", self.path(experiment, ".h5")]
        return [str(word) for word in words]

    def run(self, experiment):
        """Runs it, whatever has been before, and returns the record."""
        for ending in (".run", ".json", ".h5"):
            self.path(experiment, ending).unlink(missing_ok=True)
        self.path(experiment, ".run").parent.mkdir(parents=True, exist_ok=True)
        command = self.command(experiment)
        begin = time.monotonic()
        error = execute(command, self.root, self.limit)
        record = {
            "key": self.key(experiment),
            "command": shlex.join(command),
            "seconds": time.monotonic() - begin,
            "error": error,
        }
        part = self.path(experiment, ".run.part")
        part.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
        part.replace(self.path(experiment, ".run"))
        return record


class Progress:
    """One line: how many are done, time so far and an estimate of what is left. On a terminal it is written over and over."""

    def __init__(self, todo, done_before, jobs, stream=None):
        self.stream = stream or sys.stderr
        self.left = sum(experiment.cost for experiment in todo)
        self.total, self.count, self.jobs = len(todo) + done_before, done_before, jobs
        self.begin = self.shown = time.monotonic()
        self.spent = 0.0  # of the costs, by runs that have ended

    def estimate(self, elapsed):
        """Costs are seconds of one process; what has ended tells how far off they are."""
        pace = elapsed / self.spent if self.spent else 1 / self.jobs
        return pace * self.left

    def ended(self, experiment, error=""):
        self.count += 1
        self.left = max(0.0, self.left - experiment.cost)
        self.spent += experiment.cost
        now = time.monotonic()
        elapsed = now - self.begin
        line = f"{self.count} of {self.total} runs, {clock(elapsed)} elapsed, about {clock(self.estimate(elapsed))} left"
        over = self.stream.isatty()
        if error:
            self.stream.write(f"{CLEAR if over else ''}FAILED {experiment.name}: {error}\n")
        if over:
            self.stream.write(f"{CLEAR}{line}" + ("\n" if self.count == self.total else ""))
        elif self.count == self.total or now - self.shown >= 5:
            self.stream.write(f"{line}\n")
            self.shown = now
        self.stream.flush()


CLEAR = "\r\x1b[K"


def clock(seconds):
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def run_all(runner, experiments, jobs=None, stream=None):
    """Runs what has not been run; returns the errors of those that failed, by name. One that fails does not stop the others."""
    jobs = jobs or len(os.sched_getaffinity(0))
    todo = [experiment for experiment in experiments if not runner.is_done(experiment)]
    todo.sort(key=lambda experiment: -experiment.cost)  # the longest first, or the last one is waited for by all cores but one
    before = len(experiments) - len(todo)
    progress = Progress(todo, before, jobs, stream)
    progress.stream.write(f"{len(todo)} runs to make on {jobs} core{'s' * (jobs > 1)}, {before} made before\n")
    errors = {}
    with ThreadPoolExecutor(jobs) as pool:
        running = {pool.submit(runner.run, experiment): experiment for experiment in todo}
        try:
            while running:
                ended, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in ended:
                    experiment, error = running.pop(future), future.result()["error"]
                    if error:
                        errors[experiment.name] = error
                    progress.ended(experiment, error)
        finally:
            pool.shutdown(cancel_futures=True)
    return errors
