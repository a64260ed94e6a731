import numpy as np
import pytest

from films import unstructured_disc
from shellcut import ImprintError, Mesh, PathCurve, imprint
from shellcut.imprinting.edge_line import IN_THE_MESH
from shellcut.mesh.structured import annulus, opening_disc, rectangle

# nodes at x = 0, 0.5, .. 10 and y = -3, -2.5, .. 3; the edge length is 0.5 everywhere
SHEET = rectangle(10.0, 6.0, size=0.5)
TOLERANCE = IN_THE_MESH * 0.5


def untouched(mesh, *curves):
    """Return the chains, after checking that the film is the one that was given."""
    result = imprint(mesh, curves)
    assert result.mesh is mesh
    assert not result.changed
    assert result.there == (True,) * len(result.chains)
    assert result.notes == ()
    assert result.step_after == result.step_before
    assert result.jacobian_after == result.jacobian_before
    assert "nothing was moved" in result.report()
    return result.chains


def along(mesh, chain):
    return mesh.nodes[chain, 0].tolist()


@pytest.mark.parametrize(
    ("start", "end", "first", "last"),
    [
        (2.2, 7.1, 2.0, 7.5),  # amid edges: to the nodes next beyond
        (2.0, 7.0, 2.0, 7.0),  # on nodes
        (2.0 + 0.9 * TOLERANCE, 7.0 - 0.9 * TOLERANCE, 2.0, 7.0),
        (2.0 - 0.9 * TOLERANCE, 7.0 + 0.9 * TOLERANCE, 2.0, 7.0),
        (2.0 - 1.1 * TOLERANCE, 7.0 + 1.1 * TOLERANCE, 1.5, 7.5),
        (4.4, 4.6, 4.0, 5.0),  # shorter than an edge, over a node
        (4.1, 4.4, 4.0, 4.5),  # shorter than an edge, within one
        (4.5, 4.8, 4.5, 5.0),
        (-1.0, 14.0, 0.0, 10.0),  # over the rim
        (-1.0, 4.8, 0.0, 5.0),
        (0.0, 10.0, 0.0, 10.0),
        (0.2, 9.7, 0.0, 10.0),  # in the edges at the rim
        (0.7, 9.2, 0.5, 9.5),  # near the rim: not led on, there is no need
    ],
)
def test_a_straight_path_on_a_line_of_the_mesh(start, end, first, last):
    for curve, ends in (
        (PathCurve.line((start, 0.5), (end, 0.5)), (first, last)),
        (PathCurve.line((end, 0.5), (start, 0.5)), (last, first)),
    ):
        (chain,) = untouched(SHEET, curve)
        x = np.linspace(*ends, round(abs(last - first) / 0.5) + 1)
        # round-off of the mesh's coordinates
        np.testing.assert_allclose(along(SHEET, chain), x, atol=1e-12)
        np.testing.assert_allclose(SHEET.nodes[chain, 1], 0.5, atol=1e-12)


def test_arcs_on_a_ring_anywhere():
    mesh = opening_disc("quick")
    ring = set(mesh.node_set("ring").tolist())
    for start, sweep in ((0.0, 20.0), (3.3, 31.0), (87.1, 4.4), (200.0, 250.0), (1.0, 1.0)):
        (chain,) = untouched(
            mesh, PathCurve.circle((0, 0, 0), 9.4, start_deg=start, end_deg=start + sweep)
        )
        assert ring.issuperset(chain.tolist())
        angle = np.degrees(np.unwrap(np.arctan2(*mesh.nodes[chain, 1::-1].T)))
        angle += 360.0 * round((start - angle[0]) / 360.0)
        # the ends are covered, and no edge more than that
        assert angle[0] <= start + 0.03
        assert angle[1] > start
        assert angle[-1] >= start + sweep - 0.03
        assert angle[-2] < start + sweep


def test_a_closed_path_and_one_through_a_hole():
    (chain,) = untouched(opening_disc("quick"), PathCurve.circle((0, 0, 0), 9.4))
    assert len(chain) == 72
    ring = annulus(3.0, 10.0, n_around=72, n_radial=14)
    found = untouched(ring, PathCurve.line((-12.0, 0.0), (12.0, 0.0)))
    assert [len(c) for c in found] == [15, 15]
    np.testing.assert_allclose(along(ring, found[0])[:: len(found[0]) - 1], [-10.0, -3.0])


def test_the_film_beyond_an_end_may_be_as_it_likes():
    # the line y = 0.5 goes on straight to x = 5 and then aside
    nodes = SHEET.nodes.copy()
    nodes[:, 1] += np.where(
        nodes[:, 0] > 5.1, 0.2 * np.minimum(nodes[:, 0] - 5.0, 1.0) * (3.0 - abs(nodes[:, 1])), 0.0
    )
    mesh = Mesh.from_arrays(nodes, SHEET.quads)
    (chain,) = untouched(mesh, PathCurve.line((2.2, 0.5), (4.8, 0.5)))
    assert along(mesh, chain)[-1] == 5.0
    (chain,) = untouched(mesh, PathCurve.line((2.2, 0.5), (5.0, 0.5)))
    assert along(mesh, chain)[-1] == 5.0
    # here the blade would have no edge under it at the end
    assert imprint(mesh, PathCurve.line((1.2, 0.5), (5.3, 0.5))).changed


@pytest.mark.parametrize(("aside", "there"), [(1.2 * TOLERANCE, True), (1.3 * TOLERANCE, False)])
def test_an_edge_under_an_end_may_stand_off_by_the_tolerance_there(aside, there):
    # the edge from (5, 0.5) ends `aside` the path, which ends at four fifths of it
    nodes = SHEET.nodes.copy()
    nodes[SHEET.nodes_where(lambda x, y, z: (x > 5.1) & (abs(y - 0.5) < 1e-9)), 1] += aside
    result = imprint(Mesh.from_arrays(nodes, SHEET.quads), PathCurve.line((2.2, 0.5), (5.4, 0.5)))
    assert result.there == (there,)


@pytest.mark.parametrize("y", [0.5 + 0.9 * TOLERANCE, 0.5 - 0.9 * TOLERANCE])
def test_a_line_within_the_tolerance_is_there(y):
    untouched(SHEET, PathCurve.line((2.2, y), (7.1, y)))


def test_what_is_not_there_is_put_in():
    for curve in (
        PathCurve.line((2.2, 0.5 + 1.1 * TOLERANCE), (7.1, 0.5 + 1.1 * TOLERANCE)),
        PathCurve.line((2.2, 0.5), (7.1, 0.52)),  # leaves the line by 0.04 edge lengths
    ):
        result = imprint(SHEET, curve)
        assert result.changed
        assert result.there == (False,)


@pytest.mark.parametrize("ends", [(5.0, 5.5), (5.0, 5.3), (5.2, 5.5), (5.1, 5.4)])
def test_the_long_way_round_from_a_place_of_an_edge_to_another_is_not_that_edge(ends):
    # a circle through two places of the edge from (5, 0) to (5.5, 0), and through no other node
    left, right = ends
    centre = (0.5 * (left + right), 1.2, 0.0)
    turn = np.degrees(np.arctan2(0.5 * (right - left), 1.2))
    radius = float(np.hypot(0.5 * (right - left), 1.2))
    short = PathCurve.circle(centre, radius, start_deg=270.0 - turn, end_deg=270.0 + turn)
    (chain,) = untouched(SHEET, short)
    np.testing.assert_allclose(along(SHEET, chain), [5.0, 5.5])
    long = PathCurve.circle(centre, radius, start_deg=turn - 90.0, end_deg=270.0 - turn)
    with pytest.raises(ImprintError):
        imprint(SHEET, long)


def test_paths_that_are_there_ask_for_no_room():
    # half a row from the rim, shorter than four edges, crossing and side by side
    nodes = SHEET.nodes.copy()
    nodes[np.isclose(nodes[:, 1], 2.5), 1] = 2.8
    mesh = Mesh.from_arrays(nodes, SHEET.quads)
    untouched(mesh, PathCurve.line((2.2, 2.8), (8.1, 2.8)))
    with pytest.raises(ImprintError, match="edges off the rim"):
        imprint(mesh, PathCurve.line((2.2, 2.79), (8.1, 2.79)))
    untouched(
        SHEET,
        PathCurve.line((-1.0, 0.0), (11.0, 0.0)),
        PathCurve.line((5.0, -4.0), (5.0, 4.0)),
        PathCurve.line((1.2, 0.5), (3.2, 0.5)),
    )


def test_a_pre_crack_on_the_path_is_no_line_of_edges():
    on_line = SHEET.nodes_where(lambda x, y, z: (abs(y) < 1e-9) & (x < 2.1))
    cut = SHEET.cut(on_line[np.argsort(SHEET.nodes[on_line, 0])])
    with pytest.raises(ImprintError, match="pre-cracks"):
        imprint(cut, PathCurve.line((-1.0, 0.0), (11.0, 0.0)))
    with pytest.raises(ImprintError):
        imprint(cut, PathCurve.line((1.1, 0.0), (1.4, 0.0)))
    for start in (2.0, 2.2):  # from its tip on
        (chain,) = untouched(cut, PathCurve.line((start, 0.0), (11.0, 0.0)))
        assert along(cut, chain)[0] == 2.0


def test_a_path_of_no_length_is_no_line():
    with pytest.raises(ImprintError, match="for 4 edges at least"):
        imprint(SHEET, PathCurve.line((5.0 - 0.3 * TOLERANCE, 0.5), (5.0 + 0.3 * TOLERANCE, 0.5)))


def test_where_one_of_two_paths_is_there_its_nodes_stay():
    there, new = (PathCurve.line((1.7, y), (8.2, y)) for y in (-1.0, 0.7))
    # the other comes first: its chain keeps clear of the line that is there
    for curves, k in (((there, new), 0), ((new, there), 1)):
        result = imprint(SHEET, curves)
        assert result.there == (k == 0, k == 1)
        np.testing.assert_allclose(along(SHEET, result.chains[k]), np.arange(1.5, 8.6, 0.5))
        kept = result.chains[k]
        np.testing.assert_array_equal(result.mesh.nodes[kept], SHEET.nodes[kept])
        assert not np.isin(kept, result.moved).any()
        keys = set(map(tuple, result.mesh.edges().nodes.tolist()))
        assert keys.issuperset(
            tuple(sorted(p)) for p in zip(kept[:-1].tolist(), kept[1:].tolist(), strict=True)
        )
        np.testing.assert_allclose(result.mesh.nodes[result.chains[1 - k], 1], 0.7, atol=1e-12)
        assert result.jacobian_after > 0.7
        assert "beside 14 that were there" in result.report()


def test_new_paths_keep_clear_of_lines_that_are_there_and_those_need_not():
    line = PathCurve.line((1.7, -2.0), (8.2, -2.0))
    with pytest.raises(ImprintError, match=r"must keep 2\.5 edges apart"):
        imprint(SHEET, [line, PathCurve.line((1.7, -0.8), (8.2, -0.8))])
    crossing = PathCurve.line((5.0, -2.9), (5.0, -0.8))
    result = imprint(SHEET, [line, crossing, PathCurve.line((1.7, 1.3), (8.2, 1.3))])
    assert result.there == (True, True, False)
    kept = np.concatenate(result.chains[:2])
    np.testing.assert_array_equal(result.mesh.nodes[kept], SHEET.nodes[kept])


def test_a_path_put_in_is_there_the_next_time():
    first = imprint(unstructured_disc(spacing=1.4), PathCurve.line((-3.0, 0.3), (4.0, 2.0)))
    assert first.changed
    again = untouched(first.mesh, PathCurve.line((-3.0, 0.3), (4.0, 2.0)))
    assert set(again[0].tolist()) <= set(first.chains[0].tolist())


def test_in_any_plane():
    R = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [-0.3, 1.0, 0.7], [0.2, -0.9, 1.1]]))[0]
    tilted = Mesh.from_arrays(SHEET.nodes @ R.T, SHEET.quads)
    ends = np.array([[2.2, 0.5, 0.0], [7.1, 0.5, 0.0]]) @ R.T
    (chain,) = untouched(tilted, PathCurve.line(*ends.tolist()))
    np.testing.assert_allclose(along(SHEET, chain), np.linspace(2.0, 7.5, 12))
