"""The golden figures of the report's tables (tests/paper/golden.json), of the runs that take less than a second; `make paper` checks all."""

import pytest
from goldenfigures import GOLDEN, differences

QUICK = ("high-speed/", "low-speed/", "one-step/")  # of each pairing and method


@pytest.mark.parametrize("name", [name if name.startswith(QUICK) else pytest.param(name, marks=pytest.mark.long) for name in GOLDEN["cheap"]])
def test_golden(name, shared_run):
    assert not differences(name, shared_run(f"-options_file options/paper/{name}.opts").summary)


def test_golden_figures_can_fail():
    """Each is checked: a summary in which all are wrong differs in all."""

    class Wrong(dict):
        def __getitem__(self, key):
            return self if key in ("schwarz", "contact", "system", "errors", "bodies", "left") else 1e9

    name = "high-speed/ii"
    assert len(differences(name, Wrong())) == len(GOLDEN["figures"][name]) >= 10
