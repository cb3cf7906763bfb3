"""plots/study.py runs an options file with combinations of values, and shows figures of the runs."""

import csv
import json
import threading

import pytest
import study
from conftest import IMPAKT, ROOT

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def call(monkeypatch, tmp_path, capsys):
    """call(*words) -> exit code, rows of the table, stdout, stderr of a study of two small blocks, in a folder in which options/ is the repository's."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "options").symlink_to(ROOT / "options")
    small = "-time_end 4e-5 -left_dm_plex_box_faces 10,2 -right_dm_plex_box_faces 6,3"

    def run(*words, file="options/blocks.opts"):
        code = study.main([str(file), "out/study.png", "--program", str(IMPAKT), "--options", small, *words])
        with open("out/study.csv", newline="") as table:
            return code, list(csv.DictReader(table)), *capsys.readouterr()

    return run


def test_table_and_picture(call, tmp_path):
    """Each combination is a run with its options, and the table has what its summary has."""
    code, table, printed, told = call("--vary", "time_step=1e-6,2e-6", "--vary=-contact_type=schwarz,lagrange")
    assert code == 0, told
    assert [(row["time_step"], row["contact_type"]) for row in table] == [("1e-6", "schwarz"), ("1e-6", "lagrange"), ("2e-6", "schwarz"), ("2e-6", "lagrange")]
    for row in table:
        summary = json.loads((tmp_path / f"out/study/{int(row['run']):03d}.json").read_text())
        assert summary["contact"]["type"] == row["contact_type"]
        assert summary["run"]["controller_steps"] == round(4e-5 / float(row["time_step"]))
        for name in study.FIGURES:
            group, key = name.split("/")
            assert float(row[name]) == summary[group][key]
        assert row["failure"] == ""
    lines = printed.splitlines()
    assert lines[0].split() == ["run", "time_step", "contact_type", *study.FIGURES]
    assert lines[3].split()[:3] == ["3", "2e-6", "schwarz"]
    assert float(lines[3].split()[5]) == pytest.approx(float(table[2]["contact/force_peak"]), rel=1e-5)
    assert lines[-2:] == ["out/study.csv", "out/study.png"]
    assert (tmp_path / "out/study.png").read_bytes()[:8] == PNG


def test_values_with_commas(call):
    code, table, _, told = call("--vary", "left_dm_plex_box_faces=10,2;10,4;", "--figure", "bodies/left/dofs")
    assert code == 0, told
    assert {row["left_dm_plex_box_faces"]: row["bodies/left/dofs"] for row in table} == {"10,2": "66", "10,4": "110"}  # 2 * 11 * 3, 2 * 11 * 5


def test_a_run_that_fails(call, tmp_path):
    """Its row says why, the others are there, and the exit code is not 0; so where all fail, and no picture of an earlier study is left."""
    code, table, printed, told = call("--vary", "left_density=1000,-1")
    assert code == 1
    assert told == "plots/study.py: 1 of 2 runs failed\n"
    assert float(table[0]["contact/force_peak"]) > 0
    assert table[0]["failure"] == table[1]["contact/force_peak"] == ""
    assert "-left_density is -1" in table[1]["failure"]
    assert f"failed: {table[1]['failure']}" in printed
    assert (tmp_path / "out/study.png").exists()
    code, table, _, told = call("--vary", "time_stepp=1e-6,2e-6")
    assert code == 1
    assert all("the nearest known one is -time_step" in row["failure"] for row in table)
    assert not (tmp_path / "out/study.png").exists()


def test_a_figure_that_is_not_there(call):
    code, table, _, _ = call("--vary", "time_step=2e-6", "--figure", "contact/heat")
    assert code == 1
    assert "its summary has no contact/heat" in table[0]["failure"]
    _, table, _, _ = call("--vary", "time_step=2e-6", "--figure", "contact/force_max")
    assert "no contact/force_max; the nearest are contact/force_" in table[0]["failure"] and "contact/force_peak" in table[0]["failure"]
    assert len(table[0]["failure"]) < 200


def test_files_of_the_case_are_left_alone(call, tmp_path):
    """Runs at the same time would write the same fields and checkpoints."""
    (tmp_path / "case.opts").write_text("-options_file options/blocks.opts\n-output_fields f.h5\n-output_fields_interval 2\n-checkpoint c.h5\n-output_history h.h5\n")
    code, _, _, told = call("--vary", "time_step=1e-6,2e-6", file="case.opts")
    assert code == 0, told
    assert sorted(path.name for path in tmp_path.rglob("*.h5") if "options" not in path.parts) == ["001.h5", "002.h5"]


@pytest.mark.parametrize("jobs", [1, 2])
def test_jobs(monkeypatch, call, jobs):
    """So many runs are under way at a time: each waits until there are that many, or a moment where there are to be no more."""
    running, most, lock, both = [0], [0], threading.Lock(), threading.Event()

    def execute(command):
        with lock:
            running[0] += 1
            most[0] = max(most[0], running[0])
            if running[0] == 2:
                both.set()
        both.wait(60 if jobs == 2 else 0.05)
        with lock:
            running[0] -= 1
        return "not run"

    monkeypatch.setattr(study, "execute", execute)
    code, table, _, _ = call("--vary", "time_step=1e-6,2e-6,4e-6", "--jobs", str(jobs))
    assert code == 1
    assert [row["failure"] for row in table] == ["not run"] * 3
    assert most[0] == jobs


def test_picture(monkeypatch, tmp_path):
    """A panel for each figure; a line for each value of the other option, over the numbers of the first one; what failed is no point."""
    drawn = []
    monkeypatch.setattr(study.Figure, "savefig", lambda figure, path, **_: drawn.append(figure))
    options = study.parse(["case.opts", "s.png", "--vary", "faces=10,2;40,2;20,2", "--vary", "method=a,b", "--figure", "x", "--figure", "y"])
    runs = list(study.combinations(options, tmp_path))
    for run in runs:
        run.figures = {"x": float(run.number), "y": None}
    runs[2].failure = "what went wrong"
    study.draw(runs, options, tmp_path / "s.png")
    axes = drawn[0].axes
    assert [each.get_title() for each in axes] == ["x", "y"]
    lines = {line.get_label(): (list(line.get_xdata()), list(line.get_ydata())) for line in axes[0].get_lines()}
    assert lines == {"method a": ([10, 20], [1, 5]), "method b": ([10, 20, 40], [2, 6, 4])}
    options = study.parse(["case.opts", "s.png", "--vary", "faces=10,20", "--vary", "method=a,b", "--over", "method", "--figure", "x"])
    runs = list(study.combinations(options, tmp_path))
    for run in runs:
        run.figures = {"x": float(run.number)}
    study.draw(runs, options, tmp_path / "s.png")
    assert [label.get_text() for label in drawn[1].axes[0].get_xticklabels()] == ["a", "b"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["s.png", "--vary", "time_step"], "'time_step' is not like"),
        (["s.png", "--vary", "time_step=1,1"], "is not like"),
        (["s.png", "--vary", "a=1", "--vary", "a=2"], "varied twice"),
        (["s.png", "--vary", "a=1", "--over", "b"], "--over b is not varied"),
        (["s.h5", "--vary", "a=1"], "the picture to be drawn"),
        (["s.png", "--vary", "a=1", "--jobs", "0"], "--jobs 0"),
        (["s.png"], "--vary"),
    ],
)
def test_usage(words, message, capsys):
    with pytest.raises(SystemExit, match="2"):
        study.main(["case.opts", *words])
    assert message in capsys.readouterr().err


def test_no_program(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(study, "PLACES", ())
    monkeypatch.setenv("PATH", str(tmp_path))
    assert study.main(["case.opts", str(tmp_path / "s.png"), "--vary", "a=1"]) == 1
    assert "name the program with --program" in capsys.readouterr().err
