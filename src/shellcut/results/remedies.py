"""What may be done about a doubt of the verdict, chosen by the options of the run.

A remedy is named only if the run has it not yet. What the checks before a run have found (no row of
edges under the path, held nodes on it, a blunt back that presses) has its remedy there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

Options = Mapping[str, Any]
"""``options`` of ``summary.json``, and its other figures."""


class _Remedy(NamedTuple):
    text: str
    is_left: Callable[[Options], bool] = lambda options: True
    """Whether a run with these options could still take it."""


_REMEDIES = {
    "slower": _Remedy("a slower motion"),
    "finer": _Remedy("a finer film near the tool"),
    "damping": _Remedy("less damping"),
    "penalty": _Remedy("a larger Contact.penalty"),
    "film edges": _Remedy("Contact.film_edges = True", lambda o: not o["film_edges"]),
    "shorter edges": _Remedy(
        "edges shorter than half of opening_u",
        lambda o: o["edge_length_mm"] > 0.5 * o["opening_u_mm"],
    ),
    "through quads": _Remedy(
        'cracks through the quads (fracture.path = "free")',
        lambda o: o["path"] == "edges" and not o["only_along_edges"],
    ),
    "more checks": _Remedy(
        "more checks (a smaller fracture.check_every)", lambda o: o["check_every"] > 1
    ),
    "smaller step": _Remedy("a smaller Stepping.safety", lambda o: not o["fixed_step"]),
    "smaller fixed step": _Remedy("a smaller Stepping.fixed", lambda o: o["fixed_step"]),
}
SMALLER_STEP = "smaller step", "smaller fixed step"
"""Of which one is left."""


def remedies(figures: Mapping[str, Any], *names: str) -> str:
    """Return a sentence with those of some remedies that are left, after a space; "" for none.

    What depends on an option that is not in the figures is left out.

    Examples
    --------
    >>> figures = {"edge_length_mm": 0.8, "options": {"opening_u_mm": 4.0, "film_edges": True}}
    >>> remedies(figures, "shorter edges", "film edges", "slower", "finer")
    ' Use a slower motion or a finer film near the tool.'
    """
    options = {**figures, **figures.get("options", {})}
    texts = [_REMEDIES[name].text for name in names if _is_left(_REMEDIES[name], options)]
    if not texts:
        return ""
    *others, last = texts
    return f" Use {', '.join(others)}{' or ' if others else ''}{last}."


def _is_left(remedy: _Remedy, options: Options) -> bool:
    try:
        return remedy.is_left(options)
    except (KeyError, TypeError):  # not recorded, or None: the run has no such thing
        return False
