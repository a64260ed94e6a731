"""Where the records of a run are: what goes with a checkpoint, besides the simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np

from shellcut.simulation.hooks import Trigger

_N_LOOK = 100
"""Looks at how deep the tool is between nodes, in a run: whatever is recorded, since a verdict
follows from them."""


@dataclass
class Bookmark:
    """When the next row, frame and picture are due, and what the records have come to.

    Examples
    --------
    >>> mark = Bookmark.at_start(until=1.0, n_row=100, n_frame=10, n_snapshot=0)
    >>> mark.row_due(0.0), mark.row_due(0.005), mark.picture_due
    (True, False, None)
    >>> Bookmark.restored(mark.saved()) == mark
    True
    """

    row_due: Trigger
    frame_due: Trigger
    picture_due: Trigger | None
    """None where none are wanted."""
    look_due: Trigger
    """Of a look at how deep the tool is between nodes."""
    row_time: float = -np.inf
    """Of the last row [s]."""
    frame_time: float = -np.inf
    """Of the last frame [s]."""
    captured_time: float = -np.inf
    """Of the last frame or picture [s]."""
    n_picture: int = 0
    unfelt: float = 0.0
    """How deep the tool was between nodes without being felt, when last looked at [mm]."""
    largest_unfelt: float = 0.0
    """The most that it ever was [mm]."""
    wall: float = 0.0
    """Wall time until it was saved [s]."""
    drawing: float = 0.0
    """The part of it that the pictures took [s]."""

    @classmethod
    def at_start(cls, *, until: float, n_row: int, n_frame: int, n_snapshot: int) -> Bookmark:
        """Return that of a run that begins, with records at equal intervals up to ``until`` [s]."""
        return cls(
            Trigger(until / n_row),
            Trigger(until / n_frame),
            Trigger(until / n_snapshot) if n_snapshot else None,
            Trigger(until / _N_LOOK),
        )

    def due(self, time: float) -> bool:
        """Whether anything is due; it stays so."""
        triggers = (self.row_due, self.frame_due, self.picture_due, self.look_due)
        return any(one is not None and time >= one.next for one in triggers)

    def copy(self) -> Bookmark:
        """Return one that stays as it is when this one goes on."""
        return replace(
            self,
            row_due=replace(self.row_due),
            frame_due=replace(self.frame_due),
            picture_due=replace(self.picture_due) if self.picture_due else None,
            look_due=replace(self.look_due),
        )

    def saved(self) -> dict[str, Any]:
        """Return it as numbers and dictionaries of numbers, by name."""
        due = {
            "row": self.row_due,
            "frame": self.frame_due,
            "picture": self.picture_due,
            "look": self.look_due,
        }
        others = {
            item.name: getattr(self, item.name)
            for item in fields(self)
            if not item.name.endswith("_due")
        }
        return {"due": {name: asdict(one) for name, one in due.items() if one}, **others}

    @classmethod
    def restored(cls, saved: Mapping[str, Any]) -> Bookmark | None:
        """Return what :meth:`saved` gave; None if that is something else."""
        if not {"row", "frame", "look"} <= saved.get("due", {}).keys():
            return None
        due = {name: Trigger(**trigger) for name, trigger in saved["due"].items()}
        others = {name: value for name, value in saved.items() if name != "due"}
        return cls(due["row"], due["frame"], due.get("picture"), due["look"], **others)
