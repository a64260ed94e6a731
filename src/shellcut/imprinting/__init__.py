"""The imprint: insert a blade's path into any flat mesh as a line of edges.

May import ``cables``, ``mesh``, ``tool``, ``material``, ``view`` and rows below.
"""

from .blade_path import blade_path
from .film_plane import ImprintError
from .imprint import ImprintResult, imprint, lies_in
from .path_curve import PathCurve

__all__ = [
    "ImprintError",
    "ImprintResult",
    "PathCurve",
    "blade_path",
    "imprint",
    "lies_in",
]
