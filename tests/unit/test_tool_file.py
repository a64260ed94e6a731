"""Tools from files: the default tooth out and back, in every disguise; chains; refusals."""

import os
import subprocess
import sys

import numpy as np
import pytest
import scipy

from shellcut import read_tool
from shellcut.formats.errors import FileError
from shellcut.formats.stl import write_stl
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.tool import Tool, ToolError

RING = tooth_ring()
V = RING.vertices
ALONG_0_3_4 = [[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]]
SINGLE = 2e-6  # mm; single precision of 10 mm is 5e-7, some operations on it


def turned(which):
    triangles = RING.triangles.copy()
    triangles[which] = triangles[which, ::-1]
    return triangles


@pytest.fixture
def cap(tmp_path):
    path = tmp_path / "cap.stl"
    RING.write(path)
    return path


def check_ring(tool, places=RING.vertices):
    """The tool is the ring of teeth: bodies, edges where they were, mid-planes, flanks."""
    assert (tool.n_body, tool.n_triangle, tool.n_edge) == (4, RING.n_triangle, RING.n_edge)
    assert [chain.n_segment for chain in tool.chains()] == [15] * 4
    assert not any(chain.closed for chain in tool.chains())

    def middles(of, vertices):
        return vertices[of.edges].mean(axis=1)

    ours, known = middles(tool, tool.vertices), middles(RING, places)
    distance = np.linalg.norm(ours[:, None] - known[None], axis=2)
    match = distance.argmin(axis=1)
    assert sorted(match) == list(range(RING.n_edge))
    assert distance.min(axis=1).max() < SINGLE
    # single precision turns the facets of a 0.4 mm segment by 5e-7 / 0.05
    np.testing.assert_allclose(tool.volume().sum(), RING.volume().sum(), rtol=1e-5)
    assert abs((tool.flank == 0).sum() - (RING.flank == 0).sum()) == 0
    return match


class TestTheDefaultToothOutAndBack:
    def test_the_same_edges_and_flanks(self, cap):
        tool = read_tool(cap, unit="mm")
        match = check_ring(tool)
        turned = np.einsum("ij,ij->i", tool.edge_normal, RING.edge_normal[match])
        np.testing.assert_allclose(np.abs(turned), 1.0, atol=1e-5)  # sine of 1e-5 squared is less
        assert len({round(t) for t in turned}) == 1  # plus is the same side on all teeth
        np.testing.assert_allclose(tool.edge_back, RING.edge_back[match], atol=1e-4)
        assert tool.name == "cap.stl"

    @pytest.mark.parametrize(
        ("vertices", "triangles", "options", "said"),
        [
            (V, turned(slice(None)), {}, "4 of 4 bodies were inside out and are turned"),
            (V, turned(slice(0, None, 3)), {}, "were oriented against their neighbours and are tu"),
            (V, RING.triangles, {"unit": None}, "no unit given: taken as mm, the tool is 19."),
            (V / 25.4, RING.triangles, {"unit": "inch"}, ""),
            (V / 1000.0, RING.triangles, {"unit": "m"}, ""),
            (V / 2.5, RING.triangles, {"unit": 2.5}, ""),
            (V - [1.0, 2.0, 3.0], RING.triangles, {"shift": (1.0, 2.0, 3.0)}, ""),
            # The file holds the tool turned so that its z lies along the axis.
            (V @ [[0, 0, -1], [0, 1, 0], [1, 0, 0]], RING.triangles, {"axis": "x"}, ""),
            (V @ [[1, 0, 0], [0, 0, -1], [0, 1, 0]], RING.triangles, {"axis": "y"}, ""),
            (V @ [[1, 0, 0], [0, -1, 0], [0, 0, -1]], RING.triangles, {"axis": "-z"}, ""),
            (V @ ALONG_0_3_4, RING.triangles, {"axis": (0, 3, 4)}, ""),
        ],
    )
    def test_in_every_disguise(self, cap, caplog, vertices, triangles, options, said):
        write_stl(cap, vertices, triangles, header="disguised")
        check_ring(read_tool(cap, **{"unit": "mm", **options}))
        assert said in caplog.text

    def test_a_hole_is_told_by_its_place(self, cap):
        triangles = np.delete(RING.triangles, [40, 41], axis=0)
        write_stl(cap, RING.vertices, triangles, header="hole")
        place = RING.vertices[np.unique(RING.triangles[[40, 41]])].mean(axis=0)
        with pytest.raises(ToolError, match=r"surface in .*cap\.stl cannot be a tool") as caught:
            read_tool(cap, unit="mm")
        (problem,) = caught.value.problems
        assert "mm across, with 4 edges" in problem
        told = [float(c) for c in problem.split("around (")[1].split(")")[0].split(", ")]
        np.testing.assert_allclose(told, place, atol=1e-4)  # to six digits


def block(path):
    """A box of 2 x 3 x 4 mm: its edges turn by 90 degrees, so none cuts."""
    corners = np.array(np.meshgrid([0, 2], [0, 3], [0, 4])).reshape(3, -1).T.astype(float)
    hull = scipy.spatial.ConvexHull(corners)
    write_stl(path, corners, hull.simplices.astype(np.int64), header="box")
    return path


def test_no_edge_cuts_when_none_is_chosen(tmp_path, cap, caplog):
    path = block(tmp_path / "box.stl")
    with pytest.raises(ToolError, match='choose edges = "none" for a blunt tool'):
        read_tool(path, unit="mm")
    tool = read_tool(path, unit="mm", edges="none")
    assert (tool.n_edge, tool.n_chain, tool.volume().tolist()) == (0, 0, [pytest.approx(24.0)])
    caplog.clear()
    assert read_tool(cap, unit="mm", edges="none").n_edge == 0
    assert "cutting edges found" not in caplog.text
    with pytest.raises(ValueError, match="or 'none', got 'all'"):
        Tool.from_triangles(tool.vertices, tool.triangles, edges="all")


class TestSize:
    """Memory and time grow as the file, whatever meets in a place."""

    @pytest.mark.skipif(sys.platform != "linux", reason="limits memory")
    def test_a_fan_on_one_edge_under_a_limit_of_memory(self, tmp_path):
        # the pairs of 20,000 vertices at one place would take 6 GB, twice
        n = 20_000
        turn = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
        rim = np.stack([5.0 * np.cos(turn), 5.0 * np.sin(turn), 0.0 * turn + 2.0], axis=1)
        vertices = np.concatenate([[[0.0, 0.0, 0.0], [0.0, 0.0, 5.0]], rim])
        triangles = np.stack([np.zeros(n), np.ones(n), 2 + np.arange(n)], axis=1).astype(int)
        write_stl(tmp_path / "fan.stl", vertices, triangles, header="fan")
        script = (
            "import resource, sys; resource.setrlimit(resource.RLIMIT_AS, (4 * 10**9,) * 2); "
            "from shellcut import read_tool; read_tool(sys.argv[1], unit='mm')"
        )
        done = subprocess.run(
            [sys.executable, "-c", script, str(tmp_path / "fan.stl")],
            capture_output=True,
            text=True,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"},
        )
        assert "1 non-manifold edge" in done.stderr
        assert "MemoryError" not in done.stderr

    def test_vertices_that_are_close_to_too_many_others(self, tmp_path):
        rng = np.random.default_rng(1)
        vertices = rng.uniform(0.0, 1.0, (9000, 3))
        write_stl(tmp_path / "soup.stl", vertices, np.arange(9000).reshape(-1, 3), header="soup")
        with pytest.raises(FileError, match=r"got 40,495,500 of 9,000 points: lower the distance"):
            read_tool(tmp_path / "soup.stl", unit="mm", merge=2.0)

    def test_holes_of_a_soup_are_told_the_largest_first(self, tmp_path):
        rng = np.random.default_rng(2)
        size = rng.permutation(np.arange(1.0, 301.0))
        corner = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]]) / 1000.0
        places = 2.0 * np.arange(300.0)[:, None, None] * [1.0, 0.0, 0.0]
        vertices = (places + size[:, None, None] * corner).reshape(-1, 3)
        write_stl(tmp_path / "soup.stl", vertices, np.arange(900).reshape(-1, 3), header="soup")
        with pytest.raises(ToolError) as caught:
            read_tool(tmp_path / "soup.stl", unit="mm")
        k = int(size.argmax())
        first = f"has 300 holes around ({2 * k + 0.3:.6g}, 0.4, 0), 1.5 mm across, with 3 edges, "
        assert first in str(caught.value)


class TestChains:
    def test_a_chain_chosen_not_to_cut(self, cap, caplog):
        tool = read_tool(cap, unit="mm", not_cutting=[1])
        assert tool.n_chain == 3
        assert tool.n_triangle == RING.n_triangle
        every = read_tool(cap, unit="mm").chains()
        for chain, known in zip(tool.chains(), [every[0], *every[2:]], strict=True):
            assert chain.length == known.length
            np.testing.assert_array_equal(chain.start, known.start)
        # the flanks of the tooth that does not cut are none any more
        assert set(tool.flank[tool.triangle_body == every[1].body]) == {0}
        assert "3 cutting edges found by angle" in caplog.text

    def test_wrong_and_all_chains_are_refused(self):
        with pytest.raises(
            ToolError,
            match=r"no cutting edges \[7\], .* cutting edge 1 \(not_cutting = \[0\]\) of body 1",
        ):
            RING.without_cutting(7)
        with pytest.raises(ToolError, match="at least one edge must cut"):
            RING.without_cutting(0, 1, 2, 3)

    def test_length_place_and_angle(self):
        blade = straight_blade(height=4.0, wedge_half_angle_deg=10.0)
        (chain,) = blade.chains()
        assert chain.length == pytest.approx(4.0, rel=1e-15)
        np.testing.assert_allclose(chain.start, [0.0, 0.0, 2.0], atol=1e-15)
        np.testing.assert_allclose(chain.centre, 0.0, atol=1e-15)
        assert chain.turn_deg == pytest.approx((160.0, 160.0), rel=1e-12)
        assert str(chain).startswith(
            "cutting edge 1 (not_cutting = [0]) of body 1: 1 segment, 4 mm, open, (0, 0, 2) to"
        )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"axis": "w"}, "axis must be x, y, z"),
        ({"axis": (0.0, 0.0, 0.0)}, "a direction of three numbers"),
        ({"shift": (1.0, 2.0)}, "shift must be three finite numbers"),
        ({"unit": -1.0}, "unit must be a finite length above 0"),
        ({"not_cutting": [9]}, "there are no cutting edges"),
    ],
)
def test_options_that_cannot_be_are_refused(cap, options, words):
    with pytest.raises(ValueError, match=words):
        read_tool(cap, **{"unit": "mm", **options})


def test_other_files_are_refused(cap, tmp_path):
    with pytest.raises(FileError, match=r"must end in one of \.stl, \.obj, \.ply, \.step"):
        read_tool(tmp_path / "cap.sldprt")
    with pytest.raises(ValueError, match=r"a tool is written as \.stl"):
        RING.write(tmp_path / "cap.obj")
    vertices = RING.vertices.copy()
    vertices[3] = np.nan
    with np.errstate(invalid="ignore"):
        write_stl(cap, vertices, RING.triangles, header="nan")
    with pytest.raises(FileError, match=r"must be finite numbers, got vertex \d+ at \(nan, "):
        read_tool(cap, unit="mm")
