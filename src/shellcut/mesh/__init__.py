"""The film as quadrilaterals: read from a file, made from an outline or on a grid, and checked.

May import ``numerics``, ``formats`` and rows below.
"""

from .checks import MeshError
from .drawing import mesh_from_drawing, read_drawing
from .film_file import read_film
from .mesh import Mesh
from .outline import mesh_from_outline

__all__ = [
    "Mesh",
    "MeshError",
    "mesh_from_drawing",
    "mesh_from_outline",
    "read_drawing",
    "read_film",
]
