"""Combinations of option values in which each pair of values stands at least once.

Most faults show with one value or with two values together (Kuhn, Wallace, Gallo, IEEE Trans. Softw. Eng. 30 (2004) 418-421), and the full product
of the values has many times more combinations.
"""

from allpairspy import AllPairs


def pairwise(*options):
    """pairwise(["a", "b"], [1, 2, 3], ...): a list of tuples with one value of each option, the same list every time."""
    return [tuple(row) for row in AllPairs([list(values) for values in options])]
