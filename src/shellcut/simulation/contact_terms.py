"""Which terms make up the contact of a film with a tool, from its settings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shellcut.contact.coulomb_friction import CoulombFriction
from shellcut.contact.edge_contact import EdgeContact
from shellcut.contact.film_outline import Part
from shellcut.contact.penalty_contact import PenaltyContact
from shellcut.contact.point_contact import PointContact
from shellcut.contact.point_friction import PointFriction
from shellcut.contact.settings import Contact
from shellcut.fracture.crack_path import MERGE
from shellcut.fracture.criterion import Fracture
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.tool.tool import Tool

from .tool_terms import ToolTerm

# Quantile of the quads' areas that the distance of the tool's points follows: those of the path.
_FINER = 0.25


def contact_terms(
    tool: Tool | None,
    settings: Contact,
    mesh: Mesh,
    film: ShellMaterial,
    fracture: Fracture,
    part_of: Callable[[int], Part],
) -> tuple[PenaltyContact | None, list[ToolTerm]]:
    """Return the contact of the nodes, and all terms in the order of their evaluation.

    Without a tool there are none.  part_of : returns the polygon of a row that is cut.
    """
    if tool is None:
        return None, []
    edge_length = float(np.sqrt(np.median(mesh.quad_areas())))
    aside = MERGE if fracture.path == "free" else 0.0
    contact = PenaltyContact(tool, settings, film, edge_length, aside)
    terms: list[ToolTerm] = [contact]
    if settings.friction > 0.0:
        terms.append(CoulombFriction(contact, settings.friction))
    if settings.tool_points:
        finer = float(np.sqrt(np.quantile(mesh.quad_areas(), _FINER)))
        points = PointContact(contact, finer)
        terms.append(points)
        if settings.friction > 0.0:
            terms.append(PointFriction(points, settings.friction))
    if settings.film_edges:
        terms.append(EdgeContact(contact, part_of))
    return contact, terms
