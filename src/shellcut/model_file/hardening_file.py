"""A hardening table from a text file: plastic strain and true stress.

::

    plastic strain [-],true stress [MPa]
    0,20.1
    0.01,22.4

Columns are known by the words strain and stress in their headings; without headings the first two
are taken. ``shellcut tensile`` writes such files. More points than a law may have are thinned.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.formats.errors import FileError
from shellcut.formats.number_table import NumberTable, read_number_table
from shellcut.material.hardening import Table
from shellcut.material.hardening_points import fewer_points
from shellcut.unit import conversion

_OTHER = re.compile(r"nominal|\beng|total|technisch", re.I)


@checked
def read_hardening(
    path: Annotated[
        str | Path,
        Option(
            "",
            "table of plastic strain and true stress, as shellcut tensile writes it",
            form="path",
        ),
    ],
) -> Table:
    """Return the hardening in a file.

    FileError if columns or units are not known, or the values are no hardening curve.
    """
    table = read_number_table(path)
    (strain_at, strain_unit), (stress_at, stress_unit) = _columns(table, Path(path))
    rows = table.numbers([strain_at, stress_at])
    strain: Floats = rows[:, 0] * strain_unit
    stress: Floats = rows[:, 1] * stress_unit
    if len(rows) > 2 and not (np.diff(strain) <= 0.0).any():
        strain, stress = fewer_points(strain, stress)
    try:
        return Table(strain, stress)
    except ValueError as problem:
        raise FileError(path, str(problem)) from None


def _columns(table: NumberTable, path: Path) -> tuple[tuple[int, float], tuple[int, float]]:
    if not table.headings:
        return (0, 1.0), (1, 1.0)
    found = {}
    for word in ("strain", "stress"):
        places = [k for k, one in enumerate(table.headings) if word in one.name.lower()]
        if len(places) != 1:
            raise FileError(
                path,
                f"one heading must name the {word}, as 'plastic strain [-]' and 'true stress "
                f"[MPa]', got {', '.join(repr(one.text) for one in table.headings)}",
            )
        found[word] = places[0]
    if wrong := [h.text for h in table.headings if _OTHER.search(h.name)]:
        raise FileError(
            path,
            f"a hardening table must have plastic strains and true stresses, got {wrong[0]!r}; "
            "shellcut tensile makes one of nominal curves",
        )
    factors, problems = [], []
    for word, usual in (("strain", "-"), ("stress", "MPa")):
        try:
            factors.append(conversion(table.headings[found[word]].unit or usual, usual))
        except ValueError as problem:
            problems.append(f"{word} {problem}")
    if problems:
        raise FileError(path, "; ".join(problems))
    return (found["strain"], factors[0]), (found["stress"], factors[1])
