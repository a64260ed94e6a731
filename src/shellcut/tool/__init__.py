"""The rigid tool: surface, cutting edges, motion, and the distance of points from it.

May import ``numerics``, ``formats`` and rows below. A tool consists of triangles; some of their
edges may cut.
"""

from .motion import Motion, ScrewMotion, StraightMotion
from .table_motion import TableMotion
from .tool import Tool
from .tool_file import read_tool

__all__ = ["Motion", "ScrewMotion", "StraightMotion", "TableMotion", "Tool", "read_tool"]
