"""Sections of the tool and its motion: ``[tool]`` and ``[motion]``."""

from __future__ import annotations

from typing import Any

from shellcut.models import guillotine, opening_test
from shellcut.models.guillotine import BLADE_HEIGHT
from shellcut.tool.motion import ScrewMotion, StraightMotion
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.table_motion import TableMotion
from shellcut.tool.tool import Tool
from shellcut.tool.tool_file import read_tool

from .key import (
    Section,
    default_of,
    direction,
    file,
    key,
    length_unit,
    number,
    numbers,
    section,
    text,
    whole,
    whole_numbers,
)

_SHIFT = "moves the tool before the run"
_EDGE_RADIUS = "of the cutting edge; 0: sharp"


class _Shape(Section):
    """A tool of the package, shifted."""

    shift: tuple[float, ...]

    def made(self) -> Tool:
        """Return the tool."""
        tool: Tool = super().made()
        return tool.translated(self.shift) if any(self.shift) else tool


@section("tool", kind="teeth", sign="teeth", of=tooth_ring)
class Teeth(_Shape):
    """A ring of teeth about the z axis that goes down through the film z = 0."""

    teeth: int = key(whole, "number of teeth", parameter="n_teeth")
    radius: float = key(number("mm"), "of the cutting circle")
    edge_inclination_deg: float = key(number("deg"), "inclination of the edge; it rises forward")
    wedge_half_angle_deg: float = key(number("deg"), "in the section parallel to the film")
    half_thickness: float = key(number("mm"), "half the distance of the parallel flanks")
    length: float = key(number("mm"), "from the tip to the back, along the arc")
    relief_deg: float = key(number("deg"), "rise of the bottom from the tip backwards")
    height: float = key(number("mm"), "from the tip to the top")
    tip_clearance: float = key(number("mm"), "of the tip above the film at the start")
    phase_deg: float = key(number("deg"), "angle of the first tip")
    edge_radius: float = key(number("mm"), _EDGE_RADIUS)
    n_arc: int | None = key(
        whole, "segments of each cutting edge", unset="1/700 of half_thickness off the cylinder"
    )
    shift: tuple[float, ...] = key(numbers("mm", count=3), _SHIFT, default=(0.0, 0.0, 0.0))


@section("tool", kind="blade", sign="edge_angle_deg", of=straight_blade)
class Blade(_Shape):
    """A wedge that moves along +x, its edge through the origin."""

    edge_angle_deg: float = key(number("deg"), "inclination of the edge; below 90 it rises forward")
    wedge_half_angle_deg: float = key(number("deg"), "in the section parallel to the film")
    half_thickness: float = key(number("mm"), "half the distance of the parallel flanks")
    length: float = key(number("mm"), "from the edge to the back")
    height: float = key(number("mm"), "from the bottom to the top")
    edge_radius: float = key(number("mm"), _EDGE_RADIUS)
    shift: tuple[float, ...] = key(numbers("mm", count=3), _SHIFT, default=(0.0, 0.0, 0.0))


@section("tool", kind="blade", sign="edge_angle_deg", of=straight_blade)
class StripBlade(Blade):
    """A wedge that moves along +x, its edge opening_u / 80 before the strip."""

    length: float | None = key(  # type: ignore[assignment]
        number("mm"), "from the edge to the back", default=None, unset="as long as the strip"
    )
    height: float = key(number("mm"), "from the bottom to the top", default=BLADE_HEIGHT)

    def arguments(self) -> dict[str, Any]:
        """Return the arguments that are given; the strip sets the others."""
        given = super().arguments()
        return {name: value for name, value in given.items() if value is not None}


@section("tool", kind="file", sign="file", of=read_tool, deferred=True)
class ToolFile(Section):
    """A surface or solids from a CAD program: STL, OBJ, PLY, and with Gmsh STEP, IGES."""

    file: str = key(file, "the tool", parameter="path", also="stl")
    unit: str | float | None = key(
        length_unit,
        "of the file: um, mm, cm, m, inch, mil",
        also="scale",
        unset="stated by STEP and IGES; guessed and logged",
    )
    axis: str | tuple[float, ...] = key(direction, "direction in the file that becomes z")
    shift: tuple[float, ...] = key(numbers("mm", count=3), "moves the tool after that")
    sharp_angle_deg: float = key(number("deg"), "smallest exterior angle of a cutting edge")
    flank_angle_deg: float = key(number("deg"), "largest turn of a flank")
    not_cutting: tuple[int, ...] = key(whole_numbers, "chains found by angle that do not cut")
    edge_radius: float = key(number("mm"), "rounds the cutting edges found; 0: as in the file")
    merge: float | None = key(
        number("mm"),
        "merge vertices closer than this",
        unset="1e-7 of the diagonal; a tenth of chord_deviation",
    )
    chord_deviation: float | None = key(
        number("mm"),
        "of triangles from curved faces of STEP and IGES",
        unset="5e-4 of the diagonal",
    )
    name: str | None = key(text, "of the tool", unset="that of the file")


@section("motion", kind="screw")
class OpeningScrew(Section):
    """The screw of the opening test: about z, downwards, with a ramp over the first 3 %."""

    angle_deg: float = key(
        number("deg", above=0.0),
        "of the whole motion",
        default=default_of(opening_test, "angle_deg"),
    )
    duration: float = key(
        number("s", above=0.0), "of the run", default=default_of(opening_test, "duration")
    )
    pitch: float = key(number("mm"), "advance per turn", default=default_of(opening_test, "pitch"))


@section("motion", kind="straight")
class StripWay(Section):
    """Along the strip, with a ramp over the first 0.1 ms."""

    speed: float = key(
        number("mm/s", above=0.0), "after the ramp", default=default_of(guillotine, "speed")
    )
    slice_ratio: float = key(
        number(),
        "speed of the blade along its edge over that along the strip",
        default=default_of(guillotine, "slice_ratio"),
    )
    travel: float | None = key(
        number("mm", above=0.0),
        "travel of the blade",
        default=default_of(guillotine, "travel"),
        unset="up to 0.625 opening_u before the end of the strip",
    )


@section("motion", kind="screw", sign="angle_deg", of=ScrewMotion.over)
class Screw(Section):
    """Turn about an axis and advance in proportion, from rest."""

    angle_deg: float = key(number("deg"), "of the whole motion")
    duration: float = key(number("s", above=0.0), "of the run")
    pitch: float = key(number("mm"), "advance per turn")
    ramp_fraction: float = key(number(), "part of the duration over which the speed rises")
    axis: tuple[float, ...] = key(numbers(count=3), "direction; the turn is counter-clockwise")
    axis_point: tuple[float, ...] = key(numbers("mm", count=3), "a point of the axis")
    advance: tuple[float, ...] | None = key(
        numbers(count=3), "direction of the advance", unset="against the axis"
    )


@section("motion", kind="straight", sign="direction", of=StraightMotion)
class Straight(Section):
    """Along a line, from rest."""

    direction: tuple[float, ...] = key(numbers(count=3), "of any length")
    speed: float = key(number("mm/s"), "after the ramp")
    ramp: float = key(number("s"), "time over which the speed rises")
    duration: float = key(number("s", above=0.0), "of the run")


@section("motion", kind="table", sign="file", of=TableMotion.read_csv, deferred=True)
class Table(Section):
    """Through poses of a CSV file, with a unit in each heading."""

    file: str = key(file, "time and x, y, z, rx, ry, rz or angle", parameter="path")
    duration: float | None = key(
        number("s", above=0.0), "of the run", default=None, unset="to the last time"
    )
