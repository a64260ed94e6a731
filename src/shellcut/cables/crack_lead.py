"""How far a crack runs ahead of a tool: a length that follows from law and tool."""

from __future__ import annotations

from shellcut.tool.tool import Tool

from .cohesive_law import CohesiveLaw

LEAD_OF_OPENING, LEAD_OF_TOOL = 0.75, 5.0
"""A crack is expected to lead by this multiple of the opening at which a cable breaks, or of the
tool's half thickness V / A (about the length of its wedge), whichever is more: a crack runs as far
ahead as the cables or the wedge open it. With the paper's law, openings up to 4 mm, that is 3 mm;
in the guillotine the crack runs ahead by 1.4 mm. The blade opens it backwards too: 1.5 mm behind
the start of a slanted cut, 0.6 mm behind the end of a tooth that comes down flat."""


def crack_lead(tool: Tool, law: CohesiveLaw | None = None) -> float:
    """Return how far a crack may run ahead of a tool, or open behind its first place [mm].

    Examples
    --------
    >>> from shellcut.tool.shapes import straight_blade
    >>> crack_lead(straight_blade())
    3.0
    """
    opening = (law or CohesiveLaw()).opening_u
    return max(LEAD_OF_OPENING * opening, LEAD_OF_TOOL * tool.half_thickness())
