"""Equal bars in a row: Newton's cradle in one dimension, and two bars that hit a resting one from both sides.

A wave runs through a bar in L/c = 2.5e-4 s; impact is at t = 0. The first bar of a cradle pushes with v0/2 sqrt(E rho) A = 50 N
for 2 L/c. The front of this push comes to the i-th pair (from 0) after i L/c, its end after (i + 2) L/c. At the free end of the
last bar the front turns round, as tension, and is at the last of the n - 1 pairs after n L/c, with the end of the push: there
the last bar leaves, with all of the momentum.
"""

import numpy as np
import pytest
from cases import long, never_tensile, worst_energy_error

CROSSING = 2.5e-4  # L/c [s]
MASS, SPEED, PUSH = 2.5e-4, 100, 50
ELEMENTS = 200

EXPLICIT = " ".join(f"-{body}_ts_type centraldifference" for body in "abc")
CRADLES = {
    "3": ("-options_file options/cradle-3.opts", "abc"),
    "3-explicit": (f"-options_file options/cradle-3.opts {EXPLICIT}", "abc"),
    "10": ("-options_file options/cradle-10.opts", "abcdefghij"),
}
SIDES = {
    "default": "-options_file options/two-sided.opts",
    "reversed": "-options_file options/two-sided.opts -contact_pairs b:a,b:c",
}


def check_system(run):
    """Also Newton's two sweeps."""
    schwarz = run.summary["schwarz"]
    assert run.summary["system"]["momentum_error_max"] <= 4e-11  # measured: 2.3e-11; masses that keep the centre are no powers of two times each other, and leave more round-off
    assert worst_energy_error(run.summary) <= 1.5e-6  # measured: 1.1e-6
    assert run.summary["contact"]["max_penetration"] <= 2e-11  # measured: 7e-12
    assert schwarz["unconverged_steps"] == 0
    assert schwarz["mean_contact_steps"] <= 2.2
    for pair in run.summary["pairs"]:
        assert never_tensile(run, pair), pair


def velocities(run, bodies):
    return [run.history[f"body/{body}/mean_velocity"][-1] for body in bodies]


@pytest.mark.parametrize("case", ["3", "3-explicit", *long("10")])
def test_cradle(case, shared_run):
    options, bodies = CRADLES[case]
    run = shared_run(options)
    check_system(run)
    n, pairs = len(bodies), list(run.summary["pairs"])
    assert len(pairs) == n - 1
    assert run.summary["pairs"][pairs[-1]]["release_time"] == pytest.approx(n * CROSSING, rel=2e-3)  # measured: 1.3e-3
    *others, last = velocities(run, bodies)
    assert last == pytest.approx(SPEED, rel=3e-3)  # measured: 2.1e-3
    assert np.abs(others).max() <= 6.5e-3 * SPEED  # measured: 5.1e-3
    time = run.history["time"][()]
    for i, pair in enumerate(pairs):
        force = run.history[f"contact/{pair}/force"][()]
        pushing = time[force > PUSH / 2]
        # half of the force is where front and end of the push are, to the three elements over which a mesh can smear them
        assert pushing[0] == pytest.approx(i * CROSSING, abs=3 / ELEMENTS * CROSSING), pair
        assert pushing[-1] == pytest.approx((i + 2) * CROSSING, abs=3 / ELEMENTS * CROSSING), pair
        middle = np.abs(time - (i + 1) * CROSSING) < 0.6 * CROSSING
        assert force[middle].mean() == pytest.approx(PUSH, rel=5e-6), pair  # measured: 1.7e-6
        assert run.summary["pairs"][pair]["impulse"] == pytest.approx(MASS * SPEED, rel=4e-3), pair  # measured: 3.0e-3
        # bars that touch at rest hear a front before it is there, as dispersion has it, but do not rattle
        assert run.summary["pairs"][pair]["onsets"] <= 3, pair


@pytest.mark.parametrize("case", ["reversed", *long("default")])
def test_two_sided(case, shared_run):
    """b is pushed from both sides, with 50 N. What each push makes is at the other side after L/c, as if b were hit by its mirror
    image: 100 N against v0. After 2 L/c the waves in a and c are back, and 50 N are left. After 3 L/c, a and c fly back with the
    speed that they had.
    """
    run = shared_run(SIDES[case])
    check_system(run)
    assert velocities(run, "abc") == pytest.approx([-SPEED, 0, SPEED], abs=2e-3 * SPEED)
    time = run.history["time"][()]
    forces = [run.history[f"contact/{pair}/force"][()] for pair in run.summary["pairs"]]
    for pair, force in zip(run.summary["pairs"].values(), forces):
        assert pair["onsets"] == 1
        assert pair["release_time"] == pytest.approx(3 * CROSSING, rel=2e-3)  # measured: 1.3e-3
        assert pair["impulse"] == pytest.approx(2 * MASS * SPEED, rel=1e-3)  # measured: 6e-4
        for phase, level in enumerate((PUSH, 2 * PUSH, PUSH)):
            middle = np.abs(time - (phase + 0.5) * CROSSING) < 0.3 * CROSSING
            assert force[middle].mean() == pytest.approx(level, rel=1e-4)  # measured: 5.8e-5; fronts ring, the more the further they have come
    # each step is converged to 1e-12 m, 8e-8 of the compression of an element by 100 N, and so of the force
    np.testing.assert_allclose(*forces, rtol=0, atol=2e-6)  # measured: 5.6e-7 N
