"""Which quads of a node own the flank of a crack edge, and with it the half-edge of a cable there.

A crack edge has two flanks, each the edge of one quad. A cable holds up to two half-edges of its
node, known by the origin of their far ends; where the node is parted, each goes with the quads that
own its flank.
"""

from __future__ import annotations

import numpy as np

from shellcut.state import State


def cable_ends(state: State, node: int) -> list[tuple[int, int]]:
    """Return (cable, end) of the cables that hold a node, broken ones included."""
    c = state.cable
    which, end = np.nonzero(c.ends[: c.count] == node)
    return list(zip(which.tolist(), end.tolist(), strict=True))


def half_edges(state: State, cable: int) -> list[int]:
    """Return which of its two half-edges a cable has."""
    return [i for i in range(2) if state.cable.half_edge[cable, i] > 0]


def owned_half_edges(state: State, cable: int, node: int, quads: tuple[int, ...]) -> list[int]:
    """Return which half-edges of a cable belong to these quads of the node that it holds."""
    far = state.cable.half_edge_far[cable]
    return [i for i in half_edges(state, cable) if owns_flank(state, node, quads, int(far[i]))]


def cable_shares(state: State, node: int, quads: tuple[int, ...]) -> list[tuple[int, int, float]]:
    """Return what of the cables on a node goes with some of its quads: (cable, end, share)."""
    shares = []
    for cable, end in cable_ends(state, node):
        length = state.cable.half_edge[cable]
        mine = sum(float(length[i]) for i in owned_half_edges(state, cable, node, quads))
        shares.append((cable, end, mine / float(length.sum())))
    return shares


def owns_flank(state: State, node: int, quads: tuple[int, ...], far_origin: int) -> bool:
    """Whether one of the quads at a node has the edge to a far end of the given origin."""
    for e in quads:
        ring = state.quads[e].tolist()
        a = ring.index(node)
        if far_origin in (
            int(state.node.origin[ring[(a + 1) % 4]]),
            int(state.node.origin[ring[a - 1]]),
        ):
            return True
    return False
