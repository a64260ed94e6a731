"""The triangulated tool: its checks, cutting edges, mid-planes and flanks."""

import numba as nb
import numpy as np
import pytest

from blunt_tools import prism
from shellcut.tool.cutting_edge import CUT_DEPTH, CuttingEdges, edge_point, strip_coordinates
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.tool import Tool, ToolError

HALF_ANGLE = np.radians(8.0)  # the base of the wedge turns by 98°, below sharp_angle_deg


def wedge(half_angle=HALF_ANGLE, at=(0.0, 0.0, 0.0)):
    """Edge on the z axis, solid towards -x: vertices 0 (low) and 3 (high) bound the edge."""
    y = np.tan(half_angle)
    vertices, triangles = prism([(0.0, 0.0), (-1.0, y), (-1.0, -y)], 0.0, 2.0)
    return vertices + at, triangles


def joined(*parts):
    vertices, triangles, n = [], [], 0
    for v, t in parts:
        vertices.append(v)
        triangles.append(t + n)
        n += len(v)
    return np.concatenate(vertices), np.concatenate(triangles)


def with_tips(angle):
    """Points of the unit circle, and one above and one below its middle."""
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    return np.concatenate([rim, [[0.0, 0.0, 0.1], [0.0, 0.0, -0.1]]])


def revolved(sections):
    """Vertices and triangles of a ring about z; sections: (n_angle, n_corner, 2), of (r, z)."""
    n_angle, n_corner, _ = sections.shape
    angle = 2.0 * np.pi * np.arange(n_angle)[:, None] / n_angle
    r, z = sections[..., 0], sections[..., 1]
    vertices = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=2).reshape(-1, 3)
    i, k = np.meshgrid(np.arange(n_angle), np.arange(n_corner), indexing="ij")
    a, b = (((i + step) % n_angle * n_corner + k).ravel() for step in (0, 1))
    after = (k.ravel() + 1) % n_corner - k.ravel()
    triangles = np.concatenate(
        [np.stack(t, 1) for t in ((a, b, b + after), (a, b + after, a + after))]
    )
    return vertices, triangles


def crown(n_tooth, first=0, per_tooth=24):
    """Teeth on a tube, sharp on half of its rim and blunt on the rest; walls without a step."""
    low = np.array([[9.18, 0.6], [9.42, 0.6], [9.6, 1.5], [9.6, 5.0], [9.0, 5.0], [9.0, 1.5]])
    sections = np.repeat(low[None], n_tooth * per_tooth, axis=0)
    sharp = (np.arange(len(sections)) + first) % per_tooth <= per_tooth // 2
    sections[sharp, 0], sections[sharp, 1] = (9.3, 0.0), (9.3, 0.0)
    vertices, triangles = revolved(sections)
    # Where the rim is sharp its two corners are one.
    once = [k - (k % 6 == 1 and sharp[k // 6]) for k in range(len(vertices))]
    triangles = np.array(once)[triangles]
    whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return vertices, triangles[whole]


def tube_with_two_edges(n=60):
    """A tube with a closed cutting edge at either end."""
    section = [[9.3, 0.0], [9.6, 1.5], [9.6, 3.5], [9.3, 5.0], [9.0, 3.5], [9.0, 1.5]]
    return revolved(np.repeat(np.array(section)[None], n, axis=0))


def walls(tool):
    """Sides on the outer and on the inner wall of a ring about z."""
    out = tool.triangle_normals[:, :2] * tool.vertices[tool.triangles].mean(axis=1)[:, :2]
    facing = out.sum(axis=1) / 9.3
    return set(tool.flank[facing > 0.9].tolist()), set(tool.flank[facing < -0.9].tolist())


def refusal(*args, **kwargs):
    with pytest.raises(ToolError) as caught:
        Tool.from_triangles(*args, **kwargs)
    return str(caught.value)


class TestCuttingEdge:
    def test_wedge_edge_and_its_sides(self):
        vertices, triangles = wedge()
        assert Tool.from_triangles(vertices, triangles).edges.tolist() == [[0, 3]]
        for edge, plus_y in (([0, 3], -1.0), ([3, 0], 1.0)):
            tool = Tool.from_triangles(vertices, triangles, edges=[edge])
            np.testing.assert_allclose(tool.edge_normal, [[0.0, plus_y, 0.0]], atol=1e-15)
            np.testing.assert_allclose(tool.edge_back, [[-1.0, 0.0, 0.0]], atol=1e-15)
            assert tool.triangle_normals[tool.edge_flank_plus[0], 1] * plus_y > 0.9
            assert tool.triangle_normals[tool.edge_flank_minus[0], 1] * plus_y < -0.9

    @pytest.mark.parametrize("half_angle_deg", [3.0, 12.0, 25.0])
    def test_wedge_turns_by_180_minus_twice_its_half_angle(self, half_angle_deg):
        surface = wedge(np.radians(half_angle_deg))
        turn = 180.0 - 2.0 * half_angle_deg
        assert Tool.from_triangles(*surface, sharp_angle_deg=turn - 0.01).n_edge == 1
        assert f"the sharpest turns by {turn:.1f}" in refusal(*surface, sharp_angle_deg=turn + 0.01)

    def test_mid_plane_bisects_an_uneven_wedge(self):
        section = [(0.0, 0.0), (-1.0, 0.5), (-1.0, 0.1)]
        tool = Tool.from_triangles(*prism(section, 0.0, 2.0), sharp_angle_deg=150.0)
        plus, minus = tool.edge_flank_plus[0], tool.edge_flank_minus[0]
        normals, b, back = tool.triangle_normals, tool.edge_normal[0], tool.edge_back[0]
        assert normals[plus] @ b == pytest.approx(-(normals[minus] @ b), rel=1e-12)
        assert normals[plus] @ back == pytest.approx(normals[minus] @ back, rel=1e-12)
        assert normals[plus] @ back < 0.0  # the faces look forward, the back vector into the solid
        assert abs(b @ back) < 1e-15

    def test_given_segments_are_chained_and_keep_the_first_direction(self):
        vertices = with_tips(np.radians([0.0, 10.0, 20.0, 30.0]))
        fan = [(i, i + 1, 4) for i in range(3)] + [(i + 1, i, 5) for i in range(3)]
        triangles = [*fan, (3, 5, 4), (0, 4, 5)]
        tool = Tool.from_triangles(vertices, triangles, edges=[(2, 1), (0, 1), (3, 2)])
        assert tool.edges.tolist() == [[3, 2], [2, 1], [1, 0]]
        assert tool.edge_chain.tolist() == [0, 0, 0]
        assert (tool.edge_normal[:, 2] < -0.99).all()
        assert (tool.edge_back[:, 0] < 0.0).all()

    def test_disc_knife_has_one_closed_chain_and_two_flanks(self):
        n = 24
        vertices = with_tips(2.0 * np.pi * np.arange(n) / n)
        triangles = [(i, (i + 1) % n, n) for i in range(n)]
        triangles += [((i + 1) % n, i, n + 1) for i in range(n)]
        tool = Tool.from_triangles(vertices, triangles)
        (chain,) = tool.chains()
        assert chain.closed
        assert chain.n_segment == n
        assert chain.length == pytest.approx(2 * n * np.sin(np.pi / n), rel=1e-12)
        assert "closed, through (1, 0, 0), turns by" in str(chain)
        np.testing.assert_array_equal(tool.edges[:, 1], np.roll(tool.edges[:, 0], -1))
        np.testing.assert_array_equal(tool.flank, np.repeat([1, -1], n))

    def test_both_edges_of_a_dagger_agree_on_the_plus_side_beside_a_blunt_body(self):
        dagger = prism([(1.0, 0.0), (0.0, 0.2), (-1.0, 0.0), (0.0, -0.2)], 0.0, 2.0)
        block = prism([(9.0, 1.0), (8.0, 1.0), (8.0, 0.0), (9.0, 0.0)], 0.0, 2.0)
        tool = Tool.from_triangles(*joined(block, dagger))
        assert (tool.n_body, tool.n_chain, tool.n_tooth) == (2, 2, 3)
        assert tool.edge_normal[0] @ tool.edge_normal[1] > 0.99
        side = np.sign(tool.triangle_normals @ tool.edge_normal[0])
        flanks = np.where((abs(side) > 0.5) & (tool.triangle_body == 1), side, 0.0)
        np.testing.assert_array_equal(tool.flank, flanks)
        assert set(tool.triangle_tooth[tool.triangle_body == 0]) == {0}
        assert sorted(tool.edge_tooth) == [1, 2]
        x = tool.vertices[tool.triangles].mean(axis=1)[:, 0]
        for tooth, edge in zip(tool.edge_tooth, tool.edges, strict=True):
            mine = x[tool.triangle_tooth == tooth]
            assert mine.size >= 4
            assert (mine * tool.vertices[edge[0], 0] >= -1e-12).all()

    def test_point_runs_from_the_first_vertex_to_the_second(self):
        tool = Tool.from_triangles(*wedge())
        np.testing.assert_allclose(tool.point(0, 0.25), [0.0, 0.0, 0.5], atol=1e-15)
        with pytest.raises(ValueError, match=r"edge must be in \[0, 1\), got 1"):
            tool.point(1, 0.5)
        with pytest.raises(ValueError, match=r"s must be in \[0, 1\], got 1.5"):
            tool.point(0, 1.5)


class TestFlanks:
    def test_flank_stops_at_the_flank_angle(self):
        # wedge of 8° on parallel flanks: the shoulder turns by 8°
        y = 0.2
        section = [(0.0, 0.0), (-y / np.tan(HALF_ANGLE), y), (-3.0, y), (-3.0, -y)]
        section.append((-y / np.tan(HALF_ANGLE), -y))
        wide = Tool.from_triangles(*prism(section, 0.0, 2.0), flank_angle_deg=9.0)
        narrow = Tool.from_triangles(*prism(section, 0.0, 2.0), flank_angle_deg=7.0)
        assert np.bincount(wide.flank + 1).tolist() == [4, 8, 4]
        assert np.bincount(narrow.flank + 1).tolist() == [2, 12, 2]

    def test_round_back_is_shared_by_the_nearer_edge_side(self):
        angle = np.linspace(np.pi / 2, 3 * np.pi / 2, 16)
        section = np.concatenate([[(3.0, 0.0)], np.column_stack([np.cos(angle), np.sin(angle)])])
        tool = Tool.from_triangles(*prism(section, 0.0, 2.0), edges=[(17, 0)])
        centre = tool.vertices[tool.triangles].mean(axis=1)
        beside = np.abs(tool.triangle_normals[:, 2]) < 0.5
        clear = beside & (np.abs(centre[:, 1]) > 0.2)
        np.testing.assert_array_equal(tool.flank[clear], np.sign(centre[clear, 1]))
        assert (tool.flank[beside] != 0).all()
        assert (tool.flank[~beside] == 0).all()


class TestSurface:
    def test_vertices_are_merged_left_out_and_copied(self):
        vertices, triangles = wedge()
        soup = vertices[triangles].reshape(-1, 3)
        soup += 1e-9 * np.random.default_rng(3).standard_normal(soup.shape)
        tool = Tool.from_triangles(soup, np.arange(len(soup)).reshape(-1, 3))
        assert (tool.n_vertex, tool.n_edge, tool.n_body) == (6, 1, 1)
        tool = Tool.from_triangles(
            np.concatenate([[[9.0, 9.0, 9.0]], vertices]), triangles + 1, edges=[(1, 4)]
        )
        assert tool.n_vertex == 6
        assert tool.edges.tolist() == [[0, 3]]
        with pytest.raises(ValueError, match="read-only"):
            tool.vertices[0, 0] = 1.0
        assert "straight blade" in repr(straight_blade())

    def test_volume_and_box_by_body(self):
        tool = Tool.from_triangles(*joined(wedge(), wedge(np.radians(6.0), at=(5.0, 0.0, 0.0))))
        expected = 2.0 * np.tan([HALF_ANGLE, np.radians(6.0)])
        np.testing.assert_allclose(tool.volume(), expected, rtol=1e-12)
        assert tool.triangle_body.tolist() == [0] * 8 + [1] * 8
        assert tool.edge_body.tolist() == [0, 1]
        lower, upper = tool.bounding_box()
        np.testing.assert_allclose(lower, [-1.0, -np.tan(HALF_ANGLE), 0.0])
        np.testing.assert_allclose(upper, [5.0, np.tan(HALF_ANGLE), 2.0])


class TestRefusals:
    def test_shapes_types_ids_and_angles(self):
        message = refusal(np.zeros((4, 2)), [[0.0, 1.0, 2.0]], edges=[1, 2])
        assert "vertices must have shape (n_vertex, 3), got (4, 2)" in message
        assert "triangles must hold integer vertex ids, got float64" in message
        assert "edges must have shape (n_edge, 2) and at least one row, got (2,)" in message
        vertices, triangles = wedge()
        vertices[2, 1] = np.nan
        message = refusal(vertices, triangles + 1)
        assert "1 vertex not finite, first id 2" in message
        assert "triangles must hold vertex ids in [0, 6), got 1 to 6" in message
        message = refusal(*wedge(), sharp_angle_deg=180.0, flank_angle_deg=0.0)
        assert "sharp_angle_deg must be between 0 and 180, got 180.0" in message
        assert "flank_angle_deg must be between 0 and 90, got 0.0" in message

    def test_triangles_that_do_not_fit(self):
        vertices, triangles = wedge()
        message = refusal(vertices, triangles[:-1])
        assert "3 open edges: the surface has a hole around (-0.666667, 0, 2), 1.039 mm" in message
        flat = np.concatenate([vertices, [[0.0, 0.0, 1.0]]])
        message = refusal(flat, np.concatenate([triangles, [(0, 3, 6)]]))
        assert "1 degenerate triangle (no area), centred at (0, 0, 1)" in message
        fin = np.concatenate([vertices, [[1.0, 0.0, 1.0]]])
        message = refusal(fin, np.concatenate([triangles, [(0, 3, 6)]]))
        assert "1 non-manifold edge (more than two triangles meet): (0, 0, 0) to (" in message
        message = refusal(*joined(wedge(), wedge(at=(1.0, np.tan(HALF_ANGLE), 2.0))))
        assert "1 non-manifold vertex" in message
        assert "move them apart: (0, 0, 2)" in message
        triangles[0] = triangles[0, ::-1]
        message = refusal(vertices, triangles)
        assert "3 edges between triangles of opposite orientation" in message
        assert "triangles[i, ::-1]" in message

    def test_edges_that_cannot_cut(self):
        vertices, triangles = wedge()
        vertices = np.concatenate([vertices, [[3.0, 0.0, 0.0]]])
        message = refusal(vertices, triangles, edges=[(2, 4), (0, 3), (3, 0), (0, 6), (1, 3)])
        assert "3 given cutting edges not an edge of the surface" in message
        assert "with a vertex that no triangle uses" in message
        assert "1 of the given cutting edges repeat" in message
        assert "1 given cutting edge flat or concave" in refusal(
            vertices, triangles, edges=[(0, 4)]
        )
        cube = prism([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 0.0, 2.0)
        message = refusal(*cube)
        assert "none turns by sharp_angle_deg = 100 or more, the sharpest turns by 90.0" in message
        assert 'lower sharp_angle_deg, or choose edges = "none" for a blunt tool' in message

    def test_all_problems_come_together(self):
        (first, t), (second, _) = wedge(), wedge(at=(5.0, 0.0, 0.0))
        message = refusal(*joined((first, t[:-1]), (second, t[:, ::-1])), edges=[(0, 9)])
        assert message.startswith("the surface cannot be a tool:\n- ")
        assert "3 open edges" in message
        assert "negative volume of tooth 2 (of 2)" in message
        assert "vertices, triangles[:, ::-1] for the triangles of that tooth" in message
        assert "1 given cutting edge not an edge" in message
        assert "give vertices, triangles[:, ::-1]" in refusal(first, t[:, ::-1])


def test_strips_of_a_curved_edge_leave_no_gap():
    # Any point behind a tooth's edge, within its height, belongs to some segment.
    tool, deep = tooth_ring(), CUT_DEPTH * 0.375  # of edges of 0.375 mm
    edges = CuttingEdges.of(tool)
    mine = np.flatnonzero(tool.edge_body == 0)
    low, high = tool.vertices[tool.edges[mine[0], 0]], tool.vertices[tool.edges[mine[-1], 1]]
    assert low[2] < high[2]
    for s in np.linspace(0.01, 0.99, 150):
        k = mine[int(s * mine.size)]
        fraction = s * mine.size - int(s * mine.size)
        for depth in (1e-6, 0.1, 0.5, 1.4):
            p = tool.point(int(k), fraction) + depth * tool.edge_back[k]
            found = [strip_coordinates(tuple(p), j, edges.segments, deep)[3] for j in mine]
            assert any(found), (s, depth)


def test_an_edge_point_is_clipped_to_its_segment_and_no_tool_has_none():
    edges = CuttingEdges.of(straight_blade())
    for along, z in ((-0.5, 3.0), (0.0, 3.0), (2.0, 1.0), (6.0, -3.0), (7.0, -3.0)):
        np.testing.assert_allclose(edge_point(along, 0, edges.segments), [0, 0, z], atol=1e-15)
    edges = CuttingEdges.of(None)
    assert edges.segments.shape == (0, 5, 3)
    assert edges.tooth.shape == (0,)
    # A film with cables and without a tool takes the kernels of one with a tool.
    assert nb.typeof(edges) == nb.typeof(CuttingEdges.of(straight_blade()))


RINGS = {
    **{f"{n} teeth from {k}": crown(n, k) for n, k in ((2, 0), (3, 5), (4, 0), (4, 17), (5, 9))},
    "closed edges": tube_with_two_edges(),
}


@pytest.mark.parametrize("name", RINGS)
@pytest.mark.parametrize("turned", [0.0, 0.7, 2.0])
def test_a_smooth_wall_is_one_side_of_all_cutting_edges_on_it(name, turned):
    vertices, triangles = RINGS[name]
    c, s = np.cos(turned), np.sin(turned)
    tool = Tool.from_triangles(
        vertices @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]), triangles
    )
    assert tool.n_body == 1
    assert tool.n_chain >= 2
    assert walls(tool) in (({1}, {-1}), ({-1}, {1}))


@pytest.mark.parametrize("name", RINGS)
@pytest.mark.parametrize("chain", [0, 1])
def test_given_edges_with_opposite_sides_on_a_smooth_wall_are_refused(name, chain):
    vertices, triangles = RINGS[name]
    tool = Tool.from_triangles(vertices, triangles)
    edges = tool.edges.copy()
    assert Tool.from_triangles(tool.vertices, tool.triangles, edges=edges).n_edge == len(edges)
    edges[tool.edge_chain == chain] = edges[tool.edge_chain == chain, ::-1]
    with pytest.raises(ToolError, match=r"must be on the same side.*reverse all segments"):
        Tool.from_triangles(tool.vertices, tool.triangles, edges=edges)


def test_edges_whose_flanks_cannot_agree_are_taken_as_given():
    # Each of three faces of a spike is the plus side of one edge and the minus side of another.
    corners = [[0.0, 0.0, 0.0], [0.5, 0.0, 3.0], [-0.25, 0.4, 3.0], [-0.25, -0.4, 3.0]]
    tool = Tool.from_triangles(
        corners, [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]], edges=[[0, 1], [0, 2], [0, 3]]
    )
    assert tool.edges.tolist() == [[0, 1], [0, 2], [0, 3]]
