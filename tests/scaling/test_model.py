"""The model of a step's time gives back the rates from which times were made, and its parts go with ranks as they should."""

import pytest
from model import ARCHER2, JOINED, PARTS, fit, large, moved, parts, predict

RATES = {"elements": 5e4, "element": 2e-7, "cache": 1e-8, "layer": 8e-10, "joined": 1e-9, "solve_loss": 1.5, "latency": 1e-6, "network_GB_per_s": 5, "reduction": 2e-6}
ELEMENTS, SURFACES = 5e4, (625, 441)


def test_fit_gives_back_what_times_were_made_from():
    cases = [(contact, ranks) for contact in (False, True) for ranks in (1, 2)]
    times = {case: predict(RATES, ELEMENTS, SURFACES, *case) for case in cases}
    layers = parts(RATES, ELEMENTS, SURFACES, False, 1)["solutions"]
    found = fit({name: RATES[name] for name in ("latency", "network_GB_per_s", "reduction")}, ELEMENTS, SURFACES, times, layers)
    assert found == pytest.approx(RATES, rel=1e-10)


def test_parts():
    one, many = (parts(RATES, ELEMENTS, SURFACES, True, ranks) for ranks in (1, 64))
    assert one["halos"] == one["reductions"] == 0
    assert many["elements"] == pytest.approx(one["elements"] / 64 * (1 - 6 * RATES["cache"] / RATES["element"]))
    assert many["reductions"] == pytest.approx(6 * parts(RATES, ELEMENTS, SURFACES, True, 2)["reductions"])
    assert one["solutions"] / 64 < many["solutions"]  # separators are on the path of all ranks
    apart = [parts(RATES, ELEMENTS, SURFACES, False, ranks)["solutions"] for ranks in (1, 64)]
    assert apart[0] == apart[1]  # small layers are whole on every rank
    assert one["solutions"] == pytest.approx(apart[0] * (1 + JOINED * RATES["joined"] / RATES["layer"]))
    large_layers = [parts(RATES, ELEMENTS, (10_000, 8_000), False, ranks)["solutions"] for ranks in (1, 64)]
    assert large_layers[0] / 64 < large_layers[1] < large_layers[0]


def test_large():
    rows = large(moved(RATES, 10, ARCHER2))
    assert rows[0]["efficiency"] == 1
    for row in rows:
        assert row["step"] == pytest.approx(sum(row[name] for name in PARTS))
        assert row["bottleneck"] in PARTS
