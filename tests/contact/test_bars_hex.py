"""Two explicit bars of hexahedra with many contact nodes (options/bars-hex.opts, coarser): forces by sparse factors, elements once in a step."""

import csv
from collections import Counter

import numpy as np
import pytest
from cases import long, longest, never_tensile

STEPS = 20
COARSE = "-left_dm_plex_box_faces 12,20,20 -right_dm_plex_box_faces 10,17,17 -time_step 1.8e-6 -time_end 3.6e-5"
BARS = f"-options_file options/bars-hex.opts {COARSE}"
PAIR = "left.xmax:right.xmin"


def events(path):
    """Counts of PETSc's log events on the first rank, in all stages together."""
    counts = Counter()
    with path.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["Rank"] == "0":
                counts[row["Event Name"]] += int(row["Count"])
    return counts


@pytest.mark.parametrize("ranks", [1, 2, *longest(3)])
def test_costs(ranks, impakt, tmp_path):
    """The forces of the elements are computed once in a step and body, whatever the sweeps. The interface is factored once; then a step takes
    one solution of the interface, which finds the balance of both layers with the forces between them, and none of each layer."""
    counts = []
    for steps in (STEPS // 2, STEPS):
        log = tmp_path / f"{steps}.csv"
        run = impakt(f"{BARS} -time_end {1.8e-6 * steps} -log_view :{log}:ascii_csv", ranks)
        assert run.summary["schwarz"]["mean_contact_steps"] == 2
        counts.append(events(log))
        assert counts[-1]["BodyForce"] == 2 * (steps + 1)  # and one for the start
        assert counts[-1]["ContactFactor"] == 1
    assert counts[1]["MatSolve"] - counts[0]["MatSolve"] == STEPS // 2
    assert counts[1]["BodyCompliance"] == counts[0]["BodyCompliance"]  # products of conjugate gradients, until there are factors


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_nonlinear(ranks, impakt, tmp_path):
    """A nonlinear layer moves in every sweep, and its body's elements are asked once. Slow bars, which are as good as linear."""
    words = "-left_initial_velocity 0.1,0,0 -right_initial_velocity -0.1,0,0"
    log = tmp_path / "log.csv"
    linear = impakt(f"{BARS} {words}", ranks)
    run = impakt(f"{BARS} {words} -left_material_type neo_hookean -right_material_type neo_hookean -log_view :{log}:ascii_csv", ranks)
    counts = events(log)
    assert counts["BodyForce"] == 2 * (STEPS + 1)
    assert run.summary["schwarz"]["mean_contact_steps"] <= 4  # measured: 3
    force, other = (made.history[f"contact/{PAIR}/force"][()] for made in (run, linear))
    np.testing.assert_allclose(force, other, rtol=0, atol=2e-4 * other.max())  # strains are 1e-4; measured: 6e-5


@pytest.mark.parametrize("ranks", [1, *long(2)])
def test_forces(ranks, shared_run):
    """The same forces as by prescribed displacements and Anderson's method, which stops within the tolerance of positions."""
    direct = shared_run(BARS, ranks)
    other = shared_run(f"{BARS} -schwarz_snes_type anderson -schwarz_condense 0 -schwarz_snes_max_it 100", ranks)
    assert never_tensile(direct, PAIR)
    for name, tolerance in ((f"contact/{PAIR}/force", 1e-9), ("body/left/kinetic", 1e-12), ("body/right/potential", 1e-11)):
        values = other.history[name][()]
        np.testing.assert_allclose(direct.history[name][()], values, rtol=0, atol=tolerance * values.max(), err_msg=name)
    assert abs(direct.summary["system"]["energy_error_max"]) <= 1e-12  # measured: 2e-13
