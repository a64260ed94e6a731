"""Group cutting segments into chains, each ordered from end to end, all facing the same way."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats, Ints, product


def chains_of(segments: Ints) -> tuple[Ints, Ints]:
    """Return segments ordered by chain, and the chain of each.

    A chain ends at a vertex unless exactly two segments meet there. It keeps the given direction of
    its first segment; chains are numbered in the order of these.
    """
    at_vertex: dict[int, list[int]] = {}
    for e, (i, j) in enumerate(segments.tolist()):
        at_vertex.setdefault(i, []).append(e)
        at_vertex.setdefault(j, []).append(e)

    def step(e: int, vertex: int) -> tuple[int, int] | None:
        # the segment that continues e at this vertex, and that segment's far vertex
        meeting = at_vertex[vertex]
        if len(meeting) != 2:
            return None
        other = meeting[0] if meeting[1] == e else meeting[1]
        i, j = segments[other].tolist()
        return other, j if i == vertex else i

    ordered: list[tuple[int, int]] = []
    chain: list[int] = []
    done = np.zeros(len(segments), dtype=bool)
    n_chain = 0
    for seed in range(len(segments)):
        if done[seed]:
            continue
        done[seed] = True
        tail, head = segments[seed].tolist()
        links = [(tail, head)]
        e, vertex = seed, head
        while (found := step(e, vertex)) is not None and not done[found[0]]:
            links.append((vertex, found[1]))
            e, vertex = found
            done[e] = True
        before = []
        e, vertex = seed, tail
        while (found := step(e, vertex)) is not None and not done[found[0]]:
            before.append((found[1], vertex))
            e, vertex = found
            done[e] = True
        links = before[::-1] + links
        ordered += links
        chain += [n_chain] * len(links)
        n_chain += 1
    return np.array(ordered, dtype=np.int64).reshape(-1, 2), np.array(chain, dtype=np.int64)


def chains_facing_back(body: Ints, chain: Ints, normal: Floats) -> npt.NDArray[np.bool_]:
    """Return which chains face opposite to the first chain of their body."""
    reverse = np.zeros(chain.max() + 1, dtype=bool)
    facing: dict[int, Floats] = {}
    for c in range(reverse.size):
        mean = normal[chain == c].sum(axis=0)
        first = facing.setdefault(int(body[chain == c][0]), mean)
        reverse[c] = float(product(mean, first)) < 0.0
    return reverse


def reverse_chains(segments: Ints, chain: Ints, reverse: npt.NDArray[np.bool_]) -> Ints:
    """Return the segments with some of the chains reversed."""
    turned = segments.copy()
    for c in np.flatnonzero(reverse):
        turned[chain == c] = segments[chain == c][::-1, ::-1]
    return turned
