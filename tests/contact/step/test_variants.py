"""Random variants, drawn with a seed, of a sheet that is hit and of bars that are pressed on each other: contact with mass at its nodes brings no energy."""

import math
import random

import numpy as np
import pytest
from cases import long, validate
from contactstep import energy, momentum_error, pressed_bars, sheet_and_block

# Largest step of an explicit body [s]: 0.8 of the stable one, that of the sheet, of the block and of the bars
STABLE = {"sheet": 1.2e-7, "block": 2.8e-7, "a": 2.8e-7, "b": 3e-7}


def variant(seed):
    """Scene, integrators and options."""
    draw = random.Random(seed)
    impact, kinds = draw.random() < 0.6, draw.choice(("II", "IE", "EI", "EE"))
    step = 1e-6 * 10 ** draw.uniform(math.log10(0.2), math.log10(20))
    names = ("block", "sheet") if impact else ("a", "b")
    substeps = []
    for name, kind in zip(names, kinds, strict=True):
        least = math.ceil(step / STABLE[name]) if kind == "E" else 1
        most = max(least, 200 if kind == "E" else 3)
        substeps.append(round(math.exp(draw.uniform(math.log(least), math.log(most)))))
    mu = draw.choice((0, draw.uniform(0, 0.8)))
    swap = draw.random() < 0.5
    steps = min(400, math.ceil(3e-4 / step))  # from the first touch to the release, or a part of it
    if not impact:
        pair = "b.xmin:a.xmax" if swap else "a.xmax:b.xmin"
        return "pressed", kinds, pressed_bars(kinds, mu, step, max(steps, 100) * step, substeps, pair, at_rest=draw.random() < 0.3, more="-contact_balanced_start false")
    more = {
        "gap": 10 ** draw.uniform(-6, math.log10(5e-5)),
        "turn": draw.choice((0, draw.uniform(0, 360))),
        "frame": draw.choice(((0, 0), (draw.uniform(-20, 20), draw.uniform(-20, 20)))),
        "velocity": (draw.uniform(-3, 3), -(10 ** draw.uniform(-0.3, 1.2))),
        "free": draw.random() < 0.3,
    }
    steps += math.ceil(-more["gap"] / more["velocity"][1] / step)
    return "impact", kinds, sheet_and_block(kinds, mu, step, steps * step, substeps, "sheet:block" if swap else "block:sheet", **more)


@pytest.mark.parametrize("seed", [*long(*range(12)), *validate(*range(12, 200))])
def test_variant(seed, impakt):
    scene, kinds, options = variant(seed)
    run = impakt(options, timeout=120)
    assert run.summary["contact"]["steps_in_contact"] > 0
    change = energy(run)
    assert np.all(np.isfinite(change))
    assert change.max() <= (1e-9 if kinds == "II" else 1e-3)
    if scene == "impact":
        assert momentum_error(run, "block") <= 1e-11
