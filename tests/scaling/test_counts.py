"""What the counts of runs on several ranks may be: they do not hang on a clock, nor on how many cores there are."""

import subprocess
from types import SimpleNamespace

import pytest
from bench import execute, read_summary
from cases import long, validate
from conftest import BUILD, MPIEXEC
from ranks import (
    MPI,
    all_reductions,
    boxes,
    counts_of,
    exponent,
    memory,
    run,
    run_counting,
)

ARGUMENTS = SimpleNamespace(build=BUILD, mpiexec=MPIEXEC, time_limit=300)


@pytest.fixture(autouse=True)
def environment(monkeypatch, take_cores):
    take_cores(2)
    for name, value in MPI.items():
        monkeypatch.setenv(name, value)


def count(ranks, size=6, integrator="centraldifference"):
    return [counts_of(ARGUMENTS, boxes(size, integrator=integrator), r, (3, 6)) for r in ranks]


def check(rows):
    """All steps were in contact; each takes as many sweeps and reductions whatever the ranks."""
    two = rows[0]
    for row in rows:
        assert row["steps_in_contact"] == 6
        assert row["sweeps"] == two["sweeps"]
        assert row["reductions"] == two["reductions"] > 0
        assert 0 < row["neighbours"] < row["ranks"]


@pytest.mark.long
def test_explicit():
    check(count([2, 4]))


@pytest.mark.validate
def test_explicit_on_many_ranks():
    """What the largest rank has goes down as ranks go up: elements, and faces and rows of contact. Rows are nodes, of which the ranks at an edge have
    some more: 25 x 25 of them on 4 x 4 ranks are 7 x 7 at most, 1.25 times the mean. Each neighbour gets 71 to 84 messages in a step."""
    ranks = [2, 4, 8, 16]
    rows = count(ranks, size=24)
    check(rows)
    assert all(row["work_imbalance"] <= 1.2 and row["messages"] <= 90 * row["neighbours"] for row in rows)
    for name, bound in (("elements", 0.02), ("facets", 0.02), ("rows", 0.15)):
        assert exponent(ranks, [row[name] for row in rows]) == pytest.approx(-1, abs=bound)


RADIUS = 0.01  # m


def discs(n, gap, speed=1, **more):
    """Options of n explicit discs of 48 elements in rows of 4, so far apart, each of which moves toward the middle of all."""
    options = {"bodies": ",".join(f"d{i}" for i in range(n)), "contact_pairs": "auto", "contact_facing": "false", "progress": 0, "time_step": 2e-5}
    for i in range(n):
        row, column = divmod(i, 4)
        options |= {
            f"d{i}_dm_plex_dim": 2,
            f"d{i}_dm_plex_shape": "ball",
            f"d{i}_ball_radius": RADIUS,
            f"d{i}_ball_centre": f"{(2 * RADIUS + gap) * column + 1e-5 * row},{(2 * RADIUS + gap) * row}",
            f"d{i}_ball_divisions": 4,
            f"d{i}_density": 1000,
            f"d{i}_youngs_modulus": 1e6,
            f"d{i}_poissons_ratio": 0.25,
            f"d{i}_ts_type": "centraldifference",
            f"d{i}_initial_velocity": f"{speed * (1.5 - column)},0",
        }
    return options | more


def test_small_bodies_are_whole_on_ranks():
    """Explicit bodies that touch nothing: as many reductions in a step whatever their number, no message, nothing of a body on two ranks, and as much on each. With
    bodies that are divided there were 6 reductions for each body."""
    few, many = (counts_of(ARGUMENTS, discs(n, 5 * RADIUS), 2, (2, 4)) for n in (16, 32))
    assert few["reductions"] == many["reductions"] <= 10
    assert few["messages"] == many["messages"] == 0
    assert many["halo"] == 0
    assert many["elements"] == 16 * 48  # of one rank: half of all bodies


@pytest.mark.parametrize(("material", "most", "more"), [*long(("neo_hookean", 75, 1.3)), *validate(("linear_elastic", 33, 1.05))])
def test_small_bodies_in_contact_on_ranks(material, most, more):
    """Discs that fly at each other in rows of 4, twice as many rows on two ranks: what ranks tell each other goes with the pairs between them, of which there
    are as many, and not with the bodies in contact nor with rows that are built anew. Measured: 30 both times. It was 39 when each body between ranks told its
    roles and inputs by itself, and 129 with 160 discs when each pair told its motion. Of neo-Hookean discs 52 and 55, whose sweeps are 3.9 and 4.2: it was 214
    and 256 when each product of secants, each new column of a compliance and each body between ranks had a word of its own. The contact step, makes 58 and 73, with as many passes as the slowest of the groups takes."""
    few, many = (counts_of(ARGUMENTS, discs(n, 5e-4) | {f"d{i}_material_type": material for i in range(n)}, 2, (20, 40)) for n in (32, 64))
    assert many["steps_in_contact"] > 20
    assert many["reductions"] <= most
    assert many["reductions"] <= more * few["reductions"]


@pytest.mark.long
def test_setup_of_small_bodies_on_ranks():
    """What ranks tell each other for each disc more, from options to the end of a step. Measured: 270, of which 125 are for the
    mass by extrapolated velocities, and 12 tell which elements bound the step. 20 steps of 160 of them took 22159 with mass that moves, and 55793 where each mesh was made
    on the first rank and moved, and each vector and pair asked all ranks."""
    few, many = (all_reductions(ARGUMENTS, discs(n, 5e-4), 2, 1) for n in (16, 32))
    assert 0 < many - few <= 280 * 16


@pytest.mark.parametrize("integrator", [*long("alpha2"), *validate("centraldifference")])
def test_steps_of_bodies_on_their_own_ranks_wait_for_nobody(integrator):
    """Forces are brought before the steps of bodies, and displacements taken after them: no rank waits for the step of a body that another makes."""
    options = boxes(6, integrator=integrator) | {"a_ranks": 0, "b_ranks": 1}
    made, messages, reductions = (
        [b - a for a, b in zip(*(run_counting(ARGUMENTS, options, 2, steps, "BodyIntegrate", column) for steps in (2, 6)))]
        for column in ("Count", "Num Messages", "Num Reductions")
    )
    assert min(made) > 4
    assert messages == reductions == [0, 0]


def two_blocks(**more):
    """Options of two rubber blocks in the plane, one above the other, of which each lies whole on a rank."""
    options = {"bodies": "a,b", "contact_pairs": "a:b", "contact_facing": "false", "progress": 0}
    for name, low, faces in (("a", 0.02, "4,4"), ("b", -0.1, "5,5")):
        options |= {
            f"{name}_dm_plex_box_faces": faces,
            f"{name}_dm_plex_box_lower": f"0,{low}",
            f"{name}_dm_plex_box_upper": f"0.1,{low + 0.1}",
            f"{name}_mesh_division": "whole",
            f"{name}_density": 1000,
            f"{name}_youngs_modulus": 1e6,
            f"{name}_poissons_ratio": 0.25,
            f"{name}_material_type": "neo_hookean",
            f"{name}_ts_type": "centraldifference",
        }
    return options | {"b_boundary_displacement": "ymin"} | more


def check_same_on_ranks(one, other, tolerance):
    """A run on several ranks, on which no body is divided, does what it does on one; relative to the largest energy."""
    scale = max(body["kinetic"] for body in one["bodies"].values())
    assert other["timing"]["ranks"]["halo"]["largest"] == 0
    assert other["contact"]["steps_in_contact"] == one["contact"]["steps_in_contact"]
    for name, body in one["bodies"].items():
        for energy in ("kinetic", "potential"):
            assert other["bodies"][name][energy] == pytest.approx(body[energy], rel=0, abs=tolerance * scale)


def test_whole_bodies_with_prescribed_rows_on_ranks():
    """A rubber block spins onto one whose lower side is led up and down: its rank makes factors of its layer by itself, 37 times in 80 steps, and tells the
    others of them before rows are prescribed, in which all ranks take part. Measured: 5e-15 of the energy."""
    motion = {"a_initial_velocity": "-50*(y-0.07),50*(x-0.05)-2", "b_boundary_displacement_ymin": "0,1e-3*(1-cos(500*t))"}
    one, other = (run(ARGUMENTS, two_blocks(time_step=1e-4, **motion), ranks, 80) for ranks in (1, 3))
    assert one["contact"]["steps_in_contact"] > 20
    check_same_on_ranks(one, other, 1e-10)


@pytest.mark.parametrize("material", ["neo_hookean", *long("linear_elastic")])
def test_small_bodies_do_the_same_on_ranks(material):
    """Discs that meet, on one rank and three: round-off of the contact forces between ranks; measured: 4e-14."""
    options = discs(12, 5e-4) | {f"d{i}_material_type": material for i in range(12)}  # whose corners lie 0.09 mm outside their radius
    one, other = (run(ARGUMENTS, options, ranks, 40) for ranks in (1, 3))
    assert one["contact"]["steps_in_contact"] > 5
    check_same_on_ranks(one, other, 1e-12)


def test_failure_on_one_rank_is_told_once():
    """A body that is torn apart: the same message and the same exit code on one rank and on two, of which one alone has the body."""
    options = discs(12, 5 * RADIUS) | {f"d{i}_material_type": "neo_hookean" for i in range(12)} | {"d9_initial_velocity": "1000*sin(900*x),0", "time_end": 1e-3}
    found = []
    for ranks in (1, 2):
        words = [word for name, value in options.items() for word in (f"-{name}", str(value))]
        done = subprocess.run([*MPIEXEC, "-n", str(ranks), BUILD / "impakt", *words], timeout=300, capture_output=True, text=True, check=False)
        lines = [line for line in done.stderr.splitlines() if line.startswith("impakt: error:")]
        found.append((done.returncode, lines))
    assert found[0] == found[1]
    assert found[0][0] != 0
    assert len(found[0][1]) == 1
    assert "'d9'" in found[0][1][0]


@pytest.mark.long
def test_contact_on_a_corner():
    """A small box on one corner of a large one: with cuts across the longest edges alone the rank with most facets has 1.9 times the mean."""
    before, after = (
        run(ARGUMENTS, boxes(12, corner=True), 4, 3, more)["timing"]["ranks"]["facets"] for more in (("-a_mesh_contact_cost", "0", "-b_mesh_contact_cost", "0"), ())
    )
    assert before["largest"] >= 1.8 * before["mean"]
    assert after["largest"] == after["mean"]


@pytest.mark.validate
def test_memory_goes_with_ranks():
    """Of 3.5e5 elements, what a rank has beyond what a process needs by itself, less its halo; measured: an exponent of -0.93. Small factors of layers, up to
    5000 unknowns, lie on all ranks: boxes of a quarter of the elements have -0.7."""
    arguments, found = SimpleNamespace(**vars(ARGUMENTS), ranks=8, size=24), {}
    memory(arguments, found, [])
    assert found["memory"]["exponent"] == pytest.approx(-1, abs=0.1)


def write_cube(path, n):
    """A cube of n x n x n hexahedra, as Gmsh writes it."""
    m = n + 1
    nodes = [f"{1 + i + m * (j + m * k)} {i} {j} {k}" for k in range(m) for j in range(m) for i in range(m)]
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [" ".join(str(1 + i + a + m * (j + b + m * (k + c))) for a, b, c in corners) for k in range(n) for j in range(n) for i in range(n)]
    elements = [f"{e} 5 2 0 1 {cell}" for e, cell in enumerate(cells, 1)]
    path.write_text("\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes)), *nodes, "$EndNodes", "$Elements", str(len(elements)), *elements, "$EndElements", ""]))


@pytest.mark.long
def test_mesh_file_is_on_one_rank_alone(tmp_path):
    """Beyond what a process needs by itself, ranks that do not read the file have at most 0.4 of what a run on one rank has: a quarter of the
    elements, and what shares and halos differ by. A copy of the mesh there would add more than a half; measured: 0.28."""
    peaks = {}
    for n, ranks in ((2, 1), (2, 4), (36, 1), (36, 4)):
        mesh, summary = tmp_path / f"{n}.msh", tmp_path / "summary.json"
        write_cube(mesh, n)
        words = f"-bodies b -b_dm_plex_filename {mesh} -b_density 1000 -b_youngs_modulus 1e9 -b_ts_type centraldifference -time_step 1e-5 -time_end 1e-5 -progress 0"
        execute([*MPIEXEC, "-n", str(ranks), BUILD / "impakt", *words.split(), "-output_summary", str(summary)], 300)
        memory = read_summary(summary, mesh.name)["timing"]["ranks"]["peak_memory"]
        others = (memory["mean"] * ranks - memory["largest"]) / max(1, ranks - 1)  # the first rank, which reads, has most
        peaks[n, ranks] = others if ranks > 1 else memory["largest"]
    assert peaks[36, 4] - peaks[2, 4] < 0.4 * (peaks[36, 1] - peaks[2, 1])


def test_exponent():
    assert exponent([1, 2, 4, 8], [7, 3 * 2**0.5, 3 * 4**0.5, 3 * 8**0.5]) == pytest.approx(0.5, abs=1e-14)
    assert exponent([1, 2], [1, 2]) is None
