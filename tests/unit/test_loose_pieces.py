"""Loose pieces: which they are, and what happens when one is taken out of a run."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell
from shellcut.recording.checkpoint import load_checkpoint, save_checkpoint
from shellcut.recording.frame_capture import Exposure
from shellcut.state import DROPPED, STRAIGHT
from shellcut.state.pieces import Pieces

N_SHEET = 6 * 4  # quads of the large piece
FIRST = 7 * 5  # and its nodes


def two_sheets(height):
    """A sheet and a smaller one over it."""
    one, two = rectangle(3.0, 2.0, n_x=6, n_y=4), rectangle(2.0, 1.4, n_x=5, n_y=4)
    nodes = np.concatenate([one.nodes, two.nodes + np.array([0.3, 0.1, height])])
    return sc.Mesh.from_arrays(nodes, np.concatenate([one.quads, two.quads + one.n_node]))


def flying(drop="clear", *, path="edges", points=None, height=1.5, **options):
    """The small sheet flies away, wobbling; the large one is held at its end."""
    mesh = two_sheets(height)
    x = mesh.nodes[:, 0]
    v = np.zeros((mesh.n_node, 3))
    v[:, 2] = 500.0 * np.sin(2.0 * x)
    v[FIRST:, 2] = 5000.0 * (1.0 + np.sin(3.0 * x[FIRST:]))
    v[:FIRST, 2] *= x[:FIRST] > 0.0
    return sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(points_per_layer=points),
        supports=[sc.Support.clamped(np.flatnonzero(x[:FIRST] == 0.0))],
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path=path, drop_loose=drop),
        velocity=v,
        **options,
    )


def run(sim, steps):
    for _ in range(steps):
        sim.step()
    return sim


# ------------------------------------------------------------------ which pieces are loose


def test_pieces_of_a_film_by_construction_are_loose_only_if_nothing_holds_them():
    mesh = two_sheets(1.0)
    state = initial_state(mesh)
    MITC4Shell(mesh, sc.ShellMaterial.homogeneous(), damping_beta=0.0).initialise(state)
    pieces = Pieces.of(state)
    np.testing.assert_array_equal(pieces.of_row, np.repeat([0, 1], [N_SHEET, 20]))
    # Nothing is held: the heavier piece is the film.
    assert pieces.loose.tolist() == [False, True]
    assert pieces.mass == pytest.approx([6.0e-9 * 0.074, 2.8e-9 * 0.074], rel=1e-12)
    np.testing.assert_array_equal(pieces.loose_nodes(state), np.arange(mesh.n_node) >= FIRST)
    state.node.supported[FIRST] = True
    assert Pieces.of(state).loose.tolist() == [True, False]
    state.node.supported[0] = True
    assert Pieces.of(state).n_loose == 0


def test_a_choice_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="drop_loose must be 'never' or 'clear'"):
        sc.Fracture(drop_loose="now")


# ------------------------------------------------------------------ the energy that goes with one


@pytest.mark.parametrize("path", ["edges", "free"])
@pytest.mark.parametrize(
    "how",
    [
        {},
        {"damping_beta": 0.0},
        {"damping_alpha": 1e3},
        {"points": 3},
        {"loads": [sc.Gravity((0.0, 0.0, -9810.0)), sc.Pressure(1e-4, following=True)]},
    ],
    ids=["damped", "undamped", "mass damping", "thickness points", "loads"],
)
def test_its_energy_is_booked_when_it_goes(path, how):
    sim = run(flying(path=path, **how), 99)
    energy = sim.ledger.initial
    book = sim.close_ledger()
    before, left = book.imbalance, book.kinetic + book.strain
    assert book.dropped == 0.0
    sim.step()
    assert sim.state.n_dropped == 1
    book = sim.close_ledger()
    assert book.dropped > 0.5 * energy
    assert book.kinetic + book.strain < 0.1 * left
    run(sim, 100)
    # The balance of a step errs by 1e-6 here, of the changing step; the piece is 90 % of the energy
    # and each part of it, strain, rotation or the next half of the damping, would show.
    assert abs(book.imbalance - before) < 2e-5 * energy
    n = sim.state.node
    assert not n.velocity_half[FIRST : n.count].any()
    assert n.velocity_half[:FIRST].any()


def test_the_strain_energy_of_rows_is_that_of_the_film():
    for points in (None, 3):
        sim = flying("never", points=points)
        run(sim, 60)
        state, whole = sim.state, sim.ledger.strain
        a, _ = state.strain_forms
        parts = [
            sim.shell.dropped.take_out(state, rows) for rows in np.split(np.arange(44), [N_SHEET])
        ]
        assert min(parts) > 1e-3 * whole
        assert sum(parts) == pytest.approx(whole, rel=1e-10)  # round-off
        if points is None:
            # What the kernels sum up from step to step is gone with them.
            assert state.strain_forms == pytest.approx((0.0, 0.0), abs=1e-9 * a)


# ------------------------------------------------------------------ when one goes, and what is left


def test_a_piece_stays_while_it_is_not_clear():
    assert run(flying("never"), 200).state.n_dropped == 0
    near = flying(height=0.3)
    near.state.node.velocity_half[FIRST : near.state.n_node] = 0.0
    assert run(near, 100).state.n_dropped == 0  # over the sheet, at less than two edges
    # A live cable to the rest holds it.
    tied = run(flying(), 50)
    k = tied.state.cable.append_blank()
    tied.state.cable.ends[k], tied.state.cable.status[k] = (0, FIRST), STRAIGHT
    assert not tied._loose._is_clear(tied.state, np.arange(FIRST, tied.state.n_node))
    tied.state.cable.ends[k] = 0, 1
    assert tied._loose._is_clear(tied.state, np.arange(FIRST, tied.state.n_node))


def test_frames_and_log_show_it_until_it_goes():
    sim = run(flying(), 99)
    how = {"coordinate": 0.0, "coordinate_name": "path", "coordinate_unit": "mm"}
    assert len(Exposure.of(sim, **how).frame().quads) == 44
    sim.step()
    frame = Exposure.of(sim, **how).frame()
    assert len(frame.quads) == len(frame.quad_stress) == N_SHEET
    assert frame.quads.max() < FIRST
    assert sim.state.split_log[-1].kind == DROPPED
    assert sim.state.splits == []
    assert sim.state.revision == len(sim.state.split_log) == 1
    assert Pieces.of(sim.state).n_loose == 0


def test_the_rest_goes_on_as_if_it_had_never_been():
    sim, alone = run(flying(damping_beta=0.0), 300), flying("never", damping_beta=0.0)
    run(alone, 300)
    x, wanted = sim.state.node.x[:FIRST], alone.state.node.x[:FIRST]
    assert sim.state.n_dropped == 1
    np.testing.assert_allclose(x, wanted, atol=1e-4 * np.ptp(wanted[:, 2]))  # another time step


@pytest.mark.parametrize("path", ["edges", "free"])
def test_a_restart_after_it_has_gone_has_the_same_bits(tmp_path, path):
    whole = run(flying(path=path), 250)
    first = run(flying(path=path), 170)
    assert first.state.n_dropped == 1
    save_checkpoint(first, tmp_path / "half.h5")
    again = flying(path=path)
    load_checkpoint(again, tmp_path / "half.h5")
    run(again, 80)
    count = whole.state.node.count
    for name in ("x", "t", "velocity_half"):
        np.testing.assert_array_equal(
            getattr(again.state.node, name)[:count], getattr(whole.state.node, name)[:count]
        )
    assert again.close_ledger() == whole.close_ledger()


def test_a_loose_piece_comes_to_rest_on_the_film():
    mesh = two_sheets(0.1)
    v = np.zeros((mesh.n_node, 3))
    v[FIRST:, 2] = -1000.0
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(np.arange(FIRST))],
        loads=[sc.Gravity((0.0, 0.0, -2e7))],
        contact=sc.Contact(self_contact=True),
        velocity=v,
        damping_alpha=3e4,
    )
    run(sim, 4000)
    z = sim.state.node.x[FIRST : mesh.n_node, 2]
    h = sim.material.thickness
    assert np.abs(sim.state.node.velocity_half[FIRST : mesh.n_node]).max() < 1.0
    assert sim.self_contact.forces.n_touching == 30
    # Its weight on 30 springs, all as deep: k f(D) = m g.
    assert z.min() > 0.9 * h
    assert z.max() < h
    assert abs(sim.ledger.imbalance) < 5e-3 * sim.ledger.put_in


@pytest.mark.slow
def test_the_piece_that_an_opening_cuts_out_is_taken_out():
    """18 s: the cap of the quick opening test, its last cable broken at 6.9 ms, is pulled down.

    Left alone it may tip, and hang in the hole.
    """
    case = sc.opening_test(
        "quick",
        contact=sc.Contact(self_contact=True),
        fracture=sc.Fracture(path="edges", drop_loose="clear"),
        loads=[sc.Gravity((0.0, 0.0, -2e7), factor=lambda time: float(time > 6e-3))],
    )
    sim = case.simulation
    sim.run(9e-3)
    book = sim.close_ledger()
    assert sim.state.n_dropped == 1
    assert Pieces.of(sim.state).n_loose == 0
    assert 0.0 < book.dropped < 2.0 * book.load_work
    assert abs(book.imbalance) < 5e-3 * book.tool_work
