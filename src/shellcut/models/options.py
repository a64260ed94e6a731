"""Options that a ready model hands on to its simulation, by name and type."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict

from shellcut.arrays import Floats
from shellcut.contact.settings import Contact
from shellcut.fracture.options import Fracture
from shellcut.loads.adhesion import Adhesion
from shellcut.loads.loads import Load
from shellcut.loads.supports import Support
from shellcut.simulation.stable_step import Stepping
from shellcut.tool.force_term import ForceTerm


class ModelOptions(TypedDict, total=False):
    """Arguments of :class:`Simulation` that no model sets itself, for type checkers."""

    loads: Sequence[Load]
    contact: Contact | None
    fracture: Fracture | None
    stepping: Stepping | None
    directional: bool
    damping_alpha: float
    damping_beta: float | None
    damping_share: float | None
    velocity: Floats | None
    terms: Sequence[ForceTerm | Adhesion]
    quasi_static: float | None
    imperfection: int | None
    threads: int | None


class CutOptions(ModelOptions, total=False):
    """Those of a cut, which may have supports besides its clamp."""

    supports: Sequence[Support]
