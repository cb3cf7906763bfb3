"""The fixture shared_run: runs that several tests look at. Each is made once in a session of pytest, whichever of its processes asks first."""

import fcntl
import hashlib
import json
import os
import shlex
from types import SimpleNamespace

import pytest
from conftest import IMPAKT, ROOT, Run, complaints, fail, start


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
                pytest.fail(f"on {ranks} ranks, this did not end in time: {options}", pytrace=False)
            runs[key] = Run(SimpleNamespace(**json.loads((folder / "done.json").read_text())), folder)
        done = runs[key]
        found = complaints(done.stdout + done.stderr)
        if done.returncode != 0 or found:
            what = f"exit code {done.returncode}" if done.returncode else "memory not freed or options not used:\n" + "\n".join(found)
            fail(what, done.command, done.stdout, done.stderr)
        return done

    yield run
    for done in runs.values():
        if "history" in done.__dict__:
            done.history.close()
