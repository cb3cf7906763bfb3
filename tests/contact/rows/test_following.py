"""Rows that follow the surfaces: two bodies of neo-Hookean material meet off-centre, and one of them spins.

Neither has a support, so that momentum and angular momentum about any point stay what they are, and so does energy, but for what the instant of
impact inside a step costs. With rows that stayed as they were between two builds, angular momentum was off by 2.6e-2 and energy by 8e-3, in
proportion to -contact_slip_bound; now both are off by what the step leaves, of second order.
"""

import pytest
from cases import joined, long, validate

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
@pytest.mark.parametrize("more", long("", "-contact_pairs b:a") + validate(IMPLICIT, "-contact_slip_bound 0.05", "-b_ts_time_step 1.25e-7", "-a_ts_time_step 1.25e-7"), ids=["EE", "sides", "II", "bound", "substeps", "dirichlet substeps"])
def test_discs(more, shared_run):
    momentum, angular, energy = errors(shared_run(joined(DISCS, more, "-time_end 4.6e-4")))
    assert momentum <= (2e-11 if more == IMPLICIT else 1e-12)  # II: 6.3e-12, what Newton's method leaves in some thousand steps
    assert angular <= 1e-6
    assert energy <= (1e-4 if "b:a" in more else 2e-5)  # 6.7e-5 with gaps that are turned for the sake of the spin, and rows on the coarser disc


@pytest.mark.validate
def test_second_order(shared_run):
    """Twice the step, four times the angular momentum that is lost; measured: 3.9."""
    lost = [errors(shared_run(f"{DISCS} {IMPLICIT} -time_step {step} -time_end 4.6e-4"))[1] for step in (5e-7, 1e-6)]
    assert 3 <= lost[1] / lost[0] <= 5


@pytest.mark.parametrize("more", [*long(""), *validate(IMPLICIT)], ids=["EE", "II"])
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
        *long(overlapping(2, (8, 11), ("0.43",), f"-contact_pairs b:a {CENTRAL}"), overlapping(3, (4, 5), ("0.43", "0.31"), "-contact_pairs a:b")),
        *validate(overlapping(3, (4, 5), ("0.43", "0.31"), f"-contact_pairs b:a {CENTRAL}")),
    ],
    ids=["plane a:b", "plane b:a EE", "space a:b", "space b:a EE"],
)
def test_part_of_a_face(options, shared_run):
    """Nodes just beyond the end of the partner guard it, and their rows follow as others do; it slides by a fifth of its width."""
    momentum, angular, energy = errors(shared_run(options))
    assert momentum <= 2e-11
    assert angular <= 1e-6
    assert energy <= 8e-5  # measured: 6.6e-5


def test_sweeps_on_ranks(shared_run):
    """Gaps that are turned for the sake of the spin are unknowns of the first rank, which the secants of all ranks need too: as many sweeps on any number of
    ranks. Without them steps did not converge. The first 144 steps in contact."""
    one, more = (shared_run(f"{DISCS} -time_end 2.2e-4 -output_fields none", n).summary for n in (1, 3))
    assert one["contact"]["steps_in_contact"] > 100
    assert more["schwarz"]["mean_contact_steps"] == pytest.approx(one["schwarz"]["mean_contact_steps"], rel=1e-2)  # seen: equal
    assert more["contact"]["impulse"] == pytest.approx(one["contact"]["impulse"], rel=1e-9)
