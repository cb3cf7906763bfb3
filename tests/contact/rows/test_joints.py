"""Four tied blocks that meet at a node: the last tie of the circle follows from the others, and its force is not determined."""

import h5py
import numpy as np
import pytest
from cases import worst_energy_error
from setups import box, material

EVERY_STEP = "-output_fields fields.h5 -output_fields_interval 1 -output_fields_precision double"
QUARTERS = {"a": (0, 0), "b": (1, 0), "c": (0, 1), "d": (1, 1)}


def block(name, x, y, edge, more):
    more = f"{material(name, 1e9, 0.3, 1000)} -{name}_initial_velocity 10*x*y,5*x^2-y {more.format(b=name)}"
    return box(name, (4 * edge,) * 2, (x, y), (x + edge, y + edge), more)


def quarters(more=""):
    return " ".join(block(name, x, y, 1, more) for name, (x, y) in QUARTERS.items()) + " -bodies a,b,c,d -contact_law tied"


def displacements(run):
    with h5py.File(run.folder / "fields.h5") as fields:
        places = [tuple(place) for place in np.round(fields["mesh/positions"][()] / 1e-7).astype(int)]
        return places, [frame[()] for frame in fields["displacement"].values()]


EXPLICIT = "-{b}_ts_type centraldifference"


@pytest.mark.parametrize(("more", "pairs"), [("", "b:a,c:a,d:b,d:c"), (EXPLICIT, "auto")], ids=["II", "EE"])
def test_four_blocks(more, pairs, shared_run):
    """As one block, to round-off. Measured: 3e-14."""
    steps = f"-time_step 1e-5 -time_end 3e-4 {EVERY_STEP}"
    whole = shared_run(f"-bodies whole -contact_pairs none {block('whole', 0, 0, 2, more)} {steps}")
    parts = shared_run(f"{quarters(more)} -contact_pairs {pairs} {steps}")
    places, expected = displacements(whole)
    number = {place: node for node, place in enumerate(places)}
    places, found = displacements(parts)
    nodes = [number[place] for place in places]
    size = max(np.abs(frame).max() for frame in expected)
    assert max(np.abs(a[nodes] - b).max() for a, b in zip(expected, found, strict=True)) <= 1e-11 * size


@pytest.mark.parametrize(("more", "ranks"), [("", 3), (EXPLICIT, 1)], ids=["II", "EE"])
def test_four_massless_joints(more, ranks, shared_run):
    run = shared_run(f"{quarters(f'{more} -{{b}}_mass_redistribute true')} -contact_pairs a:b,a:c,b:d,c:d -time_step 1e-5 -time_end 3e-4", ranks)
    assert worst_energy_error(run.summary) <= 1e-12  # measured: 2e-15
    assert run.summary["schwarz"]["unconverged_steps"] == 0
