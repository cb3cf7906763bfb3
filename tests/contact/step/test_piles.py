"""Many bodies in one contact step: S has a block for each body, sparse where these are a small part of it, and each block a secant of its own."""

import re

import numpy as np
from pile import pile

DISCS = pile(4, 8, end=0.08, slack=0)
LINE = re.compile(r"S assembled: (sparse|dense), (\d+) rows")


def test_pile(shared_run):
    """Discs that come to rest on each other, whole groups of them."""
    one, three = (shared_run(DISCS, ranks) for ranks in (1, 3))
    scale = max(np.abs(sum(body["kinetic"][()] for body in one.history["body"].values())))
    for name, body in one.history["body"].items():  # courses part by round-off
        np.testing.assert_allclose(three.history["body"][name]["kinetic"][()], body["kinetic"][()], rtol=0, atol=1e-9 * scale, err_msg=name)


def test_sparse(impakt):
    """Blocks of 100 discs are a small part of S once many touch; iterations and LU factors find the same."""
    many = f"{pile(5, 20, end=0.075)} -contact_type force"
    run, other = impakt(f"{many} -info :contact"), impakt(f"{many} -law_ksp_type preonly -law_pc_type lu")
    found = [(kind, int(rows)) for kind, rows in LINE.findall(run.stdout)]
    assert max(rows for kind, rows in found if kind == "sparse") > 150
    assert all(kind == "dense" for kind, rows in found if rows <= 150)
    scale = max(np.abs(sum(body["kinetic"][()] for body in run.history["body"].values())))
    for name, body in run.history["body"].items():
        np.testing.assert_allclose(other.history["body"][name]["kinetic"][()], body["kinetic"][()], rtol=0, atol=1e-9 * scale, err_msg=name)
