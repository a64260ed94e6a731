"""Refuse a mesh too large for any run, before it is made.

A number with a few zeros too many asks for more quads than memory holds, and making them would
block the machine before any check of the mesh.
"""

from __future__ import annotations

import os

from .checks import MeshError

MOST_QUADS = 10_000_000
"""Quads of the largest film allowed: 9 GB, and half a second per step."""

BYTES_A_QUAD = 902.0
"""Memory of a run, measured between 1e5 and 1e6 quads (docs/performance.md)."""


def check_film_size(n_quad: float, remedy: str) -> None:
    """Refuse a film of too many quads, about, for the library or for this machine's memory.

    The number may be infinite.

    Examples
    --------
    >>> check_film_size(75e6, "enlarge size")
    Traceback (most recent call last):
    ...
    shellcut.mesh.checks.MeshError: the film must have 10,000,000 quads at most, it would have ...
    """
    needed = n_quad * BYTES_A_QUAD
    shown = f"{n_quad:,.0f}" if n_quad < 1e12 else f"{n_quad:.3g}"
    takes = f"it would have about {shown}, which take {needed / 1e9:,.3g} GB"
    if not n_quad <= MOST_QUADS:
        raise MeshError(f"the film must have {MOST_QUADS:,} quads at most, {takes}: {remedy}")
    there = _memory()
    if there is not None and needed > there:
        raise MeshError(
            f"the film must fit into this machine's memory of {there / 1e9:.3g} GB, {takes}: "
            f"{remedy}"
        )


def _memory() -> float | None:
    """Return this machine's memory in bytes, None if unknown."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * float(os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return None
