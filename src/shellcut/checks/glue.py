"""What the film's quads resolve of a glue that may peel (docs/theory/adhesion.md)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import sqrt

from shellcut.loads.adhesion import ZONE_SIDES, GluePoints
from shellcut.material.shell_material import ShellMaterial
from shellcut.tool.force_term import ForceTerm

from .finding import Finding, note

# Of sqrt(tau / (rho h)), at which the moving film takes as much energy as the glue.
_SLOW = 0.1


def check_glue(material: ShellMaterial, terms: Iterable[ForceTerm]) -> Iterator[Finding]:
    """Yield what each glue needs where it peels.

    It is no doubt: a glue that nowhere reaches its strength needs none of it. After the run, its
    answer is doubtful where it is damaged and the quads are too large.
    """
    for term in terms:
        if not isinstance(term, GluePoints):
            continue
        slow = _SLOW * sqrt(term.law.energy / material.area_density)
        came = (
            f"{term.name}: strength {term.law.strength:.3g} MPa; where it peels, it lets go over "
            f"{term.zone:.3g} mm, the film bends with a radius of {term.fold:.3g} mm, and "
            f"{ZONE_SIDES:g} sides of the quads are {ZONE_SIDES * term.side:.3g} mm"
        )
        if term.resolved < 1.0:
            needed = f"to see it peel, make its quads {term.side * term.resolved:.2g} mm small"
            yield note(came, needed)
        else:
            yield note(came, f"it peels without inertia below {slow:.2g} mm/s")
