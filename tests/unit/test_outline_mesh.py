"""Films meshed from their outline by Gmsh."""

import subprocess
import sys

import numpy as np
import pytest

from other_script import run_instead
from shellcut.mesh.checks import MeshError
from shellcut.mesh.outline import mesh_from_outline

L_SHAPE = [[0, 0], [10, 0], [10, 4], [4, 4], [4, 9], [0, 9]]
ANGLE = np.linspace(0.0, 2.0 * np.pi, 300, endpoint=False)
CIRCLE = np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=1)


class TestWithGmsh:
    @pytest.fixture(autouse=True)
    def gmsh(self):
        return pytest.importorskip("gmsh", exc_type=ImportError)

    def test_corners_are_nodes_and_the_area_is_that_of_the_polygon(self):
        mesh = mesh_from_outline(L_SHAPE, size=0.5)
        assert mesh.quad_areas().sum() == pytest.approx(60.0, rel=1e-12)  # round-off
        for corner in L_SHAPE:
            assert (np.abs(mesh.nodes[:, :2] - corner).max(axis=1) == 0.0).any()
        assert mesh.scaled_jacobian().min() > 0.4  # measured 0.71
        lengths = mesh.edge_lengths()
        assert 0.15 < lengths.min() < lengths.max() < 1.0

    def test_the_boundary_is_the_sets_in_order_around(self):
        mesh = mesh_from_outline(
            5.0 * CIRCLE, size=0.6, holes=[CIRCLE, 0.5 * CIRCLE + np.array([3.0, 0.0])]
        )
        names = ("outline", "hole_1", "hole_2")
        rims = [mesh.node_set(name) for name in names]
        assert set(np.concatenate(rims)) == set(mesh.boundary_nodes())
        assert len(rims[0]) == 52  # 2 pi 5 / 0.6, made even: a smooth outline keeps no vertices
        edges = {tuple(e) for e in mesh.edges().nodes[mesh.edges().n_quad == 1].tolist()}
        around = {
            tuple(sorted(pair)) for rim in rims for pair in zip(rim, np.roll(rim, -1), strict=True)
        }
        assert around == edges
        radius = np.hypot(*mesh.nodes[rims[0], :2].T)
        # on the polygon's sides, whose middles lie 5 (1 - cos(pi / 300)) inside the circle
        assert np.ptp(radius) < 3e-4

    @pytest.mark.parametrize("outer", [1, -1])
    @pytest.mark.parametrize("inner", [1, -1])
    def test_the_normal_is_up_whichever_way_the_loops_run(self, outer, inner):
        hole = 0.8 * CIRCLE[::inner] + [2.0, 2.0]
        mesh = mesh_from_outline(L_SHAPE[::outer], holes=[hole], size=1.0)
        np.testing.assert_allclose(mesh.directors, np.tile([0.0, 0.0, 1.0], (mesh.n_node, 1)))
        x, y, _ = mesh.nodes[mesh.node_sets["outline"]].T
        runs = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
        assert np.sign(runs) == outer  # the set runs as the outline is given

    @pytest.mark.parametrize("size", [0.37, 0.5, 0.71, 2.0, 20.0])
    def test_quads_only_at_any_size(self, size):
        mesh = mesh_from_outline(L_SHAPE, size=size)
        assert mesh.quad_areas().sum() == pytest.approx(60.0, rel=1e-12)

    def test_the_same_outline_gives_the_same_mesh(self):
        one, two = (mesh_from_outline(L_SHAPE, size=0.7) for _ in range(2))
        np.testing.assert_array_equal(one.nodes, two.nodes)
        np.testing.assert_array_equal(one.quads, two.quads)


@pytest.mark.parametrize(
    ("outline", "holes", "size", "words"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], [], 0.1, "outline crosses itself at"),
        ([[0, 0], [1, 0]], [], 0.1, "outline must be three points or more"),
        ([[0, 0], [0, 0], [1, 0]], [], 0.1, "different vertices, vertex 0 is"),
        ([[0, 0], [1, np.nan], [1, 0]], [], 0.1, "outline must be finite"),
        (5.0 * CIRCLE, [CIRCLE + 20.0], 0.5, "hole_1 lies outside"),
        (5.0 * CIRCLE, [CIRCLE + np.array([4.5, 0.0])], 0.5, "outline crosses hole_1"),
        (5.0 * CIRCLE, [3.0 * CIRCLE, CIRCLE], 0.5, "hole_2 lies in a hole"),
        (5.0 * CIRCLE, [], 0.0, "size must be positive, got 0.0 mm"),
    ],
)
def test_refusals(outline, holes, size, words):
    with pytest.raises(ValueError, match=words):
        mesh_from_outline(outline, size=size, holes=holes)


def test_a_missing_gmsh_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "gmsh", None)
    with pytest.raises(ImportError, match=r"pip install 'shellcut-fem\[mesh\]'"):
        mesh_from_outline(L_SHAPE, size=1.0)


def test_a_gmsh_that_fails_is_told(monkeypatch, tmp_path):
    run_instead(monkeypatch, tmp_path, "raise ValueError('odd')")
    monkeypatch.setitem(sys.modules, "gmsh", np)  # whatever is installed
    with pytest.raises(MeshError, match=r"outline cannot be meshed: Gmsh .* ValueError: odd"):
        mesh_from_outline(L_SHAPE, size=1.0)


def test_gmsh_stays_out_of_this_process():
    square = "[(0, 0), (2, 0), (2, 2), (0, 2)]"
    script = f"import sys, shellcut; shellcut.mesh_from_outline({square}, size=1.0);"
    pytest.importorskip("gmsh", exc_type=ImportError)
    subprocess.run([sys.executable, "-c", f"{script} assert 'gmsh' not in sys.modules"], check=True)
