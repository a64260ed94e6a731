"""The quads of a film as kernels take them: the blocks, and where the nodes are."""

from __future__ import annotations

from shellcut.arrays import Floats
from shellcut.numerics.table_address import TableWriter
from shellcut.state import KnownTopology, State

from .places import Places
from .quad_strains import PointQuads, Quads


class PresentQuads:
    """The quads of a state, kept until the next split or cut.

    ``State.quads`` says which nodes a quad has; the blocks follow it here.

    Parameters
    ----------
    places : Places
        Which quad is placed where, and the numbers of it that never change.
    """

    def __init__(self, places: Places) -> None:
        self._places = places
        self._address_of = TableWriter()
        self.forget()

    def forget(self) -> None:
        """Take the next state afresh: the places are those of another run."""
        self._known = KnownTopology()
        self._present: PointQuads | None = None
        self._address: PointQuads

    def of(self, state: State) -> PointQuads:
        """Return the quads at the positions and directors of a state."""
        if self._present is None or not self._known.is_of(state):
            self._places.blocks.rewire(state.quads, self._known.changed_quads(state))
            self._present = self.at(state.node.x, state.node.t)
            self._address = self._address_of(self._present)
            self._known.take(state)
        return self._present

    def address(self, state: State) -> PointQuads:
        """Return the address of the quads, for the kernels of the forces."""
        self.of(state)
        return self._address

    def at(self, x: Floats, t: Floats) -> PointQuads:
        """Return the quads as they are placed in the blocks, their nodes at any place.

        x, t : (n_node, 3), positions [mm] and directors.
        """
        places = self._places
        blocks = places.blocks
        return PointQuads(Quads(x, t, blocks.corner, blocks.chain, places.tables), places.points)
