"""All that reads files, on what fuzzing starts from, on what it has found (`found/`), and on damaged copies of both: nothing breaks it. `make fuzz` goes on
from there with libFuzzer, and the sanitizers find more with `make test ASAN=1`."""

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import BUILD, ROOT

TARGETS = sorted(path.stem for path in Path(__file__).parent.glob("*.c") if path.stem != "replay")
COPIES = 700  # of all seeds of a target, and three of each at least


def damage(data, draw):
    """A copy with a piece taken out, doubled or made up."""
    begin = draw.randrange(len(data) + 1)
    end = min(len(data), begin + draw.choice((1, 2, 8, 100)))
    piece = draw.choice((b"", data[begin:end] * 2, draw.randbytes(end - begin), b"-1", b"1e99", b"\n", b"${", b"\0"))
    return data[:begin] + piece + data[end:]


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    folder = tmp_path_factory.mktemp("seeds")
    subprocess.run([sys.executable, ROOT / "tests/fuzz/seeds.py", folder], check=True)
    return folder


@pytest.mark.parametrize("target", TARGETS)
def test_replay(target, seeds, launch, tmp_path):
    draw = random.Random(1)
    inputs = []
    given = sorted((seeds / target).iterdir())
    for seed in given:
        inputs.append(seed)
        for copy in range(max(3, COPIES // len(given))):
            path = tmp_path / f"{seed.name}-{copy}"
            path.write_bytes(damage(seed.read_bytes(), draw))
            inputs.append(path)
    env = os.environ | {"ASAN_OPTIONS": "detect_leaks=0"}  # what is refused with an error is not freed; `make fuzz` does not look for leaks either
    done = launch([BUILD / "tests/fuzz" / target, *inputs], 1, cwd=tmp_path, env=env)
    assert done.returncode == 0, done.stderr
    assert f"{len(inputs)} inputs" in done.stdout
