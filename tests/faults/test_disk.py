"""A disk that is full, and files that vanish, where checkpoints are concerned."""

import h5py
from conftest import IMPAKT
from restarts import summary

IMPACT = "-options_file options/impact-low-speed.opts"


def test_full(launch, folder, file_limit):
    """No room for a checkpoint: the run ends with one line that says so, and the last checkpoint is whole; with room it goes on. Without a history, which
    is larger than a checkpoint here."""
    where = folder("full")
    program = [IMPAKT, *IMPACT.split(), "-progress", "false", "-output_summary", "s.json"]
    options = ["-checkpoint", "c.h5", "-checkpoint_interval", "5", "-restart", "c.h5"]
    assert launch(program, cwd=where).returncode == 0
    whole = summary(where)
    assert launch([*program, *options, "-time_end", "1e-4"], cwd=where).returncode == 0
    size, step = (where / "c.h5").stat().st_size, h5py.File(where / "c.h5").attrs["step"]
    failed = launch([*program, *options], cwd=where, preexec_fn=file_limit(size - 1000))
    assert failed.returncode > 0
    errors = [line for line in failed.stderr.splitlines() if line.startswith("impakt: ")][1:]  # the first line says where the run goes on from
    assert errors == ["impakt: error: -checkpoint c.h5 cannot be written: File too large"]
    assert not (where / "c.h5.part").exists() and h5py.File(where / "c.h5").attrs["step"] == step
    assert launch([*program, *options], cwd=where).returncode == 0
    assert summary(where) == whole


def test_checkpoint_vanishes(run_in, folder):
    """A run does not need its own earlier checkpoints."""
    where = folder("run")
    run_in(IMPACT, where, 1, "-checkpoint", "c.h5", "-checkpoint_interval", 40, "-time_end", "1e-4", fields=False)
    (where / "c.h5").unlink()
    run_in(IMPACT, where, 1, "-checkpoint", "c.h5", "-checkpoint_interval", 10, "-restart", "c.h5", fields=False)
    assert h5py.File(where / "c.h5").attrs["step"] == 90


def test_through_a_link(run_in, folder):
    """A symbolic link is written through, and folders are made."""
    where = folder("run")
    (where / "there").mkdir()
    (where / "deep").mkdir()
    (where / "deep/c.h5").symlink_to("../there/x.h5")
    run_in(IMPACT, where, 1, "-checkpoint", "deep/c.h5", "-checkpoint_interval", 40, fields=False)
    assert (where / "deep/c.h5").is_symlink() and (where / "there/x.h5").exists() and (where / "there/x.prev.h5").exists()
    told = run_in(IMPACT, where, 1, "-checkpoint", "new/deep/c.h5", "-checkpoint_interval", 40, "-restart", "deep/c.h5", fields=False).stderr
    assert "continued from" in told
