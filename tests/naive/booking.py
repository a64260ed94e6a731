"""What a force term adds to the energy balance, entry by entry."""

from shellcut.tool.touch import ON_TOOL


def book(term, entries, on_tool):
    """Add what a term did in its last evaluation; on_tool : work of its wrench on the tool."""
    for entry, column, factor in term.booked:
        entries[entry] += factor * (on_tool if column == ON_TOOL else term.touch.sums[column])
