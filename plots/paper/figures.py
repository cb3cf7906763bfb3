"""The figures of the paper, 4.2 to 4.13, drawn from histories; each with the exact solution where there is one."""

import matplotlib
import numpy as np
from figures import BLACK, BLUE, GREEN, ORANGE, PURPLE
from matplotlib.figure import Figure

from .experiments import HIGH_SPEED, MESHES, PAIRINGS
from .results import Result, convergence_rate

STYLE = {
    "font.size": 9,
    "axes.titlesize": 10,
    "lines.linewidth": 1.3,
    "axes.axisbelow": True,
    "legend.fontsize": 8,
    "pdf.compression": 9,
}
EXACT = {"color": BLACK, "linestyle": (0, (1, 1.5)), "linewidth": 1.6, "zorder": 5}
# Told apart by colour, by dashes and, printed grey, by lightness
LINES = {
    "ii": {"color": BLUE, "linestyle": "-"},
    "ie": {"color": ORANGE, "linestyle": (0, (5, 1.5))},
    "ee": {"color": GREEN, "linestyle": (0, (4, 1.5, 1, 1.5))},
    "lagrange": {"color": PURPLE, "linestyle": "-"},
    "penalty-implicit": {"color": "#56B4E9", "linestyle": "-", "linewidth": 2.4},
    "penalty-explicit": {"color": "#7A5C00", "linestyle": (0, (5, 3))},
    "penalty": {"color": "#7A5C00", "linestyle": (0, (5, 2))},
}
MESH_LINES = dict(
    zip(
        MESHES,
        (
            {"color": "#8FBFE0"},
            {"color": "#E0A030", "linestyle": (0, (6, 1))},
            {"color": "#C04080", "linestyle": (0, (4, 1, 1, 1))},
            {"color": "#103060"},
        ),
    )
)
MICRO = 1e6
BINS = 3000  # of a series that has more values than can be seen: least and largest of each bin are drawn


def thin(time, *series):
    """Series of many values as an envelope: all that a line of them would cover is covered, at a hundredth of the points."""
    if len(time) <= 4 * BINS:
        return time, *series
    size = -(-len(time) // BINS)
    keep = np.zeros(len(time), dtype=bool)
    for values in series:
        for begin in range(0, len(time), size):
            part = values[begin : begin + size]
            keep[[begin + part.argmin(), begin + part.argmax()]] = True
    return time[keep], *(values[keep] for values in series)


def plot(axes, time, values, factor=1.0, **style):
    time, values = thin(time, values)
    axes.plot(MICRO * time, factor * values, **style)


def panels(rows=1, columns=1, size=(5.2, 3.4), **more):
    figure = Figure(figsize=(columns * size[0], rows * size[1]), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **more)
    for one in axes.flat:
        one.grid(color="0.9", linewidth=0.6)
        one.margins(x=0.01)
    return figure, axes


def label(axes, quantity, title=None, legend=None, time="time [µs]"):
    axes.set_xlabel(time)
    axes.set_ylabel(quantity)
    if title:
        axes.set_title(title)
    if legend:
        axes.legend(loc=legend, framealpha=0.9, edgecolor="0.8")


def style_of(name):
    return LINES[name.rpartition("/")[2]]


def draw_methods(axes, results, names, values, factor=1.0, exact=None):
    """A curve for each experiment of `names` (name: label); `values` takes a result and returns the series."""
    for name, text in names.items():
        plot(axes, results[name].time, values(results[name]), factor, label=text, **style_of(name))
    if exact:
        result = results[next(iter(names))]
        plot(axes, result.time, result.exact(exact), factor, label="exact", **EXACT)


CONVENTIONAL = {name: text for name, text in HIGH_SPEED.items() if "Schwarz" not in text}
SCHWARZ = {name: text for name, text in HIGH_SPEED.items() if "Schwarz" in text}


def low_speed(results):
    names = {"low-speed/lagrange": "Lagrange multiplier", "low-speed/penalty": "penalty"}
    figure, axes = panels(1, 3, (3.9, 3.3))
    drawn = (
        ("contact_position", lambda result: result.left("contact_position"), 1e3, "contact position [mm]"),
        ("contact_velocity", Result.contact_velocity, 1, "contact velocity [m/s]"),
    )
    for one, (quantity, read, factor, text) in zip(axes[0], drawn):
        draw_methods(one, results, names, read, factor, quantity)
        label(one, text)
    draw_methods(axes[0, 2], results, names, lambda result: result.force, 1e-3, "force")
    label(axes[0, 2], "contact force [kN]")
    axes[0, 0].legend(loc="lower left", framealpha=0.9, edgecolor="0.8")
    return figure


def contact_position(results):
    figure, axes = panels(1, 3, (4.2, 3.4))
    for one in axes[0, :2]:
        draw_methods(one, results, HIGH_SPEED, lambda result: result.left("contact_position"), 1e3, "contact_position")
    label(axes[0, 0], "contact position [mm]", "whole run", "lower center")
    axes[0, 1].set(xlim=(-20, 560), ylim=(-1.0, 0.9))
    label(axes[0, 1], "contact position [mm]", "while the bars touch")
    close = {"high-speed/lagrange": HIGH_SPEED["high-speed/lagrange"], **SCHWARZ}
    draw_methods(axes[0, 2], results, close, lambda result: result.left("contact_position"), 1e6, "contact_position")
    axes[0, 2].set(xlim=(200, 212), ylim=(-80, 20))
    label(axes[0, 2], "contact position [µm]", "120 steps of that, without penalty")
    return figure


def both_and_release(results, quantity, factor, text, near):
    """The whole run, and the part of it around the release; `near` is x limits, y limits."""
    figure, axes = panels(1, 2)
    for one in axes[0]:
        draw_methods(one, results, HIGH_SPEED, lambda result: result.left(quantity), factor, quantity)
    label(axes[0, 0], text, "whole run", "best")
    axes[0, 1].set(xlim=near[1], ylim=near[2])
    label(axes[0, 1], text, near[0])
    return figure


def mean_velocity(results):
    return both_and_release(
        results, "mean_velocity", 1, "mass-averaged velocity [m/s]", ("around the release", (430, 570), (-103, -70))
    )


def kinetic(results):
    return both_and_release(results, "kinetic", 1, "kinetic energy [J]", ("around the release", (430, 570), (1.0, 1.27)))


def potential(results):
    return both_and_release(results, "potential", 1, "potential energy [J]", ("around the peak", (200, 300), (1.0, 1.27)))


def energy_error(results):
    figure, axes = panels(2, 4, (3.3, 3.1))
    for row, system in enumerate((False, True)):
        who = "system" if system else "left bar"
        draw_methods(axes[row, 0], results, CONVENTIONAL, lambda result, both=system: result.energy_error(both), 100)
        label(axes[row, 0], "total energy error [%]", f"{who}: conventional methods")
        for one, (name, text) in zip(axes[row, 1:], SCHWARZ.items()):
            draw_methods(one, results, {name: None}, lambda result, both=system: result.energy_error(both), 100)
            one.axhline(-0.25, color="0.3", linewidth=1, linestyle="--", zorder=6)
            one.set_ylim(-0.56, 0.13)
            label(one, "total energy error [%]", f"{who}: {text}")
    for one in axes.flat:
        one.axhline(0, label="exact", **EXACT)
    axes[0, 0].legend(loc="center", framealpha=0.9, edgecolor="0.8")
    axes[1, 1].annotate(
        "at most 0.25 %, as the paper says",
        (300, -0.25),
        (0, -4),
        textcoords="offset points",
        ha="center",
        va="top",
        color="0.25",
        fontsize=8,
    )
    return figure


def conventional_and_schwarz(results, values, exact, text, limits, zoom):
    """(a) conventional methods, (b) each Schwarz variant for itself, since one would hide the other; below, some steps of these."""
    figure = Figure(figsize=(11, 9), layout="constrained")
    grid = figure.add_gridspec(3, 3, height_ratios=(1.2, 1, 1))
    top = figure.add_subplot(grid[0, :])
    draw_methods(top, results, CONVENTIONAL, values, 1, exact)
    top.set_ylim(limits[0])
    label(top, text, "(a) conventional methods", "best")
    beyond = max(values(results[name]).max() for name in CONVENTIONAL)
    if beyond > limits[0][1]:
        top.annotate(
            f"first step of the Lagrange multiplier: {beyond:.0f}",
            (2, limits[0][1]),
            (6, -6),
            textcoords="offset points",
            va="top",
            color="0.25",
            fontsize=8,
        )
    for column, (name, title) in enumerate(SCHWARZ.items()):
        for row, span in ((1, None), (2, zoom)):
            axes = figure.add_subplot(grid[row, column])
            result = results[name]
            inside = slice(None) if span is None else (result.time >= span[0]) & (result.time <= span[1])
            plot(
                axes,
                result.time[inside],
                values(result)[inside],
                linewidth=0.4 if span is None else 1,
                marker=None if span is None else ".",
                markersize=4,
                color=style_of(name)["color"],
            )
            plot(axes, result.time[inside], result.exact(exact)[inside], **EXACT)
            axes.set_ylim(limits[1])
            label(axes, text, f"(b) {title}" if span is None else f"{title}: 40 steps of it")
    for axes in figure.axes:
        axes.grid(color="0.9", linewidth=0.6)
        axes.margins(x=0.01)
    return figure


def contact_force(results):
    return conventional_and_schwarz(
        results, lambda result: result.force, "force", "contact force [N]", ((-15, 320), (-50, 160)), (200e-6, 204e-6)
    )


def contact_velocity(results):
    return conventional_and_schwarz(
        results,
        Result.contact_velocity,
        "contact_velocity",
        "contact velocity [m/s]",
        ((-165, 115), (-190, 115)),
        (200e-6, 204e-6),
    )


def held_traction(results):
    names = {"high-speed/ie": "linear over the controller step", "variants/paper/waveform-constant-ie": "constant over it"}
    looks = ({"color": "#E8A878", "linewidth": 0.8}, {"color": "#103060", "linewidth": 1.2})
    figure, axes = panels(1, 3, (4, 3.2))
    quantities = (
        (lambda result: result.force, "contact force [N]", "force"),
        (lambda result: result.left("contact_velocity"), "contact velocity [m/s]", "contact_velocity"),
    )
    for one, (values, text, exact) in zip(axes[0], quantities):
        for (name, held), look in zip(names.items(), looks):
            plot(one, results[name].time, values(results[name]), label=f"traction {held}", **look)
        plot(one, results[name].time, results[name].exact(exact), label="exact", **EXACT)
        label(one, text)
    for (name, _), look in zip(names.items(), looks):
        plot(axes[0, 2], results[name].time, results[name].energy_error(True), 100, **look)
    axes[0, 2].axhline(0, **EXACT)
    label(axes[0, 2], "system energy error [%]")
    axes[0, 0].legend(loc="lower center", framealpha=0.9, edgecolor="0.8")
    return figure


def mesh_study(results, pairing):
    figure, axes = panels(1, 2)
    for one in axes[0]:
        for elements in MESHES:
            result = results[f"mesh/{pairing}-{elements}"]
            plot(one, result.time, result.left("kinetic"), label=f"$N_x$ = {elements}", **MESH_LINES[elements])
        plot(one, result.time, result.exact("kinetic"), label="exact", **EXACT)
    label(axes[0, 0], "kinetic energy [J]", "whole run", "lower left")
    axes[0, 1].set(xlim=(440, 560), ylim=(1.1, 1.27))
    label(axes[0, 1], "kinetic energy [J]", "around the release")
    return figure


def convergence(results):
    figure, axes = panels(1, 1, (5.6, 3.8))
    for pairing, text in PAIRINGS.items():
        errors = [results[f"mesh/{pairing}-{elements}"].figure("errors.kinetic") for elements in MESHES]
        order = convergence_rate(MESHES, errors)
        axes[0, 0].loglog(
            MESHES, errors, marker={"ii": "o", "ie": "s", "ee": "^"}[pairing], label=f"{text}: rate {order:.2f}", **LINES[pairing]
        )
    slope = errors[0] * 1.25 * (np.array(MESHES) / MESHES[0]) ** -0.82
    axes[0, 0].loglog(MESHES, slope, color="0.4", linewidth=1, linestyle=":", label="slope of the paper, 0.82")
    axes[0, 0].set_xticks(MESHES, [str(elements) for elements in MESHES])
    axes[0, 0].set_yticks([0.003, 0.005, 0.01, 0.02], ["0.003", "0.005", "0.01", "0.02"])
    axes[0, 0].minorticks_off()
    axes[0, 0].grid(which="both", color="0.9", linewidth=0.6)
    label(axes[0, 0], "kinetic energy: relative $L_2$ error in time [1]", None, "best", "elements in each bar $N_x$ [1]")
    return figure


def iterations(results):
    figure, axes = panels(1, 3, (3.8, 2.9), sharey=True)
    for one, (pairing, text) in zip(axes[0], PAIRINGS.items()):
        result = results[f"high-speed/{pairing}"]
        one.plot(
            MICRO * result.time,
            result.sweeps,
            linestyle="none",
            marker=".",
            markersize=2.5,
            color=LINES[pairing]["color"],
            rasterized=True,
        )
        one.set_ylim(-0.3, 6.3)
        label(one, "iterations in a step [1]", text)
    return figure


# number in the paper: file name, caption, function
FIGURES = {
    "4.2": (
        "low-speed",
        "Low-speed impact: contact position, contact velocity and contact force, by the forward-increment Lagrange multiplier and explicit penalty methods. The velocity of the former is the mean one of each step",
        low_speed,
    ),
    "4.3": ("contact-position", "Contact position of the left bar", contact_position),
    "4.4": ("mean-velocity", "Mass-averaged velocity of the left bar", mean_velocity),
    "4.5": ("kinetic-energy", "Kinetic energy of the left bar", kinetic),
    "4.6": ("potential-energy", "Potential energy of the left bar", potential),
    "4.7": (
        "energy-error",
        "Relative error of the total energy: of the left bar, as in the paper (above), and of the system of both bars (below); note the scales",
        energy_error,
    ),
    "4.8": (
        "contact-force",
        "Contact force: (a) conventional methods, (b) Schwarz, with a few steps of each enlarged",
        contact_force,
    ),
    "4.9": ("contact-velocity", "Contact velocity of the left bar, in the same order. That of the Lagrange multiplier is the mean one of each step: at its end, the force that begins there is not known yet", contact_velocity),
    "4.9b": (
        "held-traction",
        "Not in the paper: Implicit-Explicit with the traction held constant over the explicit substeps, which has the little chatter and the larger loss that the paper shows",
        held_traction,
    ),
    "4.10": (
        "mesh-ii",
        "Kinetic energy of the left bar on four meshes, Implicit-Implicit Schwarz, 10⁻⁸ s in both bars",
        lambda results: mesh_study(results, "ii"),
    ),
    "4.11": ("mesh-ie", "The same, Implicit-Explicit", lambda results: mesh_study(results, "ie")),
    "4.12": ("mesh-ee", "The same, Explicit-Explicit", lambda results: mesh_study(results, "ee")),
    "4.13a": ("convergence", "Mesh convergence of the kinetic energy, with fitted rates", convergence),
    "4.13b": ("iterations", "Schwarz iterations in each controller step, 200 elements, 10⁻⁷ s", iterations),
}


def file_of(number):
    return f"figure-{number}-{FIGURES[number][0]}"


def draw(number, results, folder):
    """PNG and PDF of a figure, in a folder; NoResult if a run that it shows has failed."""
    with matplotlib.rc_context(STYLE):
        figure = FIGURES[number][2](results)
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(folder / f"{file_of(number)}.png", dpi=130, metadata={"Software": None})
        figure.savefig(folder / f"{file_of(number)}.pdf", dpi=200, metadata={"CreationDate": None})
