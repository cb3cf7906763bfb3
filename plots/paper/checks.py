"""What our runs show of the paper's statements: each function takes the results and returns what was measured, as text, and whether it
agrees with the statement. The rule for that stands in the function; bounds are those of the statement."""

from itertools import pairwise

import numpy as np

from .experiments import HIGH_SPEED, MESHES, PAIRINGS
from .published import RATE
from .results import convergence_rate
from .tables import SHORT, number, percent

YES, PART, NO = "agrees", "agrees in part", "does not agree"
PENALTY = ("high-speed/penalty-implicit", "high-speed/penalty-explicit")
LAGRANGE = "high-speed/lagrange"
CONVENTIONAL = (LAGRANGE, *PENALTY)
HELD = "variants/paper/waveform-constant-ie"
SCHWARZ = tuple(f"high-speed/{pairing}" for pairing in PAIRINGS)


def each(results, names, path, write=number):
    """Values and a text of them, named by method."""
    values = [results[name].figure(path) for name in names]
    return values, ", ".join(f"{name_of(name)} {write(value)}" for name, value in zip(names, values))


def name_of(name):
    short = name.rpartition("/")[2]
    return SHORT.get(
        short,
        {"lagrange": "Lagrange", "penalty-implicit": "implicit penalty", "penalty-explicit": "explicit penalty"}.get(
            short, short
        ),
    )


def verdict(yes, part=False):
    return YES if yes else PART if part else NO


def overclosure(results):
    closed = [max(results[name].figure("contact.max_penetration"), 0) for name in PENALTY]
    motion = max(np.abs(contact_part(results[name], "contact_position")).max() for name in SCHWARZ)
    text = f"penetration of the penalty methods up to {1e3 * max(closed):.2f} mm; Schwarz stays within {1e6 * motion:.0f} µm of the exact place, Lagrange at it"
    return text, verdict(min(closed) > 5 * motion)


def contact_part(result, quantity):
    """The middle three fifths of the time in contact."""
    inside = (result.time > 1e-4) & (result.time < 4e-4)
    return result.left(quantity)[inside]


def release_of_conventional(results):
    values, text = each(results, CONVENTIONAL, "errors.release_time", percent)
    return text, verdict(max(values) < 0)


def release_of_schwarz(results):
    values, text = each(results, SCHWARZ, "errors.release_time", percent)
    finer = results["mesh/ii-400"].figure("errors.release_time")
    text += f"; N_x = 400, Δt = 1e-8 s: {percent(finer)}"
    return text, verdict(max(map(abs, values)) <= 1.5e-4)


def better(path):
    def check(results):
        schwarz, text = each(results, SCHWARZ, path)
        conventional, more = each(results, CONVENTIONAL, path)
        return f"{text}; {more} (relative L2 error in time)", verdict(
            max(schwarz) < min(conventional), min(schwarz) < min(conventional)
        )

    return check


def kinetic_order(results):
    values, text = each(results, SCHWARZ, "errors.kinetic")
    return text, verdict(values[0] == min(values))


def peak_of_conventional(results):
    values, text = each(results, CONVENTIONAL, "errors.peak_potential", percent)
    return text, verdict(max(values) < -0.08, max(values) < -0.02)


def peak_of_schwarz(results):
    values, text = each(results, SCHWARZ, "errors.peak_potential", percent)
    text += f"; N_x = 400: {percent(results['mesh/ii-400'].figure('errors.peak_potential'))}; massless layers, N_x = 200: {percent(results['variants/default/default-ii'].figure('errors.peak_potential'))}"
    return text, verdict(max(map(abs, values)) < 1e-3)


def never_gains(results):
    left, _ = each(results, HIGH_SPEED, "bodies.left.total_energy_error_max")
    system, _ = each(results, HIGH_SPEED, "system.energy_error_max")
    text = f"left bar: up to {percent(max(left))}; system: up to {number(max(system), 2)}"
    return text, verdict(max(left) < 1e-5, max(system) < 1e-5)


def loss_of_conventional(results):
    values, text = each(results, CONVENTIONAL, "system.energy_error_min", percent)
    _, final = each(results, CONVENTIONAL, "system.energy_error_final", percent)
    return f"{text}; after release: {final}", verdict(min(values) < -0.08, min(values) < -0.02)


def loss_of_schwarz(results):
    left, text = each(results, SCHWARZ, "left.energy_error", percent)
    system, more = each(results, SCHWARZ, "system.energy_error", percent)
    return f"left bar: {text}; system: {more}", verdict(max(map(abs, left)) <= 2.5e-3, max(map(abs, system)) <= 2.5e-3)


def energy_order(results):
    ii, ie, ee = map(abs, each(results, SCHWARZ, "system.energy_error_final")[0])
    held = results[HELD].figure("system.energy_error_final")
    text = each(results, SCHWARZ, "system.energy_error_final", percent)[1]
    return f"system, after release: {text}; IE with the traction held constant over the substeps {percent(held)}", verdict(
        ee < ii < ie, max(ii, ee) < abs(held)
    )


def smooth_forces(results):
    values, text = each(results, CONVENTIONAL, "force_scatter")
    return f"force std/mean: {text}", verdict(max(values) < 0.01)


def overshoot(results):
    peak = results[LAGRANGE].figure("contact.force_peak") / results[LAGRANGE].figure("contact.force_mean")
    return f"{peak:.2f} times the mean in the first step", verdict(peak > 1.5)


def chatter(results):
    values, text = each(results, SCHWARZ, "force_scatter")
    return f"force std/mean: {text}", verdict(min(values) > 0.1, max(values) > 0.1)


def onsets(results):
    values, text = each(results, SCHWARZ, "contact.onsets")
    most = max((results[f"one-step/ee-{elements}"].figure("contact.onsets"), elements) for elements in MESHES)
    text += f"; EE with a controller step of 1e-8 s, N_x = {most[1]}: {most[0]}"
    return f"contact onsets: {text}", verdict(min(values) > 1, max(values) > 1)


def tolerance(results):
    scatter = [
        results[f"sensitivity/atol-{size}-{pairing}"].figure("force_scatter")
        / results[f"high-speed/{pairing}"].figure("force_scatter")
        - 1
        for size in ("1e-9", "1e-14")
        for pairing in PAIRINGS
    ]
    return (
        f"with 1e-9 m and 1e-14 m instead of 1e-12 m, std/mean of the force changes by {percent(max(map(abs, scatter)), 2)} at most",
        verdict(max(map(abs, scatter)) < 0.01),
    )


def mixed_chatter(results):
    values, text = each(results, SCHWARZ, "force_scatter")
    held = results[HELD].figure("force_scatter")
    bound = 0.5 * min(values[0], values[2])
    swapped = results["variants/paper/swap-sides-ie"].figure("force_scatter")
    text += f"; IE with the traction held constant over the explicit substeps: {number(held, 2)}, with sides swapped in every step: {number(swapped, 2)}"
    return f"force std/mean: {text}", verdict(
        values[1] < bound, held < bound
    )


def dissipation(results):
    names = [
        "high-speed/ii",
        "variants/paper/radius-0.9-ii",
        "variants/paper/radius-0-ii",
        "variants/paper/newmark-dissipative-ii",
    ]
    scatter, loss = (each(results, names, path)[0] for path in ("force_scatter", "system.energy_error"))
    text = "; ".join(
        f"{name.rpartition('/')[2]}: scatter {number(s, 2)}, energy {percent(e, 2)}" for name, s, e in zip(names, scatter, loss)
    )
    still, kept = (results["variants/default/default-ii"].figure(path) for path in ("force_scatter", "system.energy_error"))
    return f"{text}. But massless layers: scatter {number(still, 2)}, energy {percent(kept, 2)}", verdict(
        False, scatter[-1] < 0.2 * scatter[0]
    )


def relaxation(results):
    names = [f"variants/paper/{kind}-{pairing}" for kind in ("theta", "aitken") for pairing in PAIRINGS]
    values = each(results, names, "force_scatter")[0]
    return (
        f"fixed factor of 1/2 and Aitken, II, IE, EE: force std/mean {number(min(values), 2)} to {number(max(values), 2)}",
        verdict(max(values) < 0.1),
    )


def mesh_errors(results, pairing, folder="mesh"):
    return [results[f"{folder}/{pairing}-{elements}"].figure("errors.kinetic") for elements in MESHES]


def converges(results):
    errors = [mesh_errors(results, pairing) for pairing in PAIRINGS]
    text = "; ".join(f"{SHORT[pairing]} {number(e[0])} to {number(e[-1])}" for pairing, e in zip(PAIRINGS, errors))
    return text, verdict(all(a > b for e in errors for a, b in pairwise(e)))


def rates(results):
    found = [convergence_rate(MESHES, mesh_errors(results, pairing)) for pairing in PAIRINGS]
    text = ", ".join(f"{SHORT[pairing]} {rate:.2f}" for pairing, rate in zip(PAIRINGS, found))
    return f"fitted: {text}", verdict(
        max(abs(rate - RATE) for rate in found) < 0.02, max(abs(rate - RATE) for rate in found) < 0.15
    )


def most_accurate(results):
    last = [mesh_errors(results, pairing)[-1] for pairing in PAIRINGS]
    return "N_x = 400: " + ", ".join(f"{SHORT[pairing]} {number(error, 4)}" for pairing, error in zip(PAIRINGS, last)), verdict(
        last[2] == min(last)
    )


def growth(result):
    """Largest distance of the kinetic energy from the exact one, in the last quarter of contact over that in the first [1]."""
    away = np.abs(result.left("kinetic") - result.exact("kinetic"))
    first, last = ((result.time > a) & (result.time < b) for a, b in ((0.2e-4, 1.2e-4), (3.7e-4, 4.7e-4)))
    return away[last].max() / away[first].max()


def growing(results):
    names = {
        "ten substeps in both bars": "mesh/ie-400",
        "one step in both bars": "one-step/ie-400",
        "ten explicit ones, traction held constant over them": "sensitivity/waveform-constant-400-ie",
    }
    ratios = {text: growth(results[name]) for text, name in names.items()}
    text = "; ".join(f"{text}: {ratio:.2f} times" for text, ratio in ratios.items())
    return f"largest distance from the exact kinetic energy, late in contact against early: {text}", verdict(
        min(ratios.values()) > 2, max(ratios.values()) > 2
    )


def sweeps(results):
    found = {pairing: results[f"high-speed/{pairing}"].sweeps for pairing in PAIRINGS}
    ranges = {pairing: (values[values > 0].min(), values.max()) for pairing, values in found.items()}
    text = ", ".join(f"{SHORT[pairing]} {low} to {high}" for pairing, (low, high) in ranges.items())
    return text, verdict(all(2 <= low and high <= 5 for low, high in ranges.values()))


def fewest(results):
    values, text = each(results, SCHWARZ, "schwarz.mean_all_steps", lambda value: f"{value:.3f}")
    return f"mean over all steps: {text}; at most {results[SCHWARZ[2]].figure('schwarz.max')} for EE", verdict(
        values[2] == min(values)
    )


def none_outside(results):
    outside = 0
    for name in SCHWARZ:
        result = results[name]
        contact = result.summary["contact"]
        outside += int(
            (
                result.sweeps[
                    (result.time < contact["first_contact_time"] - 0.5e-7) | (result.time > contact["release_time"] + 1.5e-7)
                ]
                > 0
            ).sum()
        )
    return f"{outside} steps with iterations outside contact, but for the one that lets go", verdict(outside == 0)


def finer_needs_more(results):
    means = {
        pairing: [results[f"mesh/{pairing}-{elements}"].figure("schwarz.mean_all_steps") for elements in MESHES]
        for pairing in PAIRINGS
    }
    text = "; ".join(f"{SHORT[pairing]} " + ", ".join(f"{mean:.3f}" for mean in values) for pairing, values in means.items())
    return f"mean over all steps, from coarse to fine: {text}", verdict(all(values[-1] > values[0] for values in means.values()))


def step_matters_little(results):
    rows = {
        pairing: [
            results[name].figure("schwarz.max")
            for name in (f"high-speed/{pairing}", f"mesh/{pairing}-200", f"time-step/{pairing}-1e-9")
        ]
        for pairing in PAIRINGS
    }
    text = "; ".join(f"{SHORT[pairing]} {', '.join(map(str, values))}" for pairing, values in rows.items())
    same = all(len(set(rows[pairing])) == 1 for pairing in ("ii", "ie")) and rows["ee"][0] < rows["ee"][1] == rows["ee"][2]
    return f"most in a step, 1e-7, 1e-8, 1e-9 s: {text}", verdict(same)
