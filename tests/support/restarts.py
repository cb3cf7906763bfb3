"""What the tests of checkpoints share: runs in one folder, and their comparison to the last bit."""

import json
import resource
import shlex

import h5py
import numpy as np
import pytest
from conftest import IMPAKT, MPIEXEC, ROOT

PATHS = {"history": "h.h5", "summary": "s.json", "fields": "f.h5"}


def command(case, ranks, *more, fields=True):
    """The words of a run; those of files are the same each time, as the history keeps its path."""
    words = [str(IMPAKT), *shlex.split(case), "-progress", "false"]
    for output in PATHS if fields else ("history", "summary"):
        words += [f"-output_{output}", PATHS[output]]
    return (MPIEXEC + ["-n", str(ranks)] if ranks > 1 else []) + words + [str(word) for word in more]


@pytest.fixture
def folder(tmp_path):
    """folder(name): a new working directory, in which options/ is the repository's."""

    def make(name):
        path = tmp_path / name
        path.mkdir()
        (path / "options").symlink_to(ROOT / "options")
        (path / "tests").symlink_to(ROOT / "tests")  # with the meshes of cases
        return path

    return make


@pytest.fixture
def run_in(launch):
    """run_in(case, where, ranks, *more): in a folder; the run must succeed, end with another `code`, or, where that is None, with any error."""

    def start(case, where, ranks=1, *more, code=0, fields=True, **kwargs):
        done = launch(command(case, 1, *more, fields=fields), ranks, cwd=where, **kwargs)
        assert done.returncode == code if code is not None else done.returncode > 0, done.stderr
        return done

    return start


MADE_OF = {"energy/change": "energy/scale"}  # what is a difference of larger numbers, by which its round-off is measured


def differences(a, b, tolerance=0):
    """What is not the same in two folders: to the last bit, or, relative to the largest number of a series, within `tolerance`."""
    found = []
    for name in ("h.h5", "f.h5"):
        if not (a / name).exists():
            continue
        with h5py.File(a / name) as first, h5py.File(b / name) as second:
            assert set(names_of(first)) == set(names_of(second))
            for dataset in names_of(first):
                x, y = first[dataset][()], second[dataset][()]
                same = x.shape == y.shape and (x.tobytes() == y.tobytes() if not tolerance else close(x, y, tolerance, first[MADE_OF.get(dataset, dataset)][()]))
                found += [] if same else [f"{name}:{dataset}"]
    found += compare(summary(a), summary(b), tolerance)
    return found


def names_of(file):
    names = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    assert names
    return names


def close(x, y, tolerance, of):
    return x.shape == y.shape and np.nanmax(np.abs(x - y), initial=0) <= tolerance * np.nanmax(np.abs(of), initial=1e-300)


def summary(where):
    found = json.loads((where / "s.json").read_text())
    del found["timing"]
    return found


def compare(x, y, tolerance, path="s.json:"):
    if isinstance(x, dict):
        assert x.keys() == y.keys()
        return [found for key in x for found in compare(x[key], y[key], tolerance, f"{path}/{key}")]
    return [] if tolerance or x == y else [f"{path} {x} {y}"]


@pytest.fixture
def same_runs():
    """same_runs(a, b): two folders have the same history, fields and summary, to the last bit."""

    def check(a, b):
        assert differences(a, b) == []

    return check


@pytest.fixture
def file_limit():
    """file_limit(bytes): for run_in(..., preexec_fn=file_limit(n)): no file may become larger, as on a disk that is full."""
    return lambda size: lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
