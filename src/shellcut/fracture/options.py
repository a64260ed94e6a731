"""How cracks start and run: the options of a film's fracture.

When a crack at its tip runs, by two measures that reach 1:

``"force"`` (default)
    The nodal force of a trial cut (:mod:`.trial_cut`), along the opening where a blade drives the
    crack, its magnitude elsewhere. The new cables take over this very force, so a crack starts
    near equilibrium.
``"stress"``
    sigma_I / sigma_F with the stress recovered at the mid-surface, the paper's
    (:mod:`.side_tears`).

Cracks run from their tips and from where a cutting edge enters whole film. [Frangi2010] says
any node, which would also part nodes beside the cut.

**The blade-cut rule** (:mod:`.blade_drive`) differs from [Frangi2010]: a tip that a cutting edge
has passed runs whatever the stress, for a sheet under a blade is carried by the cables and its tip
may stay below the strength while the blade runs on; film that the edge enters is cut
(:mod:`.pierce`). The rule knows the blade's geometry and the nodes' positions; there is no list of
nodes of an expected path.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Literal, TypeAlias

from shellcut.arguments import Option, checked

from .anisotropy import Anisotropy

Measure: TypeAlias = Literal["force", "stress"]
Path: TypeAlias = Literal["free", "edges"]

_ONLY_ALONG_EDGES = "criterion", "blade_cut", "turn_limit_deg", "equilibrium_start"
_ONLY_THROUGH_QUADS = ("anisotropy",)


NO_IMPRINT = "cracks run through the quads of any mesh: set path = 'free', or leave it out"
"""What to write for the path ``"imprint"`` of earlier versions."""


@checked
@dataclass(frozen=True)
class Fracture:
    """How cracks start and run.

    By default the path is ``"free"``, but ``"edges"``, along sides of quads, if an option for these
    only differs from its default: ``criterion``, ``blade_cut``, ``turn_limit_deg``,
    ``equilibrium_start``; in a ready model also if sides lie under the whole path.

    Parameters
    ----------
    anisotropy : Anisotropy, optional
        How strength and energy depend on the direction of a crack, for cracks through the quads
        that no blade drives.

    Examples
    --------
    >>> Fracture(criterion="stress").blade_cut
    True
    >>> Fracture().decided().path, Fracture(criterion="stress").decided().path
    ('free', 'edges')
    """

    criterion: Annotated[Measure, Option("", "what makes a crack advance at its tip")] = "force"
    blade_cut: Annotated[
        bool, Option("", "whether the blade cuts the film that it has passed through")
    ] = True
    turn_limit_deg: Annotated[
        float,
        Option(
            "deg",
            "largest angle from a crack's last quad side to the next, where no blade drives it",
            above=0,
            below=180,
        ),
    ] = 57.0
    check_every: Annotated[int, Option("", "steps between two checks of the cracks", least=1)] = 10
    equilibrium_start: Annotated[
        bool,
        Option(
            "",
            "start cables of a crack along quad sides with the force that its node carried, which "
            "fades as they open",
        ),
    ] = False
    path: Annotated[
        Path | None,
        Option(
            "",
            "where cracks run: free through the quads, or along their sides (edges)",
            unset="edges if sides lie under the whole path or another option needs it, else free",
        ),
    ] = None
    anisotropy: Anisotropy | None = None
    fibres: Annotated[
        int | None,
        Option(
            "",
            "cables across a quad or side that is cut, evenly spaced; 0: one at each end",
            least=0,
            most=1000,
            unset="6 where a tool has cutting edges, else 0",
        ),
    ] = None
    puncture_force: Annotated[
        float | None,
        Option(
            "N",
            "force at which the tip of a cutting edge (its end, its apex or the lowest place of "
            "an arc) pierces uncut film",
            above=0,
            unset="from thickness, strength and the radii of the cutting edge",
        ),
    ] = None

    def __post_init__(self) -> None:
        if problems := list(self._contradictions()):
            raise ValueError("; ".join(problems))

    def _contradictions(self) -> Iterator[str]:
        """Yield what does not fit the path or another option."""
        of_edges, of_quads = self.only_along_edges, self._set_of(_ONLY_THROUGH_QUADS)
        if self.path == "free":
            for name in of_edges:
                needed = type(self).__dataclass_fields__[name].default
                yield (f"path = 'free' fits {name} = {needed!r} only, got {getattr(self, name)!r}")
        elif self.path is not None:
            for name in of_quads:
                yield f"{name} is for cracks through the quads only: take path='free'"
        elif of_edges and of_quads:
            yield (
                f"leave out {', '.join(of_edges)}, for cracks along quad sides only, or "
                f"{', '.join(of_quads)}, for cracks through the quads only"
            )

    @property
    def only_along_edges(self) -> tuple[str, ...]:
        """Names of the options that are set and exist for cracks along quad sides only."""
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
