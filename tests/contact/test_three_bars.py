"""Three equal bars in a row: a hits b and c, which are at rest. An elastic collision hands the speed on to c."""

import pytest
from cases import ANDERSON, long, never_tensile, worst_energy_error

BARS = "-options_file options/three-bars.opts"
EXPLICIT = " ".join(f"-{body}_ts_type centraldifference" for body in "abc")
MASS, SPEED = 2.5e-4, 100
PUSH = 50  # N: v0 / 2 sqrt(E rho) A, a bar against one at rest

# Outer iterations, roles of b (Neumann and Dirichlet; Dirichlet twice; Dirichlet and Neumann), integrators
SCHWARZ = {
    "newtonls": BARS,
    "anderson": f"{BARS} {ANDERSON}",
    "dirichlet-twice": f"{BARS} -contact_pairs b:a,b:c",
    "reversed": f"{BARS} -contact_pairs b:a,c:b",
    "explicit": f"{BARS} {EXPLICIT}",
    "outer-explicit": f"{BARS} -a_ts_type centraldifference -a_ts_time_step 2e-8 -c_ts_type centraldifference -c_ts_time_step 1e-8",
    "inner-explicit": f"{BARS} -b_ts_type centraldifference -b_ts_time_step 2e-8",
}


def check_collision(run):
    pairs = run.summary["pairs"]
    assert len(pairs) == 2
    for name, pair in pairs.items():
        assert pair["onsets"] == 1, name
        # each pair hands on all of the momentum; 0.2 % of the speed stays in what the bars ring with
        assert pair["impulse"] == pytest.approx(MASS * SPEED, rel=2.5e-3), name  # measured: 1.9e-3
        assert pair["force_mean"] == pytest.approx(PUSH, rel=5e-6), name  # measured: 1.7e-6
        assert never_tensile(run, name), name
    velocity = {body: run.history[f"body/{body}/mean_velocity"][-1] for body in "abc"}
    assert velocity["c"] == pytest.approx(SPEED, rel=2.5e-3)  # measured: 1.9e-3
    assert abs(velocity["a"]) <= 1.5e-3 * SPEED  # measured: 8e-4
    assert abs(velocity["b"]) <= 1.5e-3 * SPEED  # measured: 1.1e-3
    # b and c start one gap of 1 mm later, when the wave from a has come through b
    onsets = sorted(pair["first_contact_time"] for pair in pairs.values())
    assert onsets[0] == pytest.approx(1e-3 / SPEED, abs=2e-7)
    assert onsets[1] == pytest.approx(1e-3 / SPEED + 2.5e-4 + 1e-3 / SPEED, abs=1e-5)
    releases = sorted(pair["release_time"] for pair in pairs.values())
    for onset, release in zip(onsets, releases, strict=True):  # 2 L / c; late by the elements that fronts are smeared over: measured 1.1e-5 s
        assert 0 <= release - onset - 5e-4 <= 1.5e-5


@pytest.mark.parametrize("case", ["newtonls", "dirichlet-twice", "explicit", "inner-explicit", *long("outer-explicit", "reversed", "anderson")])
def test_schwarz(case, shared_run):
    run = shared_run(SCHWARZ[case])
    check_collision(run)
    assert run.summary["system"]["momentum_error_max"] <= 2e-11  # opposite forces, to round-off over 1e4 steps; measured: 6e-12
    assert worst_energy_error(run.summary) <= (6.9e-6 if "-explicit" in case else 8.2e-6)  # measured: 5.3e-6, 6.3e-6
    assert run.summary["contact"]["max_penetration"] <= 2e-12  # where the outer iteration stops is 1e-12 m
    assert run.summary["schwarz"]["unconverged_steps"] == 0


@pytest.mark.parametrize("more", ["", *long(EXPLICIT)], ids=["implicit", "explicit"])
def test_penalty(more, shared_run):
    run = shared_run(f"{BARS} -contact_type penalty -contact_penalty 7.5e4 {more}".strip())
    check_collision(run)
    system = run.summary["system"]
    assert system["momentum_error_max"] <= 3e-11  # measured: 9e-12
    assert abs(system["energy_error_final"]) <= 3.9e-7  # measured: 2.9e-7
    assert system["energy_error_max"] <= 3.9e-7
    # both springs hold F^2 / (2 tau) while both pairs touch, of the 1.25 J that a had without the third that is common motion
    assert system["energy_error_min"] == pytest.approx(-2 * PUSH**2 / (2 * 7.5e4) / (1.25 * 2 / 3), rel=0.02)
    # F / tau; and up to a tenth more where the waves that the gaps sent meet
    assert PUSH / 7.5e4 <= run.summary["contact"]["max_penetration"] <= 1.1 * PUSH / 7.5e4
