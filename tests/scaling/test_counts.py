"""What the counts of runs on several ranks may be: they do not hang on a clock, nor on how many cores there are."""

from types import SimpleNamespace

import pytest
from conftest import BUILD, MPIEXEC
from ranks import MPI, boxes, counts_of, exponent


@pytest.fixture(autouse=True)
def environment(monkeypatch):
    for name, value in MPI.items():
        monkeypatch.setenv(name, value)


def count(ranks, size=6, integrator="centraldifference"):
    arguments = SimpleNamespace(build=BUILD, mpiexec=MPIEXEC, time_limit=300)
    return [counts_of(arguments, boxes(size, integrator=integrator), r, (3, 6)) for r in ranks]


def check(rows):
    """All steps were in contact; each takes as many sweeps and reductions whatever the ranks."""
    two = rows[0]
    for row in rows:
        assert row["steps_in_contact"] == 6
        assert row["sweeps"] == two["sweeps"]
        assert row["reductions"] == two["reductions"] > 0
        assert 0 < row["neighbours"] < row["ranks"]


def test_explicit():
    check(count([2, 4]))


@pytest.mark.long
def test_explicit_on_many_ranks():
    """Elements of the largest rank go down as ranks go up; its bricks of both boxes may be 1.1 times the mean."""
    rows = count([2, 4, 8, 16], size=12)
    check(rows)
    assert exponent([2, 4, 8, 16], [row["elements"] for row in rows]) == pytest.approx(-1, abs=0.05)
    assert all(row["elements_imbalance"] <= 1.1 for row in rows)


def test_exponent():
    assert exponent([1, 2, 4, 8], [7, 3 * 2**0.5, 3 * 4**0.5, 3 * 8**0.5]) == pytest.approx(0.5, abs=1e-14)
    assert exponent([1, 2], [1, 2]) is None
