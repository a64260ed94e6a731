"""Tables of nodes, quads, flank points and cables: an array a property, a row an entity.

A split or a new cable appends rows; rows are never renumbered. Arrays are allocated with spare rows
and doubled when full, so kernels receive them whole together with a count.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, NamedTuple, TypeAlias, TypeVar, get_type_hints

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallIds, SmallInts
from shellcut.numerics.jit import inline_or_plain
from shellcut.numerics.lanes import aligned_zeros

_Numbers = TypeVar("_Numbers", float, Floats)
_T = TypeVar("_T", bound="_Table")


def columns(rows: int, count: int) -> Floats:
    """Return zeros of shape (rows, count), stored column by column.

    Eight consecutive nodes of a column are one vector (:mod:`shellcut.numerics.lanes`).
    """
    return np.asarray(aligned_zeros((count, rows)).T)


@inline_or_plain
def local_edge_length(contact_area: _Numbers) -> _Numbers:
    """Return the edge length of the quads at nodes of this contact area [mm]."""
    length: _Numbers = np.sqrt(4.0 * contact_area)
    return length


RESERVE = 256
"""Rows allocated ahead: a split adds a node, and most runs never need another allocation."""

STRAIGHT, JOINTED, BROKEN = 0, 1, 2

NOT_MET = -1
"""Cutting-edge segment of a cable that no edge has met."""


NOTCH = "notch"
"""Kind of the cuts that made a notch before the run."""

PUNCTURE = "puncture"
"""Kind of a cut that begins where a tool pierces the face of whole film."""

TEAR = "tear"
"""Kind of the cuts by a crack that no blade drives."""


Columns: TypeAlias = Annotated[Floats, "by column"]
"""Read by lanes in kernels, of :func:`columns`."""

_DTYPES = {Floats: float, Ints: np.int64, SmallIds: np.int32, SmallInts: np.int8, Bools: bool}


@dataclass
class _Table:
    """Arrays with one row per entity, the first ``count`` of them in use.

    The annotation of an array says the shape of a row, if that is not a single number.
    """

    count: int
    _arrays: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def _names(cls) -> tuple[str, ...]:
        """Return the names of the arrays: all fields but the count."""
        if not cls._arrays:
            cls._arrays = tuple(f.name for f in fields(cls) if f.name != "count")
        return cls._arrays

    @classmethod
    def blank(cls: type[_T], count: int, rows: int, **given: Any) -> _T:
        """Return a table of zeros with some rows, the first ``count`` in use, but the given arrays.

        A given number is put into all rows, an array into the first ones.
        """
        kinds = get_type_hints(cls, include_extras=True)
        arrays = {}
        for name in cls._names():
            kind = kinds[name]
            said = getattr(kind, "__metadata__", ())
            shape = (rows, *(said[-1] if said else ()))
            if "by column" in said:
                array = columns(*shape)
            else:
                array = aligned_zeros(shape, _DTYPES[kind.__origin__ if said else kind])
            some = given.get(name, 0)
            array[: len(some) if np.ndim(some) else rows] = some
            arrays[name] = array
        return cls(count=count, **arrays)

    def reserve(self, extra: int) -> None:
        """Make room for ``extra`` more rows, doubling the arrays if necessary."""
        arrays = self._names()
        capacity = getattr(self, arrays[0]).shape[0]
        if self.count + extra <= capacity:
            return
        for name in arrays:
            old = getattr(self, name)
            shape = (max(2 * capacity, self.count + extra), *old.shape[1:])
            # Arrays read by lanes in kernels stay stored column by column. They have rows ahead:
            # a single row, which NumPy takes for both, is stored as a row.
            by_column = old.flags.fnc
            grown = columns(*shape) if by_column else aligned_zeros(shape, old.dtype)
            grown[: self.count] = old[: self.count]
            setattr(self, name, grown)

    def append_copy(self, row: int) -> int:
        """Append a copy of ``row`` and return its id."""
        self.reserve(1)
        new = self.count
        for name in self._names():
            array = getattr(self, name)
            array[new] = array[row]
        self.count += 1
        return new

    def append_blank(self, n: int = 1) -> int:
        """Append rows of zeros and return the id of the first."""
        self.reserve(n)
        first, self.count = self.count, self.count + n
        for name in self._names():
            getattr(self, name)[first : self.count] = 0
        return first

    def saved(self) -> dict[str, Any]:
        """Return the rows in use of every array, by name."""
        return {name: getattr(self, name)[: self.count] for name in self._names()}

    def restore(self, saved: dict[str, Any]) -> None:
        """Load the rows of :meth:`saved`, at least as many entities as there are now."""
        count = len(next(iter(saved.values())))
        self.reserve(count - self.count)
        self.count = count
        for name, rows in saved.items():
            array = getattr(self, name)
            if name == "quads" and rows.ndim == 2 and rows.shape[1] > array.shape[1]:
                # Copies of cut quads have made more quads at a node than the mesh has.
                array = np.zeros((len(array), rows.shape[1]), array.dtype)
                setattr(self, name, array)
            if rows.shape != (count, *array.shape[1:]):
                raise ValueError(
                    f"{name} must have shape {(count, *array.shape[1:])}, got {rows.shape}"
                )
            array[:count] = rows


class QuadsAtNodes(NamedTuple):
    """Which quads are at which node, as kernels take it; good for one topology."""

    quads: Annotated[Ints, "(n_quad, 4)"]
    """Node ids of every quad."""
    centre: Annotated[Floats, "(n_quad, 4)"]
    """Weights of these at the centre of the film that it carries."""
    share: Annotated[Floats, "(n_quad,)"]
    """Part of a quad of the mesh that it carries."""
    at: Annotated[Ints, "(n_node, max_valence)"]
    """Quads at the node, the first ``n_at`` in use; of a flank point those that show its side."""
    n_at: Annotated[Ints, "(n_node,)"]
    """Number of quads at the node."""


class KernelNodes(NamedTuple):
    """Fields of the nodes that kernels of force terms need, named as in :class:`NodeTable`."""

    x: Annotated[Floats, "(n_node, 3)"]
    velocity_half: Annotated[Floats, "(n_node, 3)"]
    contact_area: Annotated[Floats, "(n_node,)"]
    contact_share: Annotated[Floats, "(n_node,)"]
    contact_mass: Annotated[Floats, "(n_node,)"]
    push: Annotated[Floats, "(n_node, 2)"]
    supported: Annotated[Bools, "(n_node,)"]
    contact_side: Annotated[SmallInts, "(n_node,)"]
    """Of the blade, of each node: kernels write this and the force."""
    force: Annotated[Floats, "(n_node, 3)"]

    @classmethod
    def of(cls, nodes: NodeTable) -> KernelNodes:
        """Return those of a table, good until the next split."""
        return cls(*(getattr(nodes, name) for name in cls._fields))


@dataclass
class NodeTable(_Table):
    """Nodes; positions at t_n, velocities at t_{n+1/2} (see :mod:`shellcut.central_difference`)."""

    X: Annotated[Columns, (3,)]
    """Reference position [mm]."""
    x: Annotated[Columns, (3,)]
    """Position [mm]."""
    t: Annotated[Columns, (3,)]
    """Unit director."""
    velocity_half: Annotated[Columns, (3,)]
    """Velocity [mm/s]."""
    spin_half: Annotated[Columns, (3,)]
    """Angular velocity of the director [rad/s], normal to it."""
    force_rows: Annotated[Floats, (8,)]
    """Total nodal force [N], force conjugate to the director [N·mm], and two padding numbers that
    fill the cache line."""
    mass: Floats
    """Lumped mass [t]."""
    inertia: Floats
    """Scaled rotary inertia [t·mm²]."""
    push: Annotated[Columns, (2,)]
    """1 / mass and 1 / inertia, zero at supported nodes, which move separately."""
    contact_mass: Floats
    """Mass that a contact force moves: its own, or what it feels of a copy [t]."""
    contact_area: Floats
    """Area of the contact penalty [mm²], ¼ of the mean area of the node's quads."""
    contact_share: Floats
    """Part of that area that presses: less than one where what it feels is light."""
    origin: Ints
    """Reference node this one was split from, itself if never split."""
    halved: Bools
    """Whether the node is one half of a split or pre-cut node."""
    real: Bools
    """Whether the film reaches the node: not that of a copy beyond a crack, a phantom node. Points
    on flanks are rows here too, without mass: a force on one goes on to the nodes of its copy."""
    quads: Annotated[SmallIds, (1,)]
    """Quads at the node, ascending, the first ``n_quad_at`` in use; as many columns as the most."""
    n_quad_at: SmallIds
    """Number of quads at the node."""
    supported: Bools
    """Whether any component is prescribed."""
    support: Annotated[Bools, (6,)]
    """Prescribed components, three of velocity and three of spin."""
    support_rate: Annotated[Floats, (6,)]
    """Their prescribed values [mm/s, rad/s] at t_{n+1/2}."""
    reaction: Annotated[Floats, (6,)]
    """Reaction force and moment at t_n [N, N·mm]."""
    load_force: Annotated[Floats, (3,)]
    """Following load on the node at the last evaluation [N]."""
    contact_side: SmallInts
    """Side of the blade on which the node lies: +1, -1, or 0 while unknown."""
    contact_depth: Floats
    """Penetration at the last search [mm], 0 outside."""
    contact_offset: Floats
    """Part of the penetration that does not press [mm]."""
    contact_place: Annotated[Floats, (3,)]
    """Place in the tool's frame where the offset arose [mm]."""
    contact_work: Floats
    """Work put into the contact of the node since it began [N·mm]."""
    contact_force: Annotated[Floats, (3,)]
    """Contact force on the node [N]."""
    friction_spring: Annotated[Floats, (3,)]
    """Elongation of the spring of friction, in the tool's frame [mm]."""
    friction_force: Annotated[Floats, (3,)]
    """Friction on the node [N]."""

    @property
    def force(self) -> Floats:
        """Total nodal force [N], shape (n, 3)."""
        return self.force_rows[:, 0:3]

    @property
    def director_force(self) -> Floats:
        """Total force conjugate to the director [N·mm], shape (n, 3); its moment is t x this."""
        return self.force_rows[:, 3:6]

    def take_quads(self, node: int, quads: list[int]) -> None:
        """Set the quads at a node, ascending; copies of cut quads may be more than any mesh has."""
        more = len(quads) - self.quads.shape[1]
        if more > 0:
            self.quads = np.pad(self.quads, ((0, 0), (0, max(more, self.quads.shape[1]))))
        self.quads[node, : len(quads)] = quads
        self.n_quad_at[node] = len(quads)

    def stop(self) -> None:
        """Set all velocities to zero that are not prescribed."""
        for c, rates in enumerate((self.velocity_half, self.spin_half)):
            rates[: self.count][~self.support[: self.count, 3 * c : 3 * c + 3]] = 0.0

    def weigh(self, node: int, mass: float, inertia: float) -> None:
        """Set the mass [t] and rotary inertia [t·mm²] of a node."""
        self.mass[node], self.inertia[node] = mass, inertia
        self.contact_mass[node] = mass
        self.push[node] = (0.0, 0.0) if self.supported[node] else (1.0 / mass, 1.0 / inertia)


@dataclass
class QuadTable(_Table):
    """Quads: those of the mesh, and after them the copies that cracks across them have made."""

    nodes: Annotated[SmallIds, (4,)]
    """Node ids."""
    parent: Ints
    """Quad of the mesh, itself for the first ones."""
    share: Floats
    """Part of the parent that it carries, 1 of a whole quad."""
    mass_share: Floats
    """Part of the parent's mass that it has, shape (n,); see :mod:`shellcut.fracture.cut_state`."""
    centre: Annotated[Floats, (4,)]
    """Weights of its nodes at the centre of the film that it carries, of a sliver farther from its
    flank than that."""


@dataclass
class FlankTable(_Table):
    """Points on the flanks of cracks that cross quads: nodes that are tied to a copy.

    Such a point has a row among the nodes, so that cables and contact take it as any node; but it
    has no mass. Its position and velocity are those of the copy there, and the copy's nodes take
    its force (:mod:`shellcut.fracture.flank_points`).
    """

    node: Ints
    """Row among the nodes."""
    row: Ints
    """Copy that it is tied to."""
    place: Annotated[Floats, (2,)]
    """xi, eta in the quad."""
    inward: Annotated[Floats, (2,)]
    """A place a little further along its flank, which tells to which part of a copy it belongs when
    that is cut again."""
    twin: Ints
    """The point across the crack: contact sees the two once they have parted. Itself for one that
    contact never sees."""
    nodes: Annotated[Ints, (4,)]
    """Nodes of the copy."""
    weight: Annotated[Floats, (4,)]
    """Their shape functions there."""


@dataclass
class CableTable(_Table):
    """Cohesive cables ([Frangi2010] 4): fibres across the segments of cracks, several each.

    The end of one lies between two nodes or flank points, at (1 - share) x_ends + share x_far
    (:mod:`shellcut.fracture.segment_cables`).
    """

    ends: Annotated[Ints, (2,)]
    """Node on the minus and on the plus flank where its segment starts."""
    far: Annotated[Ints, (2,)]
    """Those where it stops."""
    share: Floats
    """How far along the segment it is, as a fraction of it."""
    status: SmallInts
    """STRAIGHT, JOINTED or BROKEN."""
    area: Floats
    """Cohesive area A_i = thickness x length [mm²]."""
    length: Floats
    """Reference length of the crack that it bridges [mm]."""
    row: Annotated[Ints, (2,)]
    """Quad or copy on either flank."""
    chord: Annotated[Floats, (2, 2, 2)]
    """Where the segment starts and stops, xi and eta in the quad of each."""
    m: Annotated[Floats, (3,)]
    """Mean normal to the flanks at birth, from minus to plus."""
    start_force: Annotated[Floats, (3,)]
    """Equilibrium-start force on the minus node at zero opening [N]."""
    opening: Floats
    """Length measure of the law at the last evaluation [mm]."""
    opening_max: Floats
    """Its largest value so far [mm]."""
    traction: Floats
    """Cable stress [MPa]."""
    edge: Ints
    """Cutting-edge segment of the joint, ``NOT_MET`` before there is a joint."""
    joint_body: Annotated[Floats, (3,)]
    """Joint in the body frame of the tool [mm]."""
    joint: Annotated[Floats, (3,)]
    """Joint in space at the last evaluation [mm]."""
    joint_slack: Floats
    """Length that the bend added when the joint was made, not counted as opening."""
    grip: Floats
    """Friction of the cable around the edge: the minus branch carries 1 + this times the stress,
    the plus branch 1 - this."""
    arc_grip: Floats
    """Friction of what is drawn out over a round edge: both carry this more."""
    transport: Floats
    """Half the difference of the branches at the last evaluation, minus less plus: what has moved
    around the edge, where the joint slips [mm]."""
    overshoot: Floats
    """How far the edge had passed the cable when the joint was made [mm]."""
    branch: Annotated[Floats, (2, 3)]
    """Unit vectors from the minus and plus node towards their partner."""
    force: Annotated[Floats, (2, 3)]
    """Force on the minus and on the plus node [N]."""
    work: Floats
    """Work done on the cable so far [N·mm]."""
    start_work: Floats
    """Work done on the equilibrium-start force so far [N·mm]."""
    shed: Floats
    """What was dissipated as the edge met it, above its law from then on [N/mm]."""
    birth: Floats
    """Time of birth [s]."""
    end_time: Floats
    """Time at which it broke [s], zero while it lives."""

    def at_ends(self, rows: Floats) -> Floats:
        """Return rows : (n_node, k) of the nodes at the ends of all cables, (n_cable, 2, k)."""
        ends, far, share = (a[: self.count] for a in (self.ends, self.far, self.share))
        return np.asarray(rows[ends] + share[:, None, None] * (rows[far] - rows[ends]))
