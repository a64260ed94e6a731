"""Patch recovery: exact for linear fields, never across a crack, against least squares."""

import numpy as np
import pytest

from naive import cases
from naive import recovery as naive
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.nodal_stress import recover


class Field:
    """Stands for the shell: a stress given as a function of the quads' centres."""

    def __init__(self, tensor):
        self.tensor = tensor
        self.asked = set()

    def stress(self, state, quads):
        self.asked |= set(quads.tolist())
        centres = state.node.x[state.quads[quads]].mean(axis=1)
        return np.array([self.tensor(*c) for c in centres])


def linear(x, y, z=0.0):
    s = np.zeros((3, 3))
    s[:2, :2] = [[10 + 2 * x - y, 3 - x + 0.5 * y], [3 - x + 0.5 * y, 6 + 0.3 * x + 4 * y]]
    return s


def check_exact(state, nodes, stress, tensor=linear):
    for k, n in enumerate(nodes):
        values, vectors = np.linalg.eigh(tensor(*state.node.x[n])[:2, :2])
        assert stress.principal[k] == pytest.approx(values[-1], rel=1e-11), n
        cos = abs(stress.direction[k, :2] @ vectors[:, -1])
        assert cos == pytest.approx(1.0, abs=1e-11)
        assert stress.direction[k, 2] == 0.0


def test_linear_field_is_recovered_exactly_on_distorted_patches():
    mesh = cases.skewed_flat(5, 4, seed=3, amount=0.25)
    state = initial_state(mesh)
    nodes = np.arange(mesh.n_node)
    stress = recover(state, Field(linear), nodes)
    check_exact(state, nodes, stress)
    # The 18 nodes of the boundary have one or two quads: they take an inner neighbour's polynomial.
    assert stress.n_borrowed == mesh.boundary_nodes().size == 18
    inner = np.setdiff1d(nodes, mesh.boundary_nodes())
    assert recover(state, Field(linear), inner).n_borrowed == 0


def test_only_quads_around_the_nodes_and_their_neighbours_are_asked():
    mesh = rectangle(9.0, 7.0, n_x=9, n_y=7)
    state = initial_state(mesh)
    field = Field(linear)
    recover(state, field, np.array([34]))  # row 3, column 4
    assert field.asked == {9 * j + i for j in range(1, 5) for i in range(2, 6)}


@pytest.mark.parametrize("case", ["warped", "curved"])
def test_patch_against_least_squares(case):
    mesh = cases.ALL[case](5, 4)
    state = initial_state(mesh)
    cases.deform(state, stretch=0.05)
    rng = np.random.default_rng(2)
    samples = rng.uniform(-5, 20, (mesh.n_quad, 3, 3))
    samples += samples.transpose(0, 2, 1)

    class Samples:
        def stress(self, state, quads):
            return samples[quads]

    inner = np.setdiff1d(np.arange(mesh.n_node), mesh.boundary_nodes())
    stress = recover(state, Samples(), inner)
    for k, n in enumerate(inner):
        around = [e for e in range(mesh.n_quad) if n in mesh.quads[e]]
        centres = state.node.x[mesh.quads[around]].mean(axis=1)
        value, direction = naive.principal(
            centres, samples[around], state.node.x[n], state.node.t[n]
        )
        # Round-off of two solutions of a system of condition below 100.
        assert stress.principal[k] == pytest.approx(value, rel=1e-11)
        assert abs(stress.direction[k] @ direction) == pytest.approx(1.0, abs=1e-11)
        assert stress.direction[k] @ state.node.t[n] == pytest.approx(0.0, abs=1e-14)


def test_no_sample_from_across_a_crack():
    # A crack right through: another linear field on either side, recovered exactly on each flank.
    mesh = rectangle(6.0, 4.0, n_x=6, n_y=4).cut(list(range(14, 21)))
    state = initial_state(mesh)

    def below_or_above(x, y, z=0.0):
        return linear(x, y) if y < 0 else -3.0 * linear(y, x) + 50 * np.diag([1.0, 0, 0])

    lower = [n for n in np.flatnonzero(mesh.nodes[:, 1] == 0) if
             mesh.nodes[mesh.quads[(mesh.quads == n).any(axis=1)]][..., 1].max() == 0]  # fmt: skip
    upper = np.setdiff1d(np.flatnonzero(mesh.nodes[:, 1] == 0), lower)
    assert len(lower) == len(upper) == 7
    field = Field(below_or_above)
    check_exact(state, lower, recover(state, field, np.array(lower)))
    above = recover(state, field, upper)
    check_exact(state, upper, above, lambda x, y, z: below_or_above(x, 1e-300, z))
    assert above.n_borrowed == 7


def test_a_single_row_has_nothing_to_borrow_and_takes_the_mean():
    mesh = rectangle(3.0, 1.0, n_x=3, n_y=1)
    state = initial_state(mesh)
    stress = recover(state, Field(linear), np.array([1]))
    mean = 0.5 * (linear(0.5, 0.0) + linear(1.5, 0.0))
    assert stress.n_borrowed == 0
    assert stress.principal[0] == pytest.approx(np.linalg.eigvalsh(mean[:2, :2])[-1], rel=1e-13)
    assert recover(state, Field(linear), np.zeros(0, np.int64)).principal.shape == (0,)
