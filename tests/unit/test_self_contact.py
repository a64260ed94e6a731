"""Contact of the film with itself: forces, momentum, energy, history, restart and cost."""

import numpy as np
import pytest

import shellcut as sc
from courses import UNDAMPED
from naive.contact import smoothed
from naive.self_contact import closest_in, depth_in_plate
from naive.shell import shape
from shellcut.contact.film_outline import FilmOutline
from shellcut.contact.pair_search import PairSearch, Points
from shellcut.contact.quad_distance import closest_place, corners_of
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.numerics.jit import kernel
from test_topology import totals
from two_pieces import ON, H, evaluated, thrown, touching


@kernel
def _closest(p, x, quads, row, outline):
    return closest_place((p[0], p[1], p[2]), corners_of(x, quads, row), row, outline)


SQUARE = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
PART = ((-1.0, -1.0), (0.2, -1.0), (0.6, 0.4), (-1.0, 1.0))


@pytest.mark.parametrize(("polygon", "warped"), [(SQUARE, True), (PART, False)])
def test_the_closest_place_of_the_film_of_a_quad(polygon, warped):
    """Sides are straight however warped the quad is; flanks on quads that are parallelograms."""
    rng = np.random.default_rng(3)
    mesh = rectangle(1.0, 1.0, n_x=1, n_y=1)
    state = initial_state(mesh)
    state.quad.share[0] = 0.5
    outline = FilmOutline(lambda row: (polygon, (0, -1, -1, 3))).of(state)
    quad, flat = mesh.quads[0], mesh.nodes[mesh.quads[0]]
    for _ in range(16):
        map_ = np.eye(3) + 0.3 * rng.normal(size=(3, 3))
        corners = flat + 0.1 * rng.normal(size=(4, 3)) if warped else flat @ map_
        x = np.zeros((4, 3))
        x[quad] = corners
        p = corners.mean(axis=0) + rng.normal(size=3) * [0.6, 0.6, 0.2]
        found = _closest(p, x, mesh.quads.astype(np.int32), 0, outline)
        # The twin's search ends on grids of 1e-3 along the rim: its square is the error.
        assert np.sqrt(found.square) == pytest.approx(closest_in(p, corners, polygon), abs=1e-5)


def test_a_place_over_a_skewed_quad_is_found():
    # Squared distances from the middle of such a quad curve the wrong way: one of a raw mesh.
    corners = np.array(
        [[0.232, -10.197, 0], [0.303, -9.54, 0], [0.014, -9.296, 0], [-0.165, -9.503, 0]]
    )
    mesh = rectangle(1.0, 1.0, n_x=1, n_y=1)
    outline = FilmOutline(lambda row: (SQUARE, (0, 1, 2, 3))).of(initial_state(mesh))
    x = np.zeros((4, 3))
    x[mesh.quads[0]] = corners
    for xi, eta in np.random.default_rng(4).uniform(-0.95, 0.95, (40, 2)):
        p = shape(xi, eta)[0] @ corners + [0.0, 0.0, 0.02]
        found = _closest(p, x, mesh.quads.astype(np.int32), 0, outline)
        assert np.sqrt(found.square) == pytest.approx(0.02, rel=1e-9)
        assert (found.xi, found.eta) == pytest.approx((xi, eta), abs=1e-9)


def test_edges_are_open_at_rim_and_cut_and_where_a_node_splits():
    mesh = rectangle(4.0, 2.0, n_x=4, n_y=2)
    line = [int(np.argmin(np.hypot(mesh.nodes[:, 0] - x, mesh.nodes[:, 1]))) for x in range(3)]
    state = initial_state(mesh.cut(line))
    outline = FilmOutline().of(state)
    corners = state.node.X[state.quads]
    x, y, _ = (0.5 * (corners + np.roll(corners, -1, axis=1))).transpose(2, 0, 1)
    rim, cut = (np.abs(y) > 0.9) | np.isin(x, (0.0, 4.0)), (y == 0.0) & (x < 2.0)
    np.testing.assert_array_equal(outline.open[:, :4], rim | cut)
    # The tip is the end of an open edge also of the quads ahead of it.
    ahead = np.abs(corners[..., 0].mean(axis=1) - 2.5) < 0.5
    at_tip = (corners[..., 0] == 2.0) & (corners[..., 1] == 0.0) & ahead[:, None]
    assert at_tip.sum() == 2
    assert outline.open_at[:, :4][at_tip].all()


def test_single_points_feel_what_a_plate_with_flat_edges_exerts():
    state, term, x, first = touching([0.0, 0.0, 5.0])
    low, high = x[:first].min(axis=0), x[:first].max(axis=0)
    rng = np.random.default_rng(7)
    node = first  # a corner of the second piece, the rest of which is far above
    seen = set()
    for _ in range(60):
        edge = rng.integers(3)
        p = rng.uniform(low, high)
        p[2] = rng.uniform(-1.2, 1.2) * H
        if edge == 0:
            p[0] = high[0] - rng.uniform(-0.5, 1.0) * H
        elif edge == 1:
            p[1] = low[1] + rng.uniform(-0.5, 1.0) * H
        place = x.copy()
        state.revision += 1
        evaluated(state, term, place)  # far away: no side is known
        start = place.copy()
        start[node] = p + H * np.array([0.0, 0.0, 3.0] if edge == 2 else [2.0, -2.0, 0.0])
        state.revision += 1
        evaluated(state, term, start)
        side = 1 if edge == 2 else 0
        term.tables.memory.side[:] = side
        place[node] = p
        evaluated(state, term, place)
        # What it gets as a point: other points press on its own quad, which it has drawn along.
        own = (term.point_of_sheet() == node) & (term.carriers.pressure > 0.0)
        force = term.tables.memory.force[own].sum(axis=0)
        depth, out = depth_in_plate(p, low, high, H, side)
        k = 0.25 * 0.125 * 1678.0 * H  # a corner has a quarter of a whole node's E h / 8
        wanted = k * smoothed(depth, 0.25 * H) * out
        np.testing.assert_allclose(force, wanted, atol=1e-9 * k)
        seen.add((int(np.argmax(np.abs(out))), depth > 0.0))
    assert {(0, True), (1, True), (2, True), (0, False)} <= seen


@pytest.mark.parametrize(
    ("gap", "velocity"),
    [((0.13, 0.07, 0.4), (0.0, 0.0, 3000.0)), ((3.0, 0.1, 0.01), (3000.0, 0.0, 0.0))],
    ids=["face to face", "edge to edge"],
)
def test_pieces_thrown_at_each_other_keep_momentum_and_energy(gap, velocity):
    sim = thrown(gap, velocity)
    before, energy = totals(sim.state), sim.ledger.initial
    touched = 0
    for _ in range(700):
        sim.step()
        touched += sim.self_contact.forces.n_touching > 0
    assert touched > 10
    assert sim.self_contact.forces.n_touching == 0
    book = sim.close_ledger()
    assert book.self_contact_stored == 0.0
    # What the contact took in and does not hold is lost. Measured 1.2e-4 and 5e-5: the trapezoidal
    # rule on a force that sets in within some ten steps.
    assert abs(book.self_contact_work) < 1e-3 * energy
    assert abs(book.kinetic + book.strain - energy) < 1e-3 * energy
    # They have bounced: the large piece flies back.
    n, first = sim.state.node, 35
    mean = n.mass[:first] @ n.velocity_half[:first] / n.mass[:first].sum()
    assert mean @ np.asarray(velocity) < 0.0
    scale = n.mass[: n.count].sum() * 3000.0
    after = totals(sim.state)
    for name in ("momentum", "angular momentum"):
        np.testing.assert_allclose(after[name], before[name], atol=1e-13 * 3.0 * scale)  # round-off


def folded():
    """A tongue, cut free on three sides, swings round its hinge onto the sheet."""
    size, h = 0.25, 0.02
    mesh = rectangle(6.0, 3.0, size=size)

    def node(x, y):
        return int(np.argmin(np.hypot(mesh.nodes[:, 0] - x, mesh.nodes[:, 1] - y)))

    along, across = np.arange(3.0, 5.01, size), np.arange(-0.5, 0.51, size)
    line = [node(x, -0.75) for x in along] + [node(5.0, y) for y in across]
    film = mesh.cut(np.array([*line, *(node(x, 0.75) for x in along[::-1])]))
    centre = film.nodes[film.quads].mean(axis=1)
    of_tongue = (np.abs(centre[:, 0] - 4.0) < 1.0) & (np.abs(centre[:, 1]) < 0.75)
    tongue = np.unique(film.quads[of_tongue])
    v = np.zeros_like(film.nodes)
    v[tongue, 2] = 1e4 * (film.nodes[tongue, 0] - 3.0)
    rim = film.nodes_where(lambda x, y, z: np.maximum(abs(x - 3.0) / 3.0, abs(y) / 1.5) > 0.999)
    material = sc.ShellMaterial.homogeneous(young=500.0, thickness=h)
    held = [sc.Support.clamped(rim)]
    return sc.Simulation(film, material, supports=held, contact=ON, velocity=v), tongue


def lowest_over_the_sheet(sim, tongue):
    """Height of the tongue's lowest node behind the hinge over the sheet there."""
    x = sim.state.node.x[: sim.mesh.n_node]
    sheet = np.setdiff1d(np.arange(sim.mesh.n_node), tongue)
    behind = tongue[x[tongue, 0] < 2.6]
    if not behind.size:
        return np.inf
    off = np.linalg.norm(x[behind, None, :2] - x[None, sheet, :2], axis=2)
    return float((x[behind, 2] - x[sheet[off.argmin(axis=1)], 2]).min())


def test_a_flap_that_folds_onto_the_sheet_does_not_pass():
    # Without contact it swings through, by more than twenty thicknesses.
    sim, tongue = folded()
    least = np.inf
    while sim.state.time < 6e-4:
        sim.step()
        if sim.state.step % 20 == 0:
            least = min(least, lowest_over_the_sheet(sim, tongue))
    assert 0.0 < least < np.inf
    book = sim.close_ledger()
    assert abs(book.imbalance) < 5e-3 * book.initial
    assert book.self_contact_work > 0.0


def test_a_small_piece_that_flies_onto_a_large_quad_does_not_pass():
    """No node of the quad is near the piece: what moves is the points that look for a partner."""
    sheet, piece = rectangle(4.0, 4.0, n_x=1, n_y=1), rectangle(0.3, 0.2, n_x=1, n_y=1)
    onto = sheet.nodes.mean(axis=0) - piece.nodes.mean(axis=0) + [0.3, 0.1, 3.0 * H]
    nodes = np.concatenate([sheet.nodes, piece.nodes + onto])
    flies = np.zeros((8, 3))
    flies[4:] = [0.0, 0.0, -2000.0]
    sim = sc.Simulation(
        sc.Mesh.from_arrays(nodes, np.concatenate([sheet.quads, piece.quads + 4])),
        sc.ShellMaterial.homogeneous(thickness=H),
        supports=[sc.Support.clamped(range(4))],
        contact=ON,
        velocity=flies,
        **UNDAMPED,
    )
    sim.run(2.5e-4)
    n = sim.state.node
    assert (n.x[4:8, 2] > 0.5 * H).all()
    # It has left as it came: the sheet cannot move, and the piece swings a little.
    np.testing.assert_allclose(n.velocity_half[4:8, 2], 2000.0, rtol=0.05)


@pytest.mark.parametrize("path", ["edges", "free"])
def test_flanks_born_together_do_not_lock(path):
    work = []
    for on in (False, True):
        options = {"contact": sc.Contact(self_contact=on), "fracture": sc.Fracture(path=path)}
        case = sc.guillotine(0.8, length=8.0, width=4.8, travel=4.0, **options)
        sim = case.simulation
        sim.run(case.duration)
        work.append(sim.ledger.tool_work)
    assert abs(sim.close_ledger().self_contact_work) < 1e-4 * sim.ledger.tool_work
    # Work of the whole cut; measured equal to 5 digits.
    assert work[1] == pytest.approx(work[0], rel=5e-3)


def test_flanks_of_a_cut_that_is_closed_again_do_not_overlap():
    """A sheet cut in two along its middle, both halves pushed together in the plane."""
    mesh = rectangle(3.0, 2.0, n_x=6, n_y=4)
    line = np.flatnonzero(np.abs(mesh.nodes[:, 1]) < 1e-9)
    film = mesh.cut(line[np.argsort(mesh.nodes[line, 0])])
    y, centre = film.nodes[:, 1], film.nodes[film.quads].mean(axis=1)
    upper = np.unique(film.quads[centre[:, 1] > 0.0])
    lower = np.setdiff1d(np.arange(film.n_node), upper)
    push = [
        sc.Support(np.flatnonzero(side * y > 0.99), "xyz", "", velocity={"y": lambda _, v=v: v})
        for side, v in ((1.0, -500.0), (-1.0, 500.0))
    ]
    sim = sc.Simulation(film, sc.ShellMaterial.homogeneous(), supports=push, contact=ON)
    while sim.state.time < 2e-5:  # 0.02 mm of way: a strain of 1 %
        sim.step()
    # At its ends the cut meets the rim: the way out is along the cut there.
    inside, x = np.abs(film.nodes[:, 0] - 1.5) < 1.4, sim.state.node.x[: film.n_node, 1]
    overlap = x[lower[inside[lower]]].max() - x[upper[inside[upper]]].min()
    book, found = sim.close_ledger(), sim.self_contact.forces
    assert abs(book.imbalance) < 5e-3 * book.support_work
    assert found.n_touching == 14
    # At rest E h b (0.02 - D) / 2 = K f(D), with K = 0.625 E h of five halves of nodes on either
    # flank, E h / 8 a whole one. Measured 1 % less: the film swings, and gives way sideways.
    ways = np.linspace(0.0, 0.02, 20001)
    pressed = [0.625 * smoothed(way, sim.self_contact.law.smoothing_depth) for way in ways]
    wanted = ways[np.argmin(np.abs(np.array(pressed) - 1.5 * (0.02 - ways)))]
    assert found.deepest == pytest.approx(wanted, rel=0.05)
    assert overlap < 1.05 * found.deepest
    assert book.self_contact_stored > 0.0


def test_film_inside_film_at_first_sight_does_not_press_until_it_has_parted():
    state, term, x, first = touching([0.13, 0.07, 0.5 * H])
    force, found = evaluated(state, term, x)
    assert found.n_touching > 0
    assert found.stored == 0.0
    assert not force.any()
    up, down = x.copy(), x.copy()
    up[first:, 2] += 0.3 * H
    down[first:, 2] -= 0.1 * H
    assert evaluated(state, term, down)[1].stored > 0.0  # deeper than at first
    assert evaluated(state, term, up)[1].stored == 0.0
    # The gap has grown: back where it was it presses now.
    assert evaluated(state, term, x)[1].stored > 0.0


def test_contact_without_a_tool_says_what_it_may_be():
    mesh, film = rectangle(1.0, 1.0, size=0.5), sc.ShellMaterial.homogeneous()
    with pytest.raises(ValueError, match="self_contact=True"):
        sc.Simulation(mesh, film, contact=sc.Contact())


def test_a_point_has_as_many_partners_as_there_are_quads_near():
    mesh = rectangle(7.0, 7.0, size=0.1)
    points = Points(np.zeros(1, np.int64), np.array([[3.5, 0.0, 0.0]]), np.full(1, -1))
    found = PairSearch().find(points, np.arange(mesh.n_quad), 10.0, initial_state(mesh))
    assert found.row.tolist() == list(range(4900))


@pytest.mark.parametrize(("size", "thickness"), [(0.3, 0.074), (0.1, 0.25), (0.1, 0.45)])
def test_a_flat_film_does_not_touch_itself_however_thick_beside_its_quads(size, thickness):
    """Of quads shorter than the thickness, those that the film itself joins are left out."""
    sim = sc.Simulation(
        rectangle(2.4, 1.8, size=size),
        sc.ShellMaterial.homogeneous(thickness=thickness),
        contact=sc.Contact(self_contact=True),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path="free"),
    )
    sim.notch((-1.0, 0.04, 0.0), (1.2, 0.04, 0.0))
    for _ in range(3):
        sim.step()
    assert sim.self_contact.forces.n_touching == 0
