"""Ready-made tools; the code is in :mod:`shellcut.tool.shapes` and the files beside it.

>>> straight_blade(length=4.0, height=3.0).n_chain  # mm; its cutting edges
1
"""

from .tool.shapes import (
    BLUNTEST_EDGE,
    DEFAULT_DEVIATION,
    EDGE_DEVIATION,
    FLANK_MARGIN,
    LONGEST_TRIANGLE,
    MOST_TRIANGLES,
    round_bar,
    straight_blade,
    tooth_ring,
)

__all__ = [
    "BLUNTEST_EDGE",
    "DEFAULT_DEVIATION",
    "EDGE_DEVIATION",
    "FLANK_MARGIN",
    "LONGEST_TRIANGLE",
    "MOST_TRIANGLES",
    "round_bar",
    "straight_blade",
    "tooth_ring",
]
