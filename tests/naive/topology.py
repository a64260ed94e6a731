"""Cracks from the reference mesh alone: which quads on either side of an edge no longer agree."""

import numpy as np


def reference_edges(mesh):
    """Inner edges of the reference mesh: (node, node) -> its two quads."""
    sides = {}
    for e, quad in enumerate(mesh.quads.tolist()):
        for a in range(4):
            sides.setdefault(tuple(sorted((quad[a], quad[(a + 1) % 4]))), []).append(e)
    return {edge: quads for edge, quads in sides.items() if len(quads) == 2}


def open_ends(mesh, state):
    """Every end of every inner edge at which it has opened: (node, far) -> its two node copies."""
    found = {}
    for (i, j), (e, f) in reference_edges(mesh).items():
        for node, far in ((i, j), (j, i)):
            copies = [int(state.quads[q, mesh.quads[q].tolist().index(node)]) for q in (e, f)]
            if copies[0] != copies[1]:
                found[node, far] = frozenset(copies)
    return found


def crack_length(mesh, state):
    """Sum of half the lengths of all edges at their open ends [mm]."""
    return sum(
        0.5 * float(np.linalg.norm(mesh.nodes[i] - mesh.nodes[j]))
        for i, j in open_ends(mesh, state)
    )


def parted(state, node, cut):
    """Groups of the quads at a node when its edges to the nodes ``cut`` no longer connect them."""
    around = [e for e in range(len(state.quads)) if node in state.quads[e]]
    groups = []
    for e in around:
        ring = state.quads[e].tolist()
        a = ring.index(node)
        mine = {ring[(a + 1) % 4], ring[a - 1]} - set(cut)
        joined = [g for g in groups if g[1] & mine]
        for g in joined:
            groups.remove(g)
        quads = {e}.union(*(g[0] for g in joined))
        groups.append((quads, mine.union(*(g[1] for g in joined))))
    return sorted(tuple(sorted(quads)) for quads, _ in groups)
