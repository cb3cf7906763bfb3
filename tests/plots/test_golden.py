"""Golden figures of the report's tables (tests/paper/golden.json), of one short run of each method, pairing and speed; `make paper` checks all."""

import pytest
from goldenfigures import GOLDEN, differences

QUICK = [
    *(f"high-speed/{name}" for name in ("ii", "ie", "ee", "lagrange", "penalty-implicit", "penalty-explicit")),
    "low-speed/lagrange",
    "one-step/ie-1e-7",
    "variants/conventional/augmented-ii",
]


@pytest.mark.parametrize("name", QUICK)
def test_golden(name, shared_run):
    assert not differences(name, shared_run(f"-options_file options/paper/{name}.opts").summary)


def test_golden_figures_can_fail():
    """Each is checked: a summary in which all are wrong differs in all."""

    class Wrong(dict):
        def __getitem__(self, key):
            return self if key in ("schwarz", "contact", "system", "errors", "bodies", "left") else 1e9

    name = "high-speed/ii"
    assert len(differences(name, Wrong())) == len(GOLDEN["figures"][name]) >= 10
