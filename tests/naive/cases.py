"""Meshes and states that a kernel must stand: skewed, warped, curved, turned far."""

import numpy as np
from scipy.spatial.transform import Rotation

from shellcut import Mesh, ShellMaterial
from shellcut.fracture.quad_polygon import CORNERS
from shellcut.fracture.tip import Segment
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell

FILM = ShellMaterial.homogeneous()


def moved_mesh(mesh, nodes, **options):
    """The mesh with other node positions, directors anew from the normals."""
    return Mesh.from_arrays(
        nodes, mesh.quads, node_sets=dict(mesh.node_sets), origin=mesh.origin, **options
    )


def skewed_flat(n_x=3, n_y=2, seed=0, amount=0.15):
    """A plane sheet of unit squares, its inner and outer nodes moved in the plane."""
    mesh = rectangle(float(n_x), float(n_y), n_x=n_x, n_y=n_y)
    nodes = mesh.nodes.copy()
    nodes[:, :2] += np.random.default_rng(seed).uniform(-amount, amount, (mesh.n_node, 2))
    return moved_mesh(mesh, nodes)


def warped(n_x=3, n_y=2, seed=1):
    """Skewed and warped quads: neighbours' normals differ by up to some 30 degrees."""
    mesh = skewed_flat(n_x, n_y, seed)
    nodes = mesh.nodes.copy()
    nodes[:, 2] += np.random.default_rng(seed).uniform(-0.12, 0.12, mesh.n_node)
    return moved_mesh(mesh, nodes)


def curved(n_around=3, n_along=2, seed=2):
    """A barrel roof with exact directors, its nodes shifted along the surface."""
    mesh = cylinder(2.0, 2.0, n_around=n_around, n_along=n_along, arc_deg=75.0)
    rng = np.random.default_rng(seed)
    angle = np.arctan2(mesh.nodes[:, 0], mesh.nodes[:, 2]) + rng.uniform(-0.06, 0.06, mesh.n_node)
    y = mesh.nodes[:, 1] + rng.uniform(-0.1, 0.1, mesh.n_node)
    directors = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
    nodes = 2.0 * directors
    nodes[:, 1] = y
    return Mesh.from_arrays(nodes, mesh.quads, directors=directors)


ALL = {"flat": skewed_flat, "warped": warped, "curved": curved}


def set_up(mesh, material=FILM, damping_beta=0.0):
    """Shell and state of a mesh; the spare rows are poisoned."""
    shell = MITC4Shell(mesh, material, damping_beta=damping_beta)
    state = initial_state(mesh)
    shell.initialise(state)
    for rows in (state.node.x, state.node.t, state.node.force, state.node.director_force):
        rows[mesh.n_node :] = np.nan
    return shell, state


def deform(state, seed=3, stretch=0.1, tilt=0.2):
    """Turn the sheet by some 130 degrees, stretch it and tilt its directors at random."""
    rng = np.random.default_rng(seed)
    n = state.n_node
    turn = Rotation.from_rotvec([1.1, -1.5, 1.3])
    x = state.node.x[:n] * (1.0 + 0.5 * stretch) + rng.uniform(-stretch, stretch, (n, 3))
    t = Rotation.from_rotvec(rng.uniform(-tilt, tilt, (n, 3))).apply(state.node.t[:n])
    state.node.x[:n] = turn.apply(x) + np.array([3.0, -2.0, 5.0])
    state.node.t[:n] = turn.apply(t)
    return state


def forces_of(shell, state):
    """Energy, and minus the forces that the shell adds: dW/dx and dW/dt."""
    n = state.n_node
    state.node.force[:n] = 0.0
    state.node.director_force[:n] = 0.0
    energy = shell.add_forces(state).strain_energy
    return energy, -state.node.force[:n].copy(), -state.node.director_force[:n].copy()


def break_side(cuts, shell, state, a, b, kind="criterion"):
    """Break a side between two nodes of the mesh, from the first to the second; return the cut."""
    ring = next(r for r in shell.mesh_quads.tolist() if a in r and b in r and _next_to(r, a, b))
    row = shell.mesh_quads.tolist().index(ring)
    start, stop = ring.index(a), ring.index(b)
    side = start if stop == (start + 1) % 4 else stop
    segment = Segment(row, CORNERS[start], CORNERS[stop], side, stop, along_side=True)
    cut = cuts.along(state, segment, kind, 1.2)
    cuts.renew(state)
    return cut


def _next_to(ring, a, b):
    return (ring.index(a) - ring.index(b)) % 4 in (1, 3)


def welded(state, node):
    """Undo a cut at one node: it gets the quads of its duplicates, which are left without."""
    duplicates = np.flatnonzero(state.node.origin[: state.n_node] == node)
    state.quads[np.isin(state.quads, duplicates)] = node
    mine = np.flatnonzero((state.quads == node).any(axis=1))
    state.node.n_quad_at[duplicates] = 0
    state.node.quads[node, : mine.size], state.node.n_quad_at[node] = mine, mine.size
    return state
