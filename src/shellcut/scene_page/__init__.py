"""A run as one HTML page with a scene to turn, play and read values from, drawn by three.js.

May import ``results``, ``view`` and the layers below.
"""

from .page import ScenePage, packed_scene, scene_scripts, spread, view_html

__all__ = [
    "ScenePage",
    "packed_scene",
    "scene_scripts",
    "spread",
    "view_html",
]
