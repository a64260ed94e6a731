"""Pictures of a run, drawn by Matplotlib (``pip install shellcut[plot]``).

May import ``frame``, ``formats`` and rows below.
"""

from ._figure import can_draw
from ._panel import edge_length, legend_of, title_parts, tool_creases
from .crack_map import draw_crack_map
from .curves import Curve, Diagram, draw_curves
from .look import Look
from .model_picture import ModelView, draw_model
from .movie import MOVIES, draw_movie
from .snapshot import draw_scene, png_of

__all__ = [
    "MOVIES",
    "Curve",
    "Diagram",
    "Look",
    "ModelView",
    "can_draw",
    "draw_crack_map",
    "draw_curves",
    "draw_model",
    "draw_movie",
    "draw_scene",
    "edge_length",
    "legend_of",
    "png_of",
    "title_parts",
    "tool_creases",
]
