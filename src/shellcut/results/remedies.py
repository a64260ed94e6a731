"""What may be done about a doubt of the verdict, chosen by the options of the run.

A remedy is named only if the run has it not yet. What the checks before a run have found (no row of
edges under the path, held nodes on it, a blunt back that presses) has its remedy there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

_REMEDIES: dict[str, tuple[str, Callable[[Mapping[str, Any]], bool]]] = {
    "slower": ("a slower motion", lambda o: "quasi_static" not in o),
    "smaller share": ("a smaller quasi_static", lambda o: o["quasi_static"] > 0.0),
    "finer": ("a finer film near the tool", lambda _: True),
    "damping": ("less damping", lambda _: True),
    "penalty": ("a larger contact.penalty", lambda _: True),
    "imperfection": ("imperfection = 1", lambda o: not o["n_imperfection"]),
    "film edges": ("contact.film_edges = true", lambda o: not o["film_edges"]),
    "shorter sides": (
        "quads with sides shorter than half of opening_u",
        lambda o: o["edge_length_mm"] > 0.5 * o["opening_u_mm"],
    ),
    "through quads": (
        'cracks through the quads (fracture.path = "free")',
        lambda o: o["path"] == "edges" and not o["only_along_edges"],
    ),
    "more checks": (
        "more checks (a smaller fracture.check_every)",
        lambda o: o["check_every"] > 1,
    ),
    "smaller step": ("a smaller time.safety", lambda o: not o["fixed_step"]),
    "smaller fixed step": ("a smaller time.fixed", lambda o: o["fixed_step"]),
}
"""Words of each remedy, and whether a run with these figures and options could still take it."""
SLOWER = "slower", "smaller share"
"""Of which one is left."""
SMALLER_STEP = "smaller step", "smaller fixed step"
"""Of which one is left."""


def remedies(figures: Mapping[str, Any], *names: str) -> str:
    """Return a sentence with those of some remedies that are left, after a space; "" for none.

    What depends on an option that is not in the figures, or that the run does not have, is left
    out.

    Examples
    --------
    >>> figures = {"edge_length_mm": 0.8, "options": {"opening_u_mm": 4.0, "film_edges": True}}
    >>> remedies(figures, "shorter sides", "film edges", "slower", "finer")
    ' Use a slower motion or a finer film near the tool.'
    """
    options = {**figures, **figures.get("options", {})}
    texts = []
    for text, is_left in (_REMEDIES[name] for name in names):
        with suppress(KeyError, TypeError):  # an option that is not there, or None
            texts += [text] * bool(is_left(options))
    if not texts:
        return ""
    *others, last = texts
    return f" Use {', '.join(others)}{' or ' if others else ''}{last}."
