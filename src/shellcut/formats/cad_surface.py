"""STEP and IGES files, triangulated by Gmsh's OpenCASCADE kernel: :func:`read_cad`.

Gmsh is an optional extra (``pip install 'shellcut[mesh]'``, GPL). Each face has vertices of its
own; :mod:`shellcut.tool.seams` joins them.
"""

from __future__ import annotations

from math import isfinite
from pathlib import Path

from . import cad_process
from .cad_unit import stated_unit
from .errors import FileError, read_bytes
from .own_process import gmsh
from .surface_file import SurfaceFile

SUFFIXES = (".step", ".stp", ".iges", ".igs")
"""Ends of the names of CAD files."""

LARGEST_FILE = 200_000_000
"""Largest size [bytes]; the kernel takes about ten times as much memory."""

_SOLIDS = (b"MANIFOLD_SOLID_BREP", b"BREP_WITH_VOIDS", b"FACETED_BREP")
"""Statements of STEP that make a solid; assemblies repeat them without statements."""

_GMSH = gmsh(
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
    answer = _GMSH.answer(path, repr(float(chord_deviation or 0.0)), repr(float(scale)))
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
