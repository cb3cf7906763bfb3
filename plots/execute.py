"""Runs Impakt, for the programs that make runs themselves, and finds its message where it fails."""

import os
import re
import subprocess

ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
# As root, as in a container, Open MPI wants to be told twice
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def execute(command, folder=None, limit=None):
    """Runs a command in a folder for at most `limit` seconds; returns what went wrong, or an empty text."""
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env={**os.environ, **ONE_THREAD, **AS_ROOT},
            timeout=limit,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no result within {limit:g} s"
    except OSError as error:
        return str(error)
    return "" if done.returncode == 0 else f"exit code {done.returncode}: {message_of(done.stdout + done.stderr)}"


def message_of(output):
    """The program's message, or PETSc's first lines of an error; without them, the last lines of the output."""
    found = re.search(r"^impakt: error(?: on rank \d+)?: (.*)", output, re.MULTILINE)
    if found:
        return found[1]
    lines = [line.partition("PETSC ERROR:")[2].strip() for line in output.splitlines() if "PETSC ERROR:" in line]
    lines = [line for line in lines if line and not line.startswith("---")]
    for end, line in enumerate(lines):
        if line.startswith(("WARNING! There are unused", "See https", "PETSc Release")):
            return " ".join(lines[:end])
    return " ".join(lines[:2]) or " ".join(output.split("\n")[-4:]).strip() or "no message"
