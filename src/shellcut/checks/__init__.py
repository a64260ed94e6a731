"""Checks of a model before its run: what must hold, what came, what to do.

:func:`check_model` gathers them; :class:`Sweep` tells where and when the cutting edges pass through
the film, which the guards at the end of a run ask as well.

May import the physics (``fracture``, ``imprinting`` and rows below).
"""

from .finding import Finding, RefusedModel
from .model_check import ModelCheck, check_model
from .sweep import Fate, Sweep, edge_line

__all__ = ["Fate", "Finding", "ModelCheck", "RefusedModel", "Sweep", "check_model", "edge_line"]
