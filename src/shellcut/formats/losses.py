"""What of a file is not used, and signs of lost data: gaps in ids, ragged lines, data in comments.

None of these is an error; each becomes a note that is logged.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from .errors import named, read_bytes

_FEW = 3
"""Up to this many of a kind look like slips; more look intended."""
_MANY = 10
_MOST_KINDS = 50
_LONGEST_GAP = 10
"""Longest gap in the ids that looks like a lost part of a file."""

_NUMBERS = re.compile(r"[\s,]*[+-]?[\d.][\d.eE+-]*([\s,]+[+-]?[\d.][\d.eE+-]*){2,}[\s,]*")


def unused_note(counts: Mapping[str, int]) -> list[str]:
    """Return a note on all that a reader of meshes passes over, because no film takes it.

    Examples
    --------
    >>> unused_note({"*ELASTIC": 1, "*BOUNDARY": 2})
    ['not used, a film takes nodes, quads and sets only: 2 *BOUNDARY, 1 *ELASTIC']
    """
    if not counts:
        return []
    names = sorted(counts)
    listed = ", ".join(f"{counts[name]} {name}" for name in names[:_MOST_KINDS])
    more = f" and {len(names) - _MOST_KINDS} more kinds" if len(names) > _MOST_KINDS else ""
    return [f"not used, a film takes nodes, quads and sets only: {listed}{more}"]


def gap_note(what: str, labels: Iterable[int]) -> list[str]:
    """Return a note on ids with even steps except for a few short gaps.

    Examples
    --------
    >>> gap_note("element", [*range(1, 20), *range(21, 40)])
    ['element ids go from 1 to 39 by 1, but after 19 comes 21: is a line lost there?']
    >>> gap_note("element", [1, 5, 19, 40, 41, 50, 62, 77, 78, 90, 95])
    []
    """
    ids = np.unique(np.fromiter(labels, np.int64))
    if len(ids) < _MANY:
        return []
    steps = np.diff(ids)
    step = int(np.median(steps))
    odd = np.flatnonzero(steps != step)
    if not 0 < len(odd) <= _FEW or steps[odd].max() > (_LONGEST_GAP + 1) * step:
        return []
    told = named(f"after {ids[k]} comes {ids[k + 1]}" for k in odd.tolist())
    return [
        f"{what} ids go from {ids[0]} to {ids[-1]} by {step}, but {told}: is a line lost there?"
    ]


def ragged_note(what: str, lines: Sequence[tuple[int, int]]) -> list[str]:
    """Return a note on lines of ids whose number of ids differs from all other lines.

    Each line has its number and the number of ids in it; the last one may be shorter.
    """
    counts = np.array([n for _, n in lines[:-1]])
    if len(counts) < 2:
        return []
    usual = int(np.bincount(counts).argmax())
    odd = np.flatnonzero(counts != usual)
    last = lines[-1][1]
    told = [f"line {lines[k][0]} has {lines[k][1]}" for k in odd.tolist()]
    if last > usual:
        told.append(f"line {lines[-1][0]} has {last}")
    if not 0 < len(told) <= max(1, len(counts) // _FEW):
        return []
    return [f"{what}: its lines have {usual} ids each, but {named(told)}: is something lost?"]


def repeat_note(what: str, ids: Iterable[int]) -> list[str]:
    """Return a note on ids that occur more than once in a list."""
    values, counts = np.unique(np.fromiter(ids, np.int64), return_counts=True)
    again = values[counts > 1]
    return [f"{what} names {named(again.tolist())} more than once"] if len(again) else []


def is_numbers(text: str) -> bool:
    """Whether a comment consists of three or more numbers, like a data line."""
    return bool(_NUMBERS.fullmatch(text))


def comment_note(lines: Sequence[int]) -> list[str]:
    """Return a note on comments that look like lines of data or keywords."""
    if not lines:
        return []
    return [
        f"comments in {len(lines)} lines look like data or keywords that were switched off "
        f"(lines {named(lines)}): they are ignored"
    ]


def end_note(path: Path) -> list[str]:
    """Return a note on a text file without a final line break."""
    last = read_bytes(path)[-1:]
    return [] if last == b"\n" else ["the last line does not end: is the file cut short?"]


def blank_note(what: str, counts: Sequence[int], labels: Sequence[int]) -> list[str]:
    """Return a note on a few entries with fewer numbers than all others.

    There are as many counts as entries; a value that is not given is zero.
    """
    given = np.array(counts)
    if len(given) < _MANY:
        return []
    odd = np.flatnonzero(given < np.median(given))
    if not 0 < len(odd) <= _FEW:
        return []
    told = named(labels[k] for k in odd.tolist())
    return [f"{what} {told} have fewer coordinates than the others; missing ones are 0"]
