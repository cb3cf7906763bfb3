"""plots/impakt_results.py reads runs; plots/compare.py and plots/convergence.py draw several of them."""

import math
import re
import sys

import compare
import convergence
import h5py
import history
import impact
import impakt_results
import numpy as np
import pytest
from cases import DEFAULTS
from conftest import ROOT
from matplotlib.figure import Figure

PNG = b"\x89PNG\r\n\x1a\n"
SPRING = "-bodies b -b_dm_plex_dim 1 -b_dm_plex_box_faces 1 -b_density 1 -b_youngs_modulus 1 -b_initial_displacement 0.01*(x-0.5) -b_mass_type consistent -time_end 1"


def files(run):
    return run.folder / "history.h5", run.folder / "summary.json"


@pytest.fixture
def call(capsys):
    """call(program, *words) -> exit code, stdout, stderr of a program of plots/"""

    def run(program, *words):
        return program.main([str(word) for word in words]), *capsys.readouterr()

    return run


@pytest.fixture
def bars(shared_run):
    run = shared_run(DEFAULTS)
    return impakt_results.read(*files(run))


def test_read(bars):
    assert list(bars.bodies) == ["left", "right"]
    assert list(bars.pairs) == ["left:right"]
    assert len(bars.time) == len(bars.pairs["left:right"]["force"]) == len(bars.bodies["left"]["kinetic"])
    assert bars.number("-time_step") == pytest.approx(np.diff(bars.time).mean())
    assert bars.units["contact/left:right/force"] == "N"
    assert bars.units["body/left/kinetic"] == "J"
    assert bars.series("body/left/kinetic") is bars.bodies["left"]["kinetic"]
    assert set(bars.names) >= {"body/left/kinetic", "contact/left:right/gap"}
    assert bars.summary["contact"]["impulse"] == pytest.approx(np.linalg.norm(bars.pairs["left:right"]["impulse"][-1]), rel=1e-9)
    assert np.abs(bars.energy_error).max() == pytest.approx(max(abs(bars.summary["system"][f"energy_error_{end}"]) for end in ("min", "max")), rel=1e-6, abs=1e-15)
    assert np.isfinite(bars.gap("left:right")).all()


@pytest.mark.parametrize(
    "options",
    [
        "-options_file options/capstan.opts",  # the work of a drum that turns, what friction takes
        "-options_file options/taylor-bar-axisymmetric.opts -time_end 1e-6",  # what plastic flow takes
        "-options_file options/settling.opts",  # loads, damping
    ],
)
def test_energy_error(options, impakt):
    """That of the figures is that of the summary: it has all that energy goes to and comes from."""
    run = impakt(options)
    system = run.summary["system"]
    error = impakt_results.read(*files(run)).energy_error
    assert error[-1] == pytest.approx(system["energy_error_final"], rel=1e-6, abs=1e-12)
    assert error.max() == pytest.approx(system["energy_error_max"], rel=1e-3, abs=1e-12)  # of what starts at rest relative to the largest energy until then
    assert error.min() == pytest.approx(system["energy_error_min"], rel=1e-3, abs=1e-12)


def test_fields(impakt, tmp_path):
    run = impakt(f"-options_file options/blocks.opts -time_end 1e-5 -output_fields {tmp_path}/f.h5")
    for read in (impakt_results.read(run.folder / "history.h5"), impakt_results.read(tmp_path / "f.xdmf"), impakt_results.read(tmp_path / "f.h5")):
        fields = read.fields
        assert len(fields) == len(fields.times)
        assert fields.times[-1] == pytest.approx(1e-5)
        assert fields.names == ["left", "right"]
        assert fields["velocity", 0].shape == (len(fields.nodes), 3)
        assert fields["von_mises", -1].shape == (len(fields.cells),)
        assert (fields.positions(0) == fields.nodes + fields["displacement", 0]).all()
        assert fields.units("von_mises") == "Pa"
        with pytest.raises(impakt_results.CannotRead, match=r"no field heat.*von_mises"):
            fields["heat", 0]


def test_lines_of_the_readme(bars, launch, tmp_path):
    """What plots/README.md shows for notebooks runs as it stands there."""
    (lines,) = re.findall(r"```python\n(.*?)```", (ROOT / "plots/README.md").read_text(), re.DOTALL)
    (tmp_path / "plots").symlink_to(ROOT / "plots")
    (tmp_path / "out").mkdir()
    (tmp_path / "out/impact-high-speed.h5").write_bytes(bars.path.read_bytes())
    (tmp_path / "out/impact-high-speed.json").write_text(bars.summary_path.read_text())
    run = launch([sys.executable, "-c", lines], cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[0].split()[1] == "N"
    assert float(run.stdout.split()[-1]) == bars.summary["contact"]["impulse"]


def test_what_cannot_be_read(bars, tmp_path):
    (tmp_path / "text.h5").write_text("not HDF5\n")
    h5py.File(tmp_path / "empty.h5", "w").close()
    for path, words in ((tmp_path / "nowhere.h5", "no file"), (tmp_path / "text.h5", "cannot be read as HDF5"), (tmp_path / "empty.h5", "not the history")):
        with pytest.raises(impakt_results.CannotRead, match=words):
            impakt_results.read(path)
    with pytest.raises(impakt_results.CannotRead, match="was not given -nothing"):
        bars.number("-nothing")
    with pytest.raises(impakt_results.CannotRead, match="no series body/left/heat"):
        bars.series("body/left/heat")


def test_compare_with_itself(bars, call, tmp_path):
    code, printed, told = call(compare, bars.path, bars.path, tmp_path / "new/figure.png")
    assert code == 0, told
    assert (tmp_path / "new/figure.png").read_bytes()[:8] == PNG
    differences = [float(line.split()[-3]) for line in printed.splitlines() if line.startswith(("body/", "contact/", "system/"))]
    assert len(differences) > 15
    assert not any(differences)
    assert "options that differ" not in printed


def test_compare(impakt, call):
    """A body with half the density has half the kinetic energy and momentum; steps differ, and times are found all the same."""
    base = "-bodies b -b_dm_plex_dim 1 -b_dm_plex_box_faces 2 -b_youngs_modulus 1 -b_initial_velocity 2 -time_end 1"
    one = impakt(f"{base} -b_density 1 -time_step 0.1")
    other = impakt(f"{base} -b_density 0.5 -time_step 0.025")
    code, printed, told = call(compare, *(each.folder / "history.h5" for each in (one, other)))
    assert code == 0, told
    rows = {line.split()[0]: line.split()[1:] for line in printed.splitlines() if line.startswith("body/")}
    assert rows["body/b/kinetic"][:4] == ["J", "2", "1.000e+00", "5.0e-01"]
    assert rows["body/b/momentum"][-1] == "1.000e+00"
    assert rows["body/b/momentum"][-3] == "5.0e-01"
    assert float(rows["body/b/mean_velocity"][-1]) < 1e-12
    assert "-b_density: 1 | 0.5" in printed
    assert "-time_step: 0.1 | 0.025" in printed
    millimetres = impakt(f"{base} -b_density 1 -time_step 0.1 -units mm-t-s")
    code, printed, told = call(compare, *(each.folder / "history.h5" for each in (one, millimetres)))
    assert code == 1 and not printed
    assert "has the units SI" in told and "mm-t-s: numbers of different units" in told


def test_convergence(impakt, call, tmp_path):
    """A spring between two masses swings: the trapezoidal rule's error in its displacement falls by 4 where the step is halved."""
    omega = math.sqrt(12)  # of a bar element of length, stiffness and mass 1 with its consistent mass matrix
    exact = f"-b_exact_displacement 0.01*(x-0.5)*cos({omega!r}*t)"
    runs = [impakt(f"{SPRING} {exact} -time_step {step}") for step in (0.1, 0.025, 0.05)]
    histories = []
    for i, run in enumerate(runs):
        history, summary = files(run)
        histories.append(history.rename(tmp_path / f"{i}.h5"))
        summary.rename(tmp_path / f"{i}.json")
    code, printed, told = call(convergence, *histories, tmp_path / "new/figure.png")
    assert code == 0, told
    assert (tmp_path / "new/figure.png").read_bytes()[:8] == PNG
    head, row = printed.splitlines()[:2]
    assert head.split() == ["-time_step", "0.025", "0.05", "0.1", "slope"]
    assert row.startswith("bodies/b/displacement_error")
    assert float(row.split()[-1]) == pytest.approx(2, abs=0.1)  # terms of fourth order change it by some hundredths
    code, printed, told = call(convergence, *histories, tmp_path / "other.png", "--figure", "bodies/b/potential")
    assert code == 0, told
    assert re.search(r"bodies/b/potential +- ", printed)  # the run that others are compared with


def test_convergence_of_what_is_not_there(bars, call, tmp_path):
    for name in "ab":
        (tmp_path / f"{name}.h5").write_bytes(bars.path.read_bytes())
        (tmp_path / f"{name}.json").write_text(bars.summary_path.read_text())
    words = [tmp_path / "a.h5", tmp_path / "b.h5", tmp_path / "figure.png"]
    with h5py.File(tmp_path / "b.h5", "r+") as file:
        for more, message in (
            ([], "is the same in all runs"),
            (["--against", "contact_penalty"], "was not given -contact_penalty"),
            (["--figure", "contact/heat"], "no contact/heat"),
        ):
            if "--figure" in more:
                file.attrs["-time_step"] = "1e-9"
                file.flush()
            code, _, told = call(convergence, *words, *more)
            assert code == 1 and message in told


@pytest.mark.parametrize("program", [compare, convergence])
def test_bad_files(program, call, tmp_path):
    (tmp_path / "text.h5").write_text("not HDF5\n")
    for name in ("text.h5", "nowhere.h5"):
        code, _, told = call(program, tmp_path / name, tmp_path / name, tmp_path / "figure.png")
        assert code == 1 and name in told


def test_usage(call, capsys):
    code, _, told = call(compare)
    assert code == 1 and "usage" in told
    for words, message in (((), "HISTORY.h5"), (("a.h5", "b.h5"), "the last word is the figure")):
        with pytest.raises(SystemExit, match="2"):
            call(convergence, *words)
        assert message in capsys.readouterr().err


@pytest.fixture
def drawn(monkeypatch):
    """drawn(draw, ...) -> labels and titles of the axes of a figure, whose picture is not made"""
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))

    def run(draw, *arguments, **more):
        draw(*arguments, **more)
        return {text for axes in figures.pop().axes for text in (axes.get_xlabel(), axes.get_ylabel(), axes.get_title()) if text}

    return run


@pytest.mark.parametrize(
    "units, force, energy, gap, position, time",
    [
        ("SI", "force [N]", "energy [J]", "gap [mm]", "position [mm]", "time [µs]"),
        ("mm-t-s", "force [N]", "energy [mJ]", "gap [mm]", "position [mm]", "time [µs]"),
        ("none", "force", "energy", "gap", "position", "time"),
    ],
)
def test_axes_are_labelled_in_the_units_of_the_run(units, force, energy, gap, position, time, shared_run, drawn):
    """The high-speed impact, whose force is 100, energy 1.25, gap 0.04 and position 0.27 of whatever the units are, in 1e-3 s: a unit with a prefix takes no other."""
    path = shared_run(f"{DEFAULTS} -units {units} -exact none -time_step 1e-6").folder / "history.h5"
    run = impakt_results.read(path)
    assert {force, gap, time, "nodes [1]"} <= drawn(history.draw, path, path="-")
    assert {force, energy, position, time} <= drawn(impact.draw, path, path="-")
    assert {force, energy, gap, time} <= drawn(compare.draw, run, run, "-")
    assert compare.labelled("at time", "" if units == "none" else "s") in compare.table(compare.differences(run, run), run.units["time"])
