"""Output of a running simulation: frames, history, checkpoints, pictures, summary, progress.

May import ``simulation``, ``results``, ``checks`` and rows below. ``recorder`` is the hook that
calls the other files in order; :mod:`shellcut.results` describes every file written.
"""

from .checkpoint import load_checkpoint, save_checkpoint
from .recorder import Recorder

__all__ = ["Recorder", "load_checkpoint", "save_checkpoint"]
