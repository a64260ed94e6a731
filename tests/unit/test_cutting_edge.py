"""Coordinates along, beside and behind a cutting edge."""

import numba as nb
import numpy as np
import pytest

from shellcut.tool.cutting_edge import (
    CUT_DEPTH,
    CuttingEdges,
    edge_point,
    strip_coordinates,
)
from shellcut.tool.shapes import straight_blade, tooth_ring

DEEP = CUT_DEPTH * 0.375
"""How deep a point is owned on edges of 0.375 mm."""


def strip(p, k, edges):
    return strip_coordinates(tuple(p), k, edges.segments, DEEP)


@pytest.mark.parametrize(
    ("point", "owned"),
    [
        ((-1e-9, 0, 0), True),  # just passed
        ((1e-9, 0, 0), False),  # in front
        ((-0.3, 99.0, 0), True),  # ownership says nothing of what lies beside
        ((-DEEP + 1e-6, 0, 0), True),
        ((-DEEP - 1e-6, 0, 0), False),
        ((-1e-6, 0, 3.001), False),
        ((-1e-6, 0, -3.001), False),
        ((-0.1, 0, 3.019), True),  # strips widen by a fifth of the depth, for curved edges
        ((-0.1, 0, 3.021), False),
        ((-0.1, 0, -3.019), True),
        ((-0.1, 0, -3.021), False),
    ],
)
def test_ownership(point, owned):
    assert strip(point, 0, CuttingEdges.of(straight_blade()))[3] is owned


@pytest.mark.parametrize("k", [0, 3, 7])
def test_coordinates_are_a_rotated_frame(k):
    tool = tooth_ring()
    edges = CuttingEdges.of(tool)
    a, b = tool.vertices[tool.edges[k]]
    e = (b - a) / np.linalg.norm(b - a)
    frame = np.array([e, tool.edge_normal[k], tool.edge_back[k]])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    p = a + frame.T @ [0.05, -0.2, 0.3]
    along, lateral, depth, owns = strip(p, k, edges)
    # Round-off at positions of some 10 mm.
    np.testing.assert_allclose([along, lateral, depth], [0.05, -0.2, 0.3], atol=1e-13)
    assert owns
    assert edges.tooth[k] == tool.edge_tooth[k]


def test_strips_of_a_curved_edge_leave_no_gap():
    # Any point behind a tooth's edge, within its height, belongs to some segment.
    tool = tooth_ring()
    edges = CuttingEdges.of(tool)
    mine = np.flatnonzero(tool.edge_body == 0)
    low, high = tool.vertices[tool.edges[mine[0], 0]], tool.vertices[tool.edges[mine[-1], 1]]
    assert low[2] < high[2]
    for s in np.linspace(0.01, 0.99, 150):
        k = mine[int(s * mine.size)]
        fraction = s * mine.size - int(s * mine.size)
        for depth in (1e-6, 0.1, 0.5, 1.4):
            p = tool.point(int(k), fraction) + depth * tool.edge_back[k]
            assert any(strip(p, j, edges)[3] for j in mine), (s, depth)


def test_an_edge_point_is_clipped_to_its_segment_and_no_tool_has_none():
    edges = CuttingEdges.of(straight_blade())
    for along, z in ((-0.5, 3.0), (0.0, 3.0), (2.0, 1.0), (6.0, -3.0), (7.0, -3.0)):
        np.testing.assert_allclose(edge_point(along, 0, edges.segments), [0, 0, z], atol=1e-15)
    edges = CuttingEdges.of(None)
    assert edges.segments.shape == (0, 4, 3)
    assert edges.tooth.shape == (0,)
    # A film with cables and without a tool takes the kernels of one with a tool.
    assert nb.typeof(edges) == nb.typeof(CuttingEdges.of(straight_blade()))
