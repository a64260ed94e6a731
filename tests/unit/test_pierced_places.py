"""Whole film is pierced at the same force wherever a tip comes down and however its edge lies."""

import numpy as np
import pytest

import shellcut as sc
from films import three_quads_a_triangle
from shellcut.mesh.structured import rectangle
from shellcut.results.verdict import IDLE_LIMIT
from shellcut.tool_shapes import straight_blade
from teeth import tool_of, tooth, vee

CELL, N_CELL = 5, 4
"""Quads of 1 mm a side of one film, and films a side: each is clamped by itself."""
SIZE = float(CELL * N_CELL)
"""Of them together [mm]."""

PLACES = [
    # The rim, and the corner of it.
    (0.02, 0.02), (2.0, 0.05), (2.4, 0.05), (4.5, 0.5),
    # Nodes, and beside them.
    (0.1, 2.5), (2.0, 2.0), (3.0, 2.0), (1.0, 1.0),
    (0.5, 2.0), (2.02, 2.02), (2.02, 2.0), (2.0 + 1e-7, 2.0),
    # Sides, and beside them; within a quad.
    (2.5, 2.0), (2.0, 2.3), (2.5, 2.0 + 1e-7), (2.31, 2.77),
]  # fmt: skip
"""Where the tips come down, film by film, row by row: in the first row and column at the rim."""


def height(x):
    """Return the height of films that are curved to a radius of 10 mm, each by itself [mm]."""
    return ((x % CELL) - 0.5 * CELL) ** 2 / 20.0


def film_of(kind):
    """Return films of squares, of squares with moved nodes, of split triangles, or curved."""
    mesh = rectangle(SIZE, SIZE, size=1.0)
    nodes, quads = mesh.nodes - mesh.nodes.min(axis=0), mesh.quads
    nodes = np.round(nodes, 9)
    if kind == "skewed":
        inner = (nodes[:, :2] % CELL != 0.0).all(axis=1)
        shift = np.random.default_rng(3).uniform(-0.12, 0.12, (inner.sum(), 2))
        nodes[inner, :2] += shift
    if kind == "triangles":
        halves = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        nodes, quads, _ = three_quads_a_triangle(nodes, halves)
    if kind == "curved":
        nodes[:, 2] = height(nodes[:, 0])
    return sc.Mesh.from_arrays(nodes, quads)


def pressed(angle, path, line, kind="squares"):
    """Return a run that presses sixteen teeth into as many films."""
    mesh, line = film_of(kind), np.array(line)
    held = np.flatnonzero((mesh.nodes[:, :2] % CELL == 0.0).any(axis=1))
    firsts = [(CELL * (k % N_CELL), CELL * (k // N_CELL)) for k in range(len(PLACES))]
    teeth = []
    for first, place in zip(firsts, PLACES, strict=True):
        x, y = first + np.array(place)
        # Between two nodes the film is straight along x.
        z = np.interp(x, np.arange(SIZE + 1.0), height(np.arange(SIZE + 1.0)))
        up = [0.0, z if kind == "curved" else 0.0]
        teeth.append(tooth(line + up, height=1.0, turn_deg=angle, at=(x, y)))
    return sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(held)],
        tool=tool_of(*teeth).translated((0.0, 0.0, 0.002)),
        motion=sc.StraightMotion((0.0, 0.0, -1.0), speed=600.0, ramp=5e-5),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path=path, check_every=1),
    )


def pierced(angle, path, line, kind="squares"):
    """Press sixteen teeth into as many films; return the record of each, and of what is cut."""
    run = pressed(angle, path, line, kind)
    first = {}
    while len(first) < len(PLACES) and run.state.time < 9e-4:
        seen = len(run.state.split_log)
        run.step()
        for record in run.state.split_log[seen:]:
            place = np.array(record.reference)
            k = int(place[0] // CELL) + N_CELL * int(place[1] // CELL)
            first.setdefault(min(record.edge if record.edge >= 0 else k, len(PLACES) - 1), record)
    return first


@pytest.mark.parametrize(
    ("path", "angle", "kind"),
    [
        ("free", 0.0, "squares"),
        ("free", 30.0, "squares"),
        pytest.param("free", 45.0, "squares", marks=pytest.mark.slow),
        pytest.param("free", 105.0, "squares", marks=pytest.mark.slow),
        ("edges", 30.0, "squares"),
        ("free", 20.0, "skewed"),
        pytest.param("free", 70.0, "triangles", marks=pytest.mark.slow),
        pytest.param("free", 30.0, "curved", marks=pytest.mark.slow),
        ("free", 90.0, "curved"),
    ],
)
def test_a_tip_pierces_at_its_force_at_any_place_in_any_direction(path, angle, kind):
    # Sixteen places in each direction; the force is looked at in every step.
    first = pierced(angle, path, vee(30.0, 0.8), kind)
    assert sorted(first) == list(range(len(PLACES)))
    assert {record.kind for record in first.values()} == {"puncture"}
    assert max(record.measure for record in first.values()) < 1.06
    assert min(record.measure for record in first.values()) >= 1.0


@pytest.mark.parametrize(("gap", "n"), [(0.6, 10), (1.0, 10), (0.6, 16)])
@pytest.mark.parametrize(("offset", "angle"), [(0.03, 0.0), (0.2, 0.0), (0.2, 70.0)])
def test_blades_side_by_side_pierce_at_their_force_each(gap, n, offset, angle):
    # Less than two sides apart, in neighbouring quads or almost.
    turn = np.radians(angle)
    across, centre = 0.5 * gap * np.array([-np.sin(turn), np.cos(turn)]), np.array([6.013, offset])
    line = vee(56.0, 0.8)
    teeth = [
        tooth(line, height=2.0, half_thickness=0.15, turn_deg=angle, at=at)
        for at in (centre - across, centre + across)
    ]
    run = sc.Simulation(
        rectangle(12.0, 8.0, n_x=3 * n // 2, n_y=n),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(name) for name in ("left", "right", "bottom", "top")],
        tool=tool_of(*teeth).translated((0.0, 0.0, 0.02)),
        motion=sc.StraightMotion((0.0, 0.0, -1.0), speed=1500.0, ramp=2e-4),
        law=sc.CohesiveLaw(),
    )
    run.run(6e-4)
    pierced = {r.edge: r.measure for r in run.state.split_log if r.kind == "puncture"}
    assert pierced
    assert all(1.0 <= measure < 1.4 for measure in pierced.values())
    # The second may come down on the crack of the first, or where this has made the film slack.
    assert len(pierced) == 2 or run.cracks.idle_edge(run.state)[1] < IDLE_LIMIT


@pytest.mark.parametrize(
    ("y", "path", "doubted"),
    [(0.55, "free", True), (0.35, "free", False), (0.95, "free", False), (0.55, "edges", False)],
)
def test_two_edges_in_one_quad_are_doubted(y, path, doubted):
    line = vee(56.0, 0.8)
    teeth = [
        tooth(line, height=2.0, half_thickness=0.04, at=at) for at in ((6.013, 0.25), (6.013, y))
    ]
    run = sc.Simulation(
        rectangle(12.0, 8.0, n_x=15, n_y=10),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(name) for name in ("left", "right", "bottom", "top")],
        tool=tool_of(*teeth).translated((0.0, 0.0, 0.02)),
        motion=sc.StraightMotion((0.0, 0.0, -1.0), speed=1500.0, ramp=2e-4),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path=path),
    )
    found = [str(one) for one in sc.check_model(run, 1.5e-3).doubts]
    assert any("cut twice" in text for text in found) == doubted


def there_and_back(beside, turn, lift):
    """Return poses of a blade that cuts to x = 8, turns, and comes back ``beside`` its way [mm]."""
    way = np.array([(-1.0, 0.75), (8.0, 0.75), (8.0 + turn, 0.75 - 0.5 * beside)])
    back = way[:2][::-1] - [0.0, beside]
    places = np.column_stack([np.concatenate([way, back]), [0.0, 0.0, lift, 0.0, 0.0]])
    return places, np.pi * np.array([0.0, 0.0, 0.5, 1.0, 1.0])[:, None] * [0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("beside", "turn", "lift", "doubted"),
    [
        *((0.5, 0.0, 20.0, True), (0.4, 2.0, 0.0, True), (0.0, 0.0, 20.0, False)),
        *((0.1, 0.0, 20.0, False), (1.3, 0.0, 20.0, False)),
    ],
)
def test_an_edge_that_comes_back_beside_its_own_cut_is_doubted(beside, turn, lift, doubted):
    places, vectors = there_and_back(beside, turn, lift)
    film = rectangle(10.0, 6.0, size=1.0)
    run = sc.Simulation(
        film,
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(name) for name in ("bottom", "top")],
        tool=straight_blade(length=3.0, height=3.0),
        motion=sc.TableMotion(np.array([0.0, 2.0, 3.0, 4.0, 6.0]) * 1e-3, places, vectors),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path="free"),
    )
    found = [str(one) for one in sc.check_model(run, 6e-3).doubts]
    assert any("cut twice" in text and "1 twice" in text for text in found) == doubted


def test_a_run_resumed_while_tips_press_pierces_as_the_whole_run(tmp_path):
    # The force that pierces is a mean over the time of impacts: it is kept, too.
    whole = pressed(30.0, "free", vee(30.0, 0.8))
    while not whole.state.split_log:
        if whole.state.step % 50 == 0:
            sc.save_checkpoint(whole, tmp_path / "pressed.h5")
        whole.step()
    again = pressed(30.0, "free", vee(30.0, 0.8))
    sc.load_checkpoint(again, tmp_path / "pressed.h5")
    assert 0 < again.state.step < whole.state.step
    while not again.state.split_log:
        again.step()
    assert again.state.split_log == whole.state.split_log
    assert again.state.split_log[0].kind == "puncture"
