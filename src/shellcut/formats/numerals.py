"""Numbers as files write them: stricter than Python, which also takes ``1_000``."""

from __future__ import annotations

_LARGEST = 2**63 - 1


def whole(text: str | bytes) -> int:
    """Return a whole number of 64 bits; raise ValueError for all else.

    Examples
    --------
    >>> whole(" 12 "), whole(b"-3")
    (12, -3)
    """
    value = int(_plain(text))
    if abs(value) > _LARGEST:
        raise ValueError("a number out of range")
    return value


def number(text: str | bytes) -> float:
    """Return a number; raise ValueError for all else."""
    return float(_plain(text))


def _plain(text: str | bytes) -> str:
    plain = text.decode("latin-1") if isinstance(text, bytes) else text
    if "_" in plain or not plain.isascii():
        raise ValueError("no number")
    return plain
