"""-check: what a run would begin with and do, without making a step; and the warning of elements that alone bound the step of an explicit run."""

import re

import h5py
import numpy as np
import pytest
from conftest import IMPAKT

# Two layers of rectangles, 0.1 m high. Without Poisson's ratio waves cross an element in its least edge over c = sqrt(E / rho) = 1000 m/s, which is the stable
# step of a lumped mass.
SPEED = 1000
BAR = "-bodies bar -bar_dm_plex_filename bar.msh -bar_density 1000 -bar_youngs_modulus 1e9 -bar_ts_type centraldifference -time_step 1e-4 -time_end 1e-3"


def write_bar(path, widths):
    x, columns = np.concatenate([[0], np.cumsum(widths)]), len(widths)
    nodes = [(a, b) for b in (0, 0.1, 0.2) for a in x]
    cells = [(row + i, row + i + 1, row + i + columns + 2, row + i + columns + 1) for row in (0, columns + 1) for i in range(columns)]
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes))]
    text += [f"{i + 1} {a:.17g} {b:.17g} 0" for i, (a, b) in enumerate(nodes)]
    text += ["$EndNodes", "$Elements", str(len(cells))]
    text += [f"{i + 1} 3 2 1 1 {' '.join(str(node + 1) for node in cell)}" for i, cell in enumerate(cells)]
    path.write_text("\n".join([*text, "$EndElements", ""]))


def thin_column(thin):
    return [0.1] * 4 + [thin, 0.2 - thin] + [0.1] * 4


@pytest.fixture
def bar(tmp_path):
    """The options of a bar with columns of these widths."""

    def make(widths):
        path = tmp_path / "bar.msh"
        write_bar(path, widths)
        return BAR.replace("bar.msh", str(path))

    return make


def elements(run):
    """Step, part of the median and place of the elements that are told of."""
    lines = re.findall(r"^ +element (\d+): (\S+) s, (\S+) of the median, around \((\S+), (\S+), (\S+)\) m$", run.stdout, re.MULTILINE)
    return [[float(word) for word in line[1:]] for line in lines]


def number(run, name):
    return float(re.search(rf"^ +{name} +(?:about )?(\S+)", run.stdout, re.MULTILINE).group(1))


@pytest.mark.parametrize("ranks", [1, 3])
def test_thin_elements(bar, impakt, ranks):
    """Two of 20 elements are 50 times thinner than the others."""
    thin = 0.1 / 50
    run = impakt(f"{bar(thin_column(thin))} -check", ranks)
    told = elements(run)
    assert len(told) == 10
    for k, y in enumerate((0.05, 0.15)):
        assert told[k] == pytest.approx([thin / SPEED, 1 / 50, 0.4 + thin / 2, y, 0], rel=1e-4)
    assert [line[:2] for line in told[2:]] == [pytest.approx([0.1 / SPEED, 1], rel=1e-4)] * 8
    assert re.search(r"warning: element \d+ .* body 'bar', around \(0.401, 0.05, 0\.?\) m, has a stable step of 2e-06 s, 50 times shorter .* 56 to each", run.stderr)
    assert "-bar_ts_type alpha2" in run.stderr
    assert "56 to a controller step, 560 in the run" in run.stdout  # 1e-4 s / (0.9 x 2e-6 s), rounded up, in 10 steps
    assert sorted(path.name for path in run.folder.iterdir()) == ["options", "tests"]


@pytest.mark.parametrize("ranks", [1, 3])
def test_median(bar, impakt, ranks):
    """Of 22 elements, two of each width from 1.1 mm to 99 mm: the sixth width from either end. The ten shortest steps are those of the five thinnest columns."""
    widths = np.geomspace(1.1e-3, 0.099, 11)
    run = impakt(f"{bar(np.random.default_rng(1).permutation(widths))} -check", ranks)
    assert f"median of all elements {widths[5] / SPEED:.4g} s" in run.stdout
    assert [line[0] for line in elements(run)] == pytest.approx(np.repeat(widths[:5], 2) / SPEED, rel=1e-3)
    assert not run.stderr  # 9.5 is not 20


@pytest.mark.parametrize(("thinner", "warns"), [(19, False), (21, True)])
def test_warns_in_runs(bar, impakt, thinner, warns):
    """In any explicit run, which makes the substeps that -check expects."""
    options = bar(thin_column(0.1 / thinner))
    run, check = impakt(options), impakt(f"{options} -check")
    assert ("shorter than the median" in run.stderr) == ("shorter than the median" in check.stderr) == warns
    assert f", {run.summary['bodies']['bar']['substeps']} in the run" in check.stdout
    assert "shorter than the median" not in impakt(f"{options} -bar_ts_type alpha2").stderr


BRICK = (
    "-bodies a,b -contact_pairs a:b -time_step 1e-5 -time_end 2e-3 -b_translate 2.01,0,0 "
    + " ".join(
        f"-{body}_dm_plex_dim 3 -{body}_dm_plex_box_upper 2,1,0.5 -{body}_dm_plex_box_faces 8,4,3 -{body}_density 1000 -{body}_youngs_modulus 1e9 -{body}_initial_velocity {v},2,3"
        for body, v in (("a", 1), ("b", -1))
    )
    + " -b_ts_type centraldifference"
)


@pytest.mark.parametrize("ranks", [1, 2])
def test_inertia_and_fields(impakt, ranks):
    """m (b^2 + c^2) / 12 of a brick; and of all files the fields alone, with the first frame of the run."""
    run, check = (impakt(f"{BRICK} -output_fields f.h5 -output_fields_precision double -checkpoint c.h5 -time_end {end} {more}", ranks) for end, more in ((1e-5, ""), (2e-3, "-check")))
    mass = 1000
    squares = [length**2 for length in (2, 1, 0.5)]
    moments = [f"{name} {mass * (sum(squares) - squares[k]) / 12:.6g}" for k, name in enumerate(("xx", "yy", "zz"))]
    assert check.stdout.count(f"moments of inertia   {', '.join(moments)}, xy 0, yz 0, xz 0 kg m^2") == 2
    assert re.search(r"^  mass +1000 kg, centre \(3.01, 0.5, 0.25\) m$", check.stdout, re.MULTILINE)
    assert "smallest distance: a:b 0.01 m" in check.stdout
    assert "controller steps     200 expected" in check.stdout
    assert sorted(path.name for path in check.folder.iterdir()) == ["f.h5", "f.xdmf", "options", "tests"]
    with h5py.File(run.folder / "f.h5") as whole, h5py.File(check.folder / "f.h5") as first:
        assert first["time"][()] == [0]
        for name in ("mesh/positions", "mesh/cells", "displacement/0000", "velocity/0000", "stress/0000"):
            assert np.array_equal(first[name], whole[name]), name
        assert sum("displacement/" in name for name in (f"displacement/{key}" for key in first["displacement"])) == 1


@pytest.mark.parametrize("ranks", [1, 2])
def test_fields_of_a_run_stay(launch, tmp_path, ranks):
    """-check beside a run that is done leaves its fields, and says so; its own are written again."""
    words = f"{BRICK} -output_fields f.h5 -time_end 2e-5".split()
    assert "warning: -check" not in launch([IMPAKT, *words, "-check"], ranks, cwd=tmp_path).stderr
    assert "warning: -check" not in launch([IMPAKT, *words, "-check"], ranks, cwd=tmp_path).stderr
    launch([IMPAKT, *words], ranks, cwd=tmp_path)
    before = [(tmp_path / name).read_bytes() for name in ("f.h5", "f.xdmf")]
    check = launch([IMPAKT, *words, "-check"], ranks, cwd=tmp_path)
    assert check.returncode == 0
    assert check.stderr.count("warning: -check leaves f.h5 as it is") == 1
    assert "f.xdmf" not in check.stdout
    assert [(tmp_path / name).read_bytes() for name in ("f.h5", "f.xdmf")] == before
    assert "f.xdmf" in launch([IMPAKT, *words], ranks, cwd=tmp_path).stdout


def test_wall_time(impakt):
    """Two bricks at rest for 200 steps, the second explicit: the estimate is that of the run within what other processes of the machine do
    to both, a factor of 20."""
    run, check = (impakt(f"{BRICK} -a_initial_velocity 0,0,0 -b_initial_velocity 0,0,0 {more}") for more in ("", "-check"))
    assert 1 / 20 < number(check, "wall time") / float(re.search(r"^time loop +(\S+) s wall", run.stdout, re.MULTILINE).group(1)) < 20


def test_errors_and_restarts(impakt, tmp_path):
    """Errors of the set-up are those of a run; a checkpoint is not gone on from; an options file may follow."""
    assert "overlap by" in impakt(f"{BRICK} -b_translate 1.9,0,0 -check", expect_failure=True).stderr
    assert "-check looks at the start of the run" in impakt(f"{BRICK} -check -restart c.h5").stderr
    (tmp_path / "case.opts").write_text(re.sub(r" (?=-[a-z])", "\n", BRICK))
    assert "check of body b" in impakt(f"-check {tmp_path / 'case.opts'}").stdout
