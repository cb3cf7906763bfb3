"""The report of the paper: experiments from options files, each run once, and what is written of them; on runs of a few hundred steps."""

import io
import json
import shutil

import pytest
from conftest import IMPAKT, ROOT
from paper import __main__ as program
from paper import claims, experiments, figures, html, running, tables, text
from paper.results import NoResult, Results, convergence_rate, figure

SMALL = "-time_step 1e-6\n-left_dm_plex_box_faces 20\n-right_dm_plex_box_faces 20\n"  # 1000 steps of 0.08 h / c
EXPERIMENTS = {
    "high-speed/ii": f"# Plain alternation\n-options_file options/paper/shared/schwarz.opts\n{SMALL}",
    "high-speed/lagrange": f"# Multiplier\n-options_file options/impact-lagrange.opts\n{SMALL}",
    "variants/paper/anderson-ii": f"# Anderson | with mass\n-options_file options/paper/shared/schwarz.opts\n{SMALL}-schwarz_snes_type anderson\n",
    "variants/paper/broken-ii": f"# Broken\n-options_file options/paper/shared/schwarz.opts\n{SMALL}-schwarz_snes_tpye anderson\n",
}


def put(root, name, content):
    path = root / f"options/paper/{name}.opts"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(content)


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A folder like the repository, with few and small experiments."""
    root = tmp_path_factory.mktemp("paper")
    (root / "options").mkdir()
    for path in (ROOT / "options").glob("*.opts"):
        shutil.copy(path, root / "options")
    shutil.copytree(ROOT / "options/paper/shared", root / "options/paper/shared")
    for name, content in EXPERIMENTS.items():
        put(root, name, content)
    return root


@pytest.fixture(scope="module")
def made(root):
    """Runner, experiments, errors and what was said of the progress, after all have been run."""
    found = experiments.find(root)
    runner = running.Runner(IMPAKT, root / "runs", root)
    said = io.StringIO()
    errors = running.run_all(runner, list(found.values()), 2, said)
    return runner, found, errors, said.getvalue()


def test_experiments(root):
    found = experiments.find(root)
    assert list(found) == sorted(EXPERIMENTS)
    one = found["variants/paper/anderson-ii"]
    assert (one.group, one.variant, one.pairing) == ("variants/paper", "anderson", "ii")
    assert one.title == "Anderson | with mass"
    assert one.steps == 1000
    assert one.last("schwarz_snes_type") == "anderson"  # the included file has nrichardson
    assert "#" not in one.options
    assert "options_file" not in one.options


def test_bad_options(tmp_path):
    for content, message in (
        ("# a\n-options_file options/nowhere.opts\n", "options/nowhere.opts"),
        ("# a\n-options_file options/paper/bad.opts\n", "includes itself"),
        ("# a\n-options_file\n", "without a file"),
        ("-time_step 1\n", "first line"),
    ):
        put(tmp_path, "bad", content)
        with pytest.raises(experiments.BadOptions, match=message):
            experiments.find(tmp_path)


def test_every_options_file_of_the_paper():
    """They can be read, and no two are the same run."""
    found = experiments.find()
    assert len(found) > 100
    assert len({one.options for one in found.values()}) == len(found)
    assert {name for name in found if name.startswith("high-speed/")} == set(experiments.HIGH_SPEED)
    for elements in experiments.MESHES:
        assert {f"mesh/{pairing}-{elements}" for pairing in experiments.PAIRINGS} <= set(found)


def test_one_fails_and_the_others_run(made):
    runner, found, errors, said = made
    assert list(errors) == ["variants/paper/broken-ii"]
    assert "schwarz_snes_tpye" in errors["variants/paper/broken-ii"]  # the program's message, not only that it failed
    assert "FAILED variants/paper/broken-ii" in said
    lines = said.splitlines()
    assert lines[0] == "4 runs to make on 2 cores, 0 made before"
    assert lines[-1].startswith("4 of 4 runs, 0:0") and lines[-1].endswith("about 0:00 left")
    for name, experiment in found.items():
        assert runner.is_done(experiment) == (name not in errors)
        assert runner.path(experiment, ".h5").exists() == (name not in errors)


def test_done_is_not_run_again(made):
    runner, found, _, _ = made
    before = {
        name: runner.path(one, ".json").stat().st_mtime_ns for name, one in found.items() if runner.path(one, ".json").exists()
    }
    assert len(before) == 3
    said = io.StringIO()
    errors = running.run_all(runner, list(found.values()), 1, said)
    assert said.getvalue().startswith("1 runs to make on 1 core, 3 made before")  # the one that failed
    assert list(errors) == ["variants/paper/broken-ii"]
    assert {name: runner.path(found[name], ".json").stat().st_mtime_ns for name in before} == before


def test_what_makes_a_run_another(made, root, tmp_path):
    """Other options or another program do, another comment does not; nor is a run done of which a file is missing."""
    runner, found, _, _ = made
    one = found["high-speed/ii"]
    put(tmp_path, "high-speed/ii", "# Another\n" + one.options.replace("\n", "  # why\n"))
    assert runner.key(experiments.find(tmp_path)["high-speed/ii"]) == runner.key(one)
    put(tmp_path, "high-speed/ii", f"# Another\n{one.options}\n-schwarz_snes_atol 1e-11")
    assert runner.key(experiments.find(tmp_path)["high-speed/ii"]) != runner.key(one)
    other = tmp_path / "impakt"
    other.write_bytes(IMPAKT.read_bytes() + b"\n")
    assert not running.Runner(other, root / "runs", root).is_done(one)
    history, aside = runner.path(one, ".h5"), tmp_path / "aside.h5"
    history.rename(aside)
    assert not runner.is_done(one)
    aside.rename(history)
    assert runner.is_done(one)


def test_time_limit(root, tmp_path):
    runner = running.Runner(IMPAKT, tmp_path, root, limit=0.01)
    errors = running.run_all(runner, [experiments.find(root)["high-speed/ii"]], 1, io.StringIO())
    assert errors == {"high-speed/ii": "no result within 0.01 s"}


def test_long_runs_keep_no_history(root, tmp_path):
    put(tmp_path, "long", "# Long\n-time_end 1e-3\n-time_step 1e-9\n")
    long = experiments.find(tmp_path)["long"]
    assert long.steps == 1_000_000
    command = running.Runner(IMPAKT, tmp_path, tmp_path).command(long)
    assert "-output_history" not in command
    assert "-output_summary" in command


def test_report(made, tmp_path):
    """Of what there is; what is missing is said where it would be, and the failed run with its error."""
    runner, found, errors, _ = made
    results = Results(runner, found)
    program.write(results, tmp_path)
    page = (tmp_path / "report.md").read_text()
    assert "## Runs that failed" in page
    assert errors["variants/paper/broken-ii"][:60] in page
    summary = json.loads(runner.path(found["high-speed/ii"], ".json").read_text())
    assert tables.number(summary["errors"]["kinetic"]) in page
    assert "Not drawn: there is no experiment low-speed/lagrange" in page
    assert "| Broken | II | failed |" in page
    whole = (tmp_path / "report.html").read_text()
    assert "<table>" in whole
    assert "## " not in whole


def test_pictures_are_inside(tmp_path):
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    page = html.convert("# Title\n\n![A](a.png)\n", tmp_path)
    assert "<title>Title</title>" in page
    assert 'src="data:image/png;base64,iVBORw0KGgo="' in page


def test_command_fails_when_a_run_does(root, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(
        program, "find", lambda: {name: one for name, one in experiments.find(root).items() if "variants" in name}
    )
    monkeypatch.setattr(program, "Runner", lambda path, runs: running.Runner(path, runs, root))
    assert program.main(["--program", str(IMPAKT), "--out", str(tmp_path), "--jobs", "1"]) == 1
    assert "FAILED variants/paper/broken-ii" in capsys.readouterr().err
    assert program.main(["--program", str(tmp_path / "nowhere"), "--out", str(tmp_path)]) == 1
    assert "nowhere" in capsys.readouterr().err
    monkeypatch.setattr(program, "find", dict)
    assert program.main(["--program", str(IMPAKT), "--out", str(tmp_path)]) == 0


def test_number():
    values = {(0.005229, 3): "0.00523", (1.2345e-6, 2): "1.2e-6", (5, 3): "5", (0, 3): "0", (None, 3): "–", (-2765.9, 2): "-2766", (99.9996, 3): "100"}
    assert {given: tables.number(*given) for given in values} == values


def test_convergence_rate():
    assert convergence_rate((50, 100, 200), [8.0, 2.0, 0.5]) == pytest.approx(2, abs=1e-12)


def test_claims_are_judged_by_figures(made):
    """A claim that cannot be measured says so; the measures of one that can are those of the run."""
    runner, found, _, _ = made
    results = Results(runner, found)
    overshoot = next(claim for claim in claims.CLAIMS if "overshoots" in claim.text)
    measured, verdict = claims.judge(overshoot, results)
    peak = figure(results["high-speed/lagrange"].summary, "contact.force_peak") / figure(
        results["high-speed/lagrange"].summary, "contact.force_mean"
    )
    assert measured.startswith(f"{peak:.2f} times")
    assert verdict == (claims.YES if peak > 1.5 else claims.NO)
    assert any(claims.judge(claim, results)[1] == "–" for claim in claims.CLAIMS)
    with pytest.raises(NoResult, match="mesh/ii-400"):
        results["mesh/ii-400"]


def test_thin():
    """What is left out of a long series does not change the picture: least and largest value of each bin stay."""
    np = pytest.importorskip("numpy")
    time = np.linspace(0, 1, 100_000)
    values = np.sin(1e4 * time)
    values[54_321] = 3
    few, thinned = figures.thin(time, values)
    assert len(few) <= 2 * figures.BINS
    assert thinned.max() == 3
    assert thinned.min() == values.min()


def test_every_claim_has_a_section():
    assert {claim.where for claim in claims.CLAIMS} <= {"4.3", "4.4.1", "4.4.2", "5"}
    assert "figure-4.13a-convergence" in {figures.file_of(number) for number in figures.FIGURES}
    assert text.INTRODUCTION.startswith("# ")
