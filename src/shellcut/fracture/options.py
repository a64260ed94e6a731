"""How cracks start and run: the options of a film's fracture.

When a crack at its tip runs, by two measures that reach 1:

``"force"`` (default)
    The nodal force of a trial cut (:mod:`.trial_sums`). The new cables take over this very force,
    so a crack starts near equilibrium.
``"stress"``
    sigma_I / sigma_F with the stress recovered at the mid-surface, the paper's
    (:mod:`.largest_stress`).

Cracks run from their tips and from where a cutting edge goes through whole film. [Frangi2010] says
any node, which would also part nodes beside the cut.

**The blade-cut rule** (:mod:`.blade_drive`) differs from [Frangi2010]: a tip that a cutting edge
has passed runs whatever the stress, for a sheet under a blade hangs on the cables and its tip may stay
below the strength while the blade runs on; film that the edge goes through is cut (:mod:`.pierce`).
The rule knows the blade's geometry and the nodes' positions; there is no list of nodes of an
expected path.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, get_args

import numpy as np

from shellcut.arguments import checked

from .anisotropy import Anisotropy

Measure: TypeAlias = Literal["force", "stress"]
Path: TypeAlias = Literal["free", "edges"]
CablePlaces: TypeAlias = Literal["ends", "gauss"]
DropLoose: TypeAlias = Literal["never", "clear"]

_ONLY_ALONG_EDGES = "criterion", "blade_cut", "turn_limit_deg", "equilibrium_start"
_ONLY_THROUGH_QUADS = "anisotropy", "branching", "cable_places", "largest_speed"


def instead_of(path: object) -> str:
    """Return what to write for the path ``"imprint"`` of earlier versions, nothing for another."""
    if path != "imprint":
        return ""
    return "; cracks go through the quads of any mesh: take path = 'free', or leave it out"


@checked
@dataclass(frozen=True)
class Fracture:
    """How cracks start and run.

    Parameters
    ----------
    criterion : {"force", "stress"}
        Measure of a crack, see the module.
    blade_cut : bool
        Whether the blade-cut rule is on.
    turn_limit_deg : float
        Largest turn of a crack along edges that no blade drives, from its last edge [degrees].
    check_every : int
        Steps between two checks.
    equilibrium_start : bool
        Start the cables of a crack along edges with the very force that its node carried, fading
        over an eightieth of the opening at which a cable breaks; not those where a cut begins.
    path : {"free", "edges"}, optional
        Through the quads, on any mesh (docs/theory/free-cracks.md), or along edges of the mesh,
        which must lie under the path. Left out it is ``"free"``, or ``"edges"`` where another
        option exists for these only: ``criterion``, ``blade_cut``, ``turn_limit_deg`` or
        ``equilibrium_start`` that differ from their defaults. A ready model takes ``"edges"`` too
        where edges lie under the whole path.
    anisotropy : Anisotropy, optional
        How strength and energy depend on the direction of a crack, for cracks through the quads
        that no blade drives.
    cable_places : {"ends", "gauss"}
        Where the two cables across a segment of a crack through the quads are: at its ends, or at
        its two Gauss points, where the force of a cut ripples less.
    largest_speed : float, optional
        Of cracks through the quads that no blade drives [mm/s]; by default one quad in
        ``check_every`` steps, which is mostly less than the Rayleigh speed of the film.
    branching : bool
        Whether a crack through quads that no blade drives may become two (:mod:`.branching`): once
        it runs at half of the film's Rayleigh speed. Needs ``check_every`` so small that it can.
    drop_loose : {"never", "clear"}
        Whether pieces that nothing holds are taken out of the run once they are clear of the rest
        and of the tool (:mod:`shellcut.simulation.loose_pieces`).

    Examples
    --------
    >>> Fracture(criterion="stress").blade_cut
    True
    >>> Fracture().decided().path, Fracture(criterion="stress").decided().path
    ('free', 'edges')
    """

    criterion: Measure = "force"
    blade_cut: bool = True
    turn_limit_deg: float = 57.0
    check_every: int = 10
    equilibrium_start: bool = False
    path: Path | None = None
    anisotropy: Anisotropy | None = None
    cable_places: CablePlaces = "ends"
    largest_speed: float | None = None
    branching: bool = False
    drop_loose: DropLoose = "never"

    def __post_init__(self) -> None:
        problems = []
        for name, choices in (
            ("criterion", Measure),
            ("cable_places", CablePlaces),
            ("drop_loose", DropLoose),
        ):
            if getattr(self, name) not in (allowed := get_args(choices)):
                problems.append(f"{name} must be one of {allowed}, got {getattr(self, name)!r}")
        if not 0 < self.turn_limit_deg < 180:
            problems.append(
                f"turn_limit_deg must lie between 0 and 180, got {self.turn_limit_deg!r}"
            )
        if self.check_every < 1:
            problems.append(f"check_every must be a positive count, got {self.check_every!r}")
        if self.largest_speed is not None and not 0.0 < self.largest_speed < np.inf:
            problems.append(f"largest_speed must be positive, got {self.largest_speed!r}")
        problems += self._contradictions()
        if problems:
            raise ValueError("; ".join(problems))

    def _contradictions(self) -> Iterator[str]:
        """Yield what does not go with the path, or with another option."""
        of_edges, of_quads = self.only_along_edges, self._set_of(_ONLY_THROUGH_QUADS)
        if self.path not in (None, *get_args(Path)):
            yield f"path must be one of {get_args(Path)}, got {self.path!r}" + instead_of(self.path)
        elif self.path == "free":
            for name in of_edges:
                needed = type(self).__dataclass_fields__[name].default
                yield (
                    f"path = 'free' goes with {name} = {needed!r} only, got {getattr(self, name)!r}"
                )
        elif self.path is not None:
            for name in of_quads:
                yield f"{name} is of cracks through the quads only: take path='free'"
        elif of_edges and of_quads:
            yield (
                f"{', '.join(of_edges)} must be left out, of cracks along edges only, or "
                f"{', '.join(of_quads)}, of cracks through the quads only"
            )

    @property
    def only_along_edges(self) -> tuple[str, ...]:
        """Names of the options that exist for cracks along edges only and are set."""
        return self._set_of(_ONLY_ALONG_EDGES)

    @property
    def needed_path(self) -> Path | None:
        """The path that is given, or that other options need; None where any will do."""
        if self.path is not None:
            return self.path
        if self.only_along_edges:
            return "edges"
        return "free" if self._set_of(_ONLY_THROUGH_QUADS) else None

    def decided(self) -> Fracture:
        """Return the same with a path, the default where any will do."""
        return replace(self, path=self.needed_path or "free")

    def _set_of(self, names: Iterable[str]) -> tuple[str, ...]:
        every = type(self).__dataclass_fields__
        return tuple(name for name in names if getattr(self, name) != every[name].default)
