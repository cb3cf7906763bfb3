"""Deliberate faults in src (faults.json), one after the other: does a test find each of them? `make mutants` runs this file.

The tests work on a copy of the repository in build/mutants, which has the objects of build/, so that a fault costs the compilation of one file.
For each fault these run until one test fails: the tests of the fault's folder, those of `make test`, those that `make test-all` adds.
The exit code is 1 where a fault is not found, 2 where the expression of a fault is no longer there.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

from faultlist import ROOT, misplaced, read_faults

STAGES = {"folder": "not validate", "test": "not long and not validate", "test-all": "long and not validate"}
TEST_SECONDS = 300  # a run that a fault has sent into an endless loop
NO_TESTS = 5  # pytest's exit code


class Copy:
    """A copy of the repository with the objects of a build, in which one file at a time is wrong."""

    def __init__(self, folder, build, petsc, python, mpiexec):
        self.folder, self.build = folder, folder / build.relative_to(ROOT)
        self.make = ["make", f"-j{os.cpu_count()}", f"PETSC_ROOT={petsc}", f"PYTHON={python}"]
        self.pytest = [python, "-m", "pytest", "-q", "-x", "-n", str(os.cpu_count()), "--dist", "worksteal", "--timeout", str(TEST_SECONDS)]
        self.pytest += ["-p", "no:cacheprovider", "--rootdir=.", "--ignore", "tests/mutants"]  # which would miss the expression
        self.environment = os.environ | {"IMPAKT": str(self.build / "impakt"), "IMPAKT_BUILD": str(self.build), "MPIEXEC": mpiexec}
        for path in ROOT.iterdir():  # times are kept: nothing is out of date
            if path.name not in (build.relative_to(ROOT).parts[0], "out", ".git"):
                copy(path, folder / path.name)
        for path in build.iterdir():
            if path.name in ("src", "tests", "impakt", "libimpakt.a", "examples.inc", "flags", "members", "examples"):
                copy(path, self.build / path.name)

    def programs(self, below):
        """The CMocka programs below a folder of tests, as targets of make."""
        sources = [path.relative_to(self.folder) for path in sorted((self.folder / below).rglob("*.c"))]
        build = self.build.relative_to(self.folder)
        return [str(build / path.with_suffix("")) for path in sources if path.parts[1] not in ("scaling", "library", "fuzz")]

    def compile(self, below):
        """The program and what is tested below a folder; whether that went well."""
        targets = [str(self.build.relative_to(self.folder) / "impakt"), *self.programs(below)]
        done = subprocess.run([*self.make, *targets], cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode:
            print(done.stderr[-2000:], file=sys.stderr)
        return done.returncode == 0

    def first_failure(self, *selected):
        """The first test that fails, or None."""
        done = subprocess.run([*self.pytest, *selected], cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False)
        if done.returncode in (0, NO_TESTS):
            return None
        found = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
        return found[1] if found else f"pytest ended with {done.returncode}: {done.stdout[-300:]}"


def copy(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target, symlinks=True)
    else:
        shutil.copy2(source, target, follow_symlinks=False)


def folder_of(fault):
    """Where the tests of a source are: tests/x/y for src/x/y, or the nearest folder above that has tests."""
    path = Path("tests", *Path(fault.file).parts[1:-1])
    while not (ROOT / path).is_dir():
        path = path.parent
    return str(path)


def find(tree, fault):
    """By which test, and at which stage, a fault is found."""
    source = tree.folder / fault.file
    right = source.read_text()
    source.write_text(fault.apply(right))
    try:
        for stage, marks in STAGES.items():
            below = folder_of(fault) if stage == "folder" else "tests"
            if stage != "test-all" and not tree.compile(below):
                return "compilation", "the compiler"
            test = None
            if stage == "folder":  # its CMocka programs, which test_unit.py runs, are the quickest
                test = tree.first_failure("tests/test_unit.py", "-k", f"[{below.removeprefix('tests/')}/", "-m", marks)
            test = test or tree.first_failure(below, "-m", marks)
            if test:
                return stage, test
        return "", ""
    finally:
        source.write_text(right)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("build", "petsc", "python", "mpiexec"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("names", nargs="*", help="these faults alone")
    options = parser.parse_args()
    faults = read_faults()
    wrong = misplaced(faults) + [f"no fault is called {name}" for name in options.names if name not in {fault.name for fault in faults}]
    if wrong:
        print("\n".join(wrong), file=sys.stderr)
        return 2
    folder = ROOT / options.build / "mutants"
    shutil.rmtree(folder, ignore_errors=True)
    tree = Copy(folder / "copy", ROOT / options.build, options.petsc, options.python, options.mpiexec)
    report = []
    for fault in faults:
        if options.names and fault.name not in options.names:
            continue
        begin = time.monotonic()
        stage, test = find(tree, fault)
        report.append({"fault": fault.name, "file": fault.file, "stage": stage, "test": test, "seconds": round(time.monotonic() - begin)})
        print(f"{fault.name:40} {stage or 'NOT FOUND':12} {report[-1]['seconds']:5} s  {test}", flush=True)
        (folder / "report.json").write_text(json.dumps(report, indent=1))
    found = sum(bool(line["stage"]) for line in report)
    print(f"{found} passed, {len(report) - found} failed")
    return 0 if found == len(report) else 1


if __name__ == "__main__":
    sys.exit(main())
