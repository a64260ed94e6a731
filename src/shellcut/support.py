"""Supports and prescribed motion, with their reactions.

A support holds components of the velocity, and of the spin of the director, of some nodes; a
*clamped* node holds position and director both ([Frangi2010] 5). What holds them, the reaction, is
mass x acceleration minus the nodal force, written by the kick.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ._jit import Floats, Ints
from .mesh import Mesh
from .state import State

_AXES = "xyz"
NodeChoice = str | Sequence[int] | Ints


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


@dataclass(frozen=True)
class Support:
    """Hold components of the motion of a set of nodes.

    Parameters
    ----------
    nodes : str or sequence of int
        Node set or ids.
    translation, rotation : str
        Held axes, a subset of "xyz", of the position and of the director's spin.
    velocity : mapping from axis to function of time, optional
        Prescribed velocity [mm/s] along held axes; held at rest otherwise.
    """

    nodes: NodeChoice
    translation: str = "xyz"
    rotation: str = "xyz"
    velocity: Mapping[str, Callable[[float], float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        problems = [
            f"{name} must be made of the letters x, y, z, got {axes!r}"
            for name, axes in (("translation", self.translation), ("rotation", self.rotation))
            if set(axes) - set(_AXES)
        ]
        loose = set(self.velocity) - set(self.translation)
        if loose:
            problems.append(
                f"velocity is prescribed along {sorted(loose)}, which translation "
                f"{self.translation!r} does not hold: add these axes to it"
            )
        problems += [
            f"velocity along {axis} must be a function of time, got {rate!r}: for a constant "
            f"write lambda time: {rate!r}"
            for axis, rate in self.velocity.items()
            if not callable(rate)
        ]
        if problems:
            raise ValueError("; ".join(problems))

    @classmethod
    def clamped(cls, nodes: NodeChoice) -> Support:
        """Hold position and director."""
        return cls(nodes)

    @classmethod
    def pinned(cls, nodes: NodeChoice) -> Support:
        """Hold the position, leave the director free."""
        return cls(nodes, rotation="")

    @classmethod
    def symmetry(cls, nodes: NodeChoice, normal: str) -> Support:
        """Hold nodes in the symmetry plane with the given normal axis, "x", "y" or "z"."""
        return cls(nodes, translation=normal, rotation=_AXES.replace(normal, ""))


class SupportSet:
    """All supports of a model, resolved to nodes.

    Raises
    ------
    ValueError
        If a set is unknown, or two supports prescribe the same component differently.
    """

    def __init__(self, mesh: Mesh, supports: Sequence[Support]) -> None:
        self._moving: list[tuple[Ints, int, Callable[[float], float]]] = []
        self.nodes = [choose_nodes(mesh, s.nodes) for s in supports]
        self._supports = tuple(supports)
        moved: dict[tuple[int, int], Callable[[float], float]] = {}
        for support, ids in zip(supports, self.nodes, strict=True):
            for axis, rate in support.velocity.items():
                c = _AXES.index(axis)
                clash = [n for n in ids.tolist() if moved.setdefault((n, c), rate) is not rate]
                if clash:
                    raise ValueError(
                        f"two supports prescribe the velocity along {axis} of nodes {clash[:5]}: "
                        "keep one of them"
                    )
                self._moving.append((ids, c, rate))
        # A node that one support holds at rest and another moves along the same axis.
        for support, ids in zip(supports, self.nodes, strict=True):
            for axis in set(support.translation) - set(support.velocity):
                c = _AXES.index(axis)
                clash = [n for n in ids.tolist() if (n, c) in moved]
                if clash:
                    raise ValueError(
                        f"one support holds what another moves along {axis}, nodes {clash[:5]}: "
                        "take these nodes or this axis out of one of them"
                    )

    def initialise(self, state: State) -> None:
        """Write the masks of held components."""
        for support, ids in zip(self._supports, self.nodes, strict=True):
            for axis in support.translation:
                state.node.support[ids, _AXES.index(axis)] = True
            for axis in support.rotation:
                state.node.support[ids, 3 + _AXES.index(axis)] = True
        state.node.supported[:] = state.node.support.any(axis=1)

    def prescribe(self, state: State, time_half: float) -> None:
        """Write the prescribed velocities at t_{n+1/2}."""
        for ids, c, rate in self._moving:
            state.node.support_rate[ids, c] = rate(time_half)

    def reaction(self, state: State, which: int) -> Floats:
        """Return the resultant reaction of one support [N], shape (3,)."""
        return np.asarray(state.node.reaction[self.nodes[which], :3].sum(axis=0))
