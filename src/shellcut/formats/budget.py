"""What a file may unfold to: :class:`Budget`.

A few lines can ask for more than a machine holds or a life lasts: ranges of ids, sets of sets,
blocks of blocks, a file that includes another twice which includes a third twice. Readers count
what they make of a file while they make it, and stop at the limits of this table.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from .errors import FileError

LIMITS = {
    "files with those included": 1_000,
    "lines with those of included files": 50_000_000,
    "nodes and elements with those of all instances": 20_000_000,
    "ids in its sets": 50_000_000,
    "elements drawn": 50_000,
    "points of curves": 200_000,
}
"""Most of each kind that a file may make."""

DEEPEST = 50
"""Levels of things within things of their kind: includes, sets, groups, blocks."""

_SHOWN = 10**18  # larger numbers are shown by their power of ten


class Budget:
    """Counts what the reader of one file makes; what is too much or too deep is a FileError.

    Examples
    --------
    >>> Budget(Path("film.inp")).take("ids in its sets", 10**12)
    Traceback (most recent call last):
    ...
    shellcut.formats.errors.FileError: film.inp: it must have 50,000,000 ids in its sets at ...
    """

    def __init__(self, path: Path):
        self.path = path
        self._made: Counter[str] = Counter()

    def take(self, what: str, n: int = 1, remedy: str = "is it the right file?") -> None:
        """Count ``n`` more of a kind of :data:`LIMITS`."""
        self._made[what] += n
        if (made := self._made[what]) > LIMITS[what]:
            shown = f"{made:,}" if made < _SHOWN else f"about 10^{len(str(made)) - 1}"
            raise FileError(
                self.path, f"it must have {LIMITS[what]:,} {what} at most, got {shown}: {remedy}"
            )

    def descend(self, what: str, level: int) -> None:
        """Check the level of something within others of its kind."""
        if level > DEEPEST:
            raise FileError(
                self.path,
                f"{what} must nest to {DEEPEST} levels at most, got more; does one contain itself?",
            )
