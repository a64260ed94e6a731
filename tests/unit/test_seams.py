"""Seams between faces of a CAD surface."""

import numpy as np

from shellcut.tool.seams import closed_seams
from shellcut.tool.surface import Surface


def test_seams_of_faces_that_differ_are_closed():
    """A double pyramid whose halves have different vertices on one side of the common square."""
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    tips = [[0.5, 0.5, -1], [0.5, 0.5, 1]]
    extra = [[0.3, 0, 0], [0.7, 1e-3, 0], [0.5, 0, 0]]
    places = np.array([*square, *square, *tips, *extra], dtype=float)
    triangles = []
    for rim, tip, turn in (([0, 10, 11, 1, 2, 3], 8, -1), ([4, 12, 5, 6, 7], 9, 1)):
        pairs = zip(rim, [*rim[1:], rim[0]], strict=True)
        triangles += [[a, b, tip][::turn] for a, b in pairs]
    joined, rows, n_put = closed_seams(places, np.array(triangles), merge=1e-6, reach=2e-3)
    assert n_put == 3
    assert len(joined) == 9
    assert not Surface(joined, rows).problems()
    joined, rows, n_put = closed_seams(places, np.array(triangles), merge=1e-6, reach=5e-4)
    assert n_put == 2  # the vertex a micrometre away stays out
    assert "open edges: the surface has a hole" in Surface(joined, rows).problems()[0]
