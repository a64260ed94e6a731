"""Ready-made and hand-made meshes: shapes, sets, quality, cuts, triangles split into quads."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.film_file import split_in_quads
from shellcut.mesh.mesh import MeshError
from shellcut.mesh.structured import annulus, cylinder, disc, opening_disc, rectangle

# name: quads, published number of them, nodes on the ring, floor of the smallest edge [mm], radii
# of the exact circles (measured edges 0.5815, 0.2757, 0.1643: the time step follows from them)
OPENINGS = {
    "quick": (612, 612, 72, 0.57, [10.2, 9.4, 8.6]),
    "M1": (2660, 2634, 152, 0.27, [10.2, 9.8, 9.4, 9.0, 8.6, 8.2]),
    "M2": (8625, 8647, 276, 0.16, [10.2, 10.0, 9.8, 9.6, 9.4, 9.2, 9.0]),
}


def radius(mesh, ids):
    return np.hypot(*mesh.nodes[ids, :2].T)


def check_circle(mesh, ids, r):
    """Nodes stand on a circle, evenly, counter-clockwise, the first at angle 0."""
    angle = 2.0 * np.pi * np.arange(len(ids)) / len(ids)
    wanted = r * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    assert np.abs(mesh.nodes[ids] - wanted).max() <= 1e-14 * r
    assert mesh.nodes[ids[0]].tolist() == [r, 0.0, 0.0]


def polygon_area(n, r):
    return 0.5 * n * r**2 * np.sin(2.0 * np.pi / n)


# --- rectangle -----------------------------------------------------------------------------------


def test_rectangle_has_the_nearest_divisions_exact_rows_and_named_sides():
    mesh = rectangle(20.0, 8.0, size=0.8)
    assert (mesh.n_node, mesh.n_quad) == (26 * 11, 25 * 10)
    assert rectangle(20.0, 8.0, size=0.77).n_quad == 26 * 10
    assert rectangle(1.0, 1.0, size=50.0).n_quad == 1
    mesh = rectangle(20.0, 7.3, n_x=3, n_y=6)
    x, y, z = mesh.nodes.reshape(7, 4, 3).transpose(2, 0, 1)
    assert (x == x[0]).all()
    assert (y == y[:, :1]).all()
    assert not z.any()
    assert (y == -y[::-1]).all()
    assert mesh.quad_areas() == pytest.approx(np.full(18, 20.0 * 7.3 / 18), rel=1e-14)
    assert (mesh.directors == [0.0, 0.0, 1.0]).all()
    sides = {"left": (0, 0.0), "right": (0, 20.0), "bottom": (1, -3.65), "top": (1, 3.65)}
    for name, (axis, at) in sides.items():
        ids = mesh.node_set(name)
        assert (mesh.nodes[ids, axis] == at).all()
        assert (np.diff(mesh.nodes[ids, 1 - axis]) > 0.0).all()
        assert len(ids) == (7 if axis == 0 else 4)


# --- disc ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("n_side", [1, 2, 3, 4, 7, 12, 19, 50])
@pytest.mark.parametrize("n_layer", [1, 2, 9, 40])
def test_discs_of_any_proportion_are_sound(n_side, n_layer):
    mesh = disc(3.0, n_side=n_side, n_layer=n_layer)
    n = 4 * n_side
    assert mesh.n_quad == n_side**2 + n * n_layer
    assert mesh.n_node == (n_side + 1) ** 2 + n * n_layer
    assert mesh.quad_areas().sum() == pytest.approx(polygon_area(n, 3.0), rel=1e-13)
    assert np.array_equal(np.sort(mesh.node_set("rim")), mesh.boundary_nodes())
    assert mesh.scaled_jacobian().min() > 0.5
    assert (mesh.directors == [0.0, 0.0, 1.0]).all()


@pytest.mark.parametrize("n_side", [18, 19, 30, 51])
def test_discs_of_default_layers_keep_the_promised_quality(n_side):
    mesh = disc(10.0, n_side=n_side)
    spacing = np.sqrt(np.pi * 100.0 / mesh.n_quad)
    assert mesh.edge_lengths().min() > 0.81 * spacing  # measured 0.823 to 0.840
    assert mesh.scaled_jacobian().min() > 0.81


@pytest.mark.parametrize("n_side", [12, 13])
def test_disc_has_four_quarters_alike_to_the_last_bit(n_side):
    nodes = disc(2.0, n_side=n_side, ring_radii=[1.7]).nodes[:, :2]
    turned = np.column_stack([-nodes[:, 1], nodes[:, 0]])
    assert {*map(tuple, nodes)} == {*map(tuple, turned)}


def test_discs_name_their_middle_and_their_rings():
    even, odd = disc(1.0, n_side=6), disc(1.0, n_side=7)
    assert even.nodes[even.node_set("centre")].tolist() == [[0.0, 0.0, 0.0]]
    four = odd.node_set("centre")
    assert len(four) == 4
    assert np.array_equal(np.sort(radius(odd, four)), np.sort(radius(odd, np.arange(64)))[:4])
    with_rim = disc(10.2, n_side=10, ring_radii=[10.2, 9.4])
    without = disc(10.2, n_side=10, ring_radii=(9.4,))
    assert np.array_equal(with_rim.nodes, without.nodes)
    assert sorted(with_rim.node_sets) == sorted(without.node_sets) == ["centre", "rim", "ring_9.4"]


# --- the opening problem -------------------------------------------------------------------------


@pytest.mark.parametrize("name", OPENINGS)
def test_opening_discs(name):
    mesh = opening_disc(name)
    n_quad, published, n_around, smallest, rings = OPENINGS[name]
    assert mesh.n_quad == n_quad
    assert n_quad == pytest.approx(published, rel=0.02)
    assert len(mesh.node_set("ring")) == n_around
    assert n_around % 4 == 0  # four teeth a quarter turn apart start on nodes
    assert mesh.edge_lengths().min() > smallest
    assert mesh.scaled_jacobian().min() > 0.81
    assert mesh.quad_areas().sum() == pytest.approx(polygon_area(n_around, 10.2), rel=1e-13)
    for r in rings:
        ids = mesh.node_set("rim" if r == 10.2 else f"ring_{r:g}")
        assert len(ids) == n_around
        check_circle(mesh, ids, r)
    ring = mesh.node_set("ring")
    assert np.array_equal(ring, mesh.node_set("ring_9.4"))
    # a closed line of sides
    assert mesh.cut([*ring, ring[0]]).n_node == mesh.n_node + n_around


# --- annulus and cylinder ------------------------------------------------------------------------


def test_annulus():
    mesh = annulus(1.5, 4.0, n_around=30, n_radial=5)
    assert mesh.n_quad == 150
    check_circle(mesh, mesh.node_set("inner"), 1.5)
    check_circle(mesh, mesh.node_set("outer"), 4.0)
    area = polygon_area(30, 4.0) - polygon_area(30, 1.5)
    assert mesh.quad_areas().sum() == pytest.approx(area, rel=1e-13)


def test_barrel_roof_has_exact_directors_and_sides():
    mesh = cylinder(25.0, 50.0, arc_deg=80.0, n_around=8, n_along=6)
    x, y, z = mesh.nodes.T
    assert np.hypot(x, z) == pytest.approx(np.full(63, 25.0), rel=1e-15)
    assert mesh.directors * [25.0, 1.0, 25.0] == pytest.approx(mesh.nodes * [1, 0, 1], rel=1e-15)
    assert (abs(y[mesh.node_set("bottom")]).tolist(), y.max()) == ([25.0] * 9, 25.0)
    edge = 25.0 * np.sin(np.radians(40.0))
    assert x[mesh.node_set("left")] == pytest.approx(np.full(7, -edge), rel=1e-14)
    assert x[mesh.node_set("right")] == pytest.approx(np.full(7, edge), rel=1e-14)
    chords = 8 * 2 * 25.0 * np.sin(np.radians(5.0)) * 50.0
    assert mesh.quad_areas().sum() == pytest.approx(chords, rel=1e-13)


def test_closed_cylinders_have_two_rims_and_are_not_too_coarse():
    mesh = cylinder(3.0, 10.0, n_around=24, n_along=5)
    assert mesh.n_quad == 120
    assert sorted(mesh.node_sets) == ["bottom", "top"]
    rims = np.sort([*mesh.node_set("bottom"), *mesh.node_set("top")])
    assert np.array_equal(mesh.boundary_nodes(), rims)
    # outward: quads wind counter-clockwise seen from outside
    p, q = (mesh.nodes[mesh.quads[:, a]] - mesh.nodes[mesh.quads[:, 0]] for a in (1, 3))
    centres = mesh.nodes[mesh.quads].mean(axis=1) * [1.0, 0.0, 1.0]
    assert (np.einsum("ij,ij->i", np.cross(p, q), centres) > 0.0).all()
    with pytest.raises(MeshError, match=r"60 degrees at most, got 90\.0.*refine"):
        cylinder(1.0, 1.0, n_around=4, n_along=1)


# --- arguments -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: rectangle(1.0, 1.0), "either size or both n_x and n_y, got neither"),
        (lambda: rectangle(1.0, 1.0, n_x=2), "both n_x and n_y"),
        (lambda: rectangle(1.0, 1.0, size=1.0, n_x=2), "got both; leave one out"),
        (lambda: disc(1.0, n_side=4, ring_radii=[1.2]), r"within the radius 1, got \[1.2\]"),
        (lambda: disc(1.0, n_side=4, ring_radii=[0.5, np.nan]), "above 0"),
        (lambda: disc(1.0, n_side=4, ring_radii=[0.5, 0.7]), r"decrease.*got \[0.5, 0.7\]; sort"),
        (lambda: disc(1.0, n_side=4, n_layer=1, ring_radii=[0.8]), "n_layer must exceed the 1"),
        (lambda: annulus(2.0, 1.0, n_around=8, n_radial=1), "below r_outer, got 2 and 1"),
    ],
)
def test_arguments_are_checked(build, message):
    with pytest.raises(ValueError, match=message):
        build()


@pytest.fixture
def mixed():
    """4 x 3 quads, three of them cut into two triangles."""
    mesh = rectangle(4.0, 3.0, n_x=4, n_y=3)
    cut = np.array([0, 6, 11])
    corners = mesh.quads[cut]
    triangles = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    return mesh, np.delete(mesh.quads, cut, axis=0), triangles


def test_sets_take_the_middles_and_centres_between_their_members(mixed):
    mesh, quads, triangles = mixed
    split = split_in_quads(mesh.nodes, quads, triangles)
    x, y, _ = split.nodes.T
    border = (x == 0.0) | (x == 4.0) | (abs(y) == 1.5)
    for members, there in (
        (mesh.node_set("top"), y == 1.5),
        (mesh.boundary_nodes(), border),
        (mesh.nodes_where(lambda x, y, z: x == 2.0), x == 2.0),
        (mesh.nodes_where(lambda x, y, z: x >= 2.0), x >= 2.0),
    ):
        found = np.sort(split.with_middles(members))
        np.testing.assert_array_equal(found, np.flatnonzero(there))
    line = mesh.node_set("left")
    middles = split.middles(np.stack([line[1:], line[:-1]], axis=1))
    np.testing.assert_array_equal(split.nodes[middles], [[0, y, 0] for y in (-1.0, 0.0, 1.0)])
    assert split.middles(np.array([[0, 19]])).size == 0  # no side of the mesh


def test_triangles_alone():
    split = split_in_quads(np.eye(3), np.empty((0, 4), np.int64), np.array([[0, 1, 2]]))
    assert split.quads.tolist() == [[0, 3, 6, 4], [1, 5, 6, 3], [2, 4, 6, 5]]


def test_the_step_is_that_of_the_run():
    mesh = opening_disc("quick")
    run = sc.Simulation(mesh, sc.ShellMaterial.homogeneous(), stepping=sc.Stepping(safety=1.0))
    # the same arithmetic: round-off
    assert sc.mesh_quality(mesh).stable_step == pytest.approx(run.dt, rel=1e-12)


def test_a_short_quad_is_the_worst_and_its_cost_is_told():
    mesh = rectangle(10.0, 4.0, n_x=10, n_y=4)
    nodes = mesh.nodes.copy()
    nodes[nodes[:, 0] == 5.0, 0] = 4.25  # column 4 is 0.25 wide, column 5 1.75
    quality = sc.mesh_quality(sc.Mesh.from_arrays(nodes, mesh.quads))
    assert set(quality.worst[:4]) == {4, 14, 24, 34}
    assert quality.shortest_edge[4] == 0.25
    assert quality.aspect[4] == 4.0
    assert quality.aspect[5] == 1.75
    assert quality.scaled_jacobian.min() == pytest.approx(1.0, rel=1e-14)
    # the step falls about as the shortest edge; thin quads gain a little by their width
    assert 0.2 < quality.step_cost < 0.5
    told = str(quality)
    assert "40 quads" in told
    assert f"the worst quad shortens the step to {quality.step_cost:.2f} of" in told
    assert "(4.125, -1.5, 0)" in told


def test_of_alike_quads_none_is_the_worst_and_damping_shortens_the_step():
    sheet = rectangle(4.0, 2.0, n_x=4, n_y=2)
    quality = sc.mesh_quality(sheet, damping_beta=0.0)
    assert quality.worst.size == 0
    assert "below 0.9 of the median" not in str(quality)
    assert (sc.mesh_quality(sheet, damping_beta=2e-7).step < quality.step).all()
