"""Sentences of the paper's text, each with the check of it, and a reason where our runs differ and one was found by experiment."""

from collections.abc import Callable
from dataclasses import dataclass

from . import checks
from .checks import NO, YES
from .results import NoResult


@dataclass(frozen=True)
class Claim:
    where: str  # section of the paper
    text: str  # what it says
    check: Callable  # of the results: what was measured, verdict
    reason: str = ""


TEXTBOOK = (
    "Ours are textbook implementations. The penalty springs hold F²/(2τ) = 0.067 J while the bars press, 2.7 % of the 2.5 J, and give it back at release; "
    "the multiplier stops the contact nodes, 1/400 of each bar's mass, at once: 0.25 %. What makes the published ones lose more is not stated in the paper; nothing was tuned to find out."
)

CLAIMS = (
    Claim(
        "4.4.1",
        "Both penalty methods overpredict the contact position between impact and release; Schwarz does not, its oscillations are tiny",
        checks.overclosure,
    ),
    Claim(
        "4.4.1",
        "All three conventional methods underpredict the release time",
        checks.release_of_conventional,
        "A spring that has to unload first lets go later, not earlier; the low-speed runs show the same (figure 4.2).",
    ),
    Claim(
        "4.4.1",
        "Schwarz has the release time to about 0.01 %",
        checks.release_of_schwarz,
        "Our figure is the end of the last step in contact, relative to the time in contact. It shrinks with the mesh, as the front of the reflected wave is smeared over a few elements by dispersion.",
    ),
    Claim(
        "4.4.1",
        "Schwarz has the mass-averaged velocity more accurately than any conventional method",
        checks.better("errors.mean_velocity"),
    ),
    Claim(
        "4.4.1", "Schwarz has the kinetic energy more accurately than any conventional method", checks.better("errors.kinetic")
    ),
    Claim(
        "4.4.1",
        "Of the Schwarz variants, Implicit-Implicit has the most accurate kinetic energy",
        checks.kinetic_order,
        "They differ by 10 %. Section 4.4.2 of the paper itself has Explicit-Explicit as the most accurate.",
    ),
    Claim(
        "4.4.1",
        "The conventional methods underpredict the peak potential energy by about 10 %",
        checks.peak_of_conventional,
        TEXTBOOK,
    ),
    Claim(
        "4.4.1",
        "Schwarz has the peak potential energy to less than 0.1 %",
        checks.peak_of_schwarz,
        "The chatter is still on it, and it shrinks with the mesh.",
    ),
    Claim(
        "4.4.1",
        "The total energy error of the left bar is negative for all six methods",
        checks.never_gains,
        "What one bar gains for a moment the other loses: they exchange energy through the chattering contact nodes.",
    ),
    Claim(
        "4.4.1",
        "The conventional methods lose up to 9 % of the total energy; explicit penalty most, then implicit penalty, then Lagrange",
        checks.loss_of_conventional,
        TEXTBOOK,
    ),
    Claim(
        "4.4.1",
        "Schwarz: at most 0.25 % total energy error (left bar)",
        checks.loss_of_schwarz,
        "The figure fits the system of both bars. The left bar alone shows more, since the bars exchange energy while they chatter.",
    ),
    Claim(
        "4.4.1",
        "Explicit-Explicit is the most accurate in energy, then Implicit-Implicit, then Implicit-Explicit",
        checks.energy_order,
        "Implicit-Explicit loses most if the traction is held constant over its substeps; between the other two there is little.",
    ),
    Claim("4.4.1", "Conventional methods: the contact force is smooth while the bars touch", checks.smooth_forces),
    Claim(
        "4.4.1",
        "Lagrange multiplier: the contact force overshoots at impact",
        checks.overshoot,
        "The contact nodes are brought to rest within one step: m v / Δt, with m half an element's mass.",
    ),
    Claim(
        "4.4.1",
        "Schwarz: the contact force oscillates",
        checks.chatter,
        "The contact nodes have mass, and swing on their elements about the place of the common interface. Without that mass (redistributed) they do not.",
    ),
    Claim(
        "4.4.1",
        "Contact is lost and found again, sometimes many times",
        checks.onsets,
        "While the wave is under way the force swings between 62 and 140 N, and does not come near zero (figure 4.8).",
    ),
    Claim("4.4.1", "The oscillations do not depend on the Schwarz tolerances", checks.tolerance),
    Claim(
        "4.4.1",
        "Implicit-Explicit has much less chatter",
        checks.mixed_chatter,
        "It depends on what happens to the traction between the ends of a controller step. Linear in time, all three are alike; held constant over the substeps, which is less accurate, the chatter of Implicit-Explicit nearly vanishes, as in the paper. Swapping the sides in every step makes it a fifth.",
    ),
    Claim(
        "4.4.1",
        "Dissipation is needed for lasting contact; the method that loses most chatters least",
        checks.dissipation,
        "Enough dissipation does quiet the chatter, at the price of energy. It is not needed where the contact nodes have no mass.",
    ),
    Claim("4.4.2", "The kinetic energy converges with the mesh, for all three", checks.converges),
    Claim(
        "4.4.2",
        "Rate about 0.82",
        checks.rates,
        "The points do not lie on a line: from mesh to mesh the rates are 1.17, 0.38 and 0.7, so that a fit says little.",
    ),
    Claim("4.4.2", "Explicit-Explicit is the most accurate, by a very small margin", checks.most_accurate),
    Claim(
        "4.4.2",
        "Implicit-Explicit, N_x = 400: oscillations that grow from contact to release",
        checks.growing,
        "Not found in any reading that we tried.",
    ),
    Claim("4.4.2", "Between two and five iterations in a step (N_x = 200, 1e-7 s)", checks.sweeps),
    Claim("4.4.2", "Explicit-Explicit needs the fewest at this resolution", checks.fewest),
    Claim("4.4.2", "No iterations before and after contact", checks.none_outside),
    Claim(
        "4.4.2",
        "More iterations on finer meshes",
        checks.finer_needs_more,
        "The gain of the plain alternation is about (c ΔT / h)² / 2.",
    ),
    Claim(
        "4.4.2",
        "The time step matters little, but for Explicit-Explicit from 1e-7 to 1e-8 s",
        checks.step_matters_little,
        "So with a controller step of 1e-7 s throughout, as section 4.4 has it; the gain depends on that step. If the controller's step shrinks too, the counts fall to three.",
    ),
    Claim(
        "5",
        "Slight dissipation or relaxation can mend the oscillations: relaxation",
        checks.relaxation,
        "Relaxation changes the way to the solution of a step, not that solution.",
    ),
)


def judge(claim, results):
    """What was measured, and the verdict; that it could not be measured is one too."""
    try:
        return claim.check(results)
    except NoResult as error:
        return f"not measured ({error})", "–"


def rows(results):
    """Where, what, measured, verdict, reason: texts."""
    for claim in CLAIMS:
        measured, found = judge(claim, results)
        yield [claim.where, claim.text, measured, f"**{found}**" if found == NO else found, claim.reason if found != YES else ""]
