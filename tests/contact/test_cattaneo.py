"""Equal bodies pressed together and pushed across, against Cattaneo and Mindlin: what sticks, tractions, what a loop loses. plots/cattaneo.py has the formulas."""

import os
import sys

import cattaneo
import numpy as np
import pytest
from cases import long, validate
from conftest import ROOT

CYLINDERS = "-options_file options/cattaneo-cylinders.opts"
OTHER, SWAPPED = "-lower_ball_divisions 48", "-contact_pairs lower.surface:upper.surface"


def read(run):
    return cattaneo.Run(run.folder / "history.h5")


def errors(run, step):
    """How far both ends of what sticks, half way between the last node that does and the next one, are from c, in elements; and of tractions, by mu p0, the
    largest error and the root mean square."""
    x, along, slides, element = run.nodes(step)
    sticks = np.flatnonzero(~slides)
    assert len(sticks) == sticks[-1] - sticks[0] + 1  # all between the ends
    ends = 0.5 * (x[sticks[[0, -1]]] + x[sticks[[0, -1]] + [-1, 1]])
    off = along - cattaneo.traction(2, x, run.q[step])
    return np.abs(np.abs(ends) - cattaneo.stick(2, run.q[step])).max() / element, np.abs(off).max(), np.sqrt(np.mean(off**2)), element


@pytest.mark.parametrize("options", [*long(""), *validate(OTHER, f"{OTHER} {SWAPPED}")])
def test_cylinders(options, shared_run):
    """In each of the 20 steps in which the force across grows. Before, while equal cylinders of equal meshes are pressed, nothing slides by symmetry, though each normal
    is turned by what the surfaces are pressed flat by."""
    made = shared_run(f"{CYLINDERS} {options}")
    run = read(made)
    pushed = np.flatnonzero(run.time > 0.51)
    assert len(pushed) == 20
    assert run.a[-1] < run.radius / 10 and run.q[-1] == pytest.approx(0.91, abs=0.02)
    assert np.ptp(run.load[pushed]) <= 1e-6 * run.load[-1]  # what is pushed across bears what it bore. Measured: 3e-7
    for step in pushed[run.q[pushed] > 0.2]:  # more than an element slides at either end
        end, most, rms, element = errors(run, step)
        assert 12 <= 1 / element < 17
        assert end <= 1  # measured: 0.72, 0.57, 0.76
        assert rms <= 0.025  # measured: 0.010, 0.020, 0.019
        assert most <= 0.1  # at c, where theory has a corner. Measured: 0.037, 0.079, 0.077
    assert run.loss[-1] > 0
    if not options:
        before = run.time < 0.51
        assert np.abs(run.loss[before]).max() <= 1e-12 * made.history["body/upper/potential"][before][-1]


PRESSED = f"{CYLINDERS} -time_end 0.5"
STIFF = f"{PRESSED} -upper_youngs_modulus 1e11 -contact_friction 0.05"


@pytest.mark.long
def test_unequal_stiffness(shared_run):
    """A cylinder that is 100 times as stiff keeps its shape: rows that lie as it does from the start take as much of the energy as those that are built again in
    each step (6.61 J for 5.93 J with rows half way between both)."""
    once, again = (shared_run(f"{STIFF} {more}").summary["contact"] for more in ("", "-contact_angle_bound 1e-5"))
    assert once["friction_tilt"] <= 1e-3  # measured: 3e-4
    assert once["friction_loss"] == pytest.approx(again["friction_loss"], rel=5e-3)  # measured: 3.1e-3


SPHERES = "-options_file options/cattaneo-spheres.opts"


def test_loop_loss_is_the_area_of_the_loop():
    """The formula of plots/cattaneo.py against the integral of the displacement over the force, of both branches."""
    q = 0.9
    force = np.linspace(-q, q, 20001)
    way = 3 / 16 * (2 * (1 - (q - force) / 2) ** (2 / 3) - (1 - q) ** (2 / 3) - 1)  # with mu P, S and a of 1, as q falls
    area = 2 * np.trapezoid(way, force)  # the other branch is this one, both signs turned round
    assert cattaneo.loop_loss(1, 1, 1, q) == pytest.approx(area, rel=1e-6)


@pytest.mark.validate
def test_spheres(shared_run):
    """A loop at q = 0.9, on a mesh that has five elements to the radius of the contact. q is that of the rows: the plane of contact turns by 2 % of mu, and the loss
    goes with the sixth power of q."""
    run = read(shared_run(SPHERES))
    turn, back = run.step(3), run.step(5)
    assert run.a[turn] < run.radius / 10
    (load, q), (_, other) = run.of_rows(turn), run.of_rows(back)
    assert load == pytest.approx(run.load[turn], rel=1e-3)  # measured: 1.4e-4
    assert q == pytest.approx(0.9, abs=0.02)
    assert other == pytest.approx(-q, rel=2e-3)  # measured: 7e-4
    half = run.loss[back] - run.loss[turn]
    theory = cattaneo.loop_loss(run.mu * load, run.a[turn], run.compliance, (q - other) / 2) / 2
    assert run.half_loop(turn, back) == pytest.approx(theory, rel=1e-12)  # what the figure has
    # Measured: +0.8 %. Where the radius of the contact is 0.089 of the spheres' instead of 0.079: +2.3 %, with half the steps +2.1 %. Half spaces of squares as wide
    # as these elements lose 2 % less than theory, so that the mesh hides a part of what round bodies do
    assert half == pytest.approx(theory, rel=0.02)


@pytest.mark.parametrize("cases", [*long([CYLINDERS]), *validate([CYLINDERS, SPHERES])])
def test_figure(cases, shared_run, launch, tmp_path):
    figure = tmp_path / "figure.png"
    histories = [shared_run(options).folder / "history.h5" for options in cases]
    run = launch([sys.executable, ROOT / "plots/cattaneo.py", *histories, figure], env={**os.environ, "MPLBACKEND": "Agg"})
    assert run.returncode == 0, run.stderr
    assert not run.stderr
    assert figure.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.validate
def test_spheres_on_ranks(shared_run):
    """Three ranks that divide graded balls between them: MUMPS ran out of the memory that it had expected to take, and the run ended with its error."""
    first, other = (shared_run(f"{SPHERES} -time_step 1 -time_end 1 {SWAPPED}", n).summary["contact"] for n in (1, 3))
    assert other["force_peak"] == pytest.approx(first["force_peak"], rel=1e-10)  # measured: 2e-15
    assert other["active_max"] == first["active_max"]
