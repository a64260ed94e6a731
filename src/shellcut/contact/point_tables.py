"""Tables of the contact of the tool's points with quads, and the list of their pairs."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds, SmallInts

from .contact_points import ContactPoints
from .contact_tables import Carriers, ContactNodes
from .settings import PenaltyLaw


class PointPairs(NamedTuple):
    """Which quads are near which point; the arrays have room for more."""

    used: Annotated[Ints, "(2,)"]
    """Number of listed points, and of nodes of the listed quads."""
    point: Annotated[Ints, "(n_point,)"]
    """Points with a quad near, or a force, ascending; the first ``used`` in use."""
    first: Annotated[Ints, "(n_first,)"]
    """First quad of each, and the end."""
    quad: Annotated[Ints, "(n_pair,)"]
    """Whole quads, ascending for each point."""
    node: Annotated[Ints, "(n_listed,)"]
    """Nodes of all these quads, ascending."""

    @classmethod
    def none(cls, n_point: int, n_pair: int) -> PointPairs:
        """Return the list of nothing near, with room for so many points and pairs."""
        return cls(
            used=np.zeros(2, np.int64),
            point=np.zeros(n_point, np.int64),
            first=np.zeros(n_point + 1, np.int64),
            quad=np.zeros(n_pair, np.int64),
            node=np.zeros(4 * n_pair, np.int64),
        )

    def nodes(self) -> Ints:
        """Return the nodes of the listed quads."""
        return self.node[: self.used[1]]

    def points(self) -> Ints:
        """Return the listed points."""
        return self.point[: self.used[0]]


class PointSprings(NamedTuple):
    """What the points keep from step to step."""

    side: Annotated[SmallInts, "(n_point,)"]
    """Side of the film that the point came from, +1 where its normal points, 0 far from it."""
    depth: Annotated[Floats, "(n_point,)"]
    """How far it has passed the film [mm]."""
    stored: Annotated[Floats, "(n_point,)"]
    """Penalty energy [N·mm]."""
    until: Annotated[Floats, "(n_point,)"]
    """Way walked from which on it may touch, and is looked at again [mm]."""
    force: Annotated[Floats, "(n_point, 3)"]
    """On the film [N]."""

    @classmethod
    def at_rest(cls, n: int) -> PointSprings:
        """Return those of n points far from the film."""
        return cls(
            side=np.zeros(n, np.int8),
            depth=np.zeros(n),
            stored=np.zeros(n),
            until=np.zeros(n),
            force=np.zeros((n, 3)),
        )


class PointTables(NamedTuple):
    """Kernel arguments that stay valid until the list is made anew."""

    points: ContactPoints
    radius: float
    """Of the farthest of them, around the body's origin [mm]."""
    pairs: PointPairs
    springs: PointSprings
    carriers: Carriers
    quads: Annotated[SmallIds, "(n_quad, 4)"]
    nodes: ContactNodes
    law: PenaltyLaw
