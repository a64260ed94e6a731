"""Two pieces of film near each other, for the tests of the film's contact with itself."""

import numpy as np

import shellcut as sc
from courses import UNDAMPED
from shellcut.contact.sheet_contact import SelfContact
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell
from shellcut.tool.pose import Pose

H = 0.074
ON = sc.Contact(self_contact=True)


def two_pieces(gap, turn=20.0, tilt=0.0):
    """A large piece in z = 0 and a smaller one, turned and moved by ``gap`` from its middle."""
    one = rectangle(3.0, 2.0, n_x=6, n_y=4)
    two = rectangle(2.0, 1.4, n_x=5, n_y=4)
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    a, b = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    rotation = np.array([[1, 0, 0], [0, a, -b], [0, b, a]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    middle = one.nodes.mean(axis=0)
    moved = (two.nodes - two.nodes.mean(axis=0)) @ rotation.T + middle + gap
    nodes = np.concatenate([one.nodes, moved])
    return sc.Mesh.from_arrays(nodes, np.concatenate([one.quads, two.quads + one.n_node])), one


def thrown(gap, velocity, *, thickness=H, contact=ON, **options):
    """Two free pieces that fly against each other at ``velocity`` each."""
    mesh, one = two_pieces(gap)
    v = np.tile(-np.asarray(velocity, float), (mesh.n_node, 1))
    v[: one.n_node] *= -1.0
    return sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(thickness=thickness),
        contact=contact,
        velocity=v,
        **UNDAMPED,
        **options,
    )


def touching(gap, tilt=0.0, warp=0.0):
    """State and term of two pieces, the second anywhere; nothing moves."""
    mesh, one = two_pieces((0.0, 0.0, 5.0), tilt=tilt)
    material = sc.ShellMaterial.homogeneous(thickness=H)
    state = initial_state(mesh)
    MITC4Shell(mesh, material, damping_beta=0.0).initialise(state)
    term = SelfContact(ON, material, 0.5)
    rng = np.random.default_rng(1)
    x = mesh.nodes + warp * rng.normal(size=mesh.nodes.shape)
    x[one.n_node :] += np.asarray(gap) - [0.0, 0.0, 5.0]
    return state, term, x, one.n_node


def evaluated(state, term, x):
    """Forces of the term with the nodes at x, after a look at them from where they came."""
    n = state.node
    n.x[: n.count] = x
    n.force_rows[:] = 0.0
    term.add_forces(state, Pose.at_origin())
    found = term.forces
    return n.force[: n.count].copy(), found


def approached(state, term, x, away):
    """Bring the nodes from x + away to x, so that sides are known."""
    for part in (1.0, 0.5, 0.25):
        evaluated(state, term, x + part * away)
        state.revision += 1  # search anew, as something may have come near
    return evaluated(state, term, x)


def split(state, node):
    """Part a node into halves that nothing moves apart; return the other one."""
    n, half = state.node, state.node.append_copy(node)
    n.mass[[node, half]] *= 0.5
    n.contact_mass[[node, half]] *= 0.5
    n.halved[[node, half]] = True
    n.origin[half] = n.origin[node]
    state.revision += 1
    return half


CASES = {
    "face": ([0.13, 0.07, 0.9 * H], [0.0, 0.0, 0.5], 0.0),
    "from below": ([0.13, 0.07, -0.8 * H], [0.0, 0.0, -0.5], 0.0),
    "tilted": ([0.13, 0.07, 0.18], [0.0, 0.0, 0.6], 12.0),
    "edges in plane": ([2.405, 0.1, 0.3 * H], [0.5, 0.0, 0.0], 0.0),
}
