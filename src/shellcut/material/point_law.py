"""Material law in plane stress at one thickness point, with history.

A :class:`PointLaw` is two functions of numbers and the names of its history numbers. The functions
work on one quad or on all lanes of a block (:mod:`shellcut.numerics.lanes`), so they use only
+ - * / and :mod:`shellcut.numerics.lane_functions`, and do not branch on strains. A new law is
passed to :func:`register`, which adds its row to :data:`LAWS`; a material class that names it in
``law`` then works with forces, energies, output stresses, criteria, checkpoints and frames.

:mod:`shellcut.material.law_dispatch` passes the laws to the kernels.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

from shellcut.arrays import Number
from shellcut.numerics.source_digest import source_digest

History: TypeAlias = tuple[Number, ...]


@dataclass(frozen=True, eq=False)
class PointLaw:
    """A material law at a thickness point.

    Parameters
    ----------
    name : str
        Name of the law, its key in :data:`LAWS`.
    stress : callable
        ``stress(p, strain, history, dt)`` returns four things: the second Piola-Kirchhoff stress
        (S_11, S_22, S_12) [MPa] at t_n; the stored energy density at t_n [N/mm²]; the energy
        density dissipated since t_{n-1} [N/mm²], not negative; the history at t_n. A law may
        return a fifth: whether the history has changed; if not, none is stored. ``p`` has the
        material's parameters, shape (n_parameter,); ``strain`` is (E_11, E_22, 2 E_12) at t_n in
        the point's Cartesian frame; ``history`` has the numbers at t_{n-1}, zero at the start;
        ``dt`` is the length of the step [s]. Called again with the same strain, the returned
        history and dt = 0, as for output, a law must return the same stress and dissipate nothing.
    thickness_stretch : callable
        ``thickness_stretch(p, strain, history)`` returns present thickness over reference thickness
        at the point.
    history : tuple of str
        Names of the history numbers with their units, such as ``"damage [-]"``; they are used in
        the frames. A law without history does not dissipate.
    linear : bool
        Whether the stress is the ``plane_stress`` matrix of the material times the strain, at any
        strain: then the section can be integrated through the thickness once, before the run.
    oriented : bool
        Whether the axes matter: then the strain is given, and the stress is used, along the film's
        direction (:attr:`.shell_material.ShellMaterial.direction`) and across it.
    timed : bool
        Whether the stress depends on ``dt``: such a film has no statics.
    frozen : PointLaw, optional
        The law without flow: elastic, with the history as it is, which it returns unchanged. The
        time step then follows its tangent dS/dE, which bounds that of the law in the present state;
        without one it follows ``plane_stress`` of the material, which must do so at any strain.
        The energy released at the tip of a tear is that of the frozen law, too.
    turning : tuple of int
        Where strains (11, 22, twice 12) begin among the history numbers: these turn with the axes.
    first_leads : bool
        Whether all history numbers are zero where the first is not above zero. Then the others are
        read only where it is: most of a film has never yielded, and to read five numbers of every
        point would take a third of its time.
    elastic : bool
        Whether the law is its own frozen law, which is then not given: it has no flow, though its
        stress is not linear. Kernels for it are compiled once.
    """

    name: str
    stress: Callable[..., tuple[Any, ...]]
    thickness_stretch: Callable[..., Number]
    history: tuple[str, ...] = ()
    linear: bool = False
    oriented: bool = False
    timed: bool = False
    frozen: PointLaw | None = None
    turning: tuple[int, ...] = ()
    first_leads: bool = False
    elastic: bool = False

    def __post_init__(self) -> None:
        problems = []
        if not self.name.strip():
            problems.append(f"a law needs a name, got {self.name!r}")
        if self.linear and self.history:
            problems.append(f"a linear law has no history, {self.name!r} names {self.history}")
        if len(set(self.history)) < len(self.history):
            problems.append(f"history names must differ, {self.name!r} has {self.history}")
        if self.elastic and self.history:
            problems.append(f"an elastic law has no history, {self.name!r} names {self.history}")
        if self.elastic:
            object.__setattr__(self, "frozen", self)
        elif self.frozen is not None and self.frozen.history != self.history:
            problems.append(
                f"the frozen law of {self.name!r} must have its history, {self.history}, got "
                f"{self.frozen.history}"
            )
        if not _are_strains(self.turning, len(self.history)):
            problems.append(
                "turning must name where strains of three numbers begin among the history "
                f"numbers, which must not overlap, but {self.name!r} has {self.turning} of "
                f"{len(self.history)}"
            )
        if self.first_leads and len(self.history) < 2:
            problems.append(
                f"a history must have numbers for the first to lead, {self.name!r} has "
                f"{self.history}"
            )
        if any("/" in name or not name.strip() for name in self.history):
            problems.append(
                f"history names must be words without a slash, {self.name!r} has {self.history}"
            )
        if problems:
            raise ValueError("; ".join(problems))

    @property
    def digest(self) -> str:
        """Digest of all fields, and of what the functions are and read at this moment.

        See :mod:`shellcut.numerics.source_digest`.
        """
        frozen = "" if self.frozen in (None, self) else self.frozen.digest
        words = (
            *(self.history, self.linear, self.oriented, self.timed, self.turning),
            *(self.first_leads, self.elastic, frozen),
        )
        sources = source_digest(self.stress, self.thickness_stretch)
        content, _, only_here = sources.partition(" ")
        digest = hashlib.sha256(f"{content} {words}".encode()).hexdigest()[:16]
        return f"{digest} {only_here}".rstrip()


def _are_strains(turning: tuple[int, ...], n_history: int) -> bool:
    """Return whether there are three numbers of a history from each of some places on."""
    if any(not isinstance(first, int) for first in turning):
        return False
    taken = [place for first in turning for place in range(first, first + 3)]
    return len(set(taken)) == len(taken) and all(0 <= place < n_history for place in taken)


LAWS: dict[str, PointLaw] = {}
"""All registered laws, by name."""


def register(law: PointLaw) -> PointLaw:
    """Add a law to :data:`LAWS` and return it.

    Raises
    ------
    ValueError
        If another law already has this name: one of other functions, or whose functions read other
        values, as from a factory.
    """
    known = LAWS.get(law.name, law)
    if known is not law and known.digest != law.digest:
        raise ValueError(
            f"a law {law.name!r} is already registered, with other functions or other values that "
            f"these read; give yours another name than {', '.join(sorted(LAWS))}"
        )
    LAWS[law.name] = law
    return law
