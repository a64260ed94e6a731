"""Schedule and running totals of the recorder, stored in its checkpoints."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from shellcut.numerics.trigger import Trigger
from shellcut.results.history import Written

from .run_options import RunOptions
from .unfelt_penetration import Unfelt

_N_LOOK = 100
"""Measurements of the penetration between nodes and of the film's stress over a run; independent
of the output intervals, because the verdict uses the results."""


@dataclass
class Schedule:
    """When the next row, frame and picture are due, and running totals of the recorder."""

    row_due: Trigger
    frame_due: Trigger
    picture_due: Trigger | None
    """None if no pictures are wanted."""
    look_due: Trigger
    """Of the measurements of penetration between nodes and of stress."""
    history: Written = field(default_factory=Written)
    """What the file of the rows held after the last one."""
    row_time: float = -np.inf
    """Time of the last row [s]."""
    frame_time: float = -np.inf
    """Time of the last frame [s]."""
    captured_time: float = -np.inf
    """Time of the last frame or picture [s]."""
    n_picture: int = 0
    unfelt: float = 0.0
    """Penetration between nodes, which nodal contact misses, when last measured [mm]."""
    largest_unfelt: float = 0.0
    """Its largest value so far [mm]."""
    largest_unfelt_edge: float = 0.0
    """That of edges of the film in the tool so far [mm]."""
    stress: float = 0.0
    """Stress of film far from cracks over its strength, when last measured."""
    lasting_stress: float = 0.0
    """Its largest value so far that two measurements have reached in succession."""
    wall: float = 0.0
    """Wall time up to the checkpoint [s]."""

    @classmethod
    def at_start(cls, until: float, options: RunOptions) -> Schedule:
        """Return the schedule of a new run, with equal intervals up to ``until`` [s]."""
        return cls(
            Trigger(until / options.n_row),
            Trigger(until / options.n_frame),
            Trigger(until / options.n_snapshot) if options.n_snapshot else None,
            Trigger(until / _N_LOOK),
        )

    def due(self, time: float) -> bool:
        """Whether anything is due; asking does not change that."""
        triggers = (self.row_due, self.frame_due, self.picture_due, self.look_due)
        return any(one is not None and time >= one.next for one in triggers)

    def copied(self) -> Schedule:
        """Return a copy that does not change with this one."""
        same = copy(self)
        for name in ("row_due", "frame_due", "picture_due", "look_due"):
            setattr(same, name, copy(getattr(self, name)))
        return same

    def note_unfelt(self, found: Unfelt) -> None:
        """Take down what has just been measured of penetration that no contact feels."""
        self.unfelt = found.quads
        self.largest_unfelt = max(self.largest_unfelt, found.quads)
        self.largest_unfelt_edge = max(self.largest_unfelt_edge, found.film_edges)

    def note_stress(self, stress: float) -> None:
        """Take down the stress that has just been measured, over the strength."""
        self.lasting_stress = max(self.lasting_stress, min(stress, self.stress))
        self.stress = stress

    def saved(self) -> dict[str, Any]:
        """Return the schedule as numbers and dictionaries of numbers, by name."""
        values = asdict(self)
        due = {name: values.pop(f"{name}_due") for name in ("row", "frame", "picture", "look")}
        return {"due": {name: one for name, one in due.items() if one}, **values}

    @classmethod
    def restored(cls, saved: Mapping[str, Any]) -> Schedule | None:
        """Return the schedule that :meth:`saved` gave; None if ``saved`` is something else."""
        if not {"row", "frame", "look"} <= saved.get("due", {}).keys():
            return None
        due = {f"{name}_due": Trigger(**one) for name, one in saved["due"].items()}
        others = {name: value for name, value in saved.items() if name != "due"}
        others["history"] = Written(**others["history"])
        return cls(**{"picture_due": None, **due, **others})
