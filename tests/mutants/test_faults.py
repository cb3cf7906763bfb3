"""The expressions of all deliberate faults are there: who deletes one writes another. `make mutants` looks which tests find them."""

from collections import Counter
from pathlib import Path

from faultlist import misplaced, read_faults


def test_expressions_are_there():
    assert not misplaced(read_faults())


def test_an_expression_that_is_gone_names_the_fault():
    gone = read_faults()[0]
    gone.search = "an expression that stands nowhere"
    (message,) = misplaced([gone])
    assert f"fault {gone.name}" in message and gone.file in message


def test_faults_are_spread():
    """At least 30, in all folders, at most 8 in contact and in rows of bodies."""
    faults = read_faults()
    assert len({fault.name for fault in faults}) == len(faults) >= 30
    folders = Counter(Path(fault.file).parts[1] for fault in faults)
    assert len(folders) >= 14
    assert sum(fault.file.startswith(("src/contact/", "src/body/rows/")) for fault in faults) <= 8
