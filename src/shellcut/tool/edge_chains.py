"""Group cutting segments into chains, each ordered from end to end, all facing the same way."""

from __future__ import annotations

import numpy as np

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

    done = np.zeros(len(segments), dtype=bool)

    def walk(e: int, vertex: int) -> list[tuple[int, int]]:
        # the segments that continue e from a vertex on, each from the end that is met first
        links: list[tuple[int, int]] = []
        while len(meeting := at_vertex[vertex]) == 2:
            e = meeting[0] if meeting[1] == e else meeting[1]
            if done[e]:
                break
            done[e] = True
            i, j = segments[e].tolist()
            links.append((vertex, j if i == vertex else i))
            vertex = links[-1][1]
        return links

    ordered: list[tuple[int, int]] = []
    chain: list[int] = []
    n_chain = 0
    for seed in range(len(segments)):
        if done[seed]:
            continue
        done[seed] = True
        tail, head = segments[seed].tolist()
        after = walk(seed, head)
        before = [(far, near) for near, far in walk(seed, tail)]
        links = [*before[::-1], (tail, head), *after]
        ordered += links
        chain += [n_chain] * len(links)
        n_chain += 1
    return np.array(ordered, dtype=np.int64).reshape(-1, 2), np.array(chain, dtype=np.int64)


def facing_alike(segments: Ints, chain: Ints, body: Ints, normal: Floats) -> Ints:
    """Return segments with those chains reversed that face opposite to the first of their body."""
    turned = segments.copy()
    facing: dict[int, Floats] = {}
    for c in range(chain.max() + 1):
        mine = chain == c
        mean = normal[mine].sum(axis=0)
        first = facing.setdefault(int(body[mine][0]), mean)
        if float(product(mean, first)) < 0.0:
            turned[mine] = segments[mine][::-1, ::-1]
    return turned
