"""What a term does that presses film and tool together between the film's nodes."""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Floats


class PressForces(NamedTuple):
    """Results of one evaluation."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_body, 6)."""
    node_work: float
    """Work of the contact on the nodes since t_{n-1} [N·mm]."""
    stored: float
    """Penalty energy at t_n [N·mm]."""
    absorbed: float
    """Energy of springs that have let go since t_{n-1} [N·mm]."""
    n_touching: int
    """Number of points of the tool, or edges of the film, that press."""
    deepest: float
    """Largest depth that presses [mm]."""

    def add_works(self, entries: dict[str, float], on_tool: float) -> None:
        """Add to the ledger's entries, ``on_tool`` being the work of the wrench."""
        entries["contact_work"] -= self.node_work + on_tool
        entries["contact_absorbed"] += self.absorbed
