"""Fields of a run, read by libraries of others: pyvista (vtk, which ParaView is made of) and meshio. Pictures of them."""

import itertools
import os
import random
import re
import shutil
import sys
import time

import h5py
import meshio
import numpy as np
import pytest
import pyvista
import render
from cases import LUMPED, long
from conftest import IMPAKT, ROOT, start
from held import held
from pace import paced, paced_steps
from PIL import Image

# With lumped mass, left where it is, a bar's mean velocity is the mean over its elements of the mean of their two nodes
BARS = f"{LUMPED} -left_mass_redistribute false -right_mass_redistribute false -exact none"
ELEMENTS, DENSITY, MODULUS = 200, 1000, 1e9

# Two solids, apart, deformed uniformly from the start; all strains and stresses differ: exx 1, eyy -2, ezz 3, exy 2, eyz -1, exz 4 e-5
YOUNG, POISSON = 2e11, 0.3
SOLID = "dm_plex_dim 3,density 7800,youngs_modulus 2e11,poissons_ratio 0.3,initial_displacement '1e-5*x+4e-5*y+8e-5*z,-2e-5*y-2e-5*z,3e-5*z',initial_velocity '1,2,3'"
SHAPES = {
    "hex": "dm_plex_simplex 0,dm_plex_box_faces '3,2,2',dm_plex_box_lower '0,0,0',dm_plex_box_upper '3,1,1'",
    "tet": "dm_plex_simplex 1,dm_plex_box_faces '1,2,2',dm_plex_box_lower '4,0,0',dm_plex_box_upper '5,1,1'",
}
STRAIN = 1e-5 * np.array([[1, 2, 4], [2, -2, -1], [4, -1, 3]])
STRESS = YOUNG / (1 + POISSON) * (STRAIN + POISSON / (1 - 2 * POISSON) * np.trace(STRAIN) * np.eye(3))
DEVIATOR = STRESS - np.trace(STRESS) / 3 * np.eye(3)
VON_MISES = np.sqrt(1.5 * (DEVIATOR**2).sum())

SINGLE = 2.0**-24  # largest relative error of rounding to single precision


def words(name, options):
    """'a 1,b "2,3"' as options of a body."""
    return " ".join(f"-{name}_{each}" for each in re.split(r",(?=[a-z])", options))


def solids(*names):
    return f"-bodies {','.join(names)} {' '.join(words(name, SOLID) + ' ' + words(name, SHAPES[name]) for name in names)} -time_step 1e-7 -time_end 3e-7"


def read_vtk(path):
    """Times, and for each its grid."""
    reader = pyvista.get_reader(path)
    grids = []
    for t in reader.time_values:
        reader.set_active_time_value(t)
        grids.append(reader.read())
    return np.array(reader.time_values), grids


def read_meshio(path):
    """Times, points, blocks of cells, and for each time the numbers on points and on cells."""
    with meshio.xdmf.TimeSeriesReader(path) as reader:
        points, cells = reader.read_points_cells()
        frames = [reader.read_data(k) for k in range(reader.num_steps)]
    times, on_points, on_cells = zip(*frames)
    return np.array(times), points, cells, on_points, [{name: np.concatenate(blocks) for name, blocks in each.items()} for each in on_cells]


CONTACT = {"contact_force": "N", "contact_pressure": "Pa", "contact_gap": "m", "contact_active": "1"}


def same(path, contact=True):
    """Both libraries read the same, not-a-numbers too; what vtk has read."""
    times, grids = read_vtk(path)
    times_of_meshio, points, cells, on_points, on_cells = read_meshio(path)
    np.testing.assert_array_equal(times, times_of_meshio)
    for grid, point_data, cell_data in zip(grids, on_points, on_cells):
        assert set(grid.point_data) == set(point_data) == {"displacement", "velocity", *(CONTACT if contact else ())}
        assert set(grid.cell_data) == set(cell_data) == {"stress", "von_mises", "body", "rank"}
        np.testing.assert_array_equal(grid.points, points)
        for name, values in {**point_data, **cell_data}.items():
            np.testing.assert_array_equal(grid[name], values)
    assert grids[0].n_cells == sum(len(block.data) for block in cells)
    return times, grids


@pytest.mark.parametrize(("ranks", "precision", "step", "interval"), [(1, "single", 1e-7, 102), (2, "double", 1e-6, 11), *long((3, "single", 1e-6, 11))])
def test_bars(ranks, precision, step, interval, impakt):
    run = impakt(f"{BARS} -time_step {step} -output_fields fields.h5 -output_fields_precision {precision}", ranks=ranks)
    assert re.search(r"^ *fields +fields.xdmf$", run.stdout, re.MULTILINE)
    times, grids = same(run.folder / "fields.xdmf")
    # of 10000 steps every 102nd, of 1000 every 11th, the least interval with at most 100 frames; and the last
    last = round(1e-3 / step)
    steps = np.append(np.arange(0, last, interval), last)
    assert len(times) == len(steps) <= 100 < last / (interval - 1) + 1
    np.testing.assert_array_equal(times, run.history["time"][()][steps])
    rounding = SINGLE if precision == "single" else 1e-14  # the history sums in another order
    for grid, at in zip(grids, steps, strict=True):
        assert grid["displacement"].dtype == grid["stress"].dtype == (np.float32 if precision == "single" else np.float64)
        assert set(grid["rank"]) == set(range(ranks))
        ends = grid.cells.reshape(-1, 3)[:, 1:]
        x = grid.points[:, 0] + grid["displacement"][:, 0]
        for number, name in enumerate(("left", "right")):
            mine = grid["body"] == number
            assert mine.sum() == ELEMENTS
            mean = grid["velocity"][:, 0][ends[mine]].astype(float).mean()
            np.testing.assert_allclose(mean, run.history[f"body/{name}/mean_velocity"][at].item(), rtol=0, atol=200 * rounding)  # |v| < 200 m/s
            tip = (x[ends[mine]].max, x[ends[mine]].min)[number]()
            np.testing.assert_allclose(tip, run.history[f"body/{name}/contact_position"][at].item(), rtol=0, atol=0.5 * rounding)  # bars of 0.25 m, 0.02 m apart
        if precision == "double":
            strain = np.diff(grid["displacement"][:, 0][ends])[:, 0] / np.diff(grid.points[:, 0][ends])[:, 0]
            # differences of displacements up to 0.1 m over 1.25e-3 m: 1e-14 relative to 1
            np.testing.assert_allclose(grid["stress"][:, 0], MODULUS * strain, rtol=0, atol=MODULUS * 1e-13)
            np.testing.assert_array_equal(grid["von_mises"], np.abs(grid["stress"][:, 0]))
        assert not grid["stress"][:, 1:].any()
        assert not grid["displacement"][:, 1:].any()
    if precision == "double":
        middle = grids[np.argmin(np.abs(times - 2.5e-4))]  # waves have run over the bars, and are on their way back
        near = np.abs(middle.cell_centers().points[:, 0]) < 0.05
        # rho c v = 1e8 Pa, with the ripple of lumped mass behind the front
        np.testing.assert_allclose(middle["stress"][near, 0].mean(), -DENSITY * 1000 * 100, rtol=0.02)


@pytest.mark.parametrize(("names", "ranks"), [(("hex",), 1), (("tet",), 2), (("hex", "tet"), 1), *long((("hex", "tet"), 3))], ids=lambda value: "-".join(value) if isinstance(value, tuple) else None)
def test_solids(names, ranks, impakt):
    """Stress of a uniform deformation, component by component; several shapes in one file."""
    start = "-contact_balanced_start false" if len(names) > 1 else ""  # contact nodes where they are put, not where they are in balance
    run = impakt(f"{solids(*names)} {start} -output_fields fields.h5 -output_fields_precision double -output_fields_interval 1", ranks=ranks)
    times, grids = same(run.folder / "fields.xdmf", contact=len(names) > 1)
    np.testing.assert_allclose(times, [0, 1e-7, 2e-7, 3e-7], rtol=0, atol=1e-20)
    first = grids[0]
    kinds = {"hex": pyvista.CellType.HEXAHEDRON, "tet": pyvista.CellType.TETRA}
    for number, name in enumerate(names):
        assert set(first.celltypes[first["body"] == number]) == {kinds[name]}
    sizes = first.compute_cell_sizes()["Volume"]
    assert sizes.min() > 0  # nodes are in the order of vtk
    for number, name in enumerate(names):
        np.testing.assert_allclose(sizes[first["body"] == number].sum(), {"hex": 3, "tet": 1}[name], rtol=1e-12)
    x, y, z = first.points.T
    exact = np.column_stack((1e-5 * x + 4e-5 * y + 8e-5 * z, -2e-5 * y - 2e-5 * z, 3e-5 * z))
    np.testing.assert_allclose(first["displacement"], exact, rtol=0, atol=1e-18)
    np.testing.assert_array_equal(first["velocity"], np.tile((1.0, 2.0, 3.0), (first.n_points, 1)))
    # round-off of strains 1e-5 from displacements 5e-4, times E
    np.testing.assert_allclose(first["stress"], np.tile(STRESS.ravel(), (first.n_cells, 1)), rtol=0, atol=YOUNG * 1e-17)
    np.testing.assert_allclose(first["von_mises"], VON_MISES, rtol=1e-10)
    # 3e-7 s later the middle has moved with 1, 2, 3 m/s: no wave has got there, at 6000 m/s in 2 mm
    if names == ("hex",):
        drift = (grids[-1]["displacement"] - first["displacement"]).mean(axis=0)
        np.testing.assert_allclose(drift, 3e-7 * np.array((1, 2, 3)), rtol=1e-9)  # momentum is conserved; on this mesh all nodes' mean weighs nearly as mass does


def test_units_and_options(impakt):
    run = impakt(f"{BARS} -time_end -1.99e-4 -output_fields fields.h5 -output_fields_interval 5")
    with h5py.File(run.folder / "fields.h5", "r") as file:
        assert {**dict(file.attrs), "-output_history": 0, "-output_summary": 0} == {**dict(run.history.attrs), "-output_history": 0, "-output_summary": 0}
        wanted = {"displacement": "m", "velocity": "m/s", "stress": "Pa", "von_mises": "Pa", **CONTACT}
        assert file.keys() == {*wanted, "mesh", "time"}
        for name, units in wanted.items():
            assert list(file[name]) == ["0000", "0001", "0002"]
            assert {data.attrs["units"].decode() for data in file[name].values()} == {units}
        assert file["mesh/positions"].attrs["units"] == b"m"
        assert file["time"].attrs["units"] == b"s"
        assert file["mesh/body"].attrs["names"] == "left,right"
        np.testing.assert_array_equal(file["time"][()], run.history["time"][()][[0, 5, 10]])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("-output_fields fields.h5 -output_fields_interval 1", r"-output_fields_interval 1 makes 10001 frames .* 10000 is the limit; give 2 or more"),
        ("-output_fields fields.h5 -output_fields_interval -3", r"-output_fields_interval -3 must be"),
        ("-output_fields fields.h5 -output_fields_precision half", r"half.*-output_fields_precision"),
        ("-output_fields /proc/fields.h5", r"-output_fields /proc/fields.h5 cannot be written"),
        ("-output_fields options", r"-output_fields options cannot be written"),
        ("-output_fields fields.xdmf", r"give the path of the HDF5 file"),
        ("-output_fields summary.h5 -output_summary summary.xdmf", r"are the same file, summary.xdmf; give each its own"),
        ("-output_fields h.h5 -output_history h.h5", r"-output_history and -output_fields are the same file, h.h5; give each its own"),
        ("-output_fields_interval 3", r"-output_fields_interval"),
    ],
    ids=["many", "negative", "precision", "folder", "not-a-file", "xdmf", "summary", "history", "without"],
)
@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_refused(options, message, ranks, launch, tmp_path):
    (tmp_path / "options").symlink_to(ROOT / "options")
    run = launch([IMPAKT, *BARS.split(), *options.split()], ranks, cwd=tmp_path)
    assert run.returncode > 0
    assert re.search(message, run.stderr), run.stderr
    assert not list(tmp_path.glob("*fields*"))


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_disk_too_small(ranks, launch, tmp_path):
    """Refused before anything is computed: 9999 frames with 22 numbers of 8 bytes for each element, twice what there is room for."""
    frame_of_one = 9999 * 22 * 8  # bytes
    elements = 2 * shutil.disk_usage("/dev/shm").free // frame_of_one if os.path.isdir("/dev/shm") else 0
    if not 1000 < elements < 300000:
        pytest.skip("no small file system to be found")
    (tmp_path / "options").symlink_to(ROOT / "options")
    folder = f"/dev/shm/impakt-{os.getpid()}-{ranks}"
    options = f"-output_fields {folder}/fields.h5 -output_fields_interval 1 -output_fields_precision double -left_dm_plex_box_faces {elements - ELEMENTS} -time_end 7.998e-4"
    try:
        run = launch([IMPAKT, *BARS.split(), *options.split()], ranks, cwd=tmp_path)
        assert run.returncode > 0
        told = re.search(r"will have 9999 frames, (\S+) GB in all, and there is room for .* GB; write fewer of them with -output_fields_interval", run.stderr)
        assert told, run.stderr
        assert float(told[1]) == pytest.approx(1e-9 * frame_of_one * elements, rel=0.01)  # three digits are printed; and the mesh
        assert os.listdir(folder) == []
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def test_error_in_the_run(launch, tmp_path):
    """What was written until then can be read."""
    (tmp_path / "options").symlink_to(ROOT / "options")
    stops = "-schwarz_snes_max_it 0"
    for ranks in (1, 2):
        run = launch([IMPAKT, *f"{BARS} {stops} -output_fields fields{ranks}.h5".split()], ranks, cwd=tmp_path)
        assert run.returncode > 0
        assert "were not found in 1 passes" in run.stderr
        times, grids = read_vtk(tmp_path / f"fields{ranks}.xdmf")
        # contact begins at 0, step 2000; the last of the frames, at every 102nd step, before it is the 20th
        assert len(times) == 20
        np.testing.assert_allclose(times[-1], -2e-4 + 19 * 102e-7, rtol=0, atol=1e-15)
        assert grids[-1]["velocity"][0, 0] == pytest.approx(100)


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_kill(ranks, tmp_path):
    """Killed at any moment: the frames that are listed are there, others have no time."""
    interval = paced_steps(10)
    (tmp_path / "options").symlink_to(ROOT / "options")
    path, xdmf = tmp_path / "fields.h5", tmp_path / "fields.xdmf"
    command = [IMPAKT, *f"{BARS} {paced(1e-7)} -output_fields fields.h5 -output_fields_interval {interval}".split()]
    with held(command, tmp_path, ranks) as run:
        run.until(interval + 1)
        while xdmf.read_text().count("<Time") < 10:
            run.print_lines(run.lines + 1)
        listed_on_the_way = len(read_vtk(xdmf)[0])
        run.read(1 << 16)  # it goes on, by some frames
        time.sleep(random.Random(ranks).uniform(0, 0.005))
        run.kill()
    times, grids = same(xdmf)
    assert len(times) >= listed_on_the_way >= 10
    with h5py.File(path, "r") as file:
        complete = np.isfinite(file["time"][()])
        assert len(complete) == 1001  # every tenth of 10000, and the first
        assert complete[: len(times)].all()
        assert not complete.all()
        np.testing.assert_allclose(file["time"][()][complete], -2e-4 + 1e-6 * np.arange(complete.sum()), rtol=0, atol=1e-15)
    for grid in grids:
        assert np.isfinite(grid["stress"]).all()
    for t, grid in zip(times, grids):
        if t < -1e-5:
            np.testing.assert_allclose(np.abs(grid["displacement"][:, 0]), 100 * (t + 2e-4), rtol=1e-6, atol=1e-12)  # free flight


RENDER = [sys.executable, ROOT / "plots/render.py"]
ENVIRONMENT = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
BACKGROUND = 255


def coloured(picture):
    """The share of pixels that are neither background nor grey: bodies and the colour bar."""
    pixels = np.asarray(picture.convert("RGB")).astype(int)
    return (np.ptp(pixels, axis=2) > 30).mean()


@pytest.fixture(scope="module")
def pictured(tmp_path_factory):
    """The files of a run of bars and of one of solids."""
    folder = tmp_path_factory.mktemp("pictured")
    (folder / "options").symlink_to(ROOT / "options")
    for name, options in {"bars": f"{BARS} -output_fields_interval 2000", "solids": solids("hex", "tet")}.items():
        command = options.replace("'", "").split()
        run = start([IMPAKT, *command, "-output_fields", f"{name}.h5"], cwd=folder)
        assert run.returncode == 0, run.stderr
    return folder


# Options, the size of the picture, and how much of it has colours at least: the colour bar alone, 26 by 315 or so of 1000 by 700 pixels, is 0.012
PICTURES = {
    "bars": ("--frame 3", (1000, 700), 0.03),  # seen: 0.038
    "solids": ("--scale 1000", (1000, 700), 0.12),  # of these three the least: 0.143
    "fields": ("--field body --view xz --size 400x300 --title Solids", (400, 300), 0.12),
    "moved": ("--scale 20000 --field stress_xy --frame 0", (1000, 700), 0.12),
}


@pytest.mark.parametrize("name", ["bars", "fields", *long("solids", "moved")])
def test_png(name, pictured, launch, tmp_path):
    options, size, share = PICTURES[name]
    source = pictured / ("bars.xdmf" if name == "bars" else "solids.xdmf")
    run = launch([*RENDER, source, tmp_path / f"new/{name}.png", *options.split()], env=ENVIRONMENT)
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == str(tmp_path / f"new/{name}.png")
    picture = Image.open(tmp_path / f"new/{name}.png")
    assert picture.size == size
    assert picture.getpixel((picture.width - 1, picture.height // 2))[:3] == (BACKGROUND,) * 3
    assert coloured(picture) > share


@pytest.mark.long
def test_contact_fields_drawn(pictured, launch, tmp_path):
    """Pressure comes with contact; the gap is drawn though most nodes have none."""
    pictures = {}
    for name, options in {"before": "--field contact_pressure --step 0", "during": "--field contact_pressure --step 2", "gap": "--field contact_gap --step 2"}.items():
        run = launch([*RENDER, pictured / "bars.xdmf", "--output", tmp_path / f"{name}.png", "--size", "600x400", *options.split()], env=ENVIRONMENT)
        assert run.returncode == 0, run.stderr
        pictures[name] = np.asarray(Image.open(tmp_path / f"{name}.png").convert("RGB")).astype(int)
    middle = slice(100, 250)  # rows with the bars, without time and colour bar
    colours = {name: {tuple(pixel) for pixel in picture[middle].reshape(-1, 3) if np.ptp(pixel) > 30} for name, picture in pictures.items()}
    assert len(colours["before"]) >= 1
    assert len(colours["during"] - colours["before"]) >= 1
    assert (np.ptp(pictures["gap"][middle], axis=2) == 0).mean() > 0.9  # grey and white
    assert ((pictures["gap"][middle] == 0xBB).all(axis=2)).sum() > 1000  # the bars, but for their contact nodes


@pytest.mark.long
def test_cut(pictured, launch, tmp_path):
    """What is before the plane is gone: two thirds of the larger body; the upper half of both."""
    shares = {}
    for name, options in {"whole": "", "near": "--cut x=2", "middle": "--cut z"}.items():
        run = launch([*RENDER, pictured / "solids.xdmf", tmp_path / f"{name}.png", "--field", "body", *options.split()], env=ENVIRONMENT)
        assert run.returncode == 0, run.stderr
        shares[name] = coloured(Image.open(tmp_path / f"{name}.png"))
    bar = 0.026  # of the colours
    assert shares["near"] - bar < 0.8 * (shares["whole"] - bar)
    assert shares["middle"] - bar < 0.9 * (shares["whole"] - bar)
    assert shares["near"] > bar + 0.01


def test_gif(pictured, launch, tmp_path):
    run = launch([*RENDER, pictured / "bars.xdmf", tmp_path / "film.gif", "--field", "velocity_x", "--size", "500x300", "--fps", "5"], env=ENVIRONMENT)
    assert run.returncode == 0, run.stderr
    film = Image.open(tmp_path / "film.gif")
    assert film.n_frames == 6  # steps 0, 2000, ..., 10000
    assert film.size == (500, 300)
    assert film.info["duration"] == 200  # 1000 ms / 5
    pictures = []
    for frame in range(film.n_frames):
        film.seek(frame)
        assert coloured(film) > 0.03
        pictures.append(np.asarray(film.convert("RGB")).astype(int))
    for one, next_one in itertools.pairwise(pictures):
        assert (np.abs(one - next_one).max(axis=2) > 30).mean() > 1e-3  # bars move, and change colour
    # the colour bar and its numbers stay as they are, but for the palettes of 128 colours
    np.testing.assert_array_less(np.abs(pictures[0] - pictures[-1])[260:], 60)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("nowhere.xdmf p.png", "there is no file nowhere.xdmf"),
        ("bars.h5 p.png", "give the .xdmf file"),
        ("text.xdmf p.png", "text.xdmf is not the XDMF file"),
        ("lost.xdmf p.png", "lost.xdmf names cannot be read"),
        ("bars.xdmf p.png --frame 6", "there is no frame 6: there are 6, from 0 to 5"),
        ("bars.xdmf p.png --frame first", "--frame first"),
        ("bars.xdmf p.png --field colour", "there is no field colour; there are .*von_mises"),
        ("bars.xdmf p.jpg", "give the name of a .png, .gif or .mp4"),
        ("bars.xdmf p.png --size 3x4", "--size"),
        ("bars.xdmf", "usage"),
        ("bars.xdmf p.png --output q.png", "give the name of the picture, once"),
        ("bars.xdmf p.png --cut x", "only what has three dimensions can be cut"),
        ("solids.xdmf p.png --cut r", "--cut r: give x, y or z"),
        ("solids.xdmf p.png --cut x=two", "--cut x=two: two is not a number"),
        ("solids.xdmf p.png --cut x=7", "--cut x=7: the bodies lie between x = 0 and 5"),
    ],
)
def test_cannot_be_drawn(arguments, message, pictured, capsys, monkeypatch, tmp_path):
    """The program says why; here within this process."""
    for name in ("bars.h5", "bars.xdmf", "solids.h5", "solids.xdmf"):
        (tmp_path / name).symlink_to(pictured / name)
    (tmp_path / "text.xdmf").write_text("no XML\n")
    (tmp_path / "lost.xdmf").write_text((pictured / "bars.xdmf").read_text().replace("bars.h5", "gone.h5"))
    monkeypatch.chdir(tmp_path)
    try:
        code = render.main(arguments.split())
    except SystemExit as end:
        code = end.code
    assert code > 0
    told = capsys.readouterr().err
    assert re.search(message, told), told
    assert not list(tmp_path.glob("p.*"))


def test_mp4(pictured, launch, tmp_path):
    """With ffmpeg a film, without it a message."""
    run = launch([*RENDER, pictured / "bars.xdmf", tmp_path / "film.mp4", "--size", "301x201"], env=ENVIRONMENT)
    if shutil.which("ffmpeg"):
        assert run.returncode == 0, run.stderr
        assert (tmp_path / "film.mp4").read_bytes()[4:8] == b"ftyp"
    else:
        assert run.returncode > 0
        assert "MP4 needs ffmpeg" in run.stderr
        assert not (tmp_path / "film.mp4").exists()
