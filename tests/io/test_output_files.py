"""Files of runs that share them, that somebody moves away meanwhile, that are links, or that nobody reads to their end."""

import json
import shutil
import subprocess

import h5py
import numpy as np
import pytest
from cases import long
from conftest import IMPAKT, ROOT, run_command
from held import held
from messages import check_message
from pace import paced, paced_steps

STEPS = paced_steps(1000)
RUN = ["-options_file", "options/impact-high-speed.opts", *paced(1e-6).split(), "-exact", "none", "-output_history", "d/h.h5", "-output_summary", "d/s.json", "-output_fields", "d/f.h5"]
SHORT = ["options/blocks.opts", "-time_end", "1e-6"]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "options").symlink_to(ROOT / "options")
    return tmp_path


def run(folder, *words, ranks=1):
    return run_command([IMPAKT, *words], ranks, 60, cwd=folder)


def begin(folder):
    """A run that stands still, with files there that it has not finished."""
    # without a folder for its session Open MPI has a lock of its own beside f.h5, which a run that is killed leaves
    return held([IMPAKT, *RUN], folder, OMPI_MCA_orte_create_session_dirs="1")


def check_whole(folder):
    with h5py.File(folder / "h.h5") as history, h5py.File(folder / "f.h5") as fields:
        times = history["time"][()]
        assert len(times) == STEPS + 1 and (times[1:] > times[:-1]).all()
        interval = -(-STEPS // 99)  # the least with which there are at most 100
        np.testing.assert_array_equal(fields["time"][()], times[[*range(0, STEPS, interval), STEPS]])
    assert json.loads((folder / "s.json").read_text())["system"]["energy_error_max"] < 1e-3
    assert "f.h5" in (folder / "f.xdmf").read_text()


def test_two_runs_with_one_output(folder):
    """The second one ends before it computes anything, and leaves alone what is the first one's."""
    with begin(folder) as first:
        first.until(STEPS // 20)
        for ranks in (1, 2):
            second = run(folder, *RUN, ranks=ranks)
            assert second.returncode > 0
            check_message(second, ["-output_history d/h.h5", "another run", f"process {first.process.pid} "])
        other = run(folder, *SHORT, "-output_history", "other.h5", "-output_summary", "d/s.json")
        assert other.returncode > 0
        check_message(other, ["-output_summary d/s.json", "another run"])
        code, stderr = first.finish()
    assert code == 0, stderr
    check_whole(folder / "d")
    assert not list(folder.rglob("*.lock")) and not list(folder.rglob("*.part"))


def test_lock_of_a_run_that_was_killed(folder):
    with begin(folder) as first:
        first.until(STEPS // 20)
        first.kill()
    assert list(folder.rglob("*.lock"))  # nobody holds it any more
    assert run(folder, *RUN).returncode == 0
    check_whole(folder / "d")
    assert not list(folder.rglob("*.lock"))


@pytest.mark.parametrize("what", ["folder", "files", "moved"])
def test_files_that_vanish(what, folder):
    """They are written again where their paths say, with all that was in them."""
    with begin(folder) as process:
        process.until(STEPS // 20)
        assert (folder / "d/h.h5").exists() and (folder / "d/f.xdmf").exists()
        if what == "folder":
            shutil.rmtree(folder / "d")
        elif what == "moved":
            (folder / "d").rename(folder / "elsewhere")
        else:
            for name in ("h.h5", "f.h5", "f.xdmf"):
                (folder / "d" / name).unlink()
        code, stderr = process.finish()
    assert code == 0, stderr
    check_whole(folder / "d")


def test_links_are_written_through(folder):
    (folder / "store").mkdir()
    (folder / "h.h5").symlink_to("store/real.h5")  # which is not there yet
    (folder / "store/s.json").write_text("old")
    (folder / "s.json").symlink_to(folder / "store/s.json")
    assert run(folder, *SHORT, "-output_history", "h.h5", "-output_summary", "s.json").returncode == 0
    assert (folder / "h.h5").is_symlink() and (folder / "s.json").is_symlink()
    assert h5py.is_hdf5(folder / "store/real.h5")
    assert json.loads((folder / "store/s.json").read_text())
    for name in ("f.h5", "f.xdmf"):
        (folder / name).symlink_to(f"store/{name}")
    for _ in range(2):  # what the first one has written is replaced by the second
        assert run(folder, *SHORT, "-output_fields", "f.h5").returncode == 0
        assert (folder / "f.h5").is_symlink() and (folder / "f.xdmf").is_symlink()
        assert h5py.is_hdf5(folder / "store/f.h5") and (folder / "store/f.xdmf").read_text().endswith("</Xdmf>\n")
    (folder / "ring").symlink_to("ring")
    refused = run(folder, *SHORT, "-output_history", "ring")
    assert refused.returncode > 0
    check_message(refused, ["ring"])


@pytest.mark.parametrize("ranks", [1, *long(2)])
@pytest.mark.parametrize("kind", ["link", "hard link", "folder", "options", "mesh", "table"])
def test_one_file_under_two_names(kind, ranks, folder):
    """Two outputs, or an output and what the run reads."""
    words, named = {
        "link": (["-output_history", "a.h5", "-output_summary", "b.h5"], ["-output_history and -output_summary", "same file"]),
        "hard link": (["-output_history", "a.h5", "-output_fields", "c.h5"], ["-output_history and -output_fields", "same file"]),
        "folder": (["-output_history", "sub/../x.h5", "-output_summary", "./x.h5"], ["-output_history and -output_summary", "same file"]),
        "options": (["-options_file", "mine.opts", "-output_summary", "mine.opts"], ["-output_summary mine.opts", "-options_file"]),
        "mesh": (["-left_dm_plex_filename", "a.h5", "-output_summary", "b.h5"], ["-output_summary b.h5", "reads"]),
        "table": (["-left_body_force", "table:t.txt,0", "-output_summary", "t.txt"], ["-output_summary t.txt", "-left_body_force"]),
    }[kind]
    (folder / "sub").mkdir()
    (folder / "a.h5").write_text("")
    (folder / "b.h5").symlink_to("a.h5")
    (folder / "c.h5").hardlink_to(folder / "a.h5")
    (folder / "t.txt").write_text("0 0\n1 0\n")
    shutil.copy(ROOT / "options/blocks.opts", folder / "mine.opts")
    before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    refused = run(folder, *SHORT, *words, ranks=ranks)
    assert refused.returncode > 0
    check_message(refused, named if kind != "mesh" else ["a.h5"])  # which is no mesh
    assert before == {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize("name", ["x.vtu", "x.xdmf", "x.csv"])
def test_format_of_fields(name, folder):
    refused = run(folder, *SHORT, "-output_fields", name)
    assert refused.returncode > 0
    check_message(refused, [name, "HDF5", "h5"])


def test_closed_pipe(folder):
    """`impakt ... | head -1`: silence, and the files are complete. (`mpiexec` itself ends then, and its ranks with it.)"""
    command = f"set -o pipefail; {IMPAKT} {' '.join(RUN)} | head -1"
    done = subprocess.run(["bash", "-c", command], check=False, cwd=folder, capture_output=True, text=True, timeout=100)
    assert done.returncode == 0 and done.stderr == ""
    assert done.stdout.startswith("time ")
    check_whole(folder / "d")


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_none_overrules_an_options_file(ranks, folder):
    files = ["-output_history h.h5", "-output_summary s.json", "-output_fields f.h5", "-output_fields_interval 5", "-checkpoint c.h5", "-checkpoint_interval 5"]
    (folder / "my.opts").write_text("\n".join(files) + "\n")
    done = run(folder, *SHORT, "-options_file", "my.opts", "-output_history", "none", "-output_fields", "none", "-checkpoint", "none", ranks=ranks)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    assert sorted(path.name for path in folder.iterdir()) == ["my.opts", "options", "s.json"]
    assert json.loads((folder / "s.json").read_text())["run"]["complete"] is True
