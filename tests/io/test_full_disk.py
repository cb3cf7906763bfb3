"""A disk that is full, or a file that becomes larger than the shell allows: an error in words, and what was written before can be read."""

import os
import re
import resource
import subprocess
from functools import partial

import h5py
import numpy as np
import pytest
from cases import long
from conftest import IMPAKT, ROOT, run_command
from held import held
from messages import check_message
from pace import paced, paced_steps

RUN = [IMPAKT, "-options_file", ROOT / "options/bars-high-speed.opts"]
SHORT = [*RUN, "-time_step", "4e-7", "-progress", "false"]
# A run that ends with an error frees nothing, and a leak would be another exit code where AddressSanitizer looks for them
AT_ERRORS = os.environ | {"ASAN_OPTIONS": "detect_leaks=0"}
OUTPUTS = {"history": ("h.h5", 20, 330), "fields": ("f.h5", 100, 3000), "summary": ("s.json", 1, 2)}  # kB


@pytest.mark.parametrize("output", OUTPUTS)
def test_size_limit(output, tmp_path):
    """Whatever part of the file has been written, HDF5 is not asked to finish it: that crashed at exit."""
    name, *sizes = OUTPUTS[output]
    for size in sizes:
        limit = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (1024 * size, 1024 * size))
        run = run_command([*SHORT, f"-output_{output}", name], 1, 60, AT_ERRORS, cwd=tmp_path, preexec_fn=limit)
        assert run.returncode == 67, run.stderr  # PETSC_ERR_FILE_WRITE
        check_message(run, [name, "disk full"])
        left = {path.name for path in tmp_path.iterdir()}
        assert not left & {f"{name}.part", f"{name}.lock"}  # what is not whole has gone, and the lock too
        assert (name in left) == (output == "history" and size > 100)
        if name in left:
            with h5py.File(tmp_path / name) as history:
                # the version before the one that had no room, which is the first unless the run takes two seconds; there is room for a chunk of each series
                assert 1 <= len(history["time"]) == len(history["schwarz/iterations"]) <= 1024


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 2 MB, where this machine lets us have one."""
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", disk], check=False, capture_output=True).returncode:
        pytest.skip("file systems can be mounted by root alone")
    yield disk
    subprocess.run(["umount", disk], check=True)


def fill(disk, room):
    """Leaves so many bytes free."""
    with open(disk / "other", "wb", buffering=0) as other:
        with pytest.raises(OSError, match="No space"):
            while True:
                other.write(bytes(4096))
        other.truncate(other.tell() - room)


# What lies on the full disk, and what is left there at most
ON_DISK = {
    "history": (["-output_history", "disk/h.h5"], {"h.h5"}),
    "fields": (["-output_fields", "disk/f.h5"], set()),
    "xdmf": (["-output_fields", "f.h5"], {"f.xdmf"}),  # by a symbolic link
    "summary": (["-output_summary", "disk/s.json"], set()),
    "checkpoint": (["-checkpoint", "disk/c.h5", "-checkpoint_interval", "200"], {"c.h5", "c.prev.h5"}),
}


@pytest.mark.parametrize(("output", "ranks"), [*((output, 1) for output in ON_DISK), *(pytest.param(output, 2, marks=pytest.mark.long) for output in ON_DISK)])
def test_full_disk(output, ranks, small_disk, tmp_path, take_cores):
    """No room at all, or for the begin of the file: one message, and nothing under the file's name that is not whole."""
    take_cores(ranks)
    options, most = ON_DISK[output]
    more = {"history": (65536, 460 * 1024), "checkpoint": (65536, 360 * 1024)}  # for two checkpoints, of 160 kB, but not for a third beside them
    for room in (0, 4096, *more.get(output, ())):
        fill(small_disk, room)
        if output == "xdmf":
            (tmp_path / "f.xdmf").unlink(missing_ok=True)
            (tmp_path / "f.xdmf").symlink_to("disk/f.xdmf")
        run = run_command([*SHORT, *options], ranks, 60, cwd=tmp_path)
        assert run.returncode > 0, (room, run.stderr)
        errors = [line for line in run.stderr.splitlines() if line.startswith("impakt: error")]
        assert len(errors) == 1, run.stderr
        assert "disk" in errors[0] and ("No space left" in errors[0] or "disk full" in errors[0] or "there is room for" in errors[0])
        assert "SEGV" not in run.stderr
        left = {path.name for path in small_disk.iterdir()} - {"other"}
        assert left <= most
        if "h.h5" in left:
            with h5py.File(small_disk / "h.h5") as history:
                assert len(history["time"]) == len(history["schwarz/iterations"]) > 0
        if "f.xdmf" in left:
            assert (small_disk / "f.xdmf").read_text().endswith("</Xdmf>\n")
        (small_disk / "other").unlink()
        if "c.h5" in left:
            run = run_command([*SHORT, *options, "-restart", "disk/c.h5"], ranks, 60, cwd=tmp_path)
            assert run.returncode == 0 and "continued from" in run.stderr
        for name in left:
            (small_disk / name).unlink(missing_ok=True)


def test_list_at_the_end(small_disk, tmp_path):
    """The list of frames that fits at first and not at the end, which comes too soon after it to be written before: one message."""
    fill(small_disk, 4096)
    (tmp_path / "f.xdmf").symlink_to("disk/f.xdmf")
    run = run_command([*RUN, "-output_fields", "f.h5", "-output_fields_interval", "1", "-time_end", "-1.999e-4", "-progress", "false"], 1, 60, AT_ERRORS, cwd=tmp_path)
    assert run.returncode == 67, run.stderr
    check_message(run, ["f.xdmf", "disk full"])


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_disk_that_fills_up(ranks, small_disk, tmp_path):
    """Frames before the one that had no room are whole, and the XDMF file lists them."""
    path = small_disk / "f.h5"
    command = [*RUN, *paced(1e-6).split(), "-progress", "false", "-output_fields", path, "-output_history", "h.h5", "-output_fields_interval", paced_steps(20)]
    with held(command, tmp_path, ranks, ASAN_OPTIONS="detect_leaks=0") as run:
        run.until(paced_steps(50))
        assert (small_disk / "f.xdmf").exists()
        fill(small_disk, 0)
        code, stderr = run.finish()
    assert code == 67, stderr
    errors = [line for line in stderr.splitlines() if line.startswith("impakt: error")]
    # whichever the disk had no room for: of a dataset, or of the list of frames that is written after them
    assert re.search(r"dataset /\w+(/\w+)?/00\d\d of -output_fields|/f\.xdmf\.part cannot be written", errors[0])
    assert "disk full" in errors[0]
    assert "SEGV" not in stderr
    with h5py.File(path) as fields, h5py.File(tmp_path / "h.h5") as history:
        frames = np.flatnonzero(~np.isnan(fields["time"]))
        assert len(frames) > 0
        assert list(frames) == list(range(len(frames)))
        if ranks == 1:  # with more, MPI ends all of them before the history has its last records
            assert len(errors) == 1
            assert set(fields["time"][frames]) <= set(history["time"])
        speed = [np.abs(fields[f"velocity/{frame:04d}"]).max() for frame in frames]
        assert min(speed) > 90  # of bars that fly at 100 m/s, and would be 0 in a hole
    assert (small_disk / "f.xdmf").read_text().count("<Time ") <= len(frames)
    assert not list(small_disk.glob("*.part"))
