"""Along which side a crack tears, and when: nodal force, largest principal stress, turn limit."""

import numpy as np
import pytest

from films import cut_by
from naive import cases
from shellcut import CohesiveLaw, Fracture, Pressure
from shellcut.fracture.crack_path import CrackPath
from shellcut.fracture.cracks import Cracks
from shellcut.fracture.cut_film import CutFilm
from shellcut.fracture.side_tears import SideTears
from shellcut.fracture.trial_cut import TrialCut
from shellcut.loads.loads import LoadSet
from shellcut.mesh.structured import rectangle
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade

H = 0.074
STRENGTH = 18.0
ROW = [14, 15, 16, 17]  # of six by four squares; node j * 7 + i is the i-th of row j
ANYWHERE = Pose.at_origin()


def sheet():
    return rectangle(6.0, 4.0, n_x=6, n_y=4)


def pulled(mesh, strain, loads=(), **options):
    """A film under a homogeneous strain, its cracks and its first Piola-Kirchhoff stress."""
    shell, state = cases.set_up(mesh)
    F = np.eye(3)
    F[:2, :2] += strain
    state.node.x[: mesh.n_node] = mesh.nodes @ F.T
    fracture = Fracture(path="edges", **options)
    law, held = CohesiveLaw(strength=STRENGTH), LoadSet(mesh, loads)
    cracks = Cracks(state, fracture, law, shell, held, None)
    E = 0.5 * (F.T @ F - np.eye(3))[:2, :2]
    s = cases.FILM.layers[0].material.plane_stress() @ [E[0, 0], E[1, 1], 2 * E[0, 1]]
    S = np.zeros((3, 3))
    S[:2, :2] = [[s[0], s[2]], [s[2], s[1]]]
    return shell, state, cracks, F @ S


def torn(state, cracks):
    """Let the one crack run once; return the node that parted, the tip and the measure."""
    n_before = len(state.split_log)
    cracks.cut_due(state, ANYWHERE)
    tips = [tip.ends[0] for tip in cracks.tips] or [None]
    return [(one.node, tips[0], one.measure) for one in state.split_log[n_before:]]


@pytest.mark.parametrize("jitter", [0.0, 0.12])
def test_the_measure_is_the_traction_on_the_halves_that_part(jitter):
    # A notch, then one side more: the flanks of this homogeneous state still pull behind the tip.
    mesh = cases.skewed_flat(6, 4, seed=5, amount=jitter).cut(ROW)
    strain = np.array([[0.001, 0.0], [0.0, 0.03]])
    _, state, cracks, P = pulled(mesh, strain)
    ((node, tip, measure),) = torn(state, cracks)
    assert (node, tip) == (17, 18)
    chord = mesh.nodes[18] - mesh.nodes[16]
    along = mesh.nodes[18] - mesh.nodes[17]
    # The notch has no cable and no length: the normal is that of the side ahead.
    F = np.eye(3)
    F[:2, :2] += strain
    m = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]) @ F @ along
    m /= np.linalg.norm(m)
    force = P @ np.array([-chord[1], chord[0], 0.0]) * 0.5 * H
    assert measure == pytest.approx(
        force @ m / (STRENGTH * H * 0.5 * np.linalg.norm(along)), rel=1e-9
    )


@pytest.mark.parametrize(("factor", "count"), [(0.98, 0), (1.02, 1)])
def test_a_crack_is_due_at_the_strength(factor, count):
    # Twice the traction, on the half ahead alone: see above.
    strain = factor * 0.5 * STRENGTH / (1678.0 / 0.91)
    _, state, cracks, _ = pulled(sheet().cut(ROW), np.diag([0.0, strain]))
    assert len(torn(state, cracks)) == count


def test_common_acceleration_pulls_nothing_apart():
    # Dead pressure on an unstrained skewed film: every part moves alike, though forces and masses
    # of the two sides differ.
    mesh = cases.skewed_flat(6, 4, seed=5, amount=0.2).cut(ROW)
    loads, fracture = [Pressure(0.1)], Fracture(path="edges", turn_limit_deg=100.0)
    shell, state, cracks, _ = pulled(mesh, np.zeros((2, 2)), loads, turn_limit_deg=100.0)
    topology = cracks.cuts.topology
    trial = TrialCut(topology, shell, LoadSet(mesh, loads), STRENGTH)
    (tip,) = cracks.tips
    path = CrackPath(CutFilm(topology, shell, sides_only=True))
    due = SideTears(shell, path.film, trial, STRENGTH, fracture).best(state, tip, [tip])
    assert abs(due.measure) < 1e-12


@pytest.mark.parametrize(("limit", "ends"), [(57.0, []), (80.0, []), (100.0, [10, 24])])
@pytest.mark.parametrize("criterion", ["force", "stress"])
def test_turn_limit(limit, ends, criterion):
    # Pulled along the notch: the crack would have to turn by 90 degrees.
    _, state, cracks, _ = pulled(
        sheet().cut(ROW), np.diag([0.05, -0.02]), turn_limit_deg=limit, criterion=criterion
    )
    found = torn(state, cracks)
    if criterion == "stress" and not ends:
        assert [(node, tip) for node, tip, _ in found] == [(17, 18)]  # the only side there is
        return
    assert len(found) == bool(ends)
    assert all(tip in ends for _, tip, _ in found)


@pytest.mark.parametrize(("strain", "tears"), [(0.012, True), (0.009, False)])
def test_the_largest_principal_stress_is_that_of_the_node(strain, tears):
    film = sheet().cut(ROW)
    shell, state, cracks, _ = pulled(film, np.diag([0.0, strain]), criterion="stress")
    sigma = shell.stress(state, np.array([0]))[0, 1, 1]
    wanted = [(17, 18, pytest.approx(sigma / STRENGTH, rel=1e-9))] if tears else []
    assert torn(state, cracks) == wanted


@pytest.mark.parametrize("criterion", ["force", "stress"])
def test_a_tear_runs_from_side_to_side_and_ends_at_the_rim(criterion):
    _, state, cracks, _ = pulled(sheet().cut(ROW), np.diag([0.0, 0.05]), criterion=criterion)
    state.node.support_rate[17] = 1.0  # a support that moves holds the film together
    assert torn(state, cracks) == []
    state.node.support_rate[17] = 0.0
    while torn(state, cracks):
        pass
    places = np.array([record.reference for record in state.split_log])
    np.testing.assert_allclose(places, sheet().nodes[[17, 18, 19]])
    assert cracks.tips == []
    # Whole to the rim: film above and below has no node in common.
    assert not np.intersect1d(state.quads[:12], state.quads[12:]).size
    assert state.crack_length == pytest.approx(3.0)


@pytest.mark.parametrize("path", ["free", "edges"])
@pytest.mark.parametrize("beside", [0.0, 0.049])
def test_a_rim_entered_beside_an_edge_of_the_mesh_is_cut_along_it_at_once(path, beside):
    film = rectangle(4.0, 4.0, size=0.8)
    blade = straight_blade(length=4.0, height=3.0).translated((-0.05, 0.4 + beside * 0.8, 0.0))
    sim = cut_by(blade, film, 6000.0, ramp=5e-5, fracture=Fracture(path=path))
    while not sim.state.split_log:
        sim.step()
        past = sim.motion.coordinate(sim.state.time) - 0.05
        assert past < 0.02  # at the first check; the edge moves by 0.01 mm from check to check
    (cut,) = sim.state.split_log
    np.testing.assert_allclose(cut.reference[:2], [0.0, 0.4], atol=1e-12)
    assert sim.state.crack_length == pytest.approx(0.8)
    assert past > 0.0
