"""The rule `impulse` of `-contact_type force`: contact nodes keep their mass, and contact brings no energy, whatever the bodies do inside a step."""

import math
import re

import numpy as np
import pytest
from cases import joined, long
from contactstep import (
    MM_T_S,
    energy,
    friction,
    impulse,
    integrator,
    kept_error,
    momentum_error,
    pair_of,
    pressed_bars,
    sheet_and_block,
    sweeps,
)
from pairs import pairwise
from setups import box, material, plane

# What bodies may gain by contact, by the energy that is exchanged: implicit ones nothing, to round-off (measured 2e-12); explicit ones what their staggered
# energy, that of the scheme, is off where forces change between steps (measured: nothing in impacts)
GAIN = {"implicit": 1e-9, "explicit": 1e-3}
LOSS = 0.07  # of DESIGN.md: kinetic energy of the contact nodes in the direction of the hit; measured 2.1 to 5.4 %
MOMENTUM = 1e-11  # of a free body, by the impulse of contact: 2e-12 measured, of Newton's method in the implicit body
SUBSTEPS = {"II": (1, 1), "IE": (1, 20), "EI": (20, 1), "EE": (20, 10)}


def gain_allowed(kinds):
    return GAIN["explicit" if "E" in kinds else "implicit"]


SHEET = [("II", 0), ("II", 0.2), ("IE", 0.6), ("EI", 0.2), *long(("II", 0.6), ("IE", 0), ("IE", 0.2), ("EI", 0), ("EI", 0.6), ("EE", 0), ("EE", 0.2), ("EE", 0.6))]


@pytest.mark.parametrize(("kinds", "mu"), SHEET)
def test_sheet(kinds, mu, shared_run):
    run = shared_run(sheet_and_block(kinds, mu, substeps=SUBSTEPS[kinds]))
    change = energy(run)
    assert change.max() <= gain_allowed(kinds)
    assert -LOSS <= change[-1] < -0.01  # it is not nothing either: there are hits
    assert momentum_error(run, "block") <= MOMENTUM
    assert sweeps(run)[1] == 2  # linear bodies: S is exact, and the second pass finds the forces right
    assert not run.summary["contact"]["in_contact_at_end"]
    if mu:
        assert run.summary["contact"]["friction_loss"] > 0.01 * run.history["energy/scale"][0]
        # what friction brings to a node that joins, half of whose slip in the step is let pass: DESIGN.md has 2e-4 of the energy at the start, measured 6.4e-5
        assert run.summary["contact"]["friction_least"] >= -2e-4 * run.history["energy/scale"][0]


@pytest.mark.long
def test_impulse_of_small_steps(shared_run):
    """Within 3 % of that of a tenth of the step; measured 1.8 %."""
    coarse, fine = (shared_run(sheet_and_block("II", 0.2, step=step)) for step in (1e-6, 1e-7))
    np.testing.assert_allclose(impulse(coarse)[1], impulse(fine)[1], rtol=0.03)
    assert energy(fine).max() <= GAIN["implicit"] and energy(fine)[-1] > energy(coarse)[-1]  # fewer nodes hit at once: 2.1 against 4.0 %


@pytest.mark.parametrize(("step", "off"), [(5e-6, 0.03), (2e-5, 0.05)])
def test_large_steps(step, off, shared_run):
    """Measured 1.0 and 4.0 %: twenty microseconds are four times the transit of a wave through the block. And no overlap beyond what rows move in the step that they join in: -5 m/s and waves; measured 0.64 and 2.0 m/s."""
    run, usual = (shared_run(sheet_and_block("II", 0.2, step=length)) for length in (step, 1e-6))
    np.testing.assert_allclose(impulse(run)[1], impulse(usual)[1], rtol=off)
    assert energy(run).max() <= GAIN["implicit"] and energy(run)[-1] >= -LOSS
    assert run.history["contact/block:sheet/gap"][()].min() >= -5 * step


@pytest.mark.parametrize(("kinds", "mu", "turning"), [("II", 0, 1e-6), ("EE", 0.2, 5e-5), *long(("II", 0.2, 5e-5), ("EE", 0, 1e-6))])
def test_free_sheet(kinds, mu, turning, shared_run):
    """Momentum of both to round-off. Angular momentum of neo-Hookean bodies: measured 2.7e-8 and 1.6e-9 of the largest of a body without friction, where rows lie in the
    middle of the step, in which their forces act. Friction acts across the gap that rows are closed with, 5e-6 m or less here: 1.3e-5, in proportion to the step."""
    options = sheet_and_block(kinds, mu, substeps=(7, 10) if kinds == "EE" else (1, 1), end=5e-5, free=True, of="neo_hookean")
    run = shared_run(options)
    for name, tolerance in (("momentum", 1e-12), ("angular_momentum", turning)):
        assert kept_error(run, name, ("block", "sheet")) <= tolerance
    assert energy(run).max() <= gain_allowed(kinds)
    assert sweeps(run)[1] <= 4  # nonlinear: secants; measured 3


def slab(kind="I", mu=0.3, speed=0, slope=0, step=2e-4, end=0.25, ramp=0, beta=5e-5):
    """A block of 100 mm x 40 mm, 8 x 4 elements, on a plane of a slope; its weight comes within `ramp` seconds. Damped in proportion to its stiffness, since
    sliding excites an undamped one."""
    angle = math.atan(slope)
    pull = [9.81 * math.sin(angle), -9.81 * math.cos(angle)]
    grows = f"*min(t/{ramp},1)" if ramp else ""
    return joined(
        f"-bodies b -obstacles t -contact_type force -time_step {step} -time_end {end}",
        plane("t", (0, 0), (0, 1)),
        box("b", (8, 4), (-0.05, 0), (0.05, 0.04)),
        f"-b_material_type linear_elastic -b_mass_redistribute false -b_damping_stiffness {beta}",
        material("b", 1e7, 0.3, 1000),
        f"-b_body_force {','.join(f'{1000 * g:.17g}{grows}' for g in pull)}",
        f"-b_initial_velocity {speed},0" if speed else "",
        friction(mu),
        f"-b_ts_type centraldifference -b_ts_time_step {step / 40}" if kind == "E" else "",
    )


WEIGHT = 0.1 * 0.04 * 1000 * 9.81  # N per metre of thickness


@pytest.mark.parametrize(("kind", "speed"), [("I", 1), ("E", 0.1), *long(("E", 0.3), ("E", 1))])
def test_slides_to_rest(kind, speed, impakt):
    """After v^2/(2 mu g), to 1 %; measured 0.02 %. It stays there, but for the shear vibration that remains when friction ends: 6e-4 m/s."""
    way, stop = speed**2 / (2 * 0.3 * 9.81), speed / (0.3 * 9.81)
    run = impakt(slab(kind, speed=speed, end=1.3 * stop, step=1e-4 if speed < 1 else 2e-4))
    velocity, time = run.history["body/b/mean_velocity"][:, 0], run.history["time"][()]
    assert np.trapezoid(velocity, time) == pytest.approx(way, rel=0.01)
    assert np.abs(velocity[time > 1.1 * stop]).max() <= 1e-3
    assert run.history["contact/b:t/force"][()].mean() == pytest.approx(WEIGHT, rel=0.005)


@pytest.mark.parametrize("kind", ["I", *long("E")])
def test_at_rest(kind, impakt):
    """The weight comes at once; the mean force is the weight to 0.5 %: measured 0.05 %."""
    force = impakt(slab(kind, end=0.1)).history["contact/b:t/force"][()]
    assert force.mean() == pytest.approx(WEIGHT, rel=0.005)
    assert force[len(force) // 2 :].mean() == pytest.approx(WEIGHT, rel=0.005)


@pytest.mark.parametrize(("kind", "part"), [("I", 0.98), ("I", 1.02), *long(("E", 0.98), ("E", 1.02))])
def test_incline(kind, part, impakt):
    """At 0.98 of its angle a block stays where it is, but for its shear strain (1e-6 m); at 1.02 it slides by the difference of gravity and friction: velocity at the
    end to 1 % (measured 0.15 %, of the first vibrations), of its second half to 1e-3 (1e-6)."""
    ramp, end = 0.05, 0.15 if kind == "E" else 0.25
    run = impakt(slab(kind, slope=0.3 * part, ramp=ramp, end=end))
    velocity, time = run.history["body/b/mean_velocity"][:, 0], run.history["time"][()]
    if part < 1:
        assert np.abs(np.trapezoid(velocity, time)) <= 1e-6 and np.abs(velocity[-1]) <= 1e-6
        return
    angle = math.atan(0.3 * part)
    rate = 9.81 * (math.sin(angle) - 0.3 * math.cos(angle))
    assert velocity[-1] == pytest.approx(rate * (end - ramp / 2), rel=0.01)
    middle = np.searchsorted(time, ramp + (end - ramp) / 2)
    assert velocity[-1] - velocity[middle] == pytest.approx(rate * (time[-1] - time[middle]), rel=1e-3)


def tied(kinds, substeps, step=4e-6, steps=1000):
    """A cantilever of 200 mm x 20 mm, tied in its middle between meshes of 3 and 2 elements, that swings from an initial velocity."""
    parts = {"b": ((12, 3), (0, 0), (0.1, 0.02)), "a": ((8, 2), (0.1, 0), (0.2, 0.02))}
    bodies = []
    for (name, of), n, kind in zip(parts.items(), substeps, kinds, strict=True):
        bodies += [
            box(name, *of),
            f"-{name}_material_type linear_elastic -{name}_mass_redistribute false -{name}_initial_velocity 0,250*x^2",
            material(name, 2e11, 0.3, 7800),
            integrator(name, step, n, kind),
        ]
    return joined(
        f"-bodies a,b -contact_type force -contact_law tied -contact_pairs a.xmin:b.xmax -time_step {step} -time_end {steps * step:.17g}",
        "-b_boundary_displacement xmin -b_boundary_displacement_xmin 0,0",
        *bodies,
    )


TIED = [("II", (1, 1), 1e-9), ("EI", (20, 1), 1e-4), *long(("II", (3, 2), 1e-9), ("IE", (1, 20), 1e-4), ("EE", (20, 10), 1e-4), ("EE", (20, 20), 1e-9))]


@pytest.mark.parametrize(("kinds", "substeps", "tolerance"), TIED)
def test_tied(kinds, substeps, tolerance, impakt):
    """`kinds` and `substeps` of the clamped half, and of the free one. Energy of implicit halves: measured 8e-12; with explicit ones of other substeps 3.2e-5 of steps of
    4 us, of the second order in the step; of equal substeps 1e-14. The joint opens by round-off: 1e-18 m of elements of 8.3 mm; allowed are 1e-12 of an element."""
    run = impakt(tied(kinds, substeps))
    change = energy(run)
    assert np.abs(change).max() <= tolerance
    assert np.abs(run.history[f"contact/{pair_of(run)}/gap"][()]).max() <= 1e-12 * 8.3e-3
    assert run.history["body/a/potential"][()].max() > 0.01 * run.history["energy/scale"][0]  # it bends
    assert sweeps(run)[1] == 2


def rubber(step=2e-5, end=5e-3):
    return joined(
        f"-bodies b -obstacles t -contact_type force -time_step {step} -time_end {end}",
        plane("t", (0, 0), (0, 1)),
        box("b", (8, 8), (-0.02, 1e-4), (0.02, 0.0401)),
        material("b", 1e6, 0.4, 1000),
        f"-b_material_type neo_hookean -b_mass_redistribute false -b_initial_velocity 3,-5 -b_ts_type centraldifference -b_ts_time_step {step / 20}",
        friction(0.3),
    )


def test_rubber_on_obstacle(impakt):
    """Neo-Hookean, explicit in 20 substeps, with friction."""
    run = impakt(rubber())
    change = energy(run)
    assert change.max() <= 0 and change[-1] > -LOSS
    assert momentum_error(run, "b") <= MOMENTUM
    assert sweeps(run)[1] <= 4  # measured 2


@pytest.mark.parametrize(("ranks", "end"), [(3, 5e-4), *long((2, 5e-3), (3, 5e-3))])
def test_rubber_on_ranks(ranks, end, shared_run):
    """Forces to 1e-9 of the largest; measured 4e-11."""
    run, other = shared_run(rubber(end=end)), shared_run(rubber(end=end), ranks)
    force = run.history["contact/b:t/force_vector"][()]
    assert force[:, 0].any() and np.abs(force[:, 1]).max() > 1e3
    np.testing.assert_allclose(other.history["contact/b:t/force_vector"][()], force, rtol=0, atol=1e-9 * np.abs(force).max())


@pytest.mark.parametrize(("kind", "mu"), [("E", 0.3), *long(("I", 0), ("I", 0.3), ("E", 0))])
def test_rigid_block(kind, mu, impakt):
    """In place of the elastic one; its rotations are not small, for which a secant may be due: passes measured 3."""
    options = sheet_and_block("I" + kind, mu, substeps=(1, 20 if kind == "E" else 1))
    options = re.sub(r"-block_(material_type|youngs_modulus|poissons_ratio|mass_redistribute|element_formulation|ts_time_step) \S+ ?", "", options)
    run = impakt(options + " -block_ts_type rigid")
    change = energy(run)
    assert change.max() <= gain_allowed(kind) and change[-1] >= -LOSS  # measured 0 and 4.9 to 5.4 %
    assert momentum_error(run, "block") <= MOMENTUM
    assert sweeps(run)[1] <= 4


@pytest.mark.parametrize(("kinds", "step", "substeps"), [("EI", 1e-6, (20, 1)), *long(("II", 1e-6, (1, 1)), ("EE", 1e-6, (20, 10)), ("EE", 5e-8, (1, 1)))])
def test_thick_massless_block(kinds, step, substeps, impakt):
    """On the sheet, which keeps its mass: one rule for both, no gain, losses of 1 to 4.3 %."""
    options = sheet_and_block(kinds, step=step, substeps=substeps).replace("-block_mass_redistribute false", "-block_mass_redistribute true")
    run = impakt(options)
    change = energy(run)
    assert change.max() <= gain_allowed(kinds) and -LOSS <= change[-1] < -0.005
    assert momentum_error(run, "block") <= MOMENTUM
    assert sweeps(run)[1] == 2


FRAMES = {
    "moving": {"frame": (10, 0)},
    "turned": {"turn": 30},
    "turned and moving": {"turn": 30, "frame": (10, -7)},
    "in mm, t, s": {"units": MM_T_S},
}
MOVED = [("II", "turned and moving"), ("II", "in mm, t, s")]


@pytest.mark.parametrize(("kinds", "frame"), [*MOVED, *long(*(pair for pair in pairwise(["II", "IE", "EE"], list(FRAMES)) if pair not in MOVED))])
def test_frames(kinds, frame, shared_run):
    """Impulses are those of the frame at rest to 1e-9: measured 5e-13."""
    still = impulse(shared_run(sheet_and_block(kinds, substeps=SUBSTEPS[kinds])))[:2]
    found = impulse(shared_run(sheet_and_block(kinds, substeps=SUBSTEPS[kinds], **FRAMES[frame])))[:2]
    angle = math.radians(FRAMES[frame].get("turn", 0))
    c, s = math.cos(angle), math.sin(angle)
    np.testing.assert_allclose(np.array([[c, s], [-s, c]]) @ found, still, rtol=0, atol=1e-9 * np.abs(still).max())


@pytest.mark.parametrize("kinds", ["II", *long("EE")])
def test_sides_swapped(kinds, shared_run):
    """Rows are then on the nodes of the block, which are others: the normal impulse to 3 %, measured 1.6 %."""
    first, second = (impulse(shared_run(sheet_and_block(kinds, substeps=SUBSTEPS[kinds], pair=pair))) for pair in ("block:sheet", "sheet:block"))
    np.testing.assert_allclose(second[1], -first[1], rtol=0.03)


@pytest.mark.parametrize("kinds", ["II", *long("IE", "EI", "EE")])
def test_sides_swapped_where_meshes_match(kinds, shared_run):
    """Pressed bars that a pulse opens: the same forces at every step, to 1e-3 of the largest. Measured 2.5e-4: nodes move across by 1e-8 m, and are projected along the
    normals of one side or the other."""
    runs = [shared_run(pressed_bars(kinds, 0, 2e-6, 4e-4, SUBSTEPS[kinds], pair)) for pair in ("a.xmax:b.xmin", "b.xmin:a.xmax")]
    first, second = (run.history[f"contact/{pair_of(run)}/force"][()] for run in runs)
    assert (first == 0).any() or first.min() < 0.5 * first[1]
    np.testing.assert_allclose(second, first, rtol=0, atol=1e-3 * first.max())


@pytest.mark.parametrize(
    ("kinds", "step", "substeps", "tolerance"),
    [("II", 2e-6, (1, 1), 1e-9), ("EE", 2e-7, (1, 1), 1e-12), *long(("IE", 2e-6, (1, 20), 1e-4), ("EI", 2e-6, (20, 1), 1e-4), ("EE", 2e-6, (20, 10), 1.5e-3))],
)
def test_pressed_at_rest(kinds, step, substeps, tolerance, shared_run):
    """Nothing happens. Explicit bodies of unequal substeps take or bring what their staggered energy is off where forces change, of second order in the substep:
    measured 2e-5, 1e-3 (a loss), 1.2e-3 at half of the stable step; of equal ones 5e-16 at 0.7 of it: the start counts with the forces of contact from its first
    instant on."""
    run = shared_run(pressed_bars(kinds, 0, step, 500 * step, substeps, at_rest=True))
    change = energy(run)
    assert change.max() <= tolerance and change.min() >= -1e-3
    assert np.abs(run.history[f"contact/{pair_of(run)}/gap"][()]).max() <= 1e-6 * 2.5e-3  # m, of an element in 500 steps; measured 2e-16


# Ties for 10^4 steps at several ratios of substeps
LONG_TIED = [("II", (1, 1)), ("II", (3, 2)), ("EI", (20, 1)), ("IE", (1, 20)), ("EE", (20, 10)), ("EE", (7, 50)), ("IE", (2, 200))]


@pytest.mark.validate
@pytest.mark.parametrize(("kinds", "substeps"), LONG_TIED)
def test_tied_for_long(kinds, substeps, impakt):
    """The joint opens by no more than 1e-12 of an element over 1e4 steps, and energy does not grow."""
    run = impakt(tied(kinds, substeps, step=2e-6, steps=10000), timeout=600)
    assert np.abs(run.history[f"contact/{pair_of(run)}/gap"][()]).max() <= 1e-12 * 8.3e-3
    assert energy(run).max() <= (1e-9 if kinds == "II" else 1e-3)
