"""The tables of the report, in Markdown: 4.3 and 4.4 beside the published ones, and those of methods, sensitivity and variants."""

from .experiments import MESHES, PAIRINGS
from .published import TABLE_4_3, TABLE_4_4
from .results import NoResult, convergence_rate

SHORT = {"ii": "II", "ie": "IE", "ee": "EE"}


def table(head, rows):
    """Markdown of cells that are text already."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def number(value, digits=3):
    """A figure as a reader wants it: 0.00523, 1.3e-6, and no sign or digits where there is nothing."""
    if value is None:
        return "–"
    if isinstance(value, int):
        return str(value)
    if value == 0:
        return "0"
    if 1e-3 <= abs(value) < 1e4:
        text = f"{value:.{digits}g}"
        return text if "e" not in text else f"{value:.0f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def percent(value, digits=3):
    return f"{number(100 * value, digits)} %"


def cells_of(result, count, make):
    """make(result), or one cell that says that the run failed."""
    try:
        return make(result)
    except NoResult:
        return ["failed"] + ["–"] * (count - 1)


def iterations(result):
    """max/mean, as the paper writes it: the mean over all steps; and over those in contact."""
    made = cells_of(
        result,
        1,
        lambda one: [
            f"{one.figure('schwarz.max')}/{one.figure('schwarz.mean_all_steps'):.4f} ({one.figure('schwarz.mean_contact_steps'):.3f})"
        ],
    )
    return made[0]


def iteration_table(results, first, published, ours):
    """Rows of the paper's table: `ours` maps a row and a pairing to the names of the experiments of both readings."""
    head = [first] + [f"{SHORT[pairing]}: {which}" for pairing in PAIRINGS for which in ("paper", "ours", "ours, ΔT = Δt")]
    rows = []
    for row, values in published.items():
        cells = []
        for pairing, value in zip(PAIRINGS, values):
            cells += [value, *(iterations(results[name]) if name else "–" for name in ours(row, pairing))]
        rows.append([row, *cells])
    return table(head, rows)


def names_4_3(elements, pairing):
    return f"mesh/{pairing}-{elements}", f"one-step/{pairing}-{elements}"


def table_4_3(results):
    return iteration_table(results, "N_x", TABLE_4_3, names_4_3)


def names_4_4(step, pairing):
    if step == "1e-7":
        return f"high-speed/{pairing}", "one-step/ie-1e-7" if pairing == "ie" else None
    if step == "1e-8":
        return f"mesh/{pairing}-200", f"one-step/{pairing}-200"
    return f"time-step/{pairing}-1e-9", f"one-step/{pairing}-1e-9"


def table_4_4(results):
    return iteration_table(results, "Δt [s]", TABLE_4_4, names_4_4)


def matches(results, published, ours):
    """Greatest counts that are the paper's, of both readings, and how many there are: [n, n of the other reading], [of, of]."""
    same, count = [0, 0], [0, 0]
    for row, values in published.items():
        for pairing, value in zip(PAIRINGS, values):
            for reading, name in enumerate(ours(row, pairing)):
                if name:
                    count[reading] += 1
                    same[reading] += results[name].figure("schwarz.max") == int(value.split("/")[0])
    return same, count


def agreement(results):
    """A sentence for each table on the greatest counts."""
    texts = []
    for title, published, ours in (("4.3", TABLE_4_3, names_4_3), ("4.4", TABLE_4_4, names_4_4)):
        same, count = matches(results, published, ours)
        texts.append(
            f"Of the greatest counts of table {title}, {same[0]} of {count[0]} are the paper's with the first reading, and {same[1]} of {count[1]} with ΔT = Δt."
        )
    return " ".join(texts)


def convergence(results):
    rows = []
    for folder, reading in (("mesh", "10⁻⁷ s"), ("one-step", "10⁻⁸ s")):
        for pairing, text in PAIRINGS.items():
            errors = [results[f"{folder}/{pairing}-{elements}"].figure("errors.kinetic") for elements in MESHES]
            pairs = [convergence_rate(MESHES[i : i + 2], errors[i : i + 2]) for i in range(len(MESHES) - 1)]
            rows.append(
                [
                    reading,
                    text,
                    *(number(error, 4) for error in errors),
                    ", ".join(f"{rate:.2f}" for rate in pairs),
                    f"{convergence_rate(MESHES, errors):.2f}",
                ]
            )
    return table(
        ["controller step", "coupling", *(f"N_x = {elements}" for elements in MESHES), "rates from mesh to mesh", "fitted rate"],
        rows,
    )


# head of a column: cell of a result
COLUMNS = {
    "iterations, max": lambda one: number(one.figure("schwarz.max")),
    "mean, all steps": lambda one: f"{one.figure('schwarz.mean_all_steps'):.4f}",
    "mean in contact": lambda one: f"{one.figure('schwarz.mean_contact_steps'):.3f}",
    "onsets": lambda one: number(one.figure("contact.onsets")),
    "force std/mean": lambda one: number(one.figure("force_scatter"), 2),
    "system energy error, min": lambda one: number(one.figure("system.energy_error_min"), 2),
    "max": lambda one: number(one.figure("system.energy_error_max"), 2),
    "final": lambda one: number(one.figure("system.energy_error_final"), 2),
    "left bar, min": lambda one: number(one.figure("bodies.left.total_energy_error_min"), 2),
    "left bar, max": lambda one: number(one.figure("bodies.left.total_energy_error_max"), 2),
    "kinetic": lambda one: number(one.figure("errors.kinetic")),
    "position": lambda one: number(one.figure("errors.contact_position")),
    "peak potential": lambda one: number(one.figure("errors.peak_potential")),
    "release": lambda one: number(one.figure("errors.release_time"), 2),
    "momentum error": lambda one: number(one.figure("system.momentum_error_max"), 2),
    "kinetic, worst bar": lambda one: number(worst(one, "kinetic")),
    "potential, worst bar": lambda one: number(worst(one, "potential")),
    "wall [s]": lambda one: f"{one.figure('timing.wall'):.2f}",
}
METHODS = (
    "onsets",
    "force std/mean",
    "system energy error, min",
    "max",
    "final",
    "left bar, min",
    "left bar, max",
    "kinetic",
    "position",
    "peak potential",
    "release",
    "wall [s]",
)
SENSITIVITY = ("iterations, max", "mean, all steps", "mean in contact", "onsets", "force std/mean", "system energy error, min")
VARIANTS = (
    "iterations, max",
    "mean in contact",
    "onsets",
    "force std/mean",
    "system energy error, min",
    "max",
    "kinetic",
    "position",
    "release",
    "wall [s]",
)

CASES = (
    "iterations, max",
    "mean in contact",
    "onsets",
    "system energy error, min",
    "max",
    "momentum error",
    "kinetic, worst bar",
    "potential, worst bar",
    "wall [s]",
)


def worst(one, quantity):
    """Of the errors of all bodies that the summary knows."""
    bodies = one.summary.get("errors", {}).get("bodies", {})
    return max((body[quantity] for body in bodies.values()), default=None)


def compare(results, experiments, columns, first):
    """A row for each experiment; `first` names the leading cells: (heads, function of an experiment)."""
    heads, lead = first
    rows = [
        [*lead(name), *cells_of(results[name], len(columns), lambda one: [COLUMNS[column](one) for column in columns])]
        for name in experiments
    ]
    return table([*heads, *columns], rows)


# Variants in the order in which they are told; names begin with these words, others follow by name
ORDER = (
    "default", "moving", "inside", "theta", "aitken", "anderson", "ngmres", "qn", "newton",
    "predictor", "robin", "impedance", "radius", "newmark", "reaction", "naive", "stabilized", "gap", "mass", "redistributed",
    "grazing", "two", "cradle", "substeps", "lagrange", "augmented", "penalty", "swap", "sides", "convergence", "atol", "waveform",
)  # fmt: skip


def place(variant):
    return next((at for at, word in enumerate(ORDER) if variant.startswith(word)), len(ORDER)), variant


def by_variant(results, group):
    """Experiments of a group in the order above, the pairings of each variant together."""
    found = [experiment for experiment in results.experiments.values() if experiment.group == group]
    order = [*PAIRINGS, None]
    return [experiment.name for experiment in sorted(found, key=lambda one: (place(one.variant), order.index(one.pairing)))]


def titled(results):
    def lead(name):
        experiment = results.experiments[name]
        return "as in the paper, nothing changed" if experiment.group == "high-speed" else experiment.title, SHORT.get(
            experiment.pairing, "–"
        )

    return ("what is changed", "coupling"), lead
