"""The order of a run: restart, hooks, the end of it, blow-up; and the ledger of a small cut."""

import copy
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import notched_strip
import shellcut as sc
from courses import UNDAMPED
from shellcut.mesh.structured import rectangle
from shellcut.numerics.trigger import Trigger
from shellcut.simulation.instability import UnstableStep

FILM = sc.ShellMaterial.homogeneous()
SQUARE = rectangle(2.0, 2.0, n_x=4, n_y=4)


def cutting(**options):
    """A blade that starts in front of a notch and cuts quads on its way: all parts at work."""
    return notched_strip.cutting(pulled=False, **options)


class ColumnMotion(sc.StraightMotion):
    """The same motion from arrays that are laid out otherwise now and then, as a user's may be."""

    def pose(self, time):
        rotation, translation = super().pose(time)
        if round(time * 1e9) % 2:
            translation = np.repeat(translation, 2)[::2]
        return rotation, translation


def test_a_pose_may_come_in_any_layout():
    ours, other = cutting(), cutting(motion=ColumnMotion((1, 0, 0), 2e4, ramp=5e-6))
    for sim in (ours, other):
        sim.run(until=6e-5)
    assert ours.ledger.contact_work != 0.0
    assert other.ledger == ours.ledger


def resting(mesh=SQUARE, **options):
    return sc.Simulation(mesh, FILM, loads=[sc.Pressure(1e-2)], **options)


def bits(sim):
    s = sim.state
    rows = [
        getattr(s.node, k)[: s.n_node] for k in ("x", "t", "velocity_half", "spin_half", "force")
    ]
    rows += [s.cable.force[: s.n_cable], s.cable.work[: s.n_cable], s.strain, s.quads]
    return [row.tobytes() for row in rows] + [s.time, s.step, s.n_node, repr(sim.ledger)]


class Noting:
    """A hook that notes its calls and may stop or fail."""

    def __init__(self, raises=None, at=0):
        self.calls, self.closed, self.raises, self.at = [], 0, raises, at

    def due(self, sim):
        return True

    def __call__(self, sim):
        self.calls.append(sim.state.step)
        if self.raises is not None and sim.state.step >= self.at:
            raise self.raises

    def close(self):
        self.closed += 1


END = 8e-5


@pytest.fixture(scope="module")
def whole():
    sim = cutting()
    sim.run(END)
    return sim


def test_the_case_cuts_and_its_ledger_closes(whole):
    assert whole.state.n_cable >= 3
    assert whole.cables.n_joint_made >= 2
    assert whole.cables.n_broken >= 1
    assert {record.kind for record in whole.state.split_log} <= {"blade", "criterion"}
    ledger = whole.close_ledger()
    assert ledger.tool_work > 0
    # Discretisation in time: trapezoids of contact and cables at steps of some 1e-7 s on a coarse
    # film cut at 20 m/s; measured 0.09 %. The least of the large entries, contact, is 0.8 %.
    assert abs(ledger.relative(ledger.imbalance)) < 0.003
    stored_and_lost = ledger.cohesive_stored + ledger.cohesive_dissipated
    assert stored_and_lost == pytest.approx(ledger.cohesive_work, rel=0.01)


def test_neither_a_run_in_parts_nor_hooks_change_a_bit(whole):
    class Reader(Noting):
        def due(self, sim):
            return sim.state.step % 5 == 0

        def __call__(self, sim):
            super().__call__(sim)
            sim.close_ledger()
            sim.time_step.bound(sim.state)
            sim.cracks.at_tips(sim.mesh.nodes)

    sim, reader = cutting(), Reader()
    for until in (1.3e-5, 1.4e-5, 4.9e-5, END):
        sim.run(until, hooks=[reader])
    assert len(reader.calls) > 50
    whole.close_ledger()
    sim.close_ledger()
    assert bits(sim) == bits(whole)


def test_classical_cables_never_meet_the_blade_and_without_a_law_nothing_splits():
    sim = cutting(directional=False)
    sim.run(END)
    assert (sim.cables.n_joint_made, sim.state.n_cable > 0) == (0, True)
    sim = cutting(law=None, fracture=None)
    sim.run(2e-5)
    assert (sim.state.revision, sim.cracks) == (0, None)


def test_the_table_of_what_changes_in_time_is_what_is_saved():
    page = (Path(__file__).parents[2] / "docs" / "architecture.md").read_text(encoding="utf-8")
    rows = re.search(r"\| `saved\(\)` \|.*?\n\n", page, re.S)[0].splitlines()[2:]
    told = [name for row in rows if row for name in re.findall(r"`(\w+)`", row.split("|")[1])]
    on = sc.Contact(self_contact=True, self_friction=0.2)
    assert sorted(told) == sorted(notched_strip.cutting(contact=on).saved())  # its sides move


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, pickle.dumps])
def test_a_simulation_is_not_copied(again):
    with pytest.raises(TypeError, match="save_checkpoint"):
        again(cutting())


def test_the_last_step_is_whole_and_the_initial_velocity_is_put_in():
    sim = resting()
    sim.run(1e-6)
    assert sim.state.time - sim.state.dt < 1e-6 <= sim.state.time
    assert sim.state.dt == sim.dt
    velocity = np.tile([0.0, 0.0, 100.0], (25, 1))
    sim = sc.Simulation(SQUARE, FILM, velocity=velocity, damping_alpha=0.0)
    given = 0.5 * 1e4 * sim.state.node.mass[:25].sum()
    assert sim.ledger.initial == pytest.approx(given, rel=1e-13)
    sim.run(1e-5)
    assert sim.ledger.imbalance == pytest.approx(0.0, abs=1e-12 * sim.ledger.initial)


def bent_strip(bend):
    """Return a strip of 4 x 3 mm, rolled to a radius unless that is infinite [mm]."""
    flat = rectangle(4.0, 3.0, n_x=8, n_y=6)
    if np.isinf(bend):
        return flat
    x, y, _ = flat.nodes.T
    rolled = [bend * np.sin(x / bend), y, bend * np.cos(x / bend)]
    return sc.Mesh.from_arrays(np.column_stack(rolled), flat.quads)


@pytest.mark.parametrize("spin", [(300.0, 0.0, 0.0), (0, 0, 300), (200, -100, 250)])
@pytest.mark.parametrize("bend", [np.inf, 3.0])
def test_a_film_that_spins_as_a_rigid_body_takes_its_directors_along(spin, bend):
    mesh, spin = bent_strip(bend), np.array(spin, float)
    arm = mesh.nodes - mesh.nodes.mean(axis=0)
    velocity = np.array([50.0, -20.0, 70.0]) + np.cross(spin, arm)
    sim = sc.Simulation(mesh, FILM, velocity=velocity, **UNDAMPED)
    n, node, most = sim.state.node, slice(0, mesh.n_node), 0.0

    def momentum(x, v, w):
        return (n.mass[node, None] * np.cross(x, v) + n.inertia[node, None] * w).sum(axis=0)

    t = mesh.directors
    rigid = momentum(mesh.nodes, velocity, spin - (t @ spin)[:, None] * t)
    close = 1e-6 * np.linalg.norm(rigid)
    for n_step in (0, 100):
        for _ in range(n_step):
            sim.step()
            most = max(most, sim.ledger.strain)
        found = momentum(n.x[node], n.velocity_half[node], n.spin_half[node])
        np.testing.assert_allclose(found, rigid, atol=close)
    # what holds the film together while it turns: stress² / E, stress = density (spin size)²; it
    # bends a strip that is not flat, (sagitta / thickness)² = 81 times as much
    load = 1e-9 * (spin @ spin) * 4.0**2
    assert most < (1.0 if np.isinf(bend) else 81.0) * load / 1678.0 * sim.ledger.initial


def test_all_hooks_are_served_and_closed_whatever_one_of_them_does():
    hooks = before, stopper, after = Noting(), Noting(sc.StopRun(), at=3), Noting()
    resting().run(1.0, hooks=hooks)
    assert before.calls == stopper.calls == after.calls == [0, 1, 2, 3]
    assert [hook.closed for hook in hooks] == [1, 1, 1]
    bad, good = Noting(KeyError("x"), at=2), Noting()
    with pytest.raises(KeyError):
        resting().run(1.0, hooks=[bad, good])
    assert (bad.closed, good.closed) == (1, 1)


def test_blow_up_names_the_worst_quad_and_the_safe_step():
    # The finest quads go first: the named one must be among the most strained.
    nodes = SQUARE.nodes.copy()
    nodes[SQUARE.node_set("right"), 0] = 1.6
    mesh = sc.Mesh.from_arrays(nodes, SQUARE.quads)
    still = resting(mesh)
    safe = still.time_step.bound(still.state)
    sim = resting(mesh, stepping=sc.Stepping(fixed=10.0 * safe))
    with pytest.raises(UnstableStep, match=r"quad \d+ at \(") as failure:
        sim.run(1.0)
    text = str(failure.value)
    assert f"The step of {10.0 * safe:.4g} s is longer than the safe one" in text
    assert text.endswith("leave out time.fixed.")
    # Given up while its numbers are numbers: the frame of the end can be written.
    assert np.isfinite(sim.shell.face_stresses(sim.state).stress).all()
    lengths = [
        np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        for corners in (nodes[mesh.quads], sim.state.node.x[mesh.quads])
    ]
    change = np.abs(lengths[1] / lengths[0] - 1.0).max(axis=1)
    assert change[int(re.search(r"quad (\d+)", text)[1])] == change.max()
    just_below = resting(mesh, stepping=sc.Stepping(fixed=0.95 * safe))
    just_below.run(300 * safe)
    assert np.isfinite(just_below.state.node.x[:25]).all()


def test_a_trigger_is_due_once_past_every_multiple():
    trigger = Trigger(0.1)
    times = [0.0, 0.04, 0.09, 0.11, 0.19, 0.21, 0.29, 0.65, 0.65, 0.699, 0.701]
    assert [k for k, time in enumerate(times) if trigger(time)] == [0, 3, 5, 7, 10]
    for interval in (0.0, float("nan")):
        with pytest.raises(ValueError, match="interval must be a positive time in s"):
            Trigger(interval)
