"""Pictures of a run: snapshots and curves, drawn by Matplotlib (``pip install shellcut[plot]``)."""

from .curves import draw_energy, draw_torque
from .path_picture import draw_path
from .snapshot import draw_snapshot

__all__ = ["draw_energy", "draw_path", "draw_snapshot", "draw_torque"]
