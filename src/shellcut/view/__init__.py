"""Pictures of a run, drawn by Matplotlib (``pip install 'shellcut-fem[plot]'``).

May import ``frame``, ``formats`` and the layers below.
"""

from ._figure import add_lines, can_draw, new_figure, save
from ._panel import edge_length, legend_of, mesh_edges, title_parts, tool_creases
from .crack_map import draw_crack_map
from .curves import Curve, Diagram, draw_curves
from .look import Look
from .movie import MOVIES, draw_movie
from .snapshot import draw_scene, png_of

__all__ = [
    "MOVIES",
    "Curve",
    "Diagram",
    "Look",
    "add_lines",
    "can_draw",
    "draw_crack_map",
    "draw_curves",
    "draw_movie",
    "draw_scene",
    "edge_length",
    "legend_of",
    "mesh_edges",
    "new_figure",
    "png_of",
    "save",
    "title_parts",
    "tool_creases",
]
