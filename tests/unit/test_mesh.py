import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from naive import cases
from shellcut.mesh import checks
from shellcut.mesh.mesh import MAX_VALENCE, Mesh, MeshError
from shellcut.mesh.structured import annulus, cylinder, rectangle

# two unit squares side by side:   3 - 4 - 5
#                                  |   |   |
#                                  0 - 1 - 2
NODES = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]]
QUADS = [[0, 1, 4, 3], [1, 2, 5, 4]]


def three(nodes):
    return np.column_stack([nodes, np.zeros(len(nodes))])


def refusal(*args, **kwargs):
    with pytest.raises(ValueError) as caught:  # noqa: PT011
        Mesh.from_arrays(*args, **kwargs)
    return str(caught.value)


# --- what a mesh is ------------------------------------------------------------------------------


def test_arrays_are_cast_copied_and_read_only():
    nodes, quads, left = np.array(NODES, dtype=np.float32), np.array(QUADS, np.int32), [0, 3]
    mesh = Mesh.from_arrays(nodes, quads, node_sets={"left": left}, quad_sets={"all": [1, 0]})
    for array in (mesh.nodes, mesh.directors):
        assert array.dtype == np.float64
        assert not array.flags.writeable
    for array in (mesh.quads, mesh.origin, mesh.node_sets["left"], mesh.quad_sets["all"]):
        assert array.dtype == np.int64
        assert not array.flags.writeable
    assert mesh.quad_set("all").tolist() == [1, 0]
    assert mesh.origin.tolist() == list(range(6))
    nodes[0] = 7.0  # the caller's arrays stay the caller's
    quads[0] = 0
    assert mesh.nodes[0].tolist() == [0.0, 0.0, 0.0]
    assert mesh.quads.tolist() == QUADS
    with pytest.raises(FrozenInstanceError):
        mesh.nodes = mesh.nodes
    with pytest.raises(TypeError):
        mesh.node_sets["left"] = np.array([0])
    mesh = mesh.cut([1, 4])
    again = pickle.loads(pickle.dumps(mesh))
    for name in ("nodes", "quads", "directors", "origin"):
        assert np.array_equal(getattr(again, name), getattr(mesh, name))
        assert not getattr(again, name).flags.writeable
    assert "8 nodes, 2 quads, node_sets=['left']" in repr(again)


def test_edges_name_their_quads():
    edges = Mesh.from_arrays(NODES, QUADS).edges()
    assert edges.nodes.tolist() == [[0, 1], [0, 3], [1, 2], [1, 4], [2, 5], [3, 4], [4, 5]]
    assert edges.n_quad.tolist() == [1, 1, 1, 2, 1, 1, 1]
    assert [set(quads) for quads in edges.quads.tolist()] == [{0}, {0}, {1}, {0, 1}, {1}, {0}, {1}]


def test_lengths_areas_jacobian_and_boundary():
    mesh = rectangle(4.0, 4.0, n_x=4, n_y=4)
    inner = mesh.nodes_where(lambda x, y, z: (x > 0.5) & (x < 3.5) & (abs(y) < 1.5))
    assert len(inner) == 9
    assert np.array_equal(mesh.boundary_nodes(), np.setdiff1d(np.arange(25), inner))
    mesh = Mesh.from_arrays([[0, 0], [4, 0], [3, 1], [0, 1]], [[0, 1, 2, 3]])
    assert mesh.edge_lengths() == pytest.approx(np.array([[4.0, np.sqrt(2.0), 3.0, 1.0]]))
    assert mesh.quad_areas() == pytest.approx([3.5], rel=1e-14)
    assert mesh.scaled_jacobian() == pytest.approx([np.sqrt(0.5)], rel=1e-14)


def test_area_of_a_warped_quad_is_that_of_the_bilinear_surface():
    nodes = np.array([[0, 0, 0], [1, 0, 0.3], [1.2, 1.1, -0.2], [0, 1, 0.2]])
    mesh = Mesh.from_arrays(nodes, [[0, 1, 2, 3]])
    n = 200  # midpoint rule
    s = (np.arange(n) + 0.5) / n
    s, t = (a.ravel()[:, None] for a in np.meshgrid(s, s))
    along = (nodes[1] - nodes[0]) * (1 - t) + (nodes[2] - nodes[3]) * t
    across = (nodes[3] - nodes[0]) * (1 - s) + (nodes[2] - nodes[1]) * s
    area = np.linalg.norm(np.cross(along, across), axis=1).mean()
    assert mesh.quad_areas()[0] == pytest.approx(area, rel=1e-3)  # 2x2 points: measured 3e-4


# --- directors -----------------------------------------------------------------------------------


def test_directors_of_a_plane_mesh_are_exact_and_all_the_same():
    mesh = annulus(1.3, 2.9, n_around=17, n_radial=3)
    assert np.array_equal(mesh.directors, np.tile([0.0, 0.0, 1.0], (mesh.n_node, 1)))
    flipped = Mesh.from_arrays(mesh.nodes, mesh.quads[:, ::-1])
    assert np.array_equal(flipped.directors, np.tile([0.0, 0.0, -1.0], (mesh.n_node, 1)))
    assert not np.signbit(flipped.directors[:, :2]).any()
    # an orthogonal matrix of determinant 1 with no zero entry
    turn, _ = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [-0.3, 1.0, 0.7], [0.2, -0.9, 1.1]]))
    turn *= np.sign(np.linalg.det(turn))
    mesh = Mesh.from_arrays(mesh.nodes @ turn.T, mesh.quads)
    assert np.array_equal(mesh.directors, np.tile(mesh.directors[0], (mesh.n_node, 1)))
    assert mesh.directors[0] == pytest.approx(turn[:, 2], abs=1e-14)


def test_mean_directors_are_weighted_by_area_and_radial_on_a_cylinder():
    # a ridge along y between a slope of length 1 and a level part of length 3: corner areas 1 : 3
    c, s = np.cos(0.4), np.sin(0.4)
    nodes = [[-c, 0, -s], [0, 0, 0], [3, 0, 0], [-c, 1, -s], [0, 1, 0], [3, 1, 0]]
    T = Mesh.from_arrays(nodes, QUADS).directors
    mean = np.array([-s, 0.0, c]) + 3.0 * np.array([0.0, 0.0, 1.0])
    assert T[1] == pytest.approx(mean / np.linalg.norm(mean), rel=1e-14)
    assert T[0] == pytest.approx([-s, 0.0, c], rel=1e-14)
    exact = cylinder(10.0, 4.0, arc_deg=120.0, n_around=12, n_along=4)
    mean = Mesh.from_arrays(exact.nodes, exact.quads).directors
    inner = np.setdiff1d(
        np.arange(exact.n_node), [*exact.node_set("left"), *exact.node_set("right")]
    )
    assert mean[inner] == pytest.approx(exact.directors[inner], abs=1e-14)


def leaning(degrees):
    return [np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees))]


LEANING = np.tile(leaning(6.0), (6, 1))
# One of four: 50 / 4 degrees would be too much for its quads as well.
ONE_LEANING = np.where(np.arange(6)[:, None] == 4, leaning(50.0), [0.0, 0.0, 1.0])


def test_directors_may_not_lean_to_all_sides_by_turns():
    # Their mean is the normal everywhere, but the film is as thin as if all leaned alike: by 40°
    # a strip bends 1.9 times as far.
    sheet = rectangle(5.0, 4.0, n_x=5, n_y=4)
    sign = np.where(sheet.nodes[:, :2].round().sum(axis=1) % 2, 1.0, -1.0)

    def lean(degrees):
        directors = np.array(leaning(degrees)) * np.stack([sign, 0 * sign, 0 * sign + 1], axis=1)
        return Mesh.from_arrays(sheet.nodes, sheet.quads, directors=directors)

    lean(9.0)
    with pytest.raises(MeshError, match=r"within 10 degrees .*, at the border within 45.* lean by"):
        lean(11.0)
    with pytest.raises(MeshError, match=r"got node 7 at \(1, -1, 0\), .* lean by 40, 40"):
        lean(40.0)


@pytest.mark.parametrize("across", [1, 2, 5])
def test_normals_of_a_coarse_surface_are_directors(across):
    # 20° a quad along and 40 / across degrees across: of one quad across no neighbour tells.
    polar = np.radians(np.linspace(-20.0, 20.0, across + 1))
    angle = np.radians(np.linspace(0.0, 60.0, 4))
    a, p = np.meshgrid(angle, polar, indexing="ij")
    normals = np.stack([np.sin(a) * np.cos(p), np.sin(p), np.cos(a) * np.cos(p)], axis=-1)
    ids = np.arange(a.size).reshape(a.shape)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    normals = normals.reshape(-1, 3)
    mesh = Mesh.from_arrays(7.0 * normals, quads.reshape(-1, 4), directors=normals)
    np.testing.assert_allclose(mesh.directors, normals, atol=1e-15)


def test_directors_may_lean_where_the_film_is_curved():
    # Exact normals of an arc in quads of 40°, and the mean normals, 20° off at the rim.
    angle = np.radians([0.0, 40.0, 80.0])
    arc = np.stack([np.sin(angle), np.zeros(3), np.cos(angle)], axis=1)
    nodes = 10.0 * np.concatenate([arc, arc]) + np.repeat([[0, -3, 0], [0, 3, 0]], 3, axis=0)
    exact = Mesh.from_arrays(nodes, QUADS, directors=np.concatenate([arc, arc]))
    mean = Mesh.from_arrays(nodes, QUADS)
    again = Mesh.from_arrays(nodes, QUADS, directors=mean.directors)
    assert (again.directors == mean.directors).all()
    lean = np.degrees(np.arccos(np.einsum("ni,ni->n", exact.directors, mean.directors)))
    np.testing.assert_allclose(lean, [20.0, 0.0, 20.0] * 2, atol=1e-5)


@pytest.mark.parametrize(
    ("directors", "words"),
    [
        (np.tile([0.0, 0.0, 2.0], (6, 1)), ["unit length", "node 0 at (0, 0, 0)", "2", "norm"]),
        (np.tile([0.0, 0.0, -1.0], (6, 1)), ["side of the normals", "node 0", "reverse"]),
        (LEANING, ["normal to the film", "within 5 degrees", "quad 0 at", "lean by 6, 6 degrees"]),
        (ONE_LEANING, ["at the border within 45", "node 4 at (1, 1, 0)", "lean by 50 degrees"]),
        (np.zeros((5, 3)), ["shape (6, 3)", "(5, 3)", "leave them out"]),
        (np.full((6, 3), np.nan), ["finite", "nan"]),
        ("up", ["directors must be an array of real numbers", "'up'"]),
    ],
)
def test_wrong_directors_are_refused(directors, words):
    message = refusal(NODES, QUADS, directors=directors)
    assert all(word in message for word in words), message


def test_given_directors_are_scaled_to_one():
    T = np.tile([0.05, 0.0, 1.0], (6, 1)) / np.sqrt(1.0025) * (1.0 + 3e-7)
    mesh = Mesh.from_arrays(NODES, QUADS, directors=T)
    assert np.linalg.norm(mesh.directors, axis=1) == pytest.approx(np.ones(6), rel=1e-15)


# --- refusals ------------------------------------------------------------------------------------


def full_fan(n):
    # n quads around node 0, in the plane
    angle = np.pi * np.arange(2 * n) / n
    rim = np.column_stack([np.cos(angle), np.sin(angle)]) * np.tile([1.0, 1.2], n)[:, None]
    nodes = np.vstack([[0.0, 0.0], rim])
    quads = [[0, 1 + 2 * i, 2 + 2 * i, 1 + (2 * i + 2) % (2 * n)] for i in range(n)]
    return nodes, quads


FOLD = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 1, 0], [1, 1, 0], [1, 1, 1]]
TEE = ([*three(NODES), [1, 0, 1], [1, 1, 1]], [*QUADS, [1, 6, 7, 4]])
HINGE = ([[0, 0], [1, 0], [1, 1], [0, 1], [2, 1], [2, 2], [1, 2]], [[0, 1, 2, 3], [2, 4, 5, 6]])
BOW_TIE = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]
ARROW = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]]


@pytest.mark.parametrize(
    ("nodes", "quads", "words"),
    [
        ([0.0, 1.0], QUADS, ["nodes must have shape (n_node, 3)", "(2,)", "one row per node"]),
        ("abc", QUADS, ["nodes must be an array of real numbers", "'abc'"]),
        (np.array(NODES) + 0j, QUADS, ["nodes must be an array of real numbers", "complex128"]),
        (np.ma.array(NODES, mask=np.eye(6, 2)), QUADS, ["nodes must", "masked", "compressed"]),
        (NODES, np.ma.array(QUADS, mask=np.eye(2, 4)), ["quads must", "masked", "filled"]),
        (NODES, [[0, 1, 4]], ["shape (n_quad, 4)", "(1, 3)", "triangles are not supported"]),
        (NODES, [[0, 1, 4, 3], [1, 2, 5]], ["quads must be an array of real numbers"]),
        (NODES, [], ["shape (n_quad, 4)", "(0,)"]),
        (NODES, np.array(QUADS, float), ["whole numbers", "float64", "cast"]),
        ([*NODES[:5], [np.inf, 1.0]], QUADS, ["finite", "node 5 at (inf, 1, 0)", "repair"]),
        (NODES, [[0, 1, 4, 3], [1, 2, 9, 4]], ["0 to 5", "quad 1 of nodes [1, 2, 9, 4]", "renumb"]),
        (NODES, np.array(QUADS) + 1, ["quad 1 of nodes [2, 3, 6, 5]", "ids count from 0"]),
        (NODES, [[0, 1, 4, 3], [1, 2, 5, 5]], ["four different nodes", "quad 1 at", "triangles"]),
        (NODES, [*QUADS, [4, 3, 0, 1]], ["same four nodes", "quad 0 at (0.5, 0.5, 0) and quad 2"]),
        ([*NODES, [9, 9]], QUADS, ["belong to a quad", "node 6 at (9, 9, 0)", "remove them"]),
        (*TEE, ["one or two quads", "at (1, 0, 0) to node 4 at (1, 1, 0) with 3", "T-joint"]),
        (NODES, [[0, 1, 4, 3], [1, 4, 5, 2]], ["opposite orientation", "quad 0", "reverse"]),
        (*HINGE, ["one fan", "node 2 at (1, 1, 0)", "duplicate the node"]),
        (*full_fan(MAX_VALENCE + 1), ["12 quads at most", "node 0", "13", "remesh"]),
        ([[0, 0], [1, 0], [2, 0], [3, 0]], [[0, 1, 2, 3]], ["degenerate", "quad 0 at (1.5, 0, 0)"]),
        (BOW_TIE, [[0, 1, 2, 3]], ["degenerate or a bow-tie", "quad 0", "in order"]),
        (ARROW, [[0, 1, 2, 3]], ["convex", "quad 0", "inverted or folded onto itself", "move"]),
        (FOLD, QUADS, ["60 degrees", "90.0 between quad 0", "smooth shells only", "round a fold"]),
        ([*NODES[:2], [0.1, 0.0], *NODES[3:5], [0.1, 1.0]], QUADS, ["180.0 between quad 0"]),
    ],
)
def test_a_wrong_mesh_is_refused(nodes, quads, words):
    message = refusal(nodes, quads)
    assert all(word in message for word in words), message
    assert message[0].islower()
    assert not message.endswith(".")
    assert "problems" not in message  # each case has one fault, and only that is reported


def test_limits_are_accepted_and_a_large_film_is_said(monkeypatch, caplog):
    assert Mesh.from_arrays(*full_fan(MAX_VALENCE)).n_quad == MAX_VALENCE
    assert not caplog.messages
    monkeypatch.setattr(checks, "_MANY_QUADS", 2)
    assert Mesh.from_arrays(FOLD, QUADS, max_fold_deg=91.0).n_quad == 2
    assert "a film of 2 quads takes 1.8e-06 GB, and minutes to check" in caplog.text


@pytest.mark.parametrize(
    ("sets", "words"),
    [
        ({"node_sets": {"left": [0, 6]}}, ["node set 'left'", "0 to 5", "got 6"]),
        ({"quad_sets": {"patch": [-1]}}, ["quad set 'patch'", "0 to 1", "got -1"]),
        ({"node_sets": {"left": [0, 3, 0]}}, ["each id once", "got 0 again", "numpy.unique"]),
        ({"node_sets": {"left": [True, False]}}, ["whole numbers", "bool", "not a mask"]),
        ({"origin": [0, 1]}, ["origin must have shape (6,)", "(2,)"]),
        ({"origin": [0, 0, 1, 3, 4, 5]}, ["their own origin", "got nodes 2"]),
    ],
)
def test_wrong_sets_and_origins_are_refused(sets, words):
    message = refusal(NODES, QUADS, **sets)
    assert all(word in message for word in words), message


def test_all_problems_are_reported_with_five_offenders():
    nodes = [*NODES, [9, 9], [np.nan, 0]]
    message = refusal(
        nodes, [[0, 1, 4, 3], [1, 4, 5, 2]], node_sets={"a": [99]}, directors=[[0, 0, 1]]
    )
    assert message.startswith("5 problems:")
    for words in ("finite", "node 6", "opposite orientation", "node set 'a'", "directors"):
        assert words in message
    message = refusal([*NODES, *np.random.default_rng(1).random((8, 2))], QUADS)
    assert message.count("node ") == 5
    assert "and 3 more" in message


# --- sets ----------------------------------------------------------------------------------------


def test_sets_are_found_by_name_and_by_place():
    mesh = rectangle(2.0, 1.0, n_x=2, n_y=1)
    assert mesh.node_set("LEFT").tolist() == mesh.node_set("left").tolist() == [0, 3]
    with pytest.raises(MeshError, match=r"\(bottom, .*'BOTTM'; did you mean 'bottom'"):
        mesh.node_set("BOTTM")
    with pytest.raises(MeshError, match=r"quad set.*\(none\), got 'patch'; add it by with_sets"):
        mesh.quad_set("patch")
    more = mesh.with_sets(node_sets={"Left": [1]}, quad_sets={"first": [0]})
    assert more.node_set("Left").tolist() == [1]
    assert more.quad_set("first").tolist() == [0]
    assert "Left" not in mesh.node_sets
    with pytest.raises(MeshError, match=r"\(Left, left, .*'LEFT'; did you mean 'Left'"):
        more.node_set("LEFT")
    with pytest.raises(MeshError, match="'left' again; choose another name"):
        mesh.with_sets(node_sets={"left": [1]})
    assert mesh.nodes_where(lambda x, y, z: x == 2.0).tolist() == [2, 5]
    with pytest.raises(MeshError, match="must return 6 bools"):
        mesh.nodes_where(lambda x, y, z: x)


# --- cut -----------------------------------------------------------------------------------------
#
# 4 x 4 squares:   20 21 22 23 24
#                  15 16 17 18 19
#                  10 11 12 13 14
#                   5  6  7  8  9
#                   0  1  2  3  4


@pytest.fixture
def sheet():
    return rectangle(4.0, 4.0, n_x=4, n_y=4).with_sets(
        node_sets={"row": [10, 11, 12, 13, 14]}, quad_sets={"first": [0]}
    )


def cut(mesh, line, copies):
    """Return the cut mesh: the sides of the line are free on both sides, all else is as before."""
    done = mesh.cut(line)
    assert done.origin[mesh.n_node :].tolist() == [mesh.origin[n] for n in copies]
    assert np.array_equal(done.nodes[done.quads], mesh.nodes[mesh.quads])
    assert np.array_equal(done.directors, done.directors[done.origin])
    was, now = mesh.edges(), done.edges()
    assert (now.n_quad == 1).sum() == (was.n_quad == 1).sum() + 2 * (len(line) - 1)
    # from_arrays refuses what is wrong in the sets and origins of the cut
    Mesh.from_arrays(done.nodes, done.quads, node_sets=done.node_sets, origin=done.origin)
    return done


def test_a_cut_inside_has_two_tips(sheet):
    done = cut(sheet, [11, 12, 13], [12])
    # the line runs along +x: quads above, on its left, keep node 12
    assert np.flatnonzero((done.quads == 12).any(axis=1)).tolist() == [9, 10]
    assert np.flatnonzero((done.quads == 25).any(axis=1)).tolist() == [5, 6]
    assert done.node_set("row").tolist() == [10, 11, 12, 13, 14, 25]
    assert done.node_set("left").tolist() == sheet.node_set("left").tolist()
    assert done.quad_set("first").tolist() == [0]
    done = sheet.cut(np.array([13, 12, 11]))
    assert np.flatnonzero((done.quads == 12).any(axis=1)).tolist() == [5, 6]


def test_cuts_from_across_and_along_the_boundary(sheet):
    done = cut(sheet, [10, 11, 12], [10, 11])
    assert done.node_set("left").tolist() == [0, 5, 10, 15, 20, 25]
    assert {10, 11, 12, 25, 26} <= set(done.boundary_nodes().tolist())
    bent, across = [10, 11, 12, 17, 22], [10, 11, 12, 13, 14]
    cut(sheet, bent, bent)
    done = cut(sheet, across, across)
    assert not np.intersect1d(done.quads[:8], done.quads[8:]).size
    closed, inner = [6, 7, 8, 13, 18, 17, 16, 11, 6], [5, 6, 9, 10]
    done = cut(sheet, closed, closed[:-1])
    rest = np.setdiff1d(np.arange(16), inner)
    assert not np.intersect1d(done.quads[inner], done.quads[rest]).size
    cut(annulus(1.0, 2.0, n_around=8, n_radial=2), [0, 8, 16], [0, 8, 16])
    # three quads around the boundary node 0: a line down one spoke and up the next parts all three
    angle = np.pi * np.arange(7) / 6
    nodes = np.vstack([[0.0, 0.0], np.column_stack([np.cos(angle), np.sin(angle)])])
    mesh = Mesh.from_arrays(nodes, [[0, 1, 2, 3], [0, 3, 4, 5], [0, 5, 6, 7]])
    assert len(np.unique(cut(mesh, [5, 0, 3], [5, 0, 0, 3]).quads)) == 12


def test_a_cut_ends_on_an_earlier_cut_or_goes_on_from_its_tip(sheet):
    notched = sheet.cut([10, 11, 12, 13])  # the lower side, on the right, has nodes 25, 26, 27
    above = cut(notched, [22, 17, 12], [22, 17, 12])
    below = cut(above, [27, 7], [27])
    assert np.flatnonzero(below.origin == 12).tolist() == [12, 27, 30, 31]
    twice = cut(sheet.cut([10, 11, 12]), [12, 13], [12])
    assert np.array_equal(notched.nodes[notched.quads], twice.nodes[twice.quads])
    assert twice.n_node == notched.n_node
    with pytest.raises(MeshError, match=r"node 12 was duplicated by a cut, its copies are \[12"):
        notched.cut([2, 7, 12])
    with pytest.raises(MeshError, match="on a cut"):
        notched.cut([11, 12])


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ([10, 12], ["follow sides of quads", "10 at (0, 0, 0) to node 12 at (2, 0, 0)", "between"]),
        ([10, 15], ["quads to its left and right", "node 10", "node 15", "leave it out"]),
        ([11, 12], ["opens nothing", "[11, 12]", "start on the border"]),
        ([11], ["two node ids or more"]),
        ([11.0, 12.0], ["two node ids or more"]),
        ([11, 99], ["0 to 24", "got 99"]),
        ([10, 11, 12, 11, 16], ["each node once", "got 11 again", "in parts"]),
    ],
)
def test_a_line_that_cannot_be_cut_is_refused(sheet, line, words):
    with pytest.raises(MeshError) as caught:
        sheet.cut(line)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_ordered_nodes_are_the_same_film():
    mesh = cases.skewed_flat(9, 7, seed=3).with_sets(
        node_sets={"some": [5, 0, 7]}, quad_sets={"two": [1, 3]}
    )
    mesh = mesh.cut([20, 21, 22, 23])
    ordered = mesh.ordered()
    assert not np.array_equal(ordered.nodes, mesh.nodes)
    np.testing.assert_array_equal(ordered.nodes[ordered.quads], mesh.nodes[mesh.quads])
    np.testing.assert_array_equal(ordered.directors[ordered.quads], mesh.directors[mesh.quads])
    same = [m.nodes[m.node_set("some")] for m in (ordered, mesh)]
    np.testing.assert_array_equal(*same)
    assert ordered.quad_set("two").tolist() == [1, 3]
    # Both halves of a cut node still name one origin, at the same place.
    np.testing.assert_array_equal(ordered.nodes[ordered.origin], ordered.nodes)
    twins = [np.flatnonzero(np.bincount(m.origin) > 1).size for m in (ordered, mesh)]
    assert twins[0] == twins[1] == 3  # the line ends inside: a tip has no twin
