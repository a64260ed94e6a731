"""Read a tool from a file of a CAD program: :func:`read_tool`.

Assumptions and repairs are logged as warnings by the logger ``shellcut.tool_file``; Python shows
them by default.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import product, three
from shellcut.formats import cad_surface
from shellcut.formats.errors import FileError, check_finite, naming, point_text
from shellcut.formats.file_axis import FileAxis, turn_to_z
from shellcut.formats.length_unit import FileUnit, unit_in_mm
from shellcut.formats.obj import read_obj
from shellcut.formats.ply import read_ply
from shellcut.formats.stl import read_stl
from shellcut.formats.surface_file import SurfaceFile

from .rounded_edge import EdgeRadius, with_edge_radius
from .surface_repair import closed_seams, repaired
from .tool import Tool, ToolError

_log = logging.getLogger("shellcut.tool_file")

READERS: dict[str, Callable[[str | Path], SurfaceFile]]
READERS = {".stl": read_stl, ".obj": read_obj, ".ply": read_ply}
"""Reader of triangles by suffix of the file name; Gmsh makes those of STEP and IGES."""

_WELD = 0.1
"""Vertices of CAD faces closer than this part of the chord deviation are one: each face's vertices
lie on its own surface, beside the common edge by the file's tolerance."""

_FARTHEST = 1e5
"""A vertex this many times farther from the middle than most is an error in the file."""

CuttingEdges: TypeAlias = Literal["by angle", "none"]


@checked
def read_tool(
    path: Annotated[str | Path, Option("", "the tool; its suffix gives the format", form="path")],
    *,
    unit: FileUnit = None,
    axis: FileAxis = "z",
    shift: Annotated[
        Sequence[float], Option("mm", "translation of the tool, after axis", form="3 numbers")
    ] = (0.0, 0.0, 0.0),
    sharp_angle_deg: Annotated[
        float, Option("deg", "smallest exterior angle of a cutting edge, 180 minus its wedge angle")
    ] = 100.0,
    flank_angle_deg: Annotated[float, Option("deg", "largest angle by which a flank turns")] = 40.0,
    edges: Annotated[
        CuttingEdges,
        Option(
            "",
            "which edges cut: those that are sharp by their angle, or none; a tool without "
            "cutting edges only presses",
        ),
    ] = "by angle",
    not_cutting: Annotated[
        Collection[int],
        Option(
            "",
            "numbers of cutting edges that should not cut, counted from 0 over all that could",
            form="whole numbers",
        ),
    ] = (),
    edge_radius: EdgeRadius = 0.0,
    merge: Annotated[
        float | None,
        Option(
            "mm",
            "vertices closer than this are merged",
            unset="1e-7 of the diagonal; a tenth of chord_deviation",
        ),
    ] = None,
    chord_deviation: Annotated[
        float | None,
        Option(
            "mm",
            "largest distance of triangles from curved faces of STEP and IGES",
            unset="5e-4 of the diagonal",
        ),
    ] = None,
    name: Annotated[str | None, Option("", "name of the tool", unset="that of the file")] = None,
) -> Tool:
    """Read a tool: STL, OBJ or PLY; STEP or IGES with Gmsh (extra ``mesh``).

    Between ``sharp_angle_deg`` = 90 (the borders of a machined block) and 120 only the teeth of a
    cap are found; :meth:`Tool.from_triangles` says what the angles are, :meth:`Tool.chains` the
    numbers. Each solid of STEP and IGES becomes a body. A warning says which unit was taken.

    Returns
    -------
    Tool

    Raises
    ------
    FileError
        For a file that cannot be read; of STEP also for solids with cavities.
    ToolError
        For a surface with holes (listed with place and size), without an inside, or without a sharp
        edge, and for bodies that touch or overlap.
    ImportError
        For STEP and IGES if Gmsh is missing.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from shellcut.tool.shapes import tooth_ring
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "cap.stl"
    >>> tooth_ring().write(path)
    >>> tool = read_tool(path, unit="mm")
    >>> tool.n_body, [round(chain.length, 3) for chain in tool.chains()]
    (4, [5.773, 5.773, 5.773, 5.773])
    """
    path = Path(path)
    move = three("shift", shift, "mm")
    turn = turn_to_z(axis)
    file = _surface(path, chord_deviation, unit)
    _check_coordinates(file)
    extent = float(np.ptp(file.vertices, axis=0).max())
    with naming(path):
        factor, note = unit_in_mm(unit, extent, "the tool", stated=file.unit_mm)
        vertices, triangles = product(factor * file.vertices, turn.T) + move, file.triangles
        if file.chord_deviation is not None:
            reach = factor * file.chord_deviation
            merge = _WELD * reach if merge is None else merge
            vertices, triangles = closed_seams(vertices, triangles, merge=merge, reach=reach)
        done = repaired(vertices, triangles, tolerance=merge)
    for said in [*file.notes, *([note] if note else []), *done.notes]:
        _log.warning("%s: %s", path, said)
    try:
        if done.problems:
            raise ToolError(done.problems)
        tool = Tool.from_triangles(
            done.vertices,
            done.triangles,
            edges="none" if edges == "none" else None,
            sharp_angle_deg=sharp_angle_deg,
            flank_angle_deg=flank_angle_deg,
            name=path.name if name is None else name,
        )
        if not_cutting:
            tool = tool.without_cutting(*not_cutting)
        tool = with_edge_radius(tool, edge_radius)
    except ToolError as refusal:
        raise ToolError(list(refusal.problems), what=f"surface in {path}") from None
    if chains := tool.chains():
        _log.warning(
            "%s: %d cutting edges found by angle, %.4g mm in all, of %d bodies; not_cutting "
            "leaves out some of:\n%s",
            path,
            len(chains),
            sum(chain.length for chain in chains),
            tool.n_body,
            "\n".join(f"  {chain}" for chain in chains),
        )
    return tool


def _surface(path: Path, chord_deviation: float | None, unit: str | float | None) -> SurfaceFile:
    suffix = path.suffix.lower()
    if suffix in cad_surface.SUFFIXES:
        with naming(path):
            given = unit_in_mm(unit, 1.0, "the tool")[0] if unit is not None else None
        return cad_surface.read_cad(path, chord_deviation, given)
    if suffix not in READERS:
        known = ", ".join((*READERS, *cad_surface.SUFFIXES))
        raise FileError(path, f"the name must end in one of {known}")
    if chord_deviation is not None:
        raise FileError(path, "chord_deviation is for STEP and IGES: this file has triangles")
    return READERS[suffix](path)


def _check_coordinates(file: SurfaceFile) -> None:
    check_finite(file.path, file.vertices, "vertex {}".format)
    away = np.abs(file.vertices - np.median(file.vertices, axis=0)).max(axis=1)
    if away.max() > _FARTHEST * np.median(away):
        k = int(np.argmax(away))
        raise FileError(
            file.path,
            f"vertices must lie together, got vertex {k} at {point_text(file.vertices[k])}, "
            f"{away[k] / np.median(away):.2g} times as far away as most; is the file damaged?",
        )
