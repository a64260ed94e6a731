"""What a history would say of edges that cut steadily, made up."""

import numpy as np

SPACING, ZONE, ARC = 0.4, 2.0, 14.8
_NAMES = ("cut_length", "process_zone", "uncut_ahead", "to_spare")


def edge(x, *, rate=0.18, spacing=SPACING, zone=ZONE, arc=ARC, begins=0.0, leaves=np.inf):
    """Return what the history says of an edge that cuts ``rate`` mm a unit of x, in steps.

    Cables break a zone behind it.
    """
    cut = np.clip(rate * (np.minimum(x, leaves) - begins), 0.0, arc)
    met = np.floor(cut / spacing + 1e-9) * spacing
    broken = np.floor(np.maximum(cut - zone, 0.0) / spacing + 1e-9) * spacing
    ahead = np.where(met > 0.0, arc - met, 0.0)
    spare = np.where(met > 0.0, 1.0, 0.0)
    return met, met - broken, ahead, spare


def edge_columns(edges):
    """Return the columns of edges by their names in the history."""
    return {
        f"{name}_edge_{k}": column
        for k, columns in enumerate(edges, start=1)
        for name, column in zip(_NAMES, columns, strict=True)
    }
