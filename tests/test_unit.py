"""The CMocka programs, which are the C files of all folders here but fuzz, scaling and library, each on one rank or on those that a comment in it
names, where something parallel is tested: /* ranks: 1 3 */. On those that another one names, /* long: 3 */, only where long tests are run; on all, if it
names none: /* long */"""

import os
import re

import pytest
from conftest import BUILD, ROOT, complaints, fail

RANKS = re.compile(r"/\*\s*ranks:\s*([\d\s,]+)\*/")
LONG = re.compile(r"/\*\s*long(?::\s*([\d\s,]+))?\s*\*/")


def cases():
    tests = ROOT / "tests"
    for source in sorted(tests.rglob("*.c")):
        program = source.relative_to(tests).with_suffix("")
        if program.parts[0] in ("scaling", "library", "fuzz"):
            continue
        text = source.read_text()
        named, long = RANKS.search(text), LONG.search(text)
        for ranks in re.findall(r"\d+", named.group(1)) if named else "1":
            is_long = long and (long.group(1) is None or ranks in re.findall(r"\d+", long.group(1)))
            yield pytest.param(program, int(ranks), id=f"{program}-{ranks}", marks=[pytest.mark.long] if is_long else [])


@pytest.mark.parametrize(("name", "ranks"), list(cases()))
def test_unit(name, ranks, launch, tmp_path):
    done = launch([BUILD / "tests" / name], ranks, cwd=tmp_path, env={**os.environ, "PETSC_OPTIONS": "-malloc_dump"})
    output = done.stdout + done.stderr
    failed = sorted(set(re.findall(r"\[  FAILED  \] (\w+)$", output, re.MULTILINE)))
    if done.returncode != 0 or failed:
        fail(f"failed: {', '.join(failed) or f'exit code {done.returncode}'}", done.command, done.stdout, done.stderr)
    found = complaints(output)
    if found:
        fail("memory not freed or options not used:\n" + "\n".join(found), done.command, done.stdout, done.stderr)
    if not re.search(r"\[  PASSED  \] [1-9]\d* test", output):
        if "[  SKIPPED ]" in output:
            pytest.skip(f"{name} skips all its tests on {ranks} ranks")
        fail("no CMocka test passed: none ran?", done.command, done.stdout, done.stderr)
