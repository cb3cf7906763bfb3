"""The model of a step's time gives back the rates from which times were made, and its parts go with ranks as they should."""

import pytest
from model import ARCHER2, PARTS, fit, large, moved, parts, predict

RATES = {"element": 2e-7, "entry": 1e-9, "solve_loss": 1.5, "latency": 1e-6, "network_GB_per_s": 5, "reduction": 2e-6}
ELEMENTS, SURFACES = 1e5, (625, 441)


def test_fit_gives_back_what_times_were_made_from():
    cases = [(contact, ranks) for contact in (False, True) for ranks in (1, 2)]
    times = {case: predict(RATES, ELEMENTS, SURFACES, *case) for case in cases}
    found = fit({name: RATES[name] for name in ("latency", "network_GB_per_s", "reduction")}, ELEMENTS, SURFACES, times)
    assert found == pytest.approx(RATES, rel=1e-10)


def test_parts():
    one, many = (parts(RATES, ELEMENTS, SURFACES, True, ranks) for ranks in (1, 64))
    assert one["halos"] == one["reductions"] == 0
    assert many["elements"] == pytest.approx(one["elements"] / 64)
    assert many["reductions"] == pytest.approx(6 * parts(RATES, ELEMENTS, SURFACES, True, 2)["reductions"])
    assert one["solutions"] / 64 < many["solutions"]  # separators are on the path of all ranks
    assert parts(RATES, ELEMENTS, SURFACES, False, 1)["solutions"] == pytest.approx(one["solutions"] / 3)  # 2 solutions in place of 6


def test_large():
    rows = large(moved(RATES, 10, ARCHER2))
    assert rows[0]["efficiency"] == 1
    for row in rows:
        assert row["step"] == pytest.approx(sum(row[name] for name in PARTS))
        assert row["bottleneck"] in PARTS
