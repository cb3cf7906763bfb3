"""Rows that follow the surfaces: two bodies of neo-Hookean material meet off-centre, and one of them spins.

Neither has a support, so that momentum and angular momentum about any point stay what they are, and so does energy, but for what the instant of
impact inside a step costs. With rows that stayed as they were between two builds, angular momentum was off by 2.6e-2 and energy by 8e-3, in
proportion to -contact_slip_bound; now both are off by what the step leaves, of second order.
"""

import math
import random

import pytest
from cases import long, longest

DISCS = "-options_file options/discs.opts"
IMPLICIT = "-a_ts_type alpha2 -b_ts_type alpha2"
BALLS = " ".join(
    f"-{b}_dm_plex_dim 3 -{b}_ball_divisions 4 -{b}_ball_centre {centre} -{b}_initial_velocity {velocity}"
    for b, centre, velocity in (("a", "-0.0101,0,0", "2,0,0"), ("b", "0.0085,0.009,0.002", "-2+100*(y-0.009),-100*(x-0.0085),0"))
)


def errors(run):
    system = run.summary["system"]
    assert run.summary["contact"]["onsets"] == 1 and run.summary["contact"]["release_time"] is not None
    return system["momentum_error_max"], system["angular_momentum_error_max"], max(abs(system["energy_error_min"]), system["energy_error_max"])


# measured: momentum 2.3e-13; angular momentum 6.6e-9 (explicit), 5.8e-8 (implicit); energy 5.8e-6 and 6.3e-6. Newton's method leaves a residual of
# 1e-12 of the forces.
@pytest.mark.parametrize("more", ["", IMPLICIT, "-contact_slip_bound 0.05", "-contact_pairs b:a", "-b_ts_time_step 1.25e-7", "-a_ts_time_step 1.25e-7"], ids=["EE", "II", "bound", "sides", "substeps", "dirichlet substeps"])
@pytest.mark.long
def test_discs(more, shared_run):
    momentum, angular, energy = errors(shared_run(f"{DISCS} {more} -time_end 4.6e-4"))
    assert momentum <= (2e-11 if more == IMPLICIT else 1e-12)  # II: 6.3e-12, what Newton's method leaves in some thousand steps
    assert angular <= 1e-6
    assert energy <= (1e-4 if "b:a" in more else 2e-5)  # 6.7e-5 with gaps that are turned for the sake of the spin, and rows on the coarser disc


@pytest.mark.long
def test_second_order(shared_run):
    """Twice the step, four times the angular momentum that is lost; measured: 3.9."""
    lost = [errors(shared_run(f"{DISCS} {IMPLICIT} -time_step {step} -time_end 4.6e-4"))[1] for step in (5e-7, 1e-6)]
    assert 3 <= lost[1] / lost[0] <= 5


@pytest.mark.parametrize("more", [*long(""), *longest(IMPLICIT)], ids=["EE", "II"])
def test_balls(more, shared_run):
    momentum, angular, energy = errors(shared_run(f"{DISCS} {BALLS} {more} -time_step 5e-7 -time_end 4.6e-4"))
    assert momentum <= (2e-11 if more else 1e-12)  # II: 3.4e-12
    assert angular <= 1e-6
    assert energy <= 1e-4


def overlapping(dim, faces, offset, more=""):
    """Two neo-Hookean blocks that face each other in part only, and slide past each other."""
    common = f"-dm_plex_dim {dim} -density 1000 -youngs_modulus 1e8 -poissons_ratio 0.25 -material_type neo_hookean"
    bodies = [
        f"-prefix_push {name}_ {common} -dm_plex_box_faces {','.join([str(n)] * dim)} {what} -prefix_pop"
        for name, n, what in (
            ("a", faces[0], f"-initial_velocity {','.join(['5', '0', '0'][:dim])}"),
            ("b", faces[1], f"-initial_velocity {','.join(['0', '20', '10'][:dim])} -translate {','.join(['1.005', *offset][:dim])}"),
        )
    ]
    return f"-bodies a,b {' '.join(bodies)} -time_step 2e-5 -time_end 1.2e-2 {more}"


CENTRAL = "-a_ts_type centraldifference -b_ts_type centraldifference"


# measured: 1.4e-7 to 2.8e-7 (plane), 3.5e-8 to 4.3e-8; where the rows of nodes beyond the end of the partner did not follow it was 5e-5 and 3e-4 to 4.8e-3
@pytest.mark.parametrize(
    "options",
    [
        overlapping(2, (8, 11), ("0.43",), "-contact_pairs a:b"),
        overlapping(2, (8, 11), ("0.43",), "-contact_pairs b:a"),
        pytest.param(overlapping(2, (8, 11), ("0.43",), f"-contact_pairs b:a {CENTRAL}"), marks=pytest.mark.long),
        pytest.param(overlapping(3, (4, 5), ("0.43", "0.31"), "-contact_pairs a:b"), marks=pytest.mark.long),
        pytest.param(overlapping(3, (4, 5), ("0.43", "0.31"), f"-contact_pairs b:a {CENTRAL}"), marks=pytest.mark.long),
    ],
    ids=["plane a:b", "plane b:a", "plane b:a EE", "space a:b", "space b:a EE"],
)
def test_part_of_a_face(options, shared_run):
    """Nodes just beyond the end of the partner guard it, and their rows follow as others do; it slides by a fifth of its width."""
    momentum, angular, energy = errors(shared_run(options))
    assert momentum <= 2e-11
    assert angular <= 1e-6
    assert energy <= 5e-5


@pytest.mark.parametrize("ranks", [2, 3])
def test_sweeps_on_ranks(ranks, shared_run):
    """Gaps that are turned for the sake of the spin are unknowns of the first rank, which the secants of all ranks need too: as many sweeps on any number of
    ranks. Without them steps did not converge. The first 144 steps in contact."""
    one, more = (shared_run(f"{DISCS} -time_end 2.2e-4 -output_fields none", n).summary for n in (1, ranks))
    assert one["contact"]["steps_in_contact"] > 100
    assert more["schwarz"]["mean_contact_steps"] == pytest.approx(one["schwarz"]["mean_contact_steps"], rel=1e-2)  # seen: equal
    assert more["contact"]["impulse"] == pytest.approx(one["contact"]["impulse"], rel=1e-9)


@pytest.mark.parametrize("ranks", [2, 3])
@pytest.mark.long
def test_ranks(ranks, shared_run):
    one, more = (errors(shared_run(f"{DISCS} -time_end 4.6e-4", n)) for n in (1, ranks))
    assert more[0] <= 1e-12
    assert more[1:] == pytest.approx(one[1:], rel=1e-3)


@pytest.mark.long
def test_sides(shared_run):
    """Without friction neither disc is to spin: what spin there is, half of it where there was all on one side, hardly depends on which disc has the
    nodes of the rows. Forces and times: of equal meshes to 1e-3."""
    found = []
    for pair in ("a:b", "b:a"):
        run = shared_run(f"{DISCS} -b_ball_divisions 16 -b_initial_velocity -2,0 -contact_pairs {pair} -time_end 4.6e-4")
        contact = run.summary["contact"]
        found.append((run.history["contact"][pair]["force"][()].max(), contact["release_time"] - contact["first_contact_time"]))
    assert found[0] == pytest.approx(found[1], rel=1e-3)


def scattered(n):
    """n linear discs in rows, that fly in all directions, every other one implicit and so divided among ranks."""
    drawn, columns = random.Random(1), math.ceil(math.sqrt(n))
    bodies = [
        f"-prefix_push d{i}_ -dm_plex_dim 2 -dm_plex_shape ball -ball_radius 0.01 -ball_centre {0.021 * (i % columns)},{0.021 * (i // columns)} -ball_divisions 4"
        f" -density 1000 -youngs_modulus 1e8 -poissons_ratio 0.25 -ts_type {'centraldifference' if i % 2 else 'alpha2'}"
        f" -initial_velocity {12 * drawn.uniform(-1, 1):.6f},{12 * drawn.uniform(-1, 1):.6f} -prefix_pop"
        for i in range(n)
    ]
    return f"-bodies {','.join(f'd{i}' for i in range(n))} -contact_pairs auto -contact_facing false -time_step 2e-6 -time_end 3e-4 {' '.join(bodies)}"


def test_friction_on_ranks(shared_run):
    """Rows that touch follow; with friction a node has two rows, and which of them touches was asked in the wrong places, which hang on how nodes are divided:
    on 3 ranks friction's work differed by 1.2e-3 and the impulse by 1.2e-4. Seen: 1e-14."""
    one, three = (shared_run(f"{scattered(12)} -contact_law coulomb -contact_friction 0.3", n).summary["contact"] for n in (1, 3))
    assert one["friction_loss"] > 1
    for name in ("friction_loss", "impulse", "force_peak"):
        assert three[name] == pytest.approx(one[name], rel=1e-10)
