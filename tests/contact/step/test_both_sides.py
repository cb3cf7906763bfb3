"""Rows of both sides: the pair is named twice, each time with another body first."""

import numpy as np
import pytest
from contactstep import sheet_and_block


@pytest.mark.parametrize(("mu", "ranks"), [(0, 1), (0.2, 3)])
def test_both_sides(mu, ranks, impakt):
    """Nodes of the block on faces of the sheet, and nodes of the sheet on faces of the block: their rows depend on each other, so that S is nearly singular. The
    impulse is that of rows on one side, contact brings no energy, and takes as much."""
    one = impakt(sheet_and_block(mu=mu))
    both = impakt(sheet_and_block(mu=mu, pair="block:sheet,sheet:block"), ranks)
    total = sum(sign * both.history[f"contact/{pair}/impulse"][-1] for pair, sign in (("block:sheet", 1), ("sheet:block", -1)))
    np.testing.assert_allclose(total[1], one.history["contact/block:sheet/impulse"][-1][1], rtol=0.04)  # which scatters by 2 % from step to step
    assert both.history["energy/change"][()].max() <= 1e-12 * both.history["energy/scale"][0]
    assert both.summary["contact"]["contact_loss"] == pytest.approx(one.summary["contact"]["contact_loss"], rel=0.1)
    assert both.summary["schwarz"]["max"] <= 3
