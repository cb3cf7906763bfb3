"""Stacks of static blocks that contact alone holds, drawn with a seed: any stiffness, gap, material and order of sides."""

import random

import pytest
from cases import joined, long
from setups import box, material, plane

GRAVITY = 9.81


def stack(seed):
    """Options and the weight that each block bears with its own. Blocks are narrower the higher they are; stiffness goes from 1e7 Pa up or down by a ratio of 1 to 1e6."""
    draw = random.Random(seed)
    dim = draw.choice((2, 2, 3))
    names = "abcde"[: draw.randint(2, 5 if dim == 2 else 3)]
    material_type = draw.choice(("linear_elastic", "neo_hookean"))
    ratio, gap = 10 ** draw.uniform(0, 6), draw.choice((0, 0, 1e-4, 1e-2, 0.1, 0.25))
    soft_first, other_side = draw.random() < 0.7, draw.random() < 0.4
    low, high = ("ymin", "ymax") if dim == 2 else ("zmin", "zmax")
    options, pairs, weights = [], [f"a.{low}:f"], []
    height, centre, width = 0.0, 0.0, 1.0
    for i, name in enumerate(names):
        thickness, density = draw.uniform(0.1, 0.3), draw.uniform(1000, 8000)
        height += 0.1 * gap * draw.random()  # of the thinnest block
        part = i / (len(names) - 1) if soft_first else 1 - i / (len(names) - 1)
        if i:
            width *= draw.uniform(0.6, 0.95)
            centre += draw.uniform(-0.15, 0.15) * width
            pairs.append(f"{names[i - 1]}.{high}:{name}.{low}" if other_side else f"{name}.{low}:{names[i - 1]}.{high}")
        depth = (-width / 2,) * (dim - 2), (width / 2,) * (dim - 2)
        lower, upper = (centre - width / 2, *depth[0], height), (centre + width / 2, *depth[1], height + thickness)
        faces = (draw.randint(3, 7), *(draw.randint(3, 5) for _ in range(dim - 2)), draw.randint(2, 3))
        options += [box(name, faces, lower, upper), material(name, 1e7 * ratio**part, 0.3, density), f"-{name}_material_type {material_type} -{name}_ts_type static"]
        options.append(f"-{name}_gravity {'0,' * (dim - 1)}{-GRAVITY}")
        weights.append(GRAVITY * density * width ** (dim - 1) * thickness)
        height += thickness
    floor = plane("f", (0,) * dim, (*(0,) * (dim - 1), 1))
    borne = [sum(weights[i:]) for i in range(len(weights))]
    return joined(f"-bodies {','.join(names)} -obstacles f -contact_pairs {','.join(pairs)} -time_step 1 -time_end 1", floor, *options), pairs, borne


STIFF = 55  # blocks of 1e13 and 1e7 Pa
SHORT = (0, 1, 4, 7, 11, 13, STIFF)
REST = [seed for seed in range(60) if seed not in SHORT]


@pytest.mark.parametrize("seed", [*SHORT, *long(*REST)])
def test_weights(seed, impakt):
    """Each block bears what stands on it, and itself, to 1e-8 of all. Measured: 2.1e-9 at most."""
    options, pairs, borne = stack(seed)
    run = impakt(options)
    for pair, weight in zip(pairs, borne, strict=True):
        assert abs(run.history[f"contact/{pair}/force_vector"][-1][-1 if "z" in pair else 1]) == pytest.approx(weight, abs=1e-8 * borne[0])
    assert "inside each other" not in run.stderr
    assert "energy error" not in run.stderr  # which says nothing where blocks fall through their gaps


def test_not_solved(impakt):
    """A law that takes more iterations than it may have ends the run, and says so, rather than going on with other forces."""
    run = impakt(joined(stack(STIFF)[0], "-law_snes_max_it 1 -law_nodes_snes_max_it 1"), expect_failure=True)
    assert "The law of the " in run.stderr and "contact rows of the step" in run.stderr and "was not solved" in run.stderr


@pytest.mark.parametrize(("seed", "ranks"), [(11, 3), *long((1, 3))])
def test_ranks(seed, ranks, impakt):
    options, pairs, borne = stack(seed)
    run = impakt(options, ranks)
    assert abs(run.history[f"contact/{pairs[0]}/force_vector"][-1][1]) == pytest.approx(borne[0], rel=1e-8)
