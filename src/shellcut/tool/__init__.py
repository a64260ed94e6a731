"""The rigid tool: its surface, its cutting edges, how it moves, and the distance to it.

May import ``numerics``, ``formats`` and rows below. A tool is triangles; edges of it may cut.
"""

from .motion import Motion, ScrewMotion, StraightMotion
from .table_motion import TableMotion
from .tool import Tool
from .tool_file import read_tool

__all__ = ["Motion", "ScrewMotion", "StraightMotion", "TableMotion", "Tool", "read_tool"]
