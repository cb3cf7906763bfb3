"""Traction over the substeps of a partner that makes more of them: what impulse both sides get from it."""

import numpy as np
import pytest

BLOCKS = "-options_file options/blocks.opts"
STEP, SUBSTEPS = 1e-6, 5
MASS, SPEED = 1000 * 0.25 * 0.05, 100  # of one block [kg], [m/s]


def momentum(run):
    return sum(MASS * body["mean_velocity"][()] for body in run.history["body"].values())


@pytest.mark.parametrize(("waveform", "integrator"), [("linear", "centraldifference"), ("constant", "alpha2")])
def test_impulse(waveform, integrator, shared_run):
    """The side of long steps takes the trapezium of a force that goes from F to F' in a step, and so does its partner if it is linear over the n
    substeps. Held at F', all substeps but half of the first one have F': the partner is ahead by (1 - 1/n) (F' - F) dt / 2, in all steps
    together by (1 - 1/n) F' dt / 2, which it gives back as the force falls to zero: 1.1e-3 of a block's momentum in between. Measured: 3e-14 (central
    differences), 3e-13. A node that is let go at a force f takes all of it from a linear partner in its first substep, and half of it over the step
    from the other side: (1 - 1/n) f dt / 2 is lost, 4e-6 of the momentum of a block in all."""
    run = shared_run(f"{BLOCKS} -schwarz_traction_waveform {waveform} -right_ts_time_step {STEP / SUBSTEPS} -right_ts_type {integrator}")
    pair = next(iter(run.history["contact"].values()))
    force = pair["force"][()]
    ahead = 0.5 * (1 - 1 / SUBSTEPS) * STEP * force if waveform == "constant" else 0 * force
    total = momentum(run)
    total = total[:, 0] if total.ndim == 2 else total
    assert force.max() > 5e6
    leaves = np.flatnonzero(np.diff(pair["active"][()]) < 0) + 1
    assert len(leaves)
    held = len(total) if waveform == "constant" else leaves[0]
    np.testing.assert_allclose(total[:held], ahead[:held], rtol=0, atol=1e-11 * 2 * MASS * SPEED)
    lost = 0 if waveform == "constant" else 0.5 * (1 - 1 / SUBSTEPS) * STEP * force[leaves - 1].sum()
    assert abs(total[-1]) <= 1e-11 * 2 * MASS * SPEED + lost
