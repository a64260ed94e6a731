"""STEP and IGES files, triangulated by Gmsh's OpenCASCADE kernel: :func:`read_cad`.

The kernel uses the definition of a unit of STEP, never by its name: an SI prefix, or a number
of such units (``CONVERSION_BASED_UNIT``). What it cannot resolve it takes for millimetres; such a
file is refused here.

Gmsh is an optional extra (``pip install 'shellcut-fem[mesh]'``, GPL). Each face has vertices of its
own; :mod:`shellcut.tool.surface_repair` joins them.
"""

from __future__ import annotations

import re
from math import inf, isfinite
from pathlib import Path

from . import cad_process
from .errors import FileError, as_file, read_bytes
from .own_process import GmshProcess
from .surface_file import SurfaceFile

SUFFIXES = (".step", ".stp", ".iges", ".igs")
"""Ends of the names of CAD files."""

LARGEST_FILE = 200_000_000
"""Largest size [bytes]; the kernel takes about ten times as much memory."""

_SOLIDS = (b"MANIFOLD_SOLID_BREP", b"BREP_WITH_VOIDS", b"FACETED_BREP")
"""Statements of STEP that make a solid; assemblies repeat them without statements."""

_STEP_BEGINS = b"ISO-10303-21"
_STATEMENT = re.compile(rb"#(\d+)\s*=([^;]*)")
_CONTEXT = re.compile(rb"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\(([^)]*)\)")
_SI = re.compile(rb"\bSI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.METRE\.\s*\)")
# parts in the order of the alphabet, as the standard wants
_NAMED = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'\s*,\s*#(\d+)\s*\)\s*LENGTH_UNIT\b")
_MEASURE = re.compile(rb"MEASURE_WITH_UNIT\s*\(\s*(?:\w+\s*\(\s*)?([^(),]*?)\s*\)?\s*,\s*#(\d+)")

_PREFIXES = {
    **{b"NANO": 1e-6, b"MICRO": 1e-3, b"MILLI": 1.0, b"CENTI": 10.0, b"DECI": 1e2, b"": 1e3},
    **{b"DECA": 1e4, b"HECTO": 1e5, b"KILO": 1e6},
}
# by the flag of the global section; 3 refers to the name that follows it
_IGES_FLAGS = {
    **{1: 25.4, 2: 1.0, 4: 304.8, 5: 1609344.0, 6: 1e3, 7: 1e6, 8: 0.0254, 9: 1e-3, 10: 10.0},
    11: 2.54e-5,
}
_IGES_NAMES = {
    **{"": 1, "IN": 1, "INCH": 1, "MM": 2, "FT": 4, "MI": 5, "M": 6, "KM": 7, "MIL": 8, "UM": 9},
    **{"CM": 10, "UIN": 11},
}
_FLAG = 13  # of the unit, among the parameters of the global section

_GMSH = GmshProcess(
    cad_process.__file__,
    "is it damaged, of a kind that OpenCASCADE cannot read, or chord_deviation too small? write it "
    "anew, or as STL",
    "reading STEP and IGES",
)


def read_cad(
    path: str | Path, chord_deviation: float | None = None, unit_mm: float | None = None
) -> SurfaceFile:
    """Read a STEP or IGES file; the surface is in the unit that the file states.

    Triangles are at most ``chord_deviation`` [mm] off curved faces, by default
    :data:`cad_process.DEVIATION` of the diagonal. The file is read in ``unit_mm`` [mm], if given,
    and not in its own unit. One that states several units is returned in mm, and then there must be
    no ``unit_mm``. A solid with a cavity and solids that touch are refused.
    """
    path = Path(path)
    if chord_deviation is not None and not (isfinite(chord_deviation) and chord_deviation > 0.0):
        raise ValueError(
            f"chord_deviation must be a finite length above 0 in mm, got {chord_deviation!r}"
        )
    content = read_bytes(path, LARGEST_FILE)
    units = stated_unit(path, content)
    listed = " and ".join(f"{unit:g}" for unit in units)
    if len(units) > 1 and unit_mm is not None:
        raise FileError(
            path,
            f"the file states units of {listed} mm, each converted to mm: unit= must not be given, "
            f"got {unit_mm:g} mm",
        )
    of_file = units[0] if len(units) == 1 else 1.0
    scale = (unit_mm or of_file) / of_file
    with as_file(path, content) as file:
        answer = _GMSH.answer(file, repr(float(chord_deviation or 0.0)), repr(float(scale)))
    if len(answer["problems"]):
        raise FileError(path, "; ".join(map(str, answer["problems"])))
    notes = [str(note) for note in answer["notes"]]
    stated = sum(content.count(name + b"(") for name in _SOLIDS)
    if 0 < answer["n_solid"] < stated:
        notes.append(
            f"{stated} solids are in the file, {answer['n_solid']} could be read: is it damaged?"
        )
    if len(units) > 1:
        notes.append(f"the file states units of {listed} mm: all lengths are converted to mm")
    return SurfaceFile(
        path,
        answer["vertices"] / of_file,
        answer["triangles"],
        notes,
        unit_mm=of_file if units else None,
        chord_deviation=float(answer["chord"]) / of_file,
    )


def stated_unit(path: Path, content: bytes) -> list[float]:
    """Return the lengths of all units that a STEP or IGES file states [mm]; usually one.

    FileError if it is neither, or states a unit that the kernel does not know.
    """
    if path.suffix.lower() in (".step", ".stp"):
        if _STEP_BEGINS not in content[:1000]:
            raise FileError(path, f"a STEP file must begin with {_STEP_BEGINS.decode()}")
        return _of_step(path, content)
    lines = content.splitlines()
    if not any(line[72:73] == b"S" for line in lines[:1]):
        raise FileError(path, "an IGES file must have an S in column 73 of its first line")
    return _of_iges(path, b"".join(line[:72] for line in lines if line[72:73] == b"G"))


def _of_step(path: Path, content: bytes) -> list[float]:
    # the units of the contexts; one that only defines another (inches by millimetres) is in none
    of_units = {one[1]: one[2] for one in _STATEMENT.finditer(content) if b"UNIT" in one[2]}
    contexts = [context for text in of_units.values() for context in _CONTEXT.findall(text)]
    used = {tag for context in contexts for tag in re.findall(rb"#(\d+)", context)}
    lengths = set()
    for tag in sorted(used):
        unit, factor, name = of_units.get(tag, b""), 1.0, b""
        if not re.search(rb"\bLENGTH_UNIT\b", unit):
            continue
        if conversion := _NAMED.search(unit):
            name, counted = conversion.groups()
            measure = _MEASURE.search(of_units.get(counted, b""))
            number, base = measure.groups() if measure else (b"0", b"")
            unit = of_units.get(base, b"")
            try:
                factor = float(number)
            except ValueError:
                factor = 0.0
        si = _SI.search(unit)
        length = factor * _PREFIXES.get(si[1] or b"", 0.0) if si else 0.0
        if not 0.0 < length < inf:
            called = f" {name.decode('latin-1')!r}" if name else ""
            raise FileError(
                path,
                f"its unit of length{called}, #{tag.decode()}, must be a metre with a prefix, or "
                "a number of these above 0: OpenCASCADE reads other units as mm; write the file "
                "in mm",
            )
        lengths.add(float(f"{length:.12g}"))  # 0.0254 of a metre is 25.4 mm
    return sorted(lengths)


def _of_iges(path: Path, section: bytes) -> list[float]:
    text = section.decode("ascii", errors="replace")
    values: list[str] = []
    separator, at = ",", 0
    # Parameters are texts, written 4Habcd, or numbers; the first one is the separator itself.
    while at < len(text) and len(values) <= _FLAG + 1:
        if string := re.match(r"\s*(\d+)H", text[at:]):
            start = at + string.end()
            value = text[start : start + int(string[1])]
            at = start + int(string[1]) + 1
        else:
            ends = text.find(separator, at), text.find(";", at), len(text)
            end = min(k for k in ends if k >= 0)
            value, at = text[at:end].strip(), end + 1
        if not values and string:
            separator = value
        values.append(value)
    flag, name = [*values[_FLAG : _FLAG + 2], "", ""][:2]
    number = int(flag) if flag.isdecimal() else 3
    if number == 3:
        number = _IGES_NAMES.get(name.strip().upper(), 0)
    if number not in _IGES_FLAGS:
        raise FileError(
            path,
            f"the flag of its unit must be 1 to {max(_IGES_FLAGS)}, or 3 with a name among "
            f"{', '.join(filter(None, _IGES_NAMES))}, got {flag!r} and {name.strip()!r}: "
            "OpenCASCADE reads others as mm; write the file in mm",
        )
    return [_IGES_FLAGS[number]]
