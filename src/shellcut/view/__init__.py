"""Pictures of a run: snapshots and curves, drawn by Matplotlib (``pip install shellcut[plot]``)."""

from .comparison_picture import draw_comparison
from .curves import draw_energy, draw_torque
from .model_picture import ModelView, draw_model
from .path_picture import draw_path
from .snapshot import draw_snapshot

__all__ = [
    "ModelView",
    "draw_comparison",
    "draw_energy",
    "draw_model",
    "draw_path",
    "draw_snapshot",
    "draw_torque",
]
