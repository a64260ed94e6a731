"""Glue between a film and a rigid base: it holds, peels and lets go by a cohesive law.

Glue points are the nodes of the glued quads. Each has the area A of the corners of quads that meet
there, a place X_P on the base, where the node lies at t_0, and a normal n of the base, towards the
film. With u = x - X_P, u_n = u · n and u_t = u - u_n n,

    (1)  d = sqrt(<u_n>² + b² |u_t|²),   m the largest d so far
    (2)  D = d_f (m - d_0) / (m (d_f - d_0)),   d_0 = s/K,   d_f = 2 tau/s
    (3)  p = -(1 - D) K (<u_n> n + b² u_t) + K <-u_n> n,    on the film, per area

with the energy tau [N/mm], the strength s [MPa] and the stiffness K [MPa/mm] of the glue and the
weight b of shear; <a> is a where it is positive, else 0. Stored are ½ (1 - D) K d² + ½ K <-u_n>²
per area, dissipated tau (m - d_0) / (d_f - d_0), from 0 to tau. Unloading follows the secant. Where
all is dissipated, the base still bears film that presses on it.

A crack that parts a node, or the corners around it, divides its area among the duplicates; each
keeps the history. Nodes of a copy of a cut quad that lie beyond the crack have no film, so no glue.
docs/theory/adhesion.md derives which strength a mesh resolves, and compares with closed forms.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, NodeStiffness, StiffnessBy, norm, three, unit
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.quad_geometry import corner_vectors, edge_lengths
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.vec3 import add_scaled, dot, load, scale, store, sub
from shellcut.state import KnownTopology, State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose
from shellcut.tool.touch import Booking, Touch

from .supports import choose_nodes

ZONE_SIDES = 1.5
"""Sides of quads that the process zone of the glue must have, and the radius of the fold."""

# Stiffness over s²/tau: d_f is 20 times d_0.
_STIFFNESS = 10.0

_WORK, _STORED, _DISSIPATED = range(3)
"""Columns of ``touch.sums``."""


class GlueLaw(NamedTuple):
    """The law of a glue."""

    energy: float
    """tau [N/mm]."""
    strength: float
    """s [MPa]."""
    stiffness: float
    """K [MPa/mm]."""
    shear: float
    """b."""

    @property
    def first(self) -> float:
        """d_0, where the strength is reached [mm]."""
        return self.strength / self.stiffness

    @property
    def last(self) -> float:
        """d_f, where the glue has let go [mm]."""
        return 2.0 * self.energy / self.strength


@checked
@dataclass(frozen=True)
class Adhesion:
    """Film glued to a rigid base where it lies at first; an entry of ``Simulation(terms=...)``.

    ValueError is raised for a law that is none: a stiffness so small that the glue would reach its
    strength only where it has let go.

    Examples
    --------
    >>> seal = Adhesion("seal", energy=0.05)
    >>> seal.law(ShellMaterial.homogeneous(), side=0.5).strength.__round__(3)
    0.344
    """

    nodes: Annotated[
        str | Sequence[int] | Ints | None,
        Option("", "all quads between them are glued", form="nodes", unset="quads are given"),
    ] = None
    quads: Annotated[
        str | Sequence[int] | Ints | None,
        Option("", "that are glued", form="quads", unset="those between the nodes"),
    ] = None
    normal: Annotated[
        Sequence[float] | None,
        Option("", "of the base, towards the film", form="3 numbers", unset="the film's directors"),
    ] = None
    energy: Annotated[float, Option("N/mm", "that it takes to peel, over area", above=0)] = 0.1
    strength: Annotated[
        float | None,
        Option("MPa", "of the glue", above=0, unset="the largest that the mesh resolves"),
    ] = None
    stiffness: Annotated[
        float | None,
        Option("MPa/mm", "of glue and base", above=0, unset="10 strength² / energy"),
    ] = None
    shear: Annotated[float, Option("", "weight of sliding beside opening in the law", least=0)] = (
        1.0
    )
    name: Annotated[str, Option("", "of this glue, if there are several", form="stem")] = "adhesion"

    def law(self, material: ShellMaterial, side: float) -> GlueLaw:
        """Return the law of this glue below a film with quads of that longest side [mm].

        Without a strength it is that at which the process zone has 1.5 sides,
        s = sqrt(E' tau) h^1.5 / (1.5 side)², with E' h³/12 the bending stiffness.
        """
        bending = float(material.bending_stiffness[0, 0])
        strength = self.strength or sqrt(12.0 * bending * self.energy) / (ZONE_SIDES * side) ** 2
        stiffness = self.stiffness or _STIFFNESS * strength**2 / self.energy
        law = GlueLaw(self.energy, strength, stiffness, self.shear)
        if not law.first < law.last:
            raise ValueError(
                f"the stiffness of {self.name} must be above strength² / (2 energy), "
                f"{strength**2 / (2.0 * self.energy):.4g} MPa/mm, got {stiffness:.4g} MPa/mm"
            )
        return law

    def glued_quads(self, mesh: Mesh) -> Ints:
        """Return the quads that are glued; ValueError if there are none."""
        if (self.nodes is None) == (self.quads is None):
            raise ValueError(f"{self.name} needs nodes or quads, one of them")
        if self.nodes is not None:
            chosen = np.zeros(mesh.n_node, np.bool_)
            chosen[choose_nodes(mesh, self.nodes)] = True
            found = np.flatnonzero(chosen[mesh.quads].all(axis=1))
            if not found.size:
                raise ValueError(
                    f"{self.name} must glue quads, and no quad has all its nodes in "
                    f"{self.nodes!r}: choose a set that is a quad wide, or quads"
                )
            return found
        assert self.quads is not None
        return mesh.quad_set(self.quads) if isinstance(self.quads, str) else _ids(self, mesh)

    def for_film(
        self, mesh: Mesh, material: ShellMaterial, _part_of: Callable[[int], Any]
    ) -> ForceTerm:
        """Return the glue points of a film."""
        quads = np.unique(self.glued_quads(mesh))
        side = float(edge_lengths(mesh.nodes, mesh.quads[quads]).max())
        normal = None if self.normal is None else unit(three("normal", self.normal))
        if normal is not None and not normal.any():
            raise ValueError(f"the normal of {self.name} must have a direction, got {self.normal}")
        law, bending = self.law(material, side), float(material.bending_stiffness[0, 0])
        return GluePoints(self.name, law, side, bending, mesh, quads, normal)


def _ids(glue: Adhesion, mesh: Mesh) -> Ints:
    ids = np.asarray(glue.quads)
    if ids.ndim != 1 or not ids.size or ids.dtype.kind not in "iu":
        raise ValueError(f"quads of {glue.name} must be the name of a set or ids, got {glue.quads}")
    if ids.min() < 0 or ids.max() >= mesh.n_quad:
        raise ValueError(f"quads of {glue.name} must lie in 0..{mesh.n_quad - 1}, got {glue.quads}")
    return np.unique(ids).astype(np.int64)


class Points(NamedTuple):
    """Glue points as the kernel takes them."""

    node: Annotated[Ints, "(n,)"]
    """Where each is, ascending."""
    area: Annotated[Floats, "(n,)"]
    """A [mm²]."""
    base: Annotated[Floats, "(n, 3)"]
    """X_P [mm]."""
    normal: Annotated[Floats, "(n, 3)"]
    """n."""
    largest: Annotated[Floats, "(n,)"]
    """m [mm], written."""
    parted: Annotated[Floats, "(n, 3)"]
    """u at t_{n-1}, replaced by that at t_n [mm]."""
    traction: Annotated[Floats, "(n, 3)"]
    """p at t_{n-1}, replaced by that at t_n [MPa]."""


_KEPT = "base", "largest", "parted", "traction"
"""Columns of the points in a checkpoint."""


class GluePoints(ForceTerm):
    """The glue points of a film.

    Parameters
    ----------
    name : str
    law : GlueLaw
    side : float
        The longest of the glued quads [mm].
    bending : float
        Stiffness of the film [N·mm].
    mesh : Mesh
    quads : ndarray of int, shape (n,)
        That are glued, ascending.
    normal : ndarray, shape (3,), optional
        Of the base; the directors by default.
    """

    booked = (
        Booking("adhesion_work", _WORK, -1.0),
        Booking("adhesion_dissipated", _DISSIPATED),
    )
    """What the energy balance gets from the sums."""

    def __init__(
        self,
        name: str,
        law: GlueLaw,
        side: float,
        bending: float,
        mesh: Mesh,
        quads: Ints,
        normal: Floats | None,
    ) -> None:
        self.name, self.law, self.quads, self.side = name, law, quads, side
        self.zone = sqrt(sqrt(12.0 * bending * law.energy) / law.strength)
        """Length over which it lets go where it peels [mm]."""
        self.fold = sqrt(0.5 * bending / law.energy)
        """Radius with which the film bends there [mm]."""
        self.touch = Touch.none(0, 3)
        X, corners = mesh.nodes, mesh.quads[quads].astype(np.int64)
        sides = (corner_vectors(X, corners, a) for a in range(4))
        self._area = np.stack([0.25 * norm(np.cross(p, q)) for p, q in sides], axis=1)
        """Of each corner of the glued quads, shape (n_quad, 4) [mm²]."""
        self._row = np.repeat(quads[:, None], 4, axis=1)
        """Row of each corner, the copy that has its film."""
        node, self._point = _merged(corners)
        """Glue point of each corner."""
        n = node.size
        self.points = Points(
            node=node,
            area=self._areas(n),
            base=X[node].copy(),
            normal=mesh.directors[node].copy() if normal is None else np.tile(normal, (n, 1)),
            largest=np.zeros(n),
            parted=np.zeros((n, 3)),
            traction=np.zeros((n, 3)),
        )
        self._known = KnownTopology()
        self._call = BoundOnce(add_glue)

    def begin(self, state: State) -> None:
        """Take the base to be where the film lies now; nothing is damaged."""
        p = self.points
        p.base[:] = state.node.x[p.node]
        for column in (p.largest, p.parted, p.traction):
            column[:] = 0.0

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the forces at t_n."""
        self._follow_cuts(state)
        n = state.node
        self._call(self.points, self.law, n.x, n.force_rows, self.touch.sums)

    def _follow_cuts(self, state: State) -> None:
        """Find the node that has the film of each corner; points that part keep the history."""
        if self._known.is_of(state):
            return
        parent = state.quad.parent[: state.n_quad]
        rows = np.flatnonzero(np.isin(parent, self.quads))
        nodes = state.quads[rows].astype(np.int64)
        copy, corner = np.nonzero(state.node.real[nodes])
        place = np.searchsorted(self.quads, parent[rows[copy]]), corner
        found = self.points.node[self._point]
        found[place], self._row[place] = nodes[copy, corner], rows[copy]
        node, point = _merged(found)
        before = np.zeros(node.size, np.int64)
        before[point], self._point = self._point, point
        kept = {name: column[before] for name, column in self.points._asdict().items()}
        self.points = Points(**{**kept, "node": node, "area": self._areas(node.size)})
        self._known.take(state)

    def _areas(self, n: int) -> Floats:
        """Return the area of each of the n points [mm²]."""
        areas: Floats = np.bincount(self._point.ravel(), self._area.ravel(), n).astype(float)
        return areas

    @property
    def resolved(self) -> float:
        """The zone over the shortest that the quads resolve; 1 or more is enough."""
        return (1.0 + 1e-9) * self.zone / (ZONE_SIDES * self.side)

    @property
    def damage(self) -> Floats:
        """Share of its energy that each point has dissipated, shape (n,)."""
        first, last = self.law.first, self.law.last
        return np.asarray(np.clip((self.points.largest - first) / (last - first), 0.0, 1.0))

    def stiffness(self, state: State, _counted: StiffnessBy) -> NodeStiffness:
        """Return the glued nodes and the stiffness of glue and base on each [N/mm]."""
        self._follow_cuts(state)
        steepest = self.law.stiffness * max(1.0, self.law.shear**2)
        return self.points.node, steepest * self.points.area

    def stored(self, _state: State) -> Mapping[str, float]:
        """Return the energy that it would give back [N·mm]."""
        return {"adhesion_stored": float(self.touch.sums[_STORED])}

    def fixed_nodes(self, _state: State) -> Ints:
        """Return the nodes where it has not let go."""
        return self.points.node[self.points.largest < self.law.last]

    def add_corner_forces(self, state: State, rows: Ints, nodes: Ints, force: Floats) -> None:
        """Add its force on a node from a single row, at the present positions [N].

        rows, nodes : (n,), row and one of its nodes.  force : (n, 3), added to.
        """
        mine = np.flatnonzero(np.isin(self._row, rows))
        if not mine.size:
            return
        row, area = self._row.ravel()[mine], self._area.ravel()[mine]
        some, point = _merged(self._point.ravel()[mine])
        # Copies of the points, each with its own node: nothing is written to the points.
        own = {name: column[some] for name, column in self.points._asdict().items()}
        node, n = own["node"], some.size
        own |= {"node": np.arange(n), "area": np.ones(n)}
        traction = np.zeros((n, 8))
        x = np.asfortranarray(state.node.x[node])
        self._call(Points(**own), self.law, x, traction, np.zeros(3))
        asked, corner = np.nonzero((row == rows[:, None]) & (node[point] == nodes[:, None]))
        np.add.at(force, asked, area[corner, None] * traction[point[corner], :3])

    def by_row(self, state: State) -> dict[str, Floats]:
        """Return the damage of each row, shape (n_row,): 0 where it holds or is not glued."""
        n, row = state.n_quad, self._row.ravel()
        damage = np.bincount(row, self.damage[self._point.ravel()], n)
        return {self.name: damage / np.maximum(np.bincount(row, minlength=n), 1)}

    def summary(self) -> Mapping[str, float]:
        """Return which shares of the glued area are damaged and have let go, and the largest lift.

        The lift is that of glue that has not let go.
        """
        p, damage = self.points, self.damage
        lift = np.einsum("nc,nc->n", p.parted, p.normal)[damage < 1.0].max(initial=0.0)
        damaged, gone = (
            p.area[some].sum() / p.area.sum() for some in (damage > 0.0, damage >= 1.0)
        )
        return {
            f"{self.name}_damaged_rel": float(damaged),
            f"{self.name}_let_go_rel": float(gone),
            f"{self.name}_lift_mm": float(lift),
            f"{self.name}_resolved_rel": self.resolved,
        }

    def saved(self) -> dict[str, Any]:
        """Return base and history, and work and forces of the last step."""
        return {"sums": self.touch.sums, **{name: getattr(self.points, name) for name in _KEPT}}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self._follow_cuts(state)
        self.touch.sums[:] = saved["sums"]
        for name in _KEPT:
            getattr(self.points, name)[:] = saved[name]


def _merged(nodes: Ints) -> tuple[Ints, Ints]:
    """Return which there are, ascending, and the place of each among them, shaped as ``nodes``."""
    found, place = np.unique(nodes, return_inverse=True)
    return found, place.reshape(nodes.shape)


@kernel
def add_glue(points: Points, law: GlueLaw, x: Floats, force: Floats, sums: Floats) -> None:
    """Add the forces of the glue to force : (n_node, 3 or more), and write the sums.

    sums : (3,), work on the film since t_{n-1}, energy stored at t_n, and dissipated since [N·mm].
    """
    node, area, base, normal, largest, parted, traction = points
    energy, strength, stiffness, shear = law
    first, last = strength / stiffness, 2.0 * energy / strength
    b2 = shear * shear
    work, stored, dissipated = 0.0, 0.0, 0.0
    for i in range(node.shape[0]):
        u = sub(load(x, node[i]), load(base, i))
        n = load(normal, i)
        u_n = dot(u, n)
        u_t = add_scaled(u, -u_n, n)
        opens, pressed = max(u_n, 0.0), max(-u_n, 0.0)
        d = sqrt(opens * opens + b2 * dot(u_t, u_t))  # (1)
        before, m = largest[i], max(largest[i], d)
        largest[i] = m
        k = stiffness  # (1 - D) K, by (2)
        if m >= last:
            k = 0.0
        elif m > first:
            k = stiffness * first * (last - m) / (m * (last - first))
        p = add_scaled(scale(stiffness * pressed - k * opens, n), -k * b2, u_t)  # (3)
        # Dissipated grows linearly in m from d_0 to d_f, and not beyond.
        spent = min(max(m, first), last) - min(max(before, first), last)
        dissipated += area[i] * energy * spent / (last - first)
        stored += 0.5 * area[i] * (k * d * d + stiffness * pressed * pressed)
        # ½ (p_{n-1} + p_n) · Δu, as all works of the energy balance.
        moved, mean = sub(u, load(parted, i)), add_scaled(load(traction, i), 1.0, p)
        work += 0.5 * area[i] * dot(mean, moved)
        store(parted, i, u)
        store(traction, i, p)
        for c in range(3):
            force[node[i], c] += area[i] * p[c]
    sums[0], sums[1], sums[2] = work, stored, dissipated
