"""Runs that several tests look at: each is made once in a session of pytest, whichever of its processes asks first.

Test files load it by `pytest_plugins = "shared"`.
"""

import fcntl
import hashlib
import json
import os
import shlex
from types import SimpleNamespace

import pytest
from conftest import IMPAKT, ROOT, Run, complaints, fail, start

DEFAULTS = "-options_file options/impact-high-speed.opts"
LUMPED = f"{DEFAULTS} -left_mass_type lumped -right_mass_type lumped"
PAIRINGS = {
    "EE": "-left_ts_type centraldifference -right_ts_type centraldifference",
    "IE": "-right_ts_type centraldifference -right_ts_time_step 1e-8",
    "EI": "-left_ts_type centraldifference -left_ts_time_step 1e-8",
    # 1e-7 s / 7; on the explicit side
    "IE7": "-right_ts_type centraldifference -right_ts_time_step 1.4285714285714286e-8",
}


def make(folder, options, ranks):
    """Runs Impakt in a folder, in which options/ and tests/ are the repository's, and notes how it went."""
    for name in ("options", "tests"):
        (folder / name).symlink_to(ROOT / name)
    words = [*shlex.split(options), "-output_history", folder / "history.h5", "-output_summary", folder / "summary.json", "-malloc_dump"]
    done = start([IMPAKT, *words], ranks, 300, cwd=folder)
    (folder / "done.json").write_text(json.dumps(vars(done)))


@pytest.fixture(scope="session")
def shared_run(tmp_path_factory):
    """shared_run("-options_file options/x.opts", ranks=2) -> Run, as of the fixture impakt, which has succeeded."""
    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent  # of the folders that the processes have of their own
    base = base / "shared"
    base.mkdir(exist_ok=True)
    runs = {}

    def run(options, ranks=1):
        key = hashlib.sha256(f"{ranks} {options}".encode()).hexdigest()[:16]
        if key not in runs:
            folder = base / key
            with open(base / f"{key}.lock", "w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                if not folder.exists():
                    folder.mkdir()
                    make(folder, options, ranks)
            if not (folder / "done.json").exists():
                pytest.fail(f"the run did not end in time: {options}", pytrace=False)
            done = Run(SimpleNamespace(**json.loads((folder / "done.json").read_text())), folder)
            runs[key] = done
        done = runs[key]
        found = complaints(done.stdout + done.stderr)
        if done.returncode != 0 or found:
            fail(f"exit code {done.returncode}" if done.returncode else "\n".join(found), done.command, done.stdout, done.stderr)
        return done

    yield run
    for done in runs.values():
        if "history" in done.__dict__:
            done.history.close()


def worst_energy_error(summary):
    """Of the system, relative to its initial energy, without sign."""
    system = summary["system"]
    return max(abs(system["energy_error_min"]), abs(system["energy_error_max"]))


def force_scatter(summary):
    return summary["contact"]["force_std"] / summary["contact"]["force_mean"]
