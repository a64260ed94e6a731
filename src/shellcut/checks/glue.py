"""Whether the film's quads resolve a glue that may peel (docs/theory/adhesion.md)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import sqrt

from shellcut.loads.adhesion import ZONE_SIDES, GluePoints
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.tool.force_term import ForceTerm

from .finding import Finding, doubt, note

# Of sqrt(tau / (rho h)), at which the moving film takes as much energy as the glue.
_SLOW = 0.1


def check_glue(
    mesh: Mesh, material: ShellMaterial, terms: Iterable[ForceTerm]
) -> Iterator[Finding]:
    """Yield a doubt for a glue that the quads do not resolve, a note for what they do."""
    for term in terms:
        if not isinstance(term, GluePoints):
            continue
        law, bending = term.law, float(material.bending_stiffness[0, 0])
        side = sqrt(float(mesh.quad_areas()[term.quads].max()))
        zone = sqrt(sqrt(12.0 * bending * law.energy) / law.strength)
        fold = sqrt(0.5 * bending / law.energy)
        slow = _SLOW * sqrt(law.energy / material.area_density)
        resolved = (
            f"{term.name}: strength {law.strength:.3g} MPa, the zone in which it lets go is "
            f"{zone:.3g} mm long, the film peels with a radius of {fold:.3g} mm, on quads of "
            f"{side:.3g} mm"
        )
        least = min(zone, fold)
        if least < (1.0 - 1e-9) * ZONE_SIDES * side:
            yield doubt(
                f"zone and radius must be {ZONE_SIDES:g} sides of the quads or more, or the film "
                "springs from quad to quad and peeling takes too much work",
                resolved,
                f"make the glued quads {least / ZONE_SIDES:.2g} mm small"
                + ("" if fold < zone else ", or leave the strength out"),
            )
        else:
            yield note(resolved, f"it peels without inertia below {slow:.2g} mm/s")
