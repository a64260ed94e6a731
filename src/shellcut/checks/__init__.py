"""Checks of a model before its run; each finding says what must hold, what came, what to do.

:func:`check_model` runs them all; :class:`Sweep` finds where and when the cutting edges pass
through the film, which the verdict at the end of a run also uses.

May import ``cables``, ``mesh``, ``tool``, ``material`` and the layers below. Of the simulation,
which it is handed, it names only the type.
"""

from .finding import Finding, RefusedModel
from .model_check import ModelCheck, check_model
from .path import edge_line
from .sweep import Fate, Sweep

__all__ = ["Fate", "Finding", "ModelCheck", "RefusedModel", "Sweep", "check_model", "edge_line"]
