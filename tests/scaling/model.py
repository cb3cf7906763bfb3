"""What a step of explicit bodies in contact takes on many ranks: from counts, latency, bandwidth and the speed of a core.

A step of `hex8` boxes is the sum of parts that ranks wait for one after the other:

- elements: time for one, times the elements of the largest rank. It grows with each doubling of these, as less of them stays in the caches, up to
  CACHED, where all comes from memory;
- halos: messages times latency, bytes over bandwidth;
- reductions: each takes the logarithm of the number of ranks times latency;
- solutions with the factors of surfaces: one with each of the massless layers, and in contact one with both joined by the rows between them. Factors
  of a sheet of n nodes in nested dissection have a constant times n log2 n entries, all of them read once for each direction; those of joined layers
  are JOINED times as many. Small layers are factored whole on every rank. Of larger ones, and of joined ones, ranks share the subtrees, but
  separators near the root lie on the path of all of them, and two messages go over each level of the tree.

Times for an element and for an entry of layers' factors and of joined ones, to which all else that contact takes is put down, are taken from runs of
one size on one rank, and what caches do, and how much less joined factors gain from two ranks than they should, from two; other sizes show how good
that is.
"""

import json
import math
import subprocess

PARTS = ("elements", "halos", "reductions", "solutions")
# Elements of a rank beyond which none stays in the caches: some 30 MB
CACHED = 1e5
# Of a step, from counts on 2 to 16 ranks (make scaling): reductions, messages to each neighbour of the boxes
REDUCTIONS = 50
MESSAGES = 75
# Operations of a solution with the joined factors of two layers of 2401 and 1681 nodes, beside those with each
JOINED = 2.75
# Nodes of a layer whose factors are whole on every rank: a third of the unknowns of MAX_REDUNDANT_SIZE in src/solver/solverchoice.c
WHOLE = 5000 / 3
# Unknowns of a node, of which factors have blocks of 3 x 3; entries of the lower triangle of a sheet of n nodes: about this times n log2 n blocks
BLOCK = 9
FILL = 31 / 4
# Bytes for each node that two ranks share, in both directions, of a body in a step
HALO_BYTES = 230

# ARCHER2: https://docs.archer2.ac.uk/user-guide/hardware: two AMD EPYC 7742 of 64 cores and 204.8 GB/s (peak) each in a node, two injection
# ports of 100 Gb/s; the latency of 2 us is assumed. Of the peak bandwidth 0.8 can be had.
ARCHER2 = {
    "name": "ARCHER2",
    "source": "https://docs.archer2.ac.uk/user-guide/hardware",
    "cores_per_node": 128,
    "memory_GB_per_s": 0.8 * 204.8 / 64,
    "network_GB_per_s": 25 / 128,
    "latency": 2e-6,
}


def sheet_entries(nodes):
    """Numbers in the factors of a sheet of so many nodes."""
    return BLOCK * FILL * nodes * math.log2(max(2, nodes)) / 2


def sheet_path(nodes, ranks):
    """Numbers in the factors that lie on the path from a rank's subtree to the root: separators, each with all that are above it, which halve the
    longer side of the sheet."""
    entries, width, height = 0, math.sqrt(nodes), math.sqrt(nodes)
    while ranks > 1:
        separator = 3 * min(width, height)
        entries += separator * (separator + 1) / 2 + separator * 3 * (width + height)
        if width > height:
            width /= 2
        else:
            height /= 2
        ranks = (ranks + 1) // 2
    return entries


def counts(elements, nodes, ranks):
    """Elements of a rank, and bytes and neighbours of its halo, where `elements` and the `nodes` of one surface in contact are spread evenly over bricks
    that each have a part of it; as many of them along the normal as make them cubes, where there are more ranks than that."""
    share = elements / ranks
    halo = 6 * share ** (2 / 3) if ranks > 1 else 0
    neighbours = min(ranks - 1, 1 if ranks == 2 else 3 if ranks <= 4 else 8 if nodes / ranks >= 1 else 26)
    return share, HALO_BYTES * halo * min(1, math.log2(max(ranks, 1)) / 6), neighbours


def divided(surfaces, ranks):
    """Numbers in factors of these surfaces that the busiest rank waits for, where ranks share them."""
    return sum(sheet_entries(nodes) / ranks + sheet_path(nodes, ranks) for nodes in surfaces)


def element_time(rates, share):
    """Seconds of one of so many elements of a rank."""
    doublings = math.log2(min(share, CACHED) / min(rates["elements"], CACHED))
    return max(0.3 * rates["element"], rates["element"] + rates["cache"] * doublings)


def parts(rates, elements, surfaces, contact, ranks):
    """Seconds of the parts of a step; `surfaces`: nodes of the two surfaces that may touch."""
    share, halo, neighbours = counts(elements, max(surfaces), ranks)
    loss = rates["solve_loss"] if ranks > 1 else 1
    whole, shared = ([nodes for nodes in surfaces if (nodes <= WHOLE) == small] for small in (True, False))
    layers = divided(whole, 1) + divided(shared, ranks) * loss
    joined = JOINED * divided(surfaces, ranks) * loss if contact else 0
    solutions = (len(shared) > 0) + contact  # of all ranks together, one after the other
    return {
        "elements": share * element_time(rates, share),
        "halos": neighbours * MESSAGES * rates["latency"] + halo / (1e9 * rates["network_GB_per_s"]),
        "reductions": REDUCTIONS * rates["reduction"] * math.log2(ranks),
        "solutions": 2 * (layers * rates["layer"] + joined * rates["joined"]) + solutions * 2 * math.log2(ranks) * rates["latency"],
    }


def predict(rates, elements, surfaces, contact, ranks):
    return sum(parts(rates, elements, surfaces, contact, ranks).values())


def fit(rates, elements, surfaces, times, layers):
    """The rates from seconds of a step by (contact, ranks), and of its solutions with layers on one rank."""
    joined = [2 * JOINED * divided(surfaces, ranks) for ranks in (1, 2)]
    contact = [times[True, ranks] - times[False, ranks] for ranks in (1, 2)]
    entry = contact[0] / joined[0]
    one = dict(rates, elements=elements, element=(times[False, 1] - layers) / elements, cache=0, layer=layers / (2 * divided(surfaces, 1)), joined=0, solve_loss=1)
    beside = predict(one, elements, surfaces, False, 2) - elements / 2 * one["element"]  # all but the elements of two ranks
    return dict(
        one,
        cache=max(0, one["element"] - (times[False, 2] - beside) / (elements / 2)),
        joined=entry,
        solve_loss=max(1, (contact[1] - 2 * rates["latency"]) / joined[1] / entry),
    )


def moved(rates, bandwidth, machine):
    """The rates on another machine, where a core does as much as its share of the memory's bandwidth lets it."""
    slower = bandwidth / machine["memory_GB_per_s"]
    return {
        "elements": rates["elements"],
        "element": rates["element"] * slower,
        "cache": rates["cache"] * slower,
        "layer": rates["layer"] * slower,
        "joined": rates["joined"] * slower,
        "solve_loss": rates["solve_loss"],
        "latency": machine["latency"],
        "reduction": machine["latency"],
        "network_GB_per_s": machine["network_GB_per_s"],
    }


def large(rates, elements=1e8, nodes=1e6, ranks=(100, 1000, 10_000, 100_000)):
    """Parts of a step on many cores, and efficiency beside the fewest of them."""
    rows = []
    for r in ranks:
        found = parts(rates, elements, (nodes, nodes), True, r)
        rows.append({"ranks": r, "step": sum(found.values())} | found | {"bottleneck": max(found, key=found.get)})
    for row in rows:
        row["efficiency"] = rows[0]["step"] * rows[0]["ranks"] / (row["step"] * row["ranks"])
    return rows


def messages(arguments):
    """Latency, bandwidth and time of a reduction between two ranks of this machine, the best of some runs."""
    command = [*arguments.mpiexec, "-n", "2", str(arguments.build / "yardstick_mpi")]
    found = [json.loads(subprocess.run(command, capture_output=True, text=True, check=True, timeout=arguments.time_limit).stdout) for _ in range(5)]
    return {
        "latency": min(f["latency"] for f in found),
        "network_GB_per_s": max(f["GB_per_s"] for f in found),
        "reduction": min(f["reduction"] for f in found),
    }
