"""Sections of the film's mesh, ``[membrane]``."""

from __future__ import annotations

from typing import Any, get_args

from shellcut.mesh.drawing import mesh_from_drawing
from shellcut.mesh.film_file import Quadratic, Triangles, read_film
from shellcut.mesh.outline import mesh_from_outline
from shellcut.mesh.structured import OpeningName, disc, opening_disc, rectangle
from shellcut.models import free_cut, guillotine, opening_test
from shellcut.models.guillotine import strip_of

from .key import (
    Section,
    choice,
    default_of,
    file,
    key,
    length_unit,
    names,
    number,
    numbers,
    polygon,
    polygons,
    section,
    whole,
)

_NOTCH = "length of the cut in which the blade starts"
_CLAMP = "node set or sets that are clamped"


@section("membrane", kind="opening", sign="mesh", of=opening_disc)
class OpeningDisc(Section):
    """The disc of the opening test, radius 10.2 mm, with node sets rim, ring and centre."""

    mesh: str = key(
        choice(*get_args(OpeningName)),
        "612, 2660 or 8625 quads",
        default=default_of(opening_test, "mesh"),
        parameter="name",
    )


@section("membrane", kind="opening", sign="mesh", of=opening_disc)
class FreeOpeningDisc(OpeningDisc):
    """The disc of the opening test, radius 10.2 mm, with node sets rim, ring and centre."""

    clamp: tuple[str, ...] = key(names, _CLAMP, default=())
    notch: float = key(number("mm"), _NOTCH, default=default_of(free_cut, "notch"))


@section("membrane", kind="strip", sign="length", of=strip_of)
class Strip(Section):
    """A strip from x = 0 with its long sides clamped."""

    length: float = key(number("mm"), "along the cut", default=default_of(guillotine, "length"))
    width: float = key(
        number("mm"), "between the clamped sides", default=default_of(guillotine, "width")
    )
    size: float = key(
        number("mm"), "edge length of the quads", default=default_of(guillotine, "size")
    )
    notch: float = key(number("mm"), _NOTCH, default=default_of(guillotine, "notch"))


@section("membrane", kind="rectangle", sign="length", of=rectangle)
class Rectangle(Section):
    """A sheet, x from 0, y about 0, with node sets left, right, bottom and top."""

    length: float = key(number("mm"), "along x")
    width: float = key(number("mm"), "along y")
    size: float = key(number("mm"), "edge length of the quads", default=None, unset="from n_x, n_y")
    n_x: int | None = key(whole, "quads along x", unset="from size")
    n_y: int | None = key(whole, "quads along y", unset="from size")
    clamp: tuple[str, ...] = key(names, _CLAMP, default=())
    notch: float = key(number("mm"), _NOTCH, default=default_of(free_cut, "notch"))


@section("membrane", kind="disc", sign="radius", of=disc)
class Disc(Section):
    """A disc about the origin, with node sets rim and centre and one per ring."""

    radius: float = key(number("mm"), "of the rim")
    n_side: int = key(whole, "quads along a side of the core")
    n_layer: int | None = key(whole, "layers of quads around the core", unset="square quads")
    ring_radii: tuple[float, ...] = key(
        numbers("mm"), "circles on which nodes lie, decreasing", default=()
    )
    clamp: tuple[str, ...] = key(names, _CLAMP, default=())
    notch: float = key(number("mm"), _NOTCH, default=default_of(free_cut, "notch"))


@section("membrane", kind="file", sign="file", of=read_film, deferred=True)
class FilmFile(Section):
    """A mesh of Gmsh, Abaqus, LS-DYNA or VTK, flat in z = 0."""

    file: str = key(file, "the mesh", parameter="path")
    unit: str | float | None = key(
        length_unit,
        "of the file: um, mm, cm, m, inch, mil",
        also="scale",
        unset="guessed and logged",
    )
    clamp: tuple[str, ...] = key(names, _CLAMP, default=("rim",))
    triangles: str = key(choice(*get_args(Triangles)), "what to do with triangles")
    quadratic: str = key(choice(*get_args(Quadratic)), "what to do with quadratic cells")
    leave_out: tuple[str, ...] = key(names, "kinds of other cells to leave out")
    merge: float | None = key(number("mm"), "merge nodes closer than this", unset="no merging")
    max_fold_deg: float = key(number("deg"), "sharpest fold allowed")


@section("membrane", kind="file", sign="file", of=read_film, deferred=True)
class StripFile(FilmFile):
    """A strip of Gmsh, Abaqus, LS-DYNA or VTK, flat in z = 0, cut along y = 0."""

    clamp: tuple[str, ...] = key(
        names, "node sets of the two long sides", default=("bottom", "top")
    )
    notch: float = key(number("mm"), _NOTCH, default=default_of(guillotine, "notch"))


@section("membrane", kind="file", sign="file", of=read_film, deferred=True)
class FreeFile(FilmFile):
    """A mesh of Gmsh, Abaqus, LS-DYNA or VTK."""

    clamp: tuple[str, ...] = key(names, _CLAMP, default=())
    notch: float = key(number("mm"), _NOTCH, default=default_of(free_cut, "notch"))


@section("membrane", kind="outline", sign="outline", of=mesh_from_outline, deferred=True)
class Outline(Section):
    """A mesh of a polygon with holes, made by Gmsh; node sets outline, hole_1, ..."""

    outline: tuple[Any, ...] = key(polygon(), "vertices in order")
    holes: tuple[Any, ...] = key(polygons(), "polygons inside")
    size: float = key(number("mm"), "edge length of the quads")
    clamp: tuple[str, ...] = key(names, _CLAMP, default=("outline",))


@section("membrane", kind="outline", sign="outline", of=mesh_from_outline, deferred=True)
class FreeOutline(Outline):
    """A mesh of a polygon with holes, made by Gmsh; node sets outline, hole_1, ..."""

    clamp: tuple[str, ...] = key(names, _CLAMP, default=())
    notch: float = key(number("mm"), _NOTCH, default=default_of(free_cut, "notch"))


@section("membrane", kind="drawing", sign="drawing", of=mesh_from_drawing, deferred=True)
class DrawnFilm(Section):
    """A mesh of the outline in a drawing, DXF or SVG, by Gmsh; node sets outline, hole_1, ..."""

    drawing: str = key(file, "the drawing", parameter="path")
    size: float = key(number("mm"), "edge length of the quads")
    unit: str | float | None = key(
        length_unit,
        "of the file: um, mm, cm, m, inch, mil",
        unset="stated by the file; guessed and logged",
    )
    layers: tuple[str, ...] = key(names, "layers to read; of SVG labels and ids")
    chord_deviation: float | None = key(
        number("mm"), "of polygons from arcs and splines", unset="1e-4 of the diagonal"
    )
    join: float | None = key(
        number("mm"), "ends of curves closer than this meet", unset="1e-6 of the diagonal"
    )
    clamp: tuple[str, ...] = key(names, _CLAMP, default=("outline",))


@section("membrane", kind="drawing", sign="drawing", of=mesh_from_drawing, deferred=True)
class FreeDrawnFilm(DrawnFilm):
    """A mesh of the outline in a drawing, DXF or SVG, by Gmsh; node sets outline, hole_1, ..."""

    clamp: tuple[str, ...] = key(names, _CLAMP, default=())
    notch: float = key(number("mm"), _NOTCH, default=default_of(free_cut, "notch"))
