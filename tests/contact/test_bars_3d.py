"""A bar of hexahedra, implicit, against one of tetrahedra of another size, explicit with a step of its own (options/bars-3d.opts); two explicit bars of hexahedra
with many contact nodes (options/bars-hex.opts, coarser)."""

import csv

import numpy as np
import pytest
from cases import long, never_tensile, same, worst_energy_error

BARS = "-options_file options/bars-3d.opts"
# as the options file has it; explicit with four substeps; other pairings
CASES = {"step of its own": "", "substeps": "-right_ts_time_step 2.5e-7", "both explicit": "-left_ts_type centraldifference -left_ts_time_step auto", "both implicit": "-right_ts_type alpha2"}
STEADY = (1e-4, 3.5e-4)  # from the passage of the first waves to before the release [s]


@pytest.mark.parametrize("case", ["step of its own", "both explicit", *long("substeps", "both implicit")])
def test_impact(case, shared_run):
    """No chatter: one onset, no tension, and a force that changes from step to step as waves of the mesh make it, by less than 1 %."""
    run = shared_run(f"{BARS} {CASES[case]}")
    assert run.summary["contact"]["onsets"] == 1
    (pair,) = run.history["contact"]  # named by the sides that were chosen
    assert never_tensile(run, pair)
    assert worst_energy_error(run.summary) <= (4e-5 if case == "substeps" else 1.5e-5)  # measured: 3.1e-5, else 1e-5
    assert run.summary["system"]["momentum_error_max"] <= 1e-12  # measured: 4e-14
    assert run.summary["schwarz"]["mean_contact_steps"] <= 2.5  # measured: 2.0
    time, force = run.history["time"][()], run.history[f"contact/{pair}/force"][()]
    force = force[(time >= STEADY[0]) & (time <= STEADY[1])]
    assert np.abs(np.diff(force)).mean() <= 0.01 * force.mean()  # measured: 8.5e-3, 6.2e-3 with 10 x 10 x 100 elements
    # a plane wave of bars: rho c v A, with the bars' speed of waves; lateral inertia moves it about that by a few per cent
    assert force.mean() == pytest.approx(1000 * (1e9 / 1000) ** 0.5 * 100 * 0.025**2, rel=0.006)  # measured: 0.5 %


@pytest.mark.long
def test_ranks(shared_run):
    runs = (shared_run(f"{BARS} {CASES['substeps']} -time_end 1e-4", n) for n in (1, 3))
    same(*runs, 1e-10, ("left", "right"), ["left:right"])  # measured: 4e-14


def test_implicit_bodies_take_one_solution_a_step(impakt, tmp_path):
    """What a change of the forces of rows brings about is added up from columns that are kept, once as many solutions have been spent on it: two passes take one solution of each body."""
    solutions = []
    for end in (2e-4, 3e-4):
        log = tmp_path / f"{end}.csv"
        impakt(f"{BARS} -right_ts_type alpha2 -time_end {end} -log_view :{log}:ascii_csv")
        with log.open(encoding="utf-8") as file:
            sign = {"MatSolve": 1, "KSPSolve": -1}  # the law is solved by a KSP, bodies by their factors
            solutions.append(sum(int(row["Count"]) * sign.get(row["Event Name"], 0) for row in csv.DictReader(file)))
    assert solutions[1] - solutions[0] == 2 * 100


def test_elements_are_asked_once_a_step(impakt, tmp_path):
    """The forces of the elements of explicit bodies are computed once in a step, linear or not, whatever contact takes. Slow bars, which are as good as linear."""
    steps, forces = 20, []
    case = "-left_dm_plex_box_faces 12,20,20 -right_dm_plex_box_faces 10,17,17 -time_step 1.8e-6 -time_end 3.6e-5 -left_initial_velocity 0.1,0,0 -right_initial_velocity -0.1,0,0"
    for kind in ("linear_elastic", "neo_hookean"):
        log = tmp_path / f"{kind}.csv"
        run = impakt(f"-options_file options/bars-hex.opts {case} -left_material_type {kind} -right_material_type {kind} -log_view :{log}:ascii_csv")
        with log.open(encoding="utf-8") as file:
            assert sum(int(row["Count"]) for row in csv.DictReader(file) if row["Event Name"] == "BodyForce") == 2 * (steps + 1)  # and one for the start
        assert never_tensile(run, "left.xmax:right.xmin")
        if kind == "linear_elastic":
            assert abs(run.summary["system"]["energy_error_max"]) <= 1e-12  # measured: 2e-13
        forces.append(run.history["contact/left.xmax:right.xmin/force"][()])
    np.testing.assert_allclose(forces[1], forces[0], rtol=0, atol=2e-4 * forces[0].max())  # strains are 1e-4; measured: 6e-5
