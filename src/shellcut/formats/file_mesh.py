"""Content of a mesh file, in one form for all formats.

Nodes and cells are numbered from 0 in the order of the file; the file's own numbers are kept as
labels for messages.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.arrays import ArrayLike, Floats, Ints

from .errors import FileError, named

POINT, LINE, TRIANGLE, QUAD = "point", "line", "triangle", "quad"
"""Kinds of cell that a film can have; other kinds have the file's own name."""

N_CORNER = {LINE: 2, TRIANGLE: 3, QUAD: 4}

_MOST_KINDS = 50  # named in a note


@dataclass(frozen=True)
class CellBlock:
    """Cells of one kind."""

    kind: str
    """One of the names above, or the file's own name for other kinds."""
    labels: Sequence[Any] | Ints
    """Labels of the cells in the file, length n."""
    nodes: Ints
    """Node numbers, shape (n, k); (n, 0) for kinds that are only counted."""
    corners: str = ""
    """For a quadratic kind: the kind of its first nodes; the next nodes are those of the sides."""


@dataclass
class FileMesh:
    """Nodes, cells and named groups of a file."""

    path: Path
    nodes: Floats
    """Coordinates in the file's own unit, shape (n_node, 3)."""
    node_labels: Sequence[Any] | Ints
    """Labels of the nodes in the file, length n_node."""
    blocks: list[CellBlock]
    node_groups: dict[str, Ints] = field(default_factory=dict)
    """Named node numbers, each once."""
    cell_groups: dict[str, Ints] = field(default_factory=dict)
    """Named cell numbers, each once; cells are numbered consecutively through all blocks."""
    notes: list[str] = field(default_factory=list)
    """Omissions and assumptions of the reader."""


class Numbering:
    """Map labels (ids in a file) to rows of an array."""

    def __init__(self, path: Path, what: str, labels: ArrayLike, places: Floats | None = None):
        self.path, self.what = path, what
        self.labels = np.asarray(labels, dtype=np.int64)
        order = np.argsort(self.labels, kind="stable")
        again = np.flatnonzero(np.diff(self.labels[order]) == 0)
        first, second = order[again], order[again + 1]
        # a node that is written again at the same place is the same node
        differs = np.ones(len(first), np.bool_)
        if places is not None:
            differs = (places[first] != places[second]).any(axis=1)
        if differs.any():
            ids = np.unique(self.labels[first[differs]])
            at = "" if places is None else ", or twice at one place"
            raise FileError(path, f"each {what} id must occur once{at}, got {named(ids)} again")
        self._order = np.delete(order, again + 1)
        self._sorted = self.labels[self._order]

    def rows(self, labels: ArrayLike, wanted_by: str) -> Ints:
        """Return the rows of some labels, of any shape.

        The part of the file that uses them is named as ``wanted_by``.
        """
        ids = np.asarray(labels, dtype=np.int64)
        missing = ids[~np.isin(ids, self._sorted)]
        if missing.size:
            raise FileError(
                self.path,
                f"{wanted_by} must name {self.what}s that the file defines, got "
                f"{named(np.unique(missing))}; is the file cut short?",
            )
        return np.asarray(self._order[np.searchsorted(self._sorted, ids)], np.int64)

    def between(self, first: int, last: int) -> Ints:
        """Return the rows of the existing labels from ``first`` to ``last``."""
        low, high = np.searchsorted(self._sorted, [first, last + 1])
        return np.asarray(self._order[low:high], np.int64)


def unique_names(groups: Sequence[tuple[str, Any, Ints]]) -> dict[str, Ints]:
    """Return members by name, each once; of one name groups get their id, ``name (id)``."""
    n_group = Counter(name for name, _, _ in groups)
    return {
        name if n_group[name] == 1 else f"{name} ({label})": np.unique(members)
        for name, label, members in groups
    }


def unused_note(counts: Mapping[str, int]) -> list[str]:
    """Return a note on all that a reader of meshes passes over, because no film takes it.

    Examples
    --------
    >>> unused_note({"*ELASTIC": 1, "*BOUNDARY": 2})
    ['not used, a film takes nodes, quads and sets only: 2 *BOUNDARY, 1 *ELASTIC']
    """
    if not counts:
        return []
    names = sorted(counts)
    listed = ", ".join(f"{counts[name]} {name}" for name in names[:_MOST_KINDS])
    more = f" and {len(names) - _MOST_KINDS} more kinds" if len(names) > _MOST_KINDS else ""
    return [f"not used, a film takes nodes, quads and sets only: {listed}{more}"]
