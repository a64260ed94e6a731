"""Supports and prescribed motion, with their reactions.

A support fixes or prescribes components of the velocity, and of the director's spin, of some nodes;
a *clamped* node has both position and director supported ([Frangi2010] 5). The reaction is mass x
acceleration minus the nodal force, written by the kick.

A director has two rotations, a spin three components. So supporting spins about axes means, with T
the director of the reference:

=====================  ==========================  ==========================================
supported axes         the director                where T lies within 30° of
=====================  ==========================  ==========================================
three                  keeps its direction
two, f is left         turns about f, on a cone    f: keeps its direction, a turn about f
                       if it is not normal to f    would hardly move it
a single one, h        stays in the plane of h     h: is free, a spin about itself moves
                       and T                       it nowhere
=====================  ==========================  ==========================================

The explicit driver (:mod:`shellcut.central_difference`) and statics
(:mod:`shellcut.statics.freedoms`) both do exactly this. So a director that leans a little, as the
mean normal at an edge does, is supported like a director that does not. The limit is 30° because
the mean normals of a mesh lean by at most that (half the largest fold between two quads,
``max_fold_deg``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked, finite_at
from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.state import KnownTopology, State

_AXES = "xyz"

# A director within 30° of an axis counts as along it, see above.
_ALONG = math.cos(math.radians(30.0))
_NAMES = [f"{kind} along {axis}" for kind in ("velocity", "spin") for axis in _AXES]
Rate = Callable[[float], float]
NodeChoice: TypeAlias = Annotated[
    str | Sequence[int] | Ints, Option("", "which nodes", form="nodes")
]


@dataclass(frozen=True)
class Ramped:
    """A value that rises linearly from 0 over a time [s]; without one it is there at once."""

    value: float
    ramp: float = 0.0

    def __call__(self, time: float) -> float:
        """Return the value at a time [s]."""
        return self.value * min(max(time / self.ramp, 0.0), 1.0) if self.ramp > 0.0 else self.value


def choose_nodes(mesh: Mesh, nodes: NodeChoice) -> Ints:
    """Return node ids from the name of a set or from ids, checked."""
    if isinstance(nodes, str):
        return mesh.node_set(nodes)
    ids = np.asarray(nodes)
    if ids.ndim != 1 or ids.size == 0 or not np.issubdtype(ids.dtype, np.integer):
        raise ValueError(
            f"nodes must be the name of a node set or a list of node ids, got {nodes!r}"
        )
    if ids.min() < 0 or ids.max() >= mesh.n_node:
        bad = ids[(ids < 0) | (ids >= mesh.n_node)][:5].tolist()
        raise ValueError(f"node ids must lie in 0..{mesh.n_node - 1}, got {bad}")
    return ids.astype(np.int64)


@checked
@dataclass(frozen=True)
class Support:
    """Support components of the motion of a set of nodes: fixed, or moved as prescribed.

    With two axes of spin supported the director only turns about the third, whatever its direction.
    A director turns only about axes normal to it. ``velocity`` and ``spin`` map axes to functions
    of time.

    Examples
    --------
    >>> support = Support("left", translation="xyz", rotation="")  # hinged
    >>> pulled = Support("right", translation="x", rotation="", velocity={"x": lambda time: 10.0})
    """

    nodes: NodeChoice
    translation: Annotated[str, Option("", "supported axes of the position", form="axes")] = "xyz"
    rotation: Annotated[str, Option("", "supported axes of the director's spin", form="axes")] = (
        "xyz"
    )
    velocity: Annotated[
        Mapping[str, Rate], Option("mm/s", "along supported axes", form="rates", unset="at rest")
    ] = field(default_factory=dict)
    spin: Annotated[
        Mapping[str, Rate], Option("rad/s", "about supported axes", form="rates", unset="at rest")
    ] = field(default_factory=dict)

    def __post_init__(self) -> None:
        problems = []
        for name, moved in (("translation", "velocity"), ("rotation", "spin")):
            axes, rates = getattr(self, name), getattr(self, moved)
            if set(axes) - set(_AXES):
                problems.append(f"{name} must be made of the letters x, y, z, got {axes!r}")
            loose = set(rates) - set(axes)
            if loose:
                problems.append(
                    f"{moved} is prescribed along {sorted(loose)}, which {name} {axes!r} does not "
                    "support: add these axes to it"
                )
            problems += [
                f"{moved} along {axis} must be a function of time, got {rate!r}: for a constant "
                f"write lambda time: {rate!r}"
                for axis, rate in rates.items()
                if not callable(rate)
            ]
        if problems:
            raise ValueError("; ".join(problems))

    def held(self) -> list[int]:
        """Return the supported components, 0-2 of translation and 3-5 of rotation."""
        return [_AXES.index(a) for a in self.translation] + [
            3 + _AXES.index(a) for a in self.rotation
        ]

    def rates(self) -> dict[int, Rate]:
        """Return the prescribed rates by component."""
        moved = {_AXES.index(axis): rate for axis, rate in self.velocity.items()}
        return moved | {3 + _AXES.index(axis): rate for axis, rate in self.spin.items()}

    @classmethod
    def clamped(cls, nodes: NodeChoice) -> Support:
        """Fix position and director."""
        return cls(nodes)

    @classmethod
    def pinned(cls, nodes: NodeChoice) -> Support:
        """Fix the position, leave the director free."""
        return cls(nodes, rotation="")

    @classmethod
    def symmetry(cls, nodes: NodeChoice, normal: str) -> Support:
        """Keep nodes in the symmetry plane with the given normal axis, "x", "y" or "z".

        Their reference directors are moved into the plane, see
        :mod:`shellcut.loads.symmetry_plane`.
        """
        if normal not in tuple(_AXES):
            raise ValueError(f"normal must be one of x, y and z, got {normal!r}")
        return cls(nodes, translation=normal, rotation=_AXES.replace(normal, ""))

    @property
    def mirror(self) -> int | None:
        """Axis normal to the symmetry plane that this support represents, 0-2; else None.

        It supports exactly the components of :meth:`symmetry`, at rest.
        """
        if len(set(self.translation)) != 1 or self.velocity or self.spin:
            return None
        rest = set(_AXES) - set(self.translation)
        return _AXES.index(self.translation[0]) if set(self.rotation) == rest else None


class SupportSet:
    """All supports of a model, resolved to nodes.

    ValueError if a set is unknown, or two supports prescribe the same component differently.
    """

    def __init__(self, mesh: Mesh, supports: Sequence[Support]) -> None:
        self.directors, self._quads = mesh.directors, mesh.quads
        self._known = KnownTopology()
        self._now: list[Ints] = []
        self._moving: list[tuple[Ints, int, Rate]] = []
        self.nodes = [choose_nodes(mesh, s.nodes) for s in supports]
        self._supports = tuple(supports)
        moved: dict[tuple[int, int], Rate] = {}
        for k, (support, ids) in enumerate(zip(supports, self.nodes, strict=True)):
            for c, rate in support.rates().items():
                clash = [n for n in ids.tolist() if moved.setdefault((n, c), rate) is not rate]
                if clash:
                    raise ValueError(
                        f"two supports prescribe the {_NAMES[c]} of nodes {clash[:5]}: "
                        "keep one of them"
                    )
                self._moving.append((ids, c, finite_at(f"{_NAMES[c]} of supports[{k}]", rate)))
        # Nodes fixed by one support and moved along the same axis by another.
        for support, ids in zip(supports, self.nodes, strict=True):
            for c in set(support.held()) - set(support.rates()):
                clash = [n for n in ids.tolist() if (n, c) in moved]
                if clash:
                    raise ValueError(
                        f"one support fixes what another moves, the {_NAMES[c]} of nodes "
                        f"{clash[:5]}: take these nodes or this axis out of one of them"
                    )

    @property
    def moved(self) -> list[tuple[Ints, int, Rate]]:
        """Nodes, axis 0-2 and velocity [mm/s] over time of all positions that supports move."""
        return [entry for entry in self._moving if entry[1] < 3]

    def initialise(self, state: State) -> None:
        """Write the masks of supported components, which no longer follow the forces."""
        for support, ids in zip(self._supports, self.nodes, strict=True):
            for c in support.held():
                state.node.support[ids, c] = True
        self._settle_spins(state)
        state.node.supported[:] = state.node.support.any(axis=1)
        state.node.push[state.node.supported] = 0.0

    def _settle_spins(self, state: State) -> None:
        """Support all spins, or none, where the supported ones amount to that for the director."""
        supported = state.node.support[: len(self.directors), 3:]
        n_supported = supported.sum(axis=1)
        along = np.abs(self.directors) > _ALONG
        supported[(n_supported == 2) & (along & ~supported).any(axis=1)] = True
        idle = (n_supported == 1) & (along & supported).any(axis=1)
        for ids, c, _ in self._moving:
            if c >= 3:  # a prescribed spin is used as given
                idle[ids] = False
        supported[idle] = False

    def prescribe(self, state: State, dt: float, pace: float) -> None:
        """Write the prescribed velocities at t_{n+1/2}; time advances by pace dt in the step."""
        if not self._moving:
            return
        if not self._known.is_of(state):
            self._now = [self._with_supported_copies(state, ids) for ids, _, _ in self._moving]
            self._known.take(state)
        time_half = state.time + 0.5 * pace * dt
        for (_, c, rate), ids in zip(self._moving, self._now, strict=True):
            state.node.support_rate[ids, c] = pace * rate(time_half)

    def reaction(self, state: State, which: int) -> Floats:
        """Return the resultant reaction of one support [N], shape (3,)."""
        ids = self._with_supported_copies(state, self.nodes[which])
        return np.asarray(state.node.reaction[ids, :3].sum(axis=0))

    def _with_supported_copies(self, state: State, ids: Ints) -> Ints:
        """Return some nodes of the mesh with the supported ones that cuts have made of them.

        A cut across a supported border gives both flanks nodes with film there, which are supported
        as before; virtual nodes are not.
        """
        n_mesh, n, quad = len(self.directors), state.node, state.quad
        supported = n.supported[n_mesh : n.count] & n.real[n_mesh : n.count]
        copies = n_mesh + np.flatnonzero(supported)
        rows = n.quads[copies, 0]
        corner = np.argmax(quad.nodes[rows] == copies[:, None], axis=1)
        of = self._quads[quad.parent[rows], corner]
        return np.concatenate([ids, copies[np.isin(of, ids)]])
