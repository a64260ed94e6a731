"""Numbers in files: parsed more strictly than in Python, which also accepts ``1_000``."""

from __future__ import annotations

_LARGEST = 2**63 - 1


def whole(text: str | bytes) -> int:
    """Return a 64-bit integer; raise ValueError for any other text.

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
    """Return a number; raise ValueError for any other text."""
    return float(_plain(text))


def _plain(text: str | bytes) -> str:
    plain = text.decode("latin-1") if isinstance(text, bytes) else text
    if "_" in plain or not plain.isascii():
        raise ValueError("no number")
    return plain
