"""Which terms make up the contact of a film with a tool and with itself, from its settings."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from shellcut.contact.border_contact import BorderContact
from shellcut.contact.coulomb_friction import CoulombFriction
from shellcut.contact.film_outline import Part
from shellcut.contact.penalty_contact import PenaltyContact
from shellcut.contact.press_term import PressTerm
from shellcut.contact.settings import Contact
from shellcut.contact.sheet_contact import PointContact, SelfContact
from shellcut.fracture.options import Fracture
from shellcut.fracture.ray_ahead import MERGE
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.tool import Tool

if TYPE_CHECKING:
    from .simulation import Simulation

# Quantile of the quads' areas that the distance of the tool's points follows: those of the path.
_FINER = 0.25


def contact_terms(
    tool: Tool | None,
    settings: Contact,
    mesh: Mesh,
    film: ShellMaterial,
    fracture: Fracture,
    part_of: Callable[[int], Part],
) -> tuple[PenaltyContact | None, list[ForceTerm]]:
    """Return the contact of the nodes, and all terms in the order of their evaluation.

    Without a tool there are none.  part_of : returns the polygon of a row that is cut.
    """
    if tool is None:
        return None, []
    edge_length = float(np.sqrt(np.median(mesh.quad_areas())))
    aside = MERGE if fracture.path == "free" else 0.0
    of_edges = part_of if settings.film_edges else None
    contact = PenaltyContact(tool, settings, film, edge_length, aside, of_edges)
    terms = _with_friction("friction", contact, settings.friction)
    if settings.tool_points:
        finer = float(np.sqrt(np.quantile(mesh.quad_areas(), _FINER)))
        terms += _with_friction("point_friction", PointContact(contact, finer), settings.friction)
    if settings.film_edges:
        edges = BorderContact(contact, edge_length)
        terms += _with_friction("edge_friction", edges, settings.friction)
    return contact, terms


def self_contact_terms(
    settings: Contact, mesh: Mesh, film: ShellMaterial, part_of: Callable[[int], Part]
) -> list[ForceTerm]:
    """Return the terms of a film's contact with itself in the order of their evaluation.

    part_of : returns the polygon of a row that is cut.
    """
    if not settings.self_contact:
        return []
    edge_length = float(np.sqrt(np.median(mesh.quad_areas())))
    contact = SelfContact(settings, film, edge_length, part_of)
    return _with_friction("self_friction", contact, settings.self_friction)


def _with_friction(name: str, contact: PressTerm, coefficient: float) -> list[ForceTerm]:
    if coefficient == 0.0:
        return [contact]
    return [contact, CoulombFriction(name, contact, coefficient)]


def polygons_of(simulation: Simulation) -> Callable[[int], Part]:
    """Return what gives the polygon of a row that is cut, by cracks that may be built later."""

    def polygon(row: int) -> Part:
        assert simulation.cracks is not None  # without cracks no row is cut
        return simulation.cracks.cuts.topology.polygon(row)

    return polygon
