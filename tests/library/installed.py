"""`make install` into a folder of this test run, done once, and programs compiled against it as a stranger would: cc and pkg-config."""

import fcntl
import os
import shlex
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import BUILD, ROOT

PLAIN = {"MAKEFLAGS", "MAKELEVEL", "MFLAGS", "MAKEOVERRIDES", "PETSC_OPTIONS"}
environment = {name: value for name, value in os.environ.items() if name not in PLAIN}


def run(command, **more):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600, check=False, **more)
    if done.returncode:
        pytest.fail(f"$ {shlex.join(map(str, command))}\nexit code {done.returncode}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}", pytrace=False)
    return done.stdout


def make_install(*variables):
    """One at a time: each links the library anew where that is needed"""
    with (BUILD / "install.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        debug = ["DEBUG=1"] if BUILD.name == "debug" else []
        run(["make", "--no-print-directory", "install", *variables, *debug], cwd=ROOT, env=environment)


def pkg_config(prefix, *words):
    return run(["pkg-config", *words, "impakt"], env={**environment, "PKG_CONFIG_PATH": str(prefix / "lib/pkgconfig")}).split()


@pytest.fixture(scope="session")
def installed(tmp_path_factory):
    """prefix, cflags, libs; installed by the first of several processes that run tests"""
    if BUILD.name == "asan":
        pytest.skip("programs of strangers do not load the address sanitizer first, which the library would need")
    base = tmp_path_factory.getbasetemp()
    root = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    prefix = root / "installed"
    with (root / "installed.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (root / "installed.done").exists():
            make_install(f"PREFIX={prefix}")
            (root / "installed.done").touch()
    return SimpleNamespace(prefix=prefix, cflags=pkg_config(prefix, "--cflags"), libs=pkg_config(prefix, "--libs"))


def compile_program(installed, source, folder):
    """With all warnings as errors, but for those of other people's headers"""
    program = Path(folder) / Path(source).stem
    theirs = [word.replace("-I", "-isystem", 1) if not word.startswith(f"-I{installed.prefix}") else word for word in installed.cflags]
    run(["cc", "-std=c11", "-Wall", "-Wextra", "-Werror", *theirs, str(source), "-o", str(program), *installed.libs], env=environment)
    return program
