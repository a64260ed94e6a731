"""What a checkpoint keeps of an object: some of its attributes, by their names.

Such an attribute is an array, a number, a table of arrays, or an object that keeps something
itself, by ``saved`` and ``restore``. An attribute that is None keeps nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy
from typing import Any, ClassVar

import numpy as np


class Kept:
    """An object that keeps the attributes in ``kept_names``, and nothing else.

    Examples
    --------
    >>> class Counter(Kept):
    ...     kept_names = ("_count",)
    ...     def __init__(self):
    ...         self._count = 0
    >>> counter = Counter()
    >>> counter.restore({"count": 3})
    >>> counter.saved()
    {'count': 3}
    """

    kept_names: ClassVar[tuple[str, ...]] = ()

    def saved(self) -> dict[str, Any]:
        """Return what it keeps: arrays of its own, not copies."""
        return saved_of(self, self.kept_names)

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take over :meth:`saved`."""
        take_over(self, self.kept_names, saved)


def saved_of(owner: object, names: Iterable[str]) -> dict[str, Any]:
    """Return some attributes as a checkpoint keeps them, without the underscores before them."""
    return {name.lstrip("_"): _saved(getattr(owner, name)) for name in names}


def take_over(owner: object, names: Iterable[str], saved: Mapping[str, Any]) -> None:
    """Give attributes the values of :func:`saved_of`.

    Objects with ``restore`` stay the same objects.

    Raises
    ------
    ValueError
        If the rows of an array of a table have another shape.
    """
    for name in names:
        value = _restored(name, getattr(owner, name), saved[name.lstrip("_")])
        setattr(owner, name, value)


def _saved(value: Any) -> Any:
    if hasattr(value, "saved"):
        return value.saved()
    if hasattr(value, "_asdict"):
        return value._asdict()
    return {} if value is None else value


def _restored(name: str, now: Any, saved: Any) -> Any:
    """Return what an attribute is with saved content; ``now`` is what it is before."""
    if hasattr(now, "restore"):
        now.restore(saved)
        return now
    if hasattr(now, "_asdict"):
        if hasattr(now, "take"):  # its arrays stay in their places, for kernels
            now.take(saved)
            return now
        for field, rows in now._asdict().items():
            wanted, got = np.shape(rows), np.shape(saved[field])
            if wanted[1:] != got[1:]:
                raise ValueError(f"{name}.{field} must have rows of shape {wanted[1:]}, got {got}")
        return type(now)(**{field: copy(rows) for field, rows in saved.items()})
    return None if now is None else copy(saved)
