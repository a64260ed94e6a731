"""What a running simulation writes: frames, history, checkpoints, pictures, summary, progress.

May import ``simulation``, ``results``, ``checks`` and rows below. ``recorder`` is the hook that
owns the order; every file it writes is described in :mod:`shellcut.results`.
"""

from .checkpoint import load_checkpoint, save_checkpoint
from .recorder import Recorder

__all__ = ["Recorder", "load_checkpoint", "save_checkpoint"]
