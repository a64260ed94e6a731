"""Which columns of a table hold strain and stress: :func:`specimen_columns`.

docs/howto/tensile.md says which are taken. Where several columns may be the same quantity, the
error names them and asks.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from shellcut.formats.errors import FileError
from shellcut.formats.number_table import Heading, NumberTable
from shellcut.unit import dimension

Choice = str | Sequence[str | int] | None

_STRAIN = (
    r"strain|dehn|elong|exten|^ext$|d[eé]form|^def$|verform|allong|allung|alarg|alongam"
    r"|^ε|^eps|^e$"
)
_NAMED = {
    kind: re.compile(words)
    for kind, words in {
        "ratio": _STRAIN,
        "length": _STRAIN + r"|displac|^displ?$|travel|traverse|stroke|hub$|^cross|querhaupt"
        r"|position|deflect|distance|^weg|weg$|verläng|längenänd|verschieb|^way$|^path$|^δl$|^dl$"
        r"|course|recorrido|corsa|d[eé]plac|desplaz|spostam|desloc",
        "stress": r"stress|spannung|contrainte|tensi[oó]n|tens[aã]o|esfuerzo|sforzo"
        r"|^σ|^sigma|^sig$|^s$|^r$",
        "force": r"force|kraft|load|^last$|prüflast|belast|^pull|^tension$|fuerza|carga|forza"
        r"|for[cç]a|charge|carico|^f$|^p$",
    }.items()
}
# These make another quantity of it: across the specimen, a rate, a single figure, a set value.
_OTHER = re.compile(
    r"rate$|speed|veloc|geschw|transv|lateral|quer(?!haupt)|width|breite|thick|dick|shear|schub"
    r"|plast|yield|streck|^peak|^max|^min|^mean|break|bruch|rupture|^at$|^bei$|setp|command|soll"
    r"|target|pre.?load|vorkraft|limit|error|drive|output|modul|energy|poisson|compress|friction"
    r"|reib|grip|clamp|spannkraft|tare|offset|residual|amplitud"
)
_TRUE = re.compile(r"true|wahr|cauchy|hencky|^log|vrai|verdader")
_MARK = re.compile(r"\d+|[a-d]|md|cd|td|°")
_LABEL = re.compile(_MARK.pattern + r"|specimen|sample|probe|prüfling|test|versuch|no|nr")
# Several of these are sensors of one specimen.
_SENSOR = re.compile(r"cell|channel|kanal|sensor|gauge|extensom|transduc|camera|aufnehmer")
_WORD = re.compile(r"[^\W\d_]+|\d+|°")
_KINDS = {"ratio": "strain", "length": "extension", "stress": "stress", "force": "force"}
_BY_NUMBER = 'choose by heading or number, as columns="1, 2"'


@dataclass(frozen=True)
class Column:
    """One column of a table and what it holds."""

    index: int
    heading: Heading
    unit: str
    """Given, or that of the heading; may be empty."""

    @property
    def dimension(self) -> str | None:
        """Dimension of the unit, None if it is unknown or missing."""
        return dimension(self.unit)

    @property
    def true(self) -> bool:
        """Whether it holds true stresses or strains."""
        return any(map(_TRUE.match, self._words))

    @property
    def _words(self) -> list[str]:
        name = self.heading.name
        return [] if name == self.heading.unit else _WORD.findall(name.replace("-", "").casefold())

    @property
    def core(self) -> tuple[str, ...]:
        """Words of the name without the labels of specimens."""
        return tuple(word for word in self._words if not _LABEL.fullmatch(word))

    @property
    def rest(self) -> tuple[str, ...]:
        """Words of the name without those that say what is measured."""
        return tuple(word for word in self._words if not self._is_said_by(word))

    def _is_said_by(self, word: str) -> bool:
        return _NAMED[str(self.dimension)].search(word) is not None

    @property
    def agrees(self) -> bool:
        """Whether name and unit say the same."""
        if self.dimension not in _NAMED or any(map(_OTHER.search, self._words)):
            return False
        if self.core:
            return any(map(self._is_said_by, self.core))
        # labels of a specimen, or a unit alone; a number of rows is neither
        bare = self.heading.name == self.heading.unit not in ("", "-")
        return bare or any(map(_MARK.fullmatch, self._words))


def specimen_columns(
    table: NumberTable, columns: Choice = None, units: str | Sequence[str] | None = None
) -> list[tuple[Column, Column]]:
    """Return the columns of strain (or extension) and stress (or force) that belong together.

    Columns are given by heading or number from 1; by default those are taken that names and units
    tell. Units are of these columns, or of strain and stress, or of all columns of the table; empty
    ones are those of the headings.
    """
    found = _with_units(table, _chosen(table, columns), columns is not None, units)
    if columns is not None:
        if unknown := [one for one in found if one.dimension not in _NAMED]:
            raise FileError(table.path, "; ".join(_no_unit(table, one) for one in unknown))
        strains, stresses = _of(found, "ratio", "length"), _of(found, "stress", "force")
    else:
        named = [one for one in found if one.agrees or not table.headings]
        strains = _of(named, "ratio") or _of(named, "length")
        stresses = _of(named, "stress") or _of(named, "force")
        strains, stresses = _nominal(strains), _nominal(stresses)
    if not strains or not stresses:
        raise FileError(table.path, _missing(table, found, strains, stresses))
    if columns is None and (said := _competing(strains, stresses)):
        pair = f"{strains[0].index + 1}, {stresses[0].index + 1}"
        raise FileError(table.path, f'{said}; choose, as columns="{pair}"')
    if len(strains) == 1:
        strains = strains * len(stresses)
    if len(strains) != len(stresses):
        raise FileError(
            table.path,
            f"every stress must have its strain, or all the same one, got {len(strains)} columns "
            f"of strain and {len(stresses)} of stress: {table.listing()}; {_BY_NUMBER}",
        )
    if by_rest := _by_rest(strains, stresses):
        return [(one, by_rest[one.rest]) for one in strains]
    return list(zip(strains, stresses, strict=True))


def _chosen(table: NumberTable, columns: Choice) -> list[int]:
    if columns is None:
        return list(range(table.n_column))
    found, problems = [], []
    for which in _parts(columns):
        try:
            found.append(table.column(which))
        except ValueError as problem:
            problems.append(str(problem))
    if problems:
        raise FileError(table.path, "; ".join(problems))
    return list(dict.fromkeys(found))


def _parts(given: str | Sequence[str | int]) -> list[str | int]:
    # headings with a comma are separated by semicolons
    if isinstance(given, str):
        return [part.strip() for part in given.split(";" if ";" in given else ",")]
    return list(given)


def _with_units(
    table: NumberTable, chosen: list[int], by_hand: bool, units: str | Sequence[str] | None
) -> list[Column]:
    headings = table.headings or (Heading("", "", ""),) * table.n_column
    columns = [Column(k, headings[k], headings[k].unit) for k in chosen]
    if units is None:
        return columns
    given = [str(unit) for unit in _parts(units)]
    if wrong := [unit for unit in given if unit and not dimension(unit)]:
        raise ValueError(f'units must be known, as "%, MPa", got {", ".join(map(repr, wrong))}')
    if len(given) == len(columns):
        each = [
            Column(one.index, one.heading, unit or one.unit)
            for one, unit in zip(columns, given, strict=True)
        ]
        if by_hand or len(each) > 2 or not table.headings or all(one.agrees for one in each):
            return each
    if by_hand or len(given) != 2:
        two = "" if by_hand else ", or two, of strain and stress"
        raise FileError(
            table.path,
            f"units must be {len(columns)}, one for each column{two}, got {len(given)}",
        )
    # each unit where the name agrees with it, and no other dimension is written
    for k, one in enumerate(columns):
        for unit in given:
            told = Column(one.index, one.heading, unit)
            if one.dimension in (None, told.dimension) and one._words and told.agrees:
                columns[k] = told
    return columns


def _of(columns: list[Column], *dimensions: str) -> list[Column]:
    return [one for one in columns if one.dimension in dimensions]


def _nominal(columns: list[Column]) -> list[Column]:
    return [one for one in columns if not one.true] or columns


def _competing(strains: list[Column], stresses: list[Column]) -> str:
    # Several columns are several specimens if labels tell them apart, or if what else the names
    # of strain and stress say does.
    if len(strains) == len(stresses) == 1 or _by_rest(strains, stresses):
        return ""
    said = []
    for columns, others in ((strains, stresses), (stresses, strains)):
        alike = len({one.core for one in columns}) == 1
        apart = len({one.rest for one in columns}) == len(columns)
        in_pairs = alike and len(columns) == len(others)
        sensors = any(_SENSOR.search(word) for word in columns[0].core)
        serves_all = alike and apart and columns is stresses and len(strains) == 1 and not sensors
        if len(columns) > 1 and not (in_pairs or serves_all):
            names = " or ".join(f"{one.index + 1}: {one.heading.text!r}" for one in columns)
            said.append(f"the {_KINDS[str(columns[0].dimension)]} may be column {names}")
    return "; ".join(said)


def _by_rest(strains: list[Column], stresses: list[Column]) -> dict[tuple[str, ...], Column]:
    # stresses by what strains are called too, where that tells all of them apart
    by_rest = {one.rest: one for one in stresses}
    rests = [one.rest for one in strains]
    told = len(by_rest) == len(stresses) and sorted(by_rest) == sorted(rests)
    return by_rest if told else {}


def _no_unit(table: NumberTable, one: Column) -> str:
    name = repr(table.name(one.index))
    if not one.unit:
        return f'the unit of {name} must be given, as --units "%, MPa"'
    return (
        f"{name} must have a unit of strain (%, -), extension (mm), stress (MPa) or force (N), "
        f"got {one.unit!r}"
    )


def _missing(
    table: NumberTable, found: list[Column], strains: list[Column], stresses: list[Column]
) -> str:
    wanted = " and ".join(
        what
        for what, have in (
            ("a column of strain (%, -) or extension (mm)", strains),
            ("one of stress (MPa) or force (N)", stresses),
        )
        if not have
    )
    unknown = [
        one
        for one in found
        if one.dimension is None
        and any(pattern.search(word) for word in one.core for pattern in _NAMED.values())
    ]
    units = ' and give units="%, MPa"' if unknown or not table.headings else ""
    return (
        f"a tensile test needs {wanted}, told by name and unit of its heading; there are "
        f"{table.listing()}; {_BY_NUMBER}{units}"
    )
