"""State of a film: all arrays that change in time, and the rule after a split.

May import ``numerics`` and the layers below.
"""

from .film import KnownTopology, OncePerTopology, SplitRecord, State
from .tables import (
    BROKEN,
    JOINTED,
    NOT_MET,
    NOTCH,
    PUNCTURE,
    RESERVE,
    STRAIGHT,
    TEAR,
    CableTable,
    FlankTable,
    KernelNodes,
    NodeTable,
    QuadsAtNodes,
    QuadTable,
    columns,
    local_edge_length,
)

__all__ = [
    "BROKEN",
    "JOINTED",
    "NOTCH",
    "NOT_MET",
    "PUNCTURE",
    "RESERVE",
    "STRAIGHT",
    "TEAR",
    "CableTable",
    "FlankTable",
    "KernelNodes",
    "KnownTopology",
    "NodeTable",
    "OncePerTopology",
    "QuadTable",
    "QuadsAtNodes",
    "SplitRecord",
    "State",
    "columns",
    "local_edge_length",
]
