"""The report, in Markdown: figures, tables, claims and variants, with a few words to each."""

from . import claims, figures, tables
from .experiments import HIGH_SPEED
from .results import NoResult

INTRODUCTION = """# The paper reproduced

J. Hoy, I. Tezaur, A. Mota, *The Schwarz alternating method for multiscale contact mechanics*: its figures, tables and
statements beside runs of Impakt. Every number below comes from the history or summary of a run; the options of a run are the
file of its name under `options/paper/`, and `make paper` makes this report. Published values stand beside ours and were not
used to choose anything. II, IE and EE are Implicit-Implicit, Implicit-Explicit and Explicit-Explicit coupling; errors are
relative, those of series L2 in time.
"""

TABLES = """The paper's figures are maximum/average. Ours are the same, and in brackets the average over the steps in contact.
The paper's average is that over **all** steps: it has 1.2532 for EE where each step in contact needs at least two.

Two readings are possible. Section 4.4 says that "for all the Schwarz methods considered, a controller time-step of ΔT = 1.0 ×
10⁻⁷ is employed", and section 4.4.2 that Δt is 10⁻⁸ s "in both subdomains": both bars then make ten substeps in each controller
step, and a hundred with Δt = 10⁻⁹ s. That is the first reading below, and the one of figures 4.10 to 4.13(a). In the other, ΔT
= Δt (the row of 10⁻⁷ s: for IE without substeps). The plain alternation contracts by about (c ΔT / h)² / 2 in each sweep, so
with a controller step of 10⁻⁸ s it has to need less.
"""

AVERAGES = """The averages come out up to a third larger than the published ones. They depend on details that the paper does not
state: on the start value of each step, the norm, and on whether the traction is linear or constant over substeps; the section
on sensitivity has them.
"""

SENSITIVITY = """The same three runs (N_x = 200, ΔT = 1e-7 s), each with one thing changed that the paper does not state, or
states otherwise. The first rows are the runs of the paper as we read it. The published averages are 2.447, 1.8768 and 1.2532.
No combination that we tried gives all three.
"""

START_VALUES = [
    f"variants/paper/{what}-{pairing}"
    for what in ("predictor-inelastic", "swap-sides")
    for pairing in tables.SHORT
]
START_VALUES.append("variants/paper/waveform-constant-ie")

VARIANTS = """High-speed impact, N_x = 200, ΔT = 1e-7 s; IE with ten explicit substeps. Wall times are of runs of which several
shared the machine. Energy errors are of the system, relative to its initial energy; 'onsets' counts how often contact begins.
As the paper has it the impact is symmetric, and where contact is quiet the trace of the step before is the solution already,
whatever the outer iteration. In a frame that moves it is not (there kinetic errors are relative to a larger energy): the rows
of outer iterations in a moving frame start from that trace, and tell what each costs. The default start value, the common
velocity of an inelastic collision, finds the solution there too as long as both bars make the same substeps.
"""

CASES = """Bars of unequal length and material, rows of bars, and other ratios of substeps, by the defaults unless a row says
otherwise. 'onsets' counts how often contact comes out of none, of any pair. The kinetic and potential errors are against the exact solution by characteristics
(`-exact characteristics`), of the bar that has the larger one. In the grazing impact both contact faces fly side by side after
5e-4 s, gap and force zero: nothing but round-off decides whether they touch.
"""

RECOMMENDATION = """Take the mass off the contact nodes (`-<body>_mass_redistribute true`, the default): of all that was tried
it alone removes chatter and energy loss together in every coupling (handing over tractions with the inertia of the contact
nodes does so between implicit bars), and whatever closes the gap then (Schwarz, multipliers, augmented Lagrangian, a stiff
penalty) finds the same solution. With averaged mass (`-<body>_mass_type averaged`, the default) the errors of kinetic energy
and position are a quarter of those with lumped mass, at no cost. Solve the interface by the contact step (`-contact_type
schwarz`, the default): two passes over the bodies in each step, no parameter, and each body is solved with its own
integrator and step.
"""


def picture(number, failed):
    caption = f"Figure {number}. {figures.FIGURES[number][1]}."
    if number in failed:
        return f"*{caption}* Not drawn: {failed[number]}\n"
    name = figures.file_of(number)
    return f"![{caption}](figures/{name}.png)\n\n*{caption}* ([PDF](figures/{name}.pdf))\n"


def or_failed(make, *arguments):
    try:
        return make(*arguments)
    except NoResult as error:
        return f"Not made: {error}"


def variant_tables(results):
    parts = []
    for group, head in VARIANT_GROUPS.items():
        names = tables.by_variant(results, group)
        if names:
            parts.append(f"### {head}\n\n{tables.compare(results, names, tables.VARIANTS, tables.titled(results))}\n")
    names = [name for name in HIGH_SPEED if name in results.experiments]
    lead = (("method",), lambda name: (HIGH_SPEED[name],))
    parts.insert(0, f"### The paper's methods\n\n{tables.compare(results, names, tables.VARIANTS, lead)}\n")
    return "\n".join(parts)


VARIANT_GROUPS = {
    "variants/paper": "The paper's Schwarz method with one thing changed",
    "variants/default": "Impakt's default with one thing changed",
    "variants/conventional": "Conventional methods with one thing changed",
}


def failures(results):
    failed = {name: results[name].error for name in results.experiments if results[name].error}
    if not failed:
        return ""
    return (
        "## Runs that failed\n\n"
        + tables.table(["run", "error"], [[f"`{name}`", error.replace("|", "\\|")] for name, error in failed.items()])
        + "\n"
    )


def report(results, failed=()):
    """The whole text. `failed`: figures that could not be drawn, and why."""
    failed = dict(failed)
    pictures = "\n".join(picture(number, failed) for number in figures.FIGURES)
    methods = (("method",), lambda name: (HIGH_SPEED[name],))
    agreement = tables.table(
        ["section", "the paper says", "measured", "verdict", "reason, where it differs"], claims.rows(results)
    )
    changed = [*(f"high-speed/{pairing}" for pairing in tables.SHORT), *START_VALUES, *tables.by_variant(results, "sensitivity")]
    changed = [name for name in changed if name in results.experiments]
    lead = ("case", "coupling"), tables.titled(results)[1]
    cases = tables.compare(results, tables.by_variant(results, "cases"), tables.CASES, lead)
    parts = [
        INTRODUCTION,
        failures(results),
        f"## What agrees, and what does not\n\n{agreement}\n",
        f"## Figures\n\n{pictures}",
        f"## The six methods in figures\n\n{or_failed(tables.compare, results, HIGH_SPEED, tables.METHODS, methods)}\n",
        f"## Convergence of the kinetic energy (figure 4.13(a))\n\nThe paper has a rate of about 0.82 for all three.\n\n{or_failed(tables.convergence, results)}\n",
        f"## Iterations (tables 4.3 and 4.4)\n\n{TABLES}\n{or_failed(tables.agreement, results)} {AVERAGES}\n\n### Table 4.3\n\n{or_failed(tables.table_4_3, results)}\n\n### Table 4.4\n\n{or_failed(tables.table_4_4, results)}\n",
        f"## Sensitivity of the iterations\n\n{SENSITIVITY}\n{tables.compare(results, changed, tables.SENSITIVITY, tables.titled(results))}\n",
        f"## Variants\n\n{VARIANTS}\n{variant_tables(results)}\n## Beyond two equal bars\n\n{CASES}\n{cases}\n\n## Recommendation\n\n{RECOMMENDATION}",
    ]
    return "\n".join(filter(None, parts))
