"""Controller steps that nobody would choose: from a tenth of what a wave takes through a contact element to a thousand times as much, with any pairing of
integrators, substeps and methods. Contact must not bring energy beyond the excess that is allowed, and an answer that only dissipates is none."""

import itertools
import random
import statistics

import pytest
from cases import long, validate

EXCESS = 1e-3  # -contact_energy_excess, by default
ROUND_OFF = 1e-9  # of energies, over some hundred steps
# An option file: its bodies; transit of its quickest contact element [s]; when bodies meet, and when the run ends at the latest [s]
CASES = {
    "beam-hit": (("beam", "block"), 2.5e-6, 0, 8e-3),
    "blocks": (("left", "right"), 5e-6, 1e-6, 1.2e-3),
    "bars-3d": (("left", "right"), 6e-6, 1e-6, 1.2e-3),
    "two-materials": (("left", "right"), 4.4e-7, 2e-4, 1.2e-3),
    "three-bars": (("a", "b", "c"), 1.25e-6, 1e-5, 2e-3),
    "cradle-3": (("a", "b", "c"), 1.25e-6, 1e-5, 2e-3),
    "stack": (("a", "b", "c", "d", "e"), 5e-4, 0.06, 0.6),
}
METHODS = ("schwarz",) * 5 + ("penalty", "lagrange")
STEPS = 400  # controller steps at most, from when bodies meet
# Explicit bodies make 107 substeps to a controller step of this many transits. In longer ones the compliance of the many rows of the stack over all substeps
# takes minutes, and in such runs its bodies are implicit.
LONGEST = {"stack": 50}
EXPLICIT_EXCESS = 2e-3  # more where a body is explicit: its staggered energy depends on the step, which cuts change; one of 16 runs of the stack gains 2.5e-3 in all


def integrator(dice, body, step, may_be_explicit=True):
    kind = dice.choice(("implicit", "implicit", "explicit", "substeps"))
    if kind == "explicit" and may_be_explicit:
        return f"-{body}_ts_type centraldifference -{body}_ts_time_step auto"
    return f"-{body}_ts_type alpha2 -{body}_ts_time_step {step / (dice.choice((2, 3, 7)) if kind == 'substeps' else 1):.17g}"


def draw(seed, methods=METHODS):
    """Options of a run."""
    dice = random.Random(seed)
    name = dice.choice(sorted(CASES))
    bodies, transit, meeting, end = CASES[name]
    factor = 10 ** dice.uniform(-1, 3)
    step = float(f"{transit * factor:.4e}")
    options = [f"-options_file options/{name}.opts -time_start 0 -time_step {step} -time_end {max(min(end, meeting + STEPS * step), meeting + 5 * step)}"]
    options += [integrator(dice, body, step, factor <= LONGEST.get(name, 1000)) for body in bodies]
    method = dice.choice(methods)
    options.append(f"-contact_type {'schwarz' if method == 'lagrange' and factor > LONGEST.get(name, 1000) else method}")
    return " ".join(options)


def check(impakt, drawn, cuts, most=(EXCESS + ROUND_OFF, EXCESS + EXPLICIT_EXCESS)):
    """Of implicit bodies alone, and where one is explicit."""
    losses = []
    for options in drawn:
        run = impakt(f"{options} -controller_step_cuts {cuts}")
        summary = run.summary
        assert any(abs(run.history[f"contact/{pair}/impulse"][()]).max() > 0 for pair in run.history["contact"]), options  # they touch
        # rows that are built again in the step may bring what no force at its start takes away; all in all there is still room for it
        assert summary["schwarz"]["unlimited_steps"] == 0 or summary["schwarz"]["rebuilds"], options
        energies = sum(body[name][()] for body in run.history["body"].values() for name in ("kinetic", "potential"))
        gain = summary["system"]["energy_error_max"] * summary["system"]["energy_scale"]
        assert gain <= most["centraldifference" in options] * (energies[0] if energies[0] > 0 else energies.max()), options
        losses.append(-summary["system"]["energy_error_final"])
    assert statistics.median(losses) < (0.01 if cuts else 0.1)  # measured over half of the batches: 2.6e-3, and 3.8e-4 with cuts


def batch_of(size, number):
    return range(size * number, size * (number + 1))


QUICK, LONG = {(2, 4)}, {(0, 0), (1, 0), (2, 0), (0, 4), (5, 4)}  # batches of seeds, and how often a step may be cut in halves
REST = [case for case in itertools.product(range(25), (0, 4)) if case not in QUICK | LONG]


@pytest.mark.parametrize(("batch", "cuts"), [*sorted(QUICK), *long(*sorted(LONG)), *validate(*REST)])
def test_random_steps(impakt, batch, cuts):
    check(impakt, map(draw, batch_of(10, batch)), cuts)


@pytest.mark.parametrize("batch", [*long(0), *validate(3, 5, 12)])
def test_random_steps_of_the_augmented_lagrangian(impakt, batch):
    """Its rounds are extrapolated: without that each run of the stack, two of ten, ended with gaps that 200 rounds had not closed. The batches have eleven of these;
    in one Newton's full steps go round between sets of rows."""
    check(impakt, (draw(seed, ("augmented_lagrangian",)) for seed in batch_of(10, batch)), 0)


# The most that the energy of the beam and the block rises, and what it is off by at the end, at steps that do not resolve their contact
@pytest.mark.parametrize("step", [1e-3, 1e-4, *long(2e-4, 5e-5, 2e-5, 1e-5)])
def test_beam_hit(impakt, step):
    free = impakt(f"-options_file options/beam-hit.opts -time_step {step} -controller_step_cuts 0 -contact_energy_cap false -energy_guard 0").summary["system"]
    system = impakt(f"-options_file options/beam-hit.opts -time_step {step} -controller_step_cuts 0").summary["system"]
    if step > 1e-5:
        assert free["energy_error_max"] > 0.07  # measured: 1.6, 1.0, 0.79, 0.54, 0.099
    assert system["energy_error_max"] <= EXCESS + ROUND_OFF
    assert abs(system["energy_error_final"]) < 0.02  # measured: 9.9e-4, 3.1e-4, -4.4e-4, -1.0e-2, -1.0e-2, 6.9e-4


ROBIN = "schwarz -schwarz_transmission robin"  # where bodies make no substeps: with them forces in the course of the step are not those that it begins with
ALL_METHODS = ("schwarz", "penalty", "lagrange", "augmented_lagrangian")
BOTH = [(method, "beam block") for method in ALL_METHODS]


@pytest.mark.parametrize(("method", "explicit"), [*((method, "") for method in (*ALL_METHODS, ROBIN)), BOTH[0], *long(*BOTH[1:], ("schwarz", "beam"), ("lagrange", "block"))])
def test_methods_are_limited_alike(impakt, method, explicit):
    """Without any excess: what contact has lost is all that it may give back."""
    integrators = " ".join(f"-{body}_ts_type centraldifference -{body}_ts_time_step auto" for body in explicit.split())
    run = impakt(f"-options_file options/beam-hit.opts -time_step 1e-4 -contact_type {method} {integrators} -contact_energy_excess 0 -controller_step_cuts 0")
    assert 0 < run.summary["schwarz"]["limited_steps"] <= 10  # measured: 1 to 9
    assert run.summary["schwarz"]["unlimited_steps"] == 0
    assert run.summary["system"]["energy_error_max"] <= ROUND_OFF
    assert run.summary["system"]["energy_error_final"] > -0.1


def test_momentum_is_kept(impakt):
    """Both bodies start with the same other force: two blocks that fly into each other, at a step in which they cross a third of each other's length."""
    run = impakt("-options_file options/blocks.opts -time_step 1e-4 -time_end 3e-3 -controller_step_cuts 0")
    assert run.summary["schwarz"]["limited_steps"] > 0
    assert run.summary["system"]["momentum_error_max"] <= 1e-11  # measured: 8e-13
    assert run.summary["system"]["energy_error_max"] <= EXCESS + ROUND_OFF


# Of these bodies themselves: the trapezoidal rule keeps the energy of a nonlinear body to some order of the step only
OWN = 1e-4  # measured: 1e-5 at twenty transits


def draw_nonlinear(seed):
    """As draw(), from one to ten transits: at longer steps elements that hit each other at 100 m/s turn inside out, which ends the run with a message."""
    dice = random.Random(f"nonlinear {seed}")
    name = dice.choice(("beam-hit", "blocks"))
    bodies, transit, meeting, end = CASES[name]
    step = float(f"{transit * 10 ** dice.uniform(0, 1):.4e}")
    options = [f"-options_file options/{name}.opts -time_start 0 -time_step {step} -time_end {min(end, meeting + 100 * step)}"]
    for i, body in enumerate(bodies):
        if i == seed % 2 or dice.random() < 0.5:  # one of them at least
            options.append(f"-{body}_material_type neo_hookean")
        options.append(integrator(dice, body, step))
    options.append(f"-contact_type {dice.choice(METHODS)}")
    return " ".join(options)


@pytest.mark.parametrize("cuts", [0, 4])
@pytest.mark.parametrize("batch", [*long(4), *validate(0, 1, 2, 3, 5, 6, 7)])
def test_random_steps_of_nonlinear_bodies(impakt, batch, cuts):
    check(impakt, map(draw_nonlinear, batch_of(4, batch)), cuts, (EXCESS + OWN, EXCESS + OWN + EXPLICIT_EXCESS))


NONLINEAR = "-left_material_type neo_hookean -right_material_type neo_hookean -left_initial_velocity 10,0 -right_initial_velocity -10,0"


def test_nonlinear_bodies(impakt):
    """Their own integrator changes their energy by up to 1e-3 at such steps, and that is not the contact's."""
    run = impakt(f"-options_file options/blocks.opts {NONLINEAR} -time_step 1e-4 -time_end 2e-3 -controller_step_cuts 0")
    assert run.summary["system"]["energy_error_max"] <= 2 * EXCESS  # measured: 1.8e-4; without the cap 8.5 % and more
    assert run.summary["system"]["energy_error_final"] > -0.06  # measured: -5e-4


def test_two_ranks(impakt):
    one, two = (impakt("-options_file options/beam-hit.opts -time_step 1e-4 -controller_step_cuts 0", ranks=ranks).summary for ranks in (1, 2))
    assert two["schwarz"]["energy_attempts"] == one["schwarz"]["energy_attempts"] > 0
    # attempts are chosen by energies, so that round-off of these comes back as that of forces
    assert two["contact"]["force_peak"] == pytest.approx(one["contact"]["force_peak"], rel=1e-8)


def test_resolved_steps_stay_as_they_are(impakt):
    """Where steps resolve the contact, nothing is limited, and the bits are those of a run without the cap."""
    capped, free = (impakt(f"-options_file options/blocks.opts -time_end 3e-4 {more}").summary for more in ("", "-contact_energy_cap false"))
    assert capped["schwarz"]["limited_steps"] == 0
    for figure in ("energy_error_max", "energy_error_final"):
        assert capped["system"][figure] == free["system"][figure]


def test_guard(impakt):
    run = impakt("-options_file options/beam-hit.opts -time_step 1e-4 -contact_energy_cap false -controller_step_cuts 0", expect_failure=True)
    for word in ("The energy has grown by", "body 'b", "block.ymin:beam.ymax", "controller step", "-energy_guard"):
        assert word in run.stderr
    assert not (run.folder / "summary.json").exists()
    impakt("-options_file options/beam-hit.opts -time_step 1e-4 -contact_energy_cap false -controller_step_cuts 0 -energy_guard 2")


LUMPED = "-left_mass_redistribute false -right_mass_redistribute false -left_mass_type lumped -right_mass_type lumped"


@pytest.mark.parametrize("choice", ["-schwarz_transmission robin", "-schwarz_transmission impedance", "-contact_type lagrange"])
def test_unstable_choices_are_refused(impakt, choice):
    run = impakt(f"-options_file options/bars-high-speed.opts {LUMPED} {choice}", expect_failure=True)
    assert choice.split()[0] in run.stderr and "-contact_allow_unstable true" in run.stderr
    impakt(f"-options_file options/bars-high-speed.opts {LUMPED} {choice} -time_end -1.99e-4 -contact_allow_unstable true")


def test_guard_where_a_load_sets_in_at_zero(impakt):
    """All rests, and after the first explicit step so does the displacement: the staggered kinetic energy is the round-off of two equal numbers, which was
    taken for a gain of 100 %."""
    steel = "-{0}_dm_plex_dim 2 -{0}_dm_plex_box_faces 10,10 -{0}_density 7800 -{0}_youngs_modulus 2e11 -{0}_poissons_ratio 0.3 -{0}_ts_type centraldifference"
    blocks = " ".join(["-bodies a,b -contact_pairs a:b", *(steel.format(body) for body in "ab"), "-b_dm_plex_box_lower 1.001,0 -b_dm_plex_box_upper 2.001,1"])
    run = impakt(f"{blocks} -a_boundary_traction xmin -a_boundary_traction_xmin 1e11*t,0 -time_step 5e-6 -time_end 1e-4")
    assert run.history["body/a/kinetic"][-1] > 10
    assert abs(run.summary["system"]["energy_error_max"]) <= 1e-14  # measured: 3e-16
