"""Three equal bars in a row: a hits b and c, which are at rest. An elastic collision hands the speed on to c."""

import pytest
from cases import ANDERSON, never_tensile, worst_energy_error

BARS = "-options_file options/three-bars.opts"
PENALTY = f"{BARS} -contact_type penalty -contact_penalty 7.5e4"
EXPLICIT = " ".join(f"-{body}_ts_type centraldifference" for body in "abc")
MASS, SPEED = 2.5e-4, 100
PUSH = 50  # N: v0 / 2 sqrt(E rho) A, a bar against one at rest

# Outer iterations, ranks, roles of b (Neumann and Dirichlet; Dirichlet twice; Dirichlet and Neumann), integrators
SCHWARZ = {
    "newtonls": (BARS, 1),
    "two-ranks": (BARS, 2),
    "anderson": (f"{BARS} {ANDERSON}", 1),
    "dirichlet-twice": (f"{BARS} -contact_pairs b:a,b:c", 1),
    "reversed": (f"{BARS} -contact_pairs b:a,c:b", 1),
    "explicit": (f"{BARS} {EXPLICIT}", 1),
}
MIXED = {
    "outer-explicit": f"{BARS} -a_ts_type centraldifference -a_ts_time_step 2e-8 -c_ts_type centraldifference -c_ts_time_step 1e-8",
    "inner-explicit": f"{BARS} -b_ts_type centraldifference -b_ts_time_step 2e-8",
}
PENALTIES = {"implicit": (PENALTY, 1), "explicit": (f"{PENALTY} {EXPLICIT}", 1)}


def check_collision(run):
    pairs = run.summary["pairs"]
    assert len(pairs) == 2
    for name, pair in pairs.items():
        assert pair["onsets"] == 1, name
        # each pair hands on all of the momentum; 0.4 % of the speed stays in what the bars ring with
        assert pair["impulse"] == pytest.approx(MASS * SPEED, rel=5e-3), name
        assert pair["force_mean"] == pytest.approx(PUSH, rel=5e-3), name  # the gaps send small waves through the bars
        assert never_tensile(run, name), name
    velocity = {body: run.history[f"body/{body}/mean_velocity"][-1] for body in "abc"}
    assert velocity["c"] == pytest.approx(SPEED, rel=5e-3)
    assert abs(velocity["a"]) <= 5e-3 * SPEED
    assert abs(velocity["b"]) <= 5e-3 * SPEED
    # b and c start one gap of 1 mm later, when the wave from a has come through b
    onsets = sorted(pair["first_contact_time"] for pair in pairs.values())
    assert onsets[0] == pytest.approx(1e-3 / SPEED, abs=2e-7)
    assert onsets[1] == pytest.approx(1e-3 / SPEED + 2.5e-4 + 1e-3 / SPEED, abs=1e-5)
    releases = sorted(pair["release_time"] for pair in pairs.values())
    assert releases[0] == pytest.approx(onsets[0] + 5e-4, rel=0.05)  # 2 L / c
    assert releases[1] == pytest.approx(onsets[1] + 5e-4, rel=0.05)


@pytest.mark.parametrize("case", list(SCHWARZ))
def test_schwarz(case, shared_run):
    run = shared_run(*SCHWARZ[case])
    check_collision(run)
    assert run.summary["system"]["momentum_error_max"] <= 1e-10  # opposite forces, to round-off over 1e4 steps
    assert worst_energy_error(run.summary) <= 1e-5
    assert run.summary["contact"]["max_penetration"] <= 1e-9
    assert run.summary["schwarz"]["unconverged_steps"] == 0


@pytest.mark.parametrize("case", list(MIXED))
def test_mixed(case, shared_run):
    """As for two bars: energy to 1e-4; momentum to the square of the step, as a waveform is not its mean at the ends."""
    run = shared_run(MIXED[case])
    check_collision(run)
    assert run.summary["system"]["momentum_error_max"] <= 1e-5
    assert worst_energy_error(run.summary) <= 1e-4


@pytest.mark.parametrize("case", list(PENALTIES))
def test_penalty(case, shared_run):
    run = shared_run(*PENALTIES[case])
    check_collision(run)
    system = run.summary["system"]
    assert system["momentum_error_max"] <= 1e-10
    assert abs(system["energy_error_final"]) <= 1e-5
    assert system["energy_error_max"] <= 1e-5
    # both springs hold F^2 / (2 tau) while both pairs touch, of the 1.25 J that a had
    assert system["energy_error_min"] == pytest.approx(-2 * PUSH**2 / (2 * 7.5e4) / 1.25, rel=0.02)
    # F / tau; and up to a tenth more where the waves that the gaps sent meet
    assert PUSH / 7.5e4 <= run.summary["contact"]["max_penetration"] <= 1.1 * PUSH / 7.5e4
