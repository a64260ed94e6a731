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
