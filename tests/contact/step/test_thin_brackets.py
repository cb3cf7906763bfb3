"""An L of sheet that falls flat, on its edge, on its corner, on a plane and on a body, with friction. Its contact nodes keep their mass (`-contact_type force`)."""

import h5py
import numpy as np
import pytest
from cases import joined, long
from contactstep import energy, kept_error
from setups import box, plane
from thinbodies import bracket, drop, in_tetrahedra, model

STEP = {"E": 1e-6, "I": 2e-6}
FIELDS = "-output_fields fields.h5 -output_fields_precision double -output_fields_interval 1"
GAIN = 1e-3  # of explicit bodies, by their staggered energy


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    """One element thick, of 506 cubes, and two, of 4140."""
    return {edge: bracket(tmp_path_factory.mktemp("bracket") / "b.msh", edge) for edge in (1e-3, 2e-3)}


def heights(run, nodes):
    """Of the nodes above the plane z = 0, and how fast the fastest goes down, per frame: on the deformed mesh."""
    with h5py.File(run.folder / "fields.h5") as file:
        start = file["mesh/positions"][:nodes]
        frames = sorted(file["displacement"])
        height = np.array([(start + file[f"displacement/{frame}"][:nodes])[:, 2].min() for frame in frames])
        speed = np.array([-file[f"velocity/{frame}"][:nodes][:, 2].min() for frame in frames])
    return height, speed


def impulse_error(run, pair):
    """Change of the bracket's momentum less the impulse of contact, by its momentum at the start."""
    momentum, of_contact = run.history["body/bracket/momentum"][()], run.history[f"contact/{pair}/impulse"][()]
    return min(np.abs(momentum - momentum[0] - sign * of_contact).max() for sign in (1, -1)) / np.abs(momentum[0]).max()


FALLS = [("E", "linear_elastic", "flat"), ("E", "neo_hookean", "corner")]
MORE = [*((kind, of, fall) for kind, models in (("E", ("linear_elastic", "neo_hookean", "j2")), ("I", ("neo_hookean",))) for of in models for fall in ("flat", "edge", "corner")), ("I", "j2", "edge")]


@pytest.mark.parametrize(("kind", "of", "fall"), [*FALLS, *long(*(case for case in MORE if case not in FALLS))])
def test_falls_on_plane(kind, of, fall, meshes, impakt):
    """On a plane, one element thick: energy, with what friction and flow take, is never above its start, momentum is what contact gives, and no node comes deeper than the way that
    the fastest makes in a step. Flat, contact takes half of what the leg below has, its sheet being one element, 0.26 of
    all, else less than 2 %."""
    run = impakt(joined(drop(meshes[2e-3], kind, of, fall, step=STEP[kind], end=1e-4), FIELDS))
    change, scale = energy(run), run.history["energy/scale"][()].max()
    assert change.max() <= (GAIN if kind == "E" else 1e-6)
    assert impulse_error(run, "bracket:t") <= 1e-12
    height, speed = heights(run, None)
    assert -height.min() <= STEP[kind] * speed.max()
    loss = run.summary["contact"]["contact_loss"] / scale
    leg = 12 / 23  # of the mass
    if kind == "I":  # a constant force takes with it what waves reach in the step, 12 mm: measured 0.61, 0.10, 0.002
        assert 0 < loss < (0.8 if fall == "flat" else 0.2)
    else:
        assert loss == pytest.approx(leg / 2, rel=0.1) if fall == "flat" else 0 < loss < 0.02
    assert np.diff(run.history["contact_loss"][()]).min() >= -1e-7 * scale


@pytest.mark.parametrize(("kind", "of", "fall"), [("E", "neo_hookean", "edge"), *long(*(("E", "neo_hookean", fall) for fall in ("flat", "corner")), ("I", "neo_hookean", "corner"))])
def test_falls_on_block(kind, of, fall, meshes, impakt):
    """On a free block of 60 mm x 60 mm x 20 mm: nothing of all momenta is lost, and contact brings no energy."""
    run = impakt(drop(meshes[2e-3], kind, of, fall, step=STEP[kind], end=6e-5, partner="block"))
    assert run.summary["contact"]["steps_in_contact"] > 5
    assert energy(run).max() <= (GAIN if kind == "E" else 1e-6)
    assert kept_error(run, "momentum", ("bracket", "block")) <= 1e-12
    assert run.summary["contact"]["max_penetration"] <= 1.5 * STEP[kind] * 5


def test_two_elements_lose_half(meshes, impakt):
    """Of a leg two elements thick a quarter of the mass hits, of one of one element half of it: 24 of 46 columns, 0.130 of all."""
    run = impakt(drop(meshes[1e-3], "E", "linear_elastic", "flat", step=1e-6, end=2e-5))
    assert run.summary["contact"]["contact_loss"] / run.history["energy/scale"][0] == pytest.approx(24 / 92 / 2, rel=0.1)


@pytest.mark.parametrize(("of", "fall", "formulation"), [("neo_hookean", "flat", "composite"), *long(("neo_hookean", "corner", "composite"), ("j2", "edge", "composite"), ("neo_hookean", "edge", "full"))])
def test_tetrahedra(of, fall, formulation, meshes, impakt, tmp_path):
    """tet10 has two layers of nodes in a sheet, of which a quarter of the mass hits when it falls flat; tet4 locks, and keeps the energy."""
    mesh = in_tetrahedra(meshes[2e-3], tmp_path / "tets.msh")
    run = impakt(drop(mesh, "E", of, fall, step=STEP["E"], end=3e-5, formulation=formulation))
    assert energy(run).max() <= GAIN
    assert impulse_error(run, "bracket:t") <= 1e-12
    assert run.summary["contact"]["max_penetration"] <= 1.5 * STEP["E"] * 5
    loss = run.summary["contact"]["contact_loss"] / run.history["energy/scale"][0]
    assert loss == pytest.approx(12 / 23 / 4, rel=0.1) if fall == "flat" else 0 < loss < 0.02


@pytest.mark.parametrize(
    ("of", "body", "thin"),
    [
        ("j2", "bracket", True),
        ("neo_hookean", (12, 12, 2), True),
        ("linear_elastic", (12, 12, 2), False),  # its sweeps are products with a compliance, and cost little
        ("neo_hookean", (12, 12, 3), False),  # inner nodes lie in two planes, and span
        ("neo_hookean", (3, 3, 3), False),
        ("neo_hookean", (8, 8, 8), False),
    ],
)
def test_set_of_implicit_bodies(of, body, thin, meshes, impakt, tmp_path):
    """An implicit nonlinear body that is thin nearly everywhere keeps its mass, though inner nodes span it around the face that may touch the plane. One step, in flight."""
    if body == "bracket":
        options = drop(in_tetrahedra(meshes[2e-3], tmp_path / "tets.msh"), "I", of, gap=1e-3, step=1e-6, end=1e-6, formulation="composite")
    else:
        options = joined(
            f"-bodies bracket -obstacles t {plane('t', (0, 0, 0), (0, 0, 1))} -contact_pairs bracket:t -time_step 1e-6 -time_end 1e-6",
            box("bracket", body, (0, 0, 1e-3), tuple(1e-3 * n for n in (*body[:2], body[2] + 1))),
            model("bracket", of, "I", formulation="mean_dilatation"),
            "-bracket_initial_velocity 0,0,-5",
        )
    run = impakt(joined(options, "-contact_view -bracket_body_view"))
    assert ("\n  body 'bracket' is thin: " in run.stdout) == thin
    assert ("contact layer massless" in run.stdout) != thin


@pytest.mark.long
@pytest.mark.parametrize("of", ["neo_hookean", "j2"])
def test_implicit_tetrahedra(of, meshes, impakt, tmp_path):
    """Flat, two steps, in each of which the passes are few: a neo-Hookean step took 43 s of a core with massless nodes, and takes 13 s; with J2 it takes 23 s. Waves cross
    the leg several times in a step, so that all of it stops: 12/23 of the energy, measured 0.58 with what the bent leg has not given back."""
    mesh = in_tetrahedra(meshes[2e-3], tmp_path / "tets.msh")
    run = impakt(drop(mesh, "I", of, step=STEP["I"], end=2 * STEP["I"], formulation="composite"))
    assert run.summary["schwarz"]["max"] <= 5
    assert energy(run).max() <= 1e-6
    assert impulse_error(run, "bracket:t") <= 1e-12
    assert run.summary["contact"]["contact_loss"] / run.history["energy/scale"][0] == pytest.approx(0.58, abs=0.03)
