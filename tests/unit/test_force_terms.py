"""The loop over the force terms: wrench, work, stiffness, ledger; a term of one's own.

What each of them holds: test_every_term.py.
"""

import re
from types import SimpleNamespace

import numpy as np
import pytest

import shellcut as sc
from courses import UNDAMPED
from naive.booking import book
from notched_strip import cutting
from shellcut import ForceTerm, load_checkpoint, save_checkpoint
from shellcut.mesh.structured import rectangle
from shellcut.recording.checkpoint import CheckpointError
from shellcut.simulation.force_terms import WorkBook, work_on_tool
from shellcut.tool.touch import ON_TOOL, Booking, Touch


class Tether(ForceTerm):
    """A linear spring between a node and a place."""

    name = "tether"
    booked = (Booking("load_work", 0),)

    def __init__(self, node, place, k):
        self.node, self.place, self.k = node, np.array(place), k
        self.touch = Touch.none(0, 1)
        self._last = None

    def add_forces(self, state, pose):
        x = state.node.x[self.node].copy()
        f = self.k * (self.place - x)
        state.node.force[self.node] += f
        f_before, x_before = self._last or (f, x)
        self.touch.sums[0], self._last = 0.5 * (f + f_before) @ (x - x_before), (f, x)

    def stiffness(self, _state, _counted):
        return np.array([self.node]), np.array([self.k])

    def saved(self):
        return {"force": self._last[0], "x": self._last[1]}

    def restore(self, _state, _pose, saved):
        self._last = saved["force"], saved["x"]


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({}, "contact points joints"),
        ({"tool_points": False}, "contact joints"),
        ({"friction": 0.2}, "contact friction points point_friction joints"),
        (
            {"film_edges": True, "tool_points": False, "friction": 0.2},
            "contact friction edges edge_friction joints",
        ),
    ],
    ids=str,
)
def test_contact_and_cables_of_a_simulation_are_terms(options, names):
    sim = cutting(contact=sc.Contact(**options))
    assert [term.name for term in sim.terms] == names.split()
    assert [list(sim.terms)[k] for k in (0, -1)] == [sim.contact, sim.cables]


def test_works_are_the_trapezoid_of_wrench_and_twist_and_go_into_their_entries():
    rng = np.random.default_rng(2)
    wrenches = rng.normal(size=(4, 2, 4, 6))  # three steps of two terms and four teeth
    wrenches[-1] = 0.0  # before the first
    terms = [SimpleNamespace(touch=Touch.none(4, n), booked=None) for n in (2, 3)]
    terms[0].booked = [Booking("b", 1), Booking("a", 0, -1.0), Booking("a", ON_TOOL, -1.0)]
    terms[1].booked = [Booking("c", 2, 3.0), Booking("a", 1)]
    rows = [(0, 1, 1), (0, 0, 0), (0, ON_TOOL, 0), (1, 2, 2), (1, 1, 0)]
    works = WorkBook(
        last=np.zeros((4, 6)),
        works=np.full(2, np.nan),
        wrenches=tuple(term.touch.wrench for term in terms),
        sums=tuple(term.touch.sums for term in terms),
        row=np.array(rows),
        factor=np.array([1.0, -1.0, -1.0, 3.0, 1.0]),
        amounts=np.full(3, np.nan),
    )
    over_turn = np.zeros(6)
    for k in range(3):
        for term, wrench in zip(terms, wrenches[k], strict=True):
            term.touch.wrench[:], term.touch.sums[:] = wrench, rng.normal(size=len(term.touch.sums))
        dt, (spin, velocity, origin) = 0.1 * (k + 1), rng.normal(size=(3, 3))
        whole = work_on_tool(np.stack([spin, velocity]), origin, dt, works)
        moved = dt * np.concatenate([velocity, spin])
        means = 0.5 * (wrenches[k - 1] + wrenches[k]).sum(axis=1)
        np.testing.assert_allclose(works.works, means @ moved, rtol=1e-13)
        assert whole == pytest.approx(works.works.sum(), rel=1e-13)
        wanted = dict.fromkeys("abc", 0.0)
        for term, work in zip(terms, means @ moved, strict=True):
            book(term, wanted, work)
        np.testing.assert_allclose(works.amounts, [*wanted.values()], rtol=1e-13)
        mean = means.sum(axis=0)
        mean[3:] += np.cross(origin - 0.5 * dt * velocity, mean[:3])
        over_turn += dt * np.linalg.norm(spin) * mean
        np.testing.assert_allclose(works.last[3], over_turn, rtol=1e-12)
    np.testing.assert_allclose(works.last[:2], wrenches[2].sum(axis=1), rtol=1e-14)
    np.testing.assert_allclose(works.last[2], wrenches[2].sum(axis=(0, 1)), rtol=1e-14)


def tethered(terms=None, **options):
    mesh = rectangle(4.0, 2.0, size=1.0)
    if terms is None:
        terms = [Tether(7, mesh.nodes[7] + [0.0, 0.0, 0.1], 0.02)]
    return sc.Simulation(mesh, sc.ShellMaterial.homogeneous(), terms=terms, **UNDAMPED | options)


def test_a_term_of_ones_own_moves_the_film_and_keeps_the_balance(tmp_path):
    whole = tethered()
    for _ in range(200):
        whole.step()
    # The film is free: its momentum is what the spring has given, and its energy, too.
    book = whole.close_ledger()
    assert whole.state.node.velocity_half[:, 2].max() > 1.0
    assert book.load_work > 0.0
    assert abs(book.relative(book.imbalance)) < 1e-6
    save_checkpoint(whole, tmp_path / "c.h5")
    with pytest.raises(CheckpointError, match="terms"):
        load_checkpoint(tethered([]), tmp_path / "c.h5")


class Plain(ForceTerm):
    """Springs between nodes and places, turning springs on directors, and no word on its work."""

    def __init__(self, nodes, places, k, turning=0.0, tool=False, name="plain"):
        self.name, self.nodes, self.k, self.turning = name, np.array(nodes), k, turning
        self.places = np.array(places, float)
        self.touch = Touch.none(int(tool), 0)

    def pulled(self, state, pose):
        at = pose.translation if len(self.touch.wrench) else 0.0
        return at + self.places - state.node.x[self.nodes]

    def add_forces(self, state, pose):
        pull = self.k * self.pulled(state, pose)
        for node, force in zip(self.nodes, pull, strict=True):
            state.node.force[node] += 0.5 * force  # in two parts
            state.node.force[node] += 0.5 * force
            state.node.director_force[node] -= self.turning * np.array([1.0, 0.0, 0.0])
        for wrench in self.touch.wrench:
            moment = np.cross(state.node.x[self.nodes] - pose.translation, pull).sum(axis=0)
            wrench[:] = -np.concatenate([pull.sum(axis=0), moment])

    def energy(self, state, pose):
        """Of springs, and of couples whose potential is the tilt of the director along x."""
        pulled = self.pulled(state, pose)
        tilt = self.turning * state.node.t[self.nodes, 0].sum()
        return 0.5 * self.k * (pulled * pulled).sum() + tilt

    def stiffness(self, state, counted):
        return self.nodes, np.full(len(self.nodes), self.k)


FLAT = rectangle(4.0, 2.0, size=1.0)
SHIFT = [0.0, 0.01, 0.1]
HELD = [sc.Support.clamped("left")]
MOVED = [*HELD, sc.Support("right", velocity={"z": lambda time: 20.0})]
PLAIN = {
    "a free film": {},
    "held where it pulls": {"nodes": [0, 7], "supports": HELD},
    "on a moving support": {"nodes": [4, 7], "supports": MOVED},
    "on directors": {"turning": 2e-4, "supports": HELD},
    "beside loads": {"loads": [sc.Gravity((0.0, 0.0, -1e6)), sc.Pressure(1e-5, following=True)]},
    "damped": {"damping_alpha": 0.0, "damping_beta": 5e-8},
}


@pytest.mark.parametrize("case", PLAIN)
def test_the_work_of_a_term_that_books_nothing_is_booked_for_it(case):
    options = dict(PLAIN[case])
    nodes, turning = options.pop("nodes", [7, 9]), options.pop("turning", 0.0)
    term = Plain(nodes, FLAT.nodes[nodes] + SHIFT, 0.02, turning)
    sim = tethered([term], **options)
    before = term.energy(sim.state, sim.pose)
    for _ in range(200):
        sim.step()
    book = sim.close_ledger()
    given = before - term.energy(sim.state, sim.pose)
    assert abs(given) > 1e-2 * before
    if "loads" not in options:  # of linear springs the trapezoidal rule is exact
        assert book.load_work == pytest.approx(given, rel=1e-9)
    assert abs(book.imbalance) < 1e-6 * abs(book.load_work)


def springs_on_tool(state):
    """Springs from all nodes near the notch to the tool: also those that will split."""
    near = np.flatnonzero(np.abs(state.node.X[: state.n_node, 1]) < 0.5)
    return Plain(near, state.node.X[near] - [0.05, 0.0, 0.0], 0.2, tool=True)


def test_a_cut_closes_with_springs_on_nodes_that_split_and_on_the_tool():
    term = springs_on_tool(cutting().state)
    sim = cutting(terms=[term])
    while sim.state.n_cable < 4:
        sim.step()
    book, energy = sim.close_ledger(), term.energy(sim.state, sim.pose)
    assert energy > 0.1 * abs(book.tool_work)
    assert abs(book.imbalance) < 1e-4 * energy
    others = sum(one.touch.wrench for one in sim.terms.on_tool if one is not term)
    np.testing.assert_array_equal(sim.tooth_wrenches, others + term.touch.wrench)


class Wrong(Plain):
    def __init__(self, **given):
        super().__init__([7], [[0.0, 0.0, 0.0]], 0.0)
        vars(self).update(given)

    def stored(self, state):
        return {"spring": 1.0} if self.name == "storing" else {}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"booked": [Booking("spring_work", ON_TOOL)]}, "plain adds to 'spring_work': it must be"),
        ({"booked": [Booking("load_work", 0)]}, "column 0 to load_work: it must be one of the 0"),
        ({"booked": [Booking("load_work", -2)]}, "column -2 to load_work"),
        ({"name": "last"}, "must have different names, and none of added, last; got "),
        ({"name": "joints"}, "must have different names"),
        ({"touch": Touch.none(2, 0)}, "a row for each tooth of the tool, got "),
    ],
)
def test_what_a_term_cannot_book_is_refused_before_the_run(given, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        cutting(terms=[Wrong(**given)])


def test_an_entry_that_the_ledger_does_not_have_is_refused():
    sim = tethered([Wrong(name="storing")])
    with pytest.raises(ValueError, match="storing stores 'spring': it must be an entry of the ene"):
        sim.close_ledger()
