"""Points on the flanks of a crack through quads: tied to the nodes of a copy.

Cables join the flanks, and the blade touches them, where a crack crosses a side: not at nodes. Such
a point P of a copy follows its nodes by the shape functions N_a at its place,

    x_P = sum N_a x_a,   v_P = sum N_a v_a,   and a force F at P acts as N_a F on node a,

so that its power F · v_P is that of the forces on the nodes, and their sum and moment are those of
F. It has a row among the nodes, without mass: cables and contact take it as a node like any other.
A force feels there the mass m_P = 1 / sum (N_a² / m_a).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.contact.film_outline import SLIVER, first_at_places
from shellcut.mesh.quad_geometry import corner_normals
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import mean_of, store
from shellcut.state import OncePerTopology, State

from .quad_polygon import UNUSED, Point


class _Tied(NamedTuple):
    """Flank points as the kernels take them."""

    n: int
    """Number of points; the rows beyond are in reserve."""
    node: Annotated[Ints, "(n_point,)"]
    nodes: Annotated[Ints, "(n_point, 4)"]
    weight: Annotated[Floats, "(n_point, 4)"]


class FlankPoints:
    """Keeps the flank points at their places, and hands on their forces."""

    def __init__(self) -> None:
        self._tied = OncePerTopology(self._laid_out)
        self._address_of = TableWriter()
        self._interpolate = BoundOnce(_interpolate)
        self._hand_on = BoundOnce(_hand_on)

    def follow(self, state: State) -> None:
        """Give all flank points the positions of their copies, and the velocities so far."""
        self._interpolate(self._tied.of(state), state.node.x, state.node.velocity_half)

    def hand_on_forces(self, state: State) -> None:
        """Add the forces on all flank points to those of the nodes they are tied to."""
        self._hand_on(self._tied.of(state), state.node.force_rows)

    def _laid_out(self, state: State) -> _Tied:
        f = state.flank
        return self._address_of(_Tied(f.count, f.node, f.nodes, f.weight))


def add_flank_point(state: State, row: int, place: Point, inward: Point) -> int:
    """Tie a new flank point to a copy; return its id among the nodes.

    Parameters
    ----------
    state : State
        Written.
    row : int
        The copy.
    place : Point
        Where in its quad.
    inward : Point
        A place a little further along the flank.
    """
    n, f = state.node, state.flank
    node, k = n.append_blank(), f.append_blank()
    f.node[k], f.place[k], f.inward[k], f.twin[k] = node, place, inward, k
    f.weight[k] = shape_functions(*place)
    n.origin[node] = node
    n.halved[node] = n.real[node] = True
    f.row[k], f.nodes[k] = row, state.quads[row]
    corners = f.nodes[k]
    for name in ("X", "x", "t", "velocity_half"):
        column = getattr(n, name)
        column[node] = product(f.weight[k], column[corners])
    return node


def tie(state: State, changed: Ints, areas: Floats, density: float) -> None:
    """Tie all flank points to the nodes that their copies have now.

    Contact treats those that have parted from their counterparts, of several at one place the
    first. Its film is that of the first two: which side of the blade a sliver lies on shows in the
    copy beyond the side.

    The contact area of one is a quarter of its quad's. It presses with as much of it, and the nodes
    around with as much of theirs, as the film can bear without shortening the step
    (:func:`_share_springs`).

    Parameters
    ----------
    state : State
        Written.
    changed : ndarray of int
        Rows that may have got other nodes since this was done last.
    areas : ndarray, shape (n_row,)
        Of whole quads [mm²].
    density : float
        rho h [t/mm²].
    """
    f, n = state.flank, state.node
    row, node = f.row[: f.count], f.node[: f.count]
    f.nodes[: f.count] = state.quads[row]
    # Of a sliver elsewhere the film around it is as before.
    sliver = state.quad.share[row] < SLIVER
    near = np.isin(f.nodes[: f.count], state.quads[changed]).any(axis=1)
    anew = near | ~sliver
    n.quads[node[anew], 0], n.n_quad_at[node[anew]] = row[anew], 1
    tied_to = np.sort(np.where(f.weight[: f.count] > UNUSED, f.nodes[: f.count], -1), axis=1)
    touched = np.flatnonzero((tied_to != tied_to[f.twin[: f.count]]).any(axis=1))
    at = first_at_places(f.nodes[touched], f.weight[touched])
    again = np.flatnonzero(at < np.arange(touched.size))
    seen = (f.weight[touched] > UNUSED).sum(axis=1) > 1  # a corner is a node itself
    seen[again] = False
    n.real[node] = False
    n.real[node[touched]] = seen
    first, second = np.unique(at[again], return_index=True)
    first, other = touched[first], touched[again[second]]
    first, other = first[anew[first]], other[anew[first]]
    n.quads[node[first], 1], n.n_quad_at[node[first]] = row[other], 2
    for k in np.flatnonzero(sliver & near).tolist():
        _find_film_around(state, k)
    mass = 1.0 / (f.weight[: f.count] ** 2 / n.mass[f.nodes[: f.count]]).sum(axis=1)
    n.contact_mass[node] = mass
    n.contact_area[node] = 0.25 * areas[row]
    _share_springs(state, node, density)


def _find_film_around(state: State, k: int) -> None:
    """Give a flank point on a sliver the film around it that lies on its side of the flank.

    The nodes of a sliver swing, so that it does not show on which side of the blade the film lies.
    Close to its tip a crack is closed, and the film of both flanks is connected: which rows lie
    on which side of the flank is decided in the reference film.
    """
    f, n, quad = state.flank, state.node, state.quad
    masters = f.nodes[k][f.weight[k] > UNUSED]
    at = np.arange(n.quads.shape[1]) < n.n_quad_at[masters, None]
    rows = np.unique(np.append(n.quads[masters][at], f.row[k]))
    nodes = f.nodes[k]
    X = n.X[nodes]
    here = product(f.weight[k], X)
    along = product(shape_functions(f.inward[k, 0], f.inward[k, 1]), X) - here
    across = np.cross(corner_normals(X), along)
    centres = (quad.centre[rows, :, None] * n.X[state.quads[rows]]).sum(axis=1) - here
    beside = product(centres, across)
    beside *= np.sign(beside[np.searchsorted(rows, f.row[k])])
    rows = np.append(f.row[k], rows[(beside > 0.0) & (rows != f.row[k])])[: n.quads.shape[1]]
    n.quads[f.node[k], : rows.size], n.n_quad_at[f.node[k]] = rows, rows.size


def bearable_area(mass: Floats, density: float) -> Floats:
    """Return the contact area that a node may carry [mm²]: half its mass over rho h.

    That of a node at a crack along edges is as large: a quarter of its quads' area, and half their
    mass. mass : [t].  density : rho h [t/mm²].
    """
    return np.asarray(0.5 * mass / density)


def _share_springs(state: State, node: Ints, density: float) -> None:
    """Write which part of its contact area presses at each flank point and at their nodes.

    Several springs act on a node where flank points are near it, and light nodes bear little. An
    area A_P at a flank point counts N_a A_P at node a (:func:`hand_on_stiffness`). Where they and
    the node's own come to more than it bears, all of them press by so much less.

    node : (n_point,), of the flank points.
    """
    f, n = state.flank, state.node
    nodes, weight = f.nodes[: f.count], f.weight[: f.count]
    masters = np.unique(nodes)
    bears = bearable_area(n.mass[: n.count], density)
    own = np.where(n.real[: n.count], np.minimum(n.contact_area[: n.count], bears), 0.0)
    felt = bearable_area(0.5 * n.contact_mass[node], density)  # it swings as a whole node does
    area = np.where(n.real[node], np.minimum(n.contact_area[node], felt), 0.0)
    carried = own + np.bincount(nodes.ravel(), (weight * area[:, None]).ravel(), n.count)
    part = np.ones(n.count)
    over = masters[carried[masters] > bears[masters]]
    part[over] = bears[over] / carried[over]
    n.contact_share[masters] = own[masters] * part[masters] / n.contact_area[masters]
    least = np.where(weight > UNUSED, part[nodes], 1.0).min(axis=1)
    n.contact_share[node] = area * least / n.contact_area[node]


def hand_on_stiffness(state: State, nodes: Ints, stiffness: Floats) -> tuple[Ints, Floats]:
    """Return which nodes have what stiffness [N/mm], that of flank points being their copies'.

    A spring k at P stores ½ k (sum N_a u_a)² along its direction, at most ½ sum k N_a u_a²: the N_a
    weigh a mean (Jensen). So it is no stiffer than springs k N_a at its nodes, and those of several
    points add up.
    """
    f = state.flank
    of = np.full(state.n_node, -1)
    of[f.node[: f.count]] = np.arange(f.count)
    point = of[nodes]
    tied = point >= 0
    masters, weights = f.nodes[point[tied]], f.weight[point[tied]]
    felt = stiffness[tied, None] * weights
    return (
        np.concatenate([nodes[~tied], masters.ravel()]),
        np.concatenate([stiffness[~tied], felt.ravel()]),
    )


@kernel
def _interpolate(tied: _Tied, x: Floats, velocity: Floats) -> None:
    """Write x and velocity : (n_node, 3) of all flank points from those of their nodes."""
    tied = borrowed(tied)
    for k in range(tied.n):
        store(x, tied.node[k], mean_of(x, tied.nodes, tied.weight, k))
        store(velocity, tied.node[k], mean_of(velocity, tied.nodes, tied.weight, k))


@kernel
def _hand_on(tied: _Tied, rows: Floats) -> None:
    """Add the forces in rows : (n_node, 8) of all flank points to their nodes."""
    tied = borrowed(tied)
    for k in range(tied.n):
        for a in range(4):
            for c in range(3):
                rows[tied.nodes[k, a], c] += tied.weight[k, a] * rows[tied.node[k], c]
