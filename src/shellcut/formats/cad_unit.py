"""The unit of length that a STEP or IGES file states."""

from __future__ import annotations

import re
from pathlib import Path

from .errors import FileError
from .length_unit import MILLIMETRES

_STEP_BEGINS = b"ISO-10303-21"
_LENGTH = re.compile(rb"#(\d+)\s*=\s*\(?.*\bLENGTH_UNIT\b", re.S)
_CONTEXT = re.compile(rb"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\(([^)]*)\)")
_SI = re.compile(rb"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.METRE\.\s*\)")
_NAMED = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", re.S)

_PREFIXES = {b"": 1e3, b"DECI": 1e2, b"CENTI": 10.0, b"MILLI": 1.0, b"MICRO": 1e-3, b"KILO": 1e6}
_NAMES = {
    **dict.fromkeys((b"INCH", b"INCHES", b"IN"), MILLIMETRES["inch"]),
    **dict.fromkeys((b"FOOT", b"FEET", b"FT"), 304.8),
    **dict.fromkeys((b"MIL", b"THOU"), MILLIMETRES["mil"]),
}
# by the flag of the global section; 3 refers to the name that follows it
_IGES_FLAGS = {1: 25.4, 2: 1.0, 4: 304.8, 6: 1e3, 8: 0.0254, 9: 1e-3, 10: 10.0, 11: 2.54e-5}
_IGES_NAMES = {"IN": 1, "INCH": 1, "MM": 2, "FT": 4, "M": 6, "MIL": 8, "UM": 9, "CM": 10}
_FLAG = 13  # of the unit, among the parameters of the global section


def stated_unit(path: Path, content: bytes) -> list[float]:
    """Return the lengths of all units that a STEP or IGES file states [mm]; usually one.

    Raises
    ------
    FileError
        If it is neither STEP nor IGES.
    """
    if path.suffix.lower() in (".step", ".stp"):
        if _STEP_BEGINS not in content[:1000]:
            raise FileError(path, f"a STEP file must begin with {_STEP_BEGINS.decode()}")
        return _of_step(content)
    lines = content.splitlines()
    if not any(line[72:73] == b"S" for line in lines[:1]):
        raise FileError(path, "an IGES file must have an S in column 73 of its first line")
    return _of_iges(b"".join(line[:72] for line in lines if line[72:73] == b"G"))


def _of_step(content: bytes) -> list[float]:
    # the units of the contexts; one that only defines another (inches by millimetres) is in none
    lengths: dict[bytes, float] = {}
    used: set[bytes] = set()
    for statement in content.split(b";"):
        if b"GLOBAL_UNIT_ASSIGNED_CONTEXT" in statement:
            for context in _CONTEXT.findall(statement):
                used |= set(re.findall(rb"#(\d+)", context))
        elif b"LENGTH_UNIT" in statement and (found := _LENGTH.search(statement)):
            if si := _SI.search(statement):
                lengths[found[1]] = _PREFIXES.get(si[1] or b"", 0.0)
            elif name := _NAMED.search(statement):
                lengths[found[1]] = _NAMES.get(name[1].strip().upper(), 0.0)
    return sorted({length for tag, length in lengths.items() if tag in used and length})


def _of_iges(section: bytes) -> list[float]:
    text = section.decode("ascii", errors="replace")
    values: list[str] = []
    separator, at = ",", 0
    # Parameters are texts, written 4Habcd, or numbers; the first one is the separator itself.
    while at < len(text) and len(values) <= _FLAG + 1:
        held = re.match(r"\s*(\d+)H", text[at:])
        if held:
            start = at + held.end()
            value = text[start : start + int(held[1])]
            at = start + int(held[1]) + 1
        else:
            end = min(
                k for k in (text.find(separator, at), text.find(";", at), len(text)) if k >= 0
            )
            value, at = text[at:end].strip(), end + 1
        if not values and held:
            separator = value
        values.append(value)
    if len(values) <= _FLAG or not values[_FLAG].isdecimal():
        return []
    flag = int(values[_FLAG])
    if flag == 3 and len(values) > _FLAG + 1:
        flag = _IGES_NAMES.get(values[_FLAG + 1].strip().upper(), 0)
    return [_IGES_FLAGS[flag]] if flag in _IGES_FLAGS else []
