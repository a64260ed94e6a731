"""One frame drawn with one camera, with colours, scale bar and legend."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats, Ints
from shellcut.frame import JOINTED, STRAIGHT, Frame, is_corner, sides_of
from shellcut.unit import shown, with_unit

from ._raster import LAMP, Camera, Canvas, view_axes
from .look import Look, at_corners

OVERSAMPLING = 2  # pixels per side averaged into one, for smooth outlines

MESH_COLOR = (0.1, 0.1, 0.15)
FLANK_COLOR = (0.05, 0.05, 0.05)
CABLE_COLORS = {STRAIGHT: (0.0, 0.75, 1.0), JOINTED: (1.0, 0.55, 0.0)}
_HALO_COLOR = (0.05, 0.05, 0.05)
_RIM_COLOR = (1.0, 1.0, 1.0)  # beside the flanks, which stand out on dark film too
EDGE_COLOR = (0.9, 0.0, 0.1)
TOOL_COLOR = (0.62, 0.64, 0.68)
TOOL_OPACITY = 0.55
PAPER = {"facecolor": "white", "alpha": 0.7, "lw": 0.0, "pad": 1.5}
"""Behind words on a picture."""
_HIDDEN_OPACITY = 0.3  # of edges and cables behind the film
_ROOM_FOR_TOOL = 0.6  # around film and edges, relative to their extent; a longer shaft leaves it


def picture(frame: Frame, camera: Camera, look: Look, limits: tuple[float, float]) -> Floats:
    """Return one frame as an image, shape (height, width, 3), without axes and text.

    limits : ends of the colour scale.
    """
    line = camera.shape[0] / 640.0  # line width grows with the picture
    film, tool = _lit_surfaces(frame, camera, look, limits)
    if look.shows("mesh"):
        mesh = Canvas(camera.shape)
        ends = camera.project(frame.points[mesh_edges(frame.quads)])
        mesh.draw_lines(ends, MESH_COLOR, 0.6 * line)
        film.blend(mesh, 0.35)
    if look.shows("flanks"):
        flanks = camera.project(frame.points[frame.crack_edges.reshape(-1, 2)])
        film.draw_lines(flanks, _RIM_COLOR, 4.2 * line)
        film.draw_lines(flanks + np.array([0.0, 0.0, 8.0 * line]), FLANK_COLOR, 2.2 * line)
    thin = Canvas(camera.shape)
    close = camera.scale * edge_length(frame) > 20.0  # room for a halo around each cable
    if look.shows("cables"):
        _draw_cables(thin, frame, camera, line, close)
    if look.shows("edges"):
        edges = camera.project(frame.edge_points)
        edges[..., 2] += 2.0 * line
        thin.draw_lines(edges, EDGE_COLOR, 3.2 * line if close else 2.4 * line)
    if look.shows("tool"):
        creases = frame.tool_points[tool_creases(frame)]
        tool.draw_lines(camera.project(creases), (0.3, 0.3, 0.33), 1.0 * line)
    # Hidden lines first, so that everything in front of the film covers them.
    film.blend(thin, _HIDDEN_OPACITY, through=True)
    film.blend(tool, TOOL_OPACITY)
    film.blend(thin, 0.9)
    return film.image(OVERSAMPLING)


def _lit_surfaces(
    frame: Frame, camera: Camera, look: Look, limits: tuple[float, float]
) -> tuple[Canvas, Canvas]:
    """Return film and tool, each on a canvas of its own, in the light and shade of one lamp."""
    film, tool = Canvas(camera.shape), Canvas(camera.shape)
    lamp = replace(camera, axes=view_axes(LAMP @ camera.axes, camera.axes[1]))
    seen = Canvas(camera.shape)
    if look.shows("film"):
        rows, columns = _triangles(frame.quads)
        nodes = frame.quads[rows, columns]
        corners = frame.points[nodes]
        values = at_corners(look.field_of(frame), frame, not look.flat)[rows, columns]
        values = (values - limits[0]) / (limits[1] - limits[0])
        normals = _normals(corners, nodes, len(frame.points)) @ camera.axes.T
        film.draw(camera.project(corners), look.colors(), values, normals[nodes])
        seen.draw(lamp.project(corners), np.zeros(3))
    if look.shows("tool"):
        triangles = frame.tool_triangles
        corners = frame.tool_points[triangles]
        flat = np.arange(triangles.size).reshape(-1, 3)  # every face with a normal of its own
        normals = _normals(corners, flat, triangles.size) @ camera.axes.T
        tool.draw(camera.project(corners), np.array(TOOL_COLOR), normals=normals[flat])
        seen.draw(lamp.project(corners), np.zeros(3))
    for canvas in (film, tool):
        canvas.darken(camera, lamp, seen)
    return film, tool


def _draw_cables(canvas: Canvas, frame: Frame, camera: Camera, line: float, close: bool) -> None:
    ends = camera.project(frame.cable_segments)
    width = 2.8 * line if close else 1.6 * line
    if close:
        halo = ends.copy()
        halo[..., 2] -= 6.0 * line  # behind all cables, not only its own
        canvas.draw_lines(halo, _HALO_COLOR, width + 1.8 * line)
    for state, color in CABLE_COLORS.items():
        chosen = ends[frame.cable_state == state]
        chosen[..., 2] += 2.0 * line
        canvas.draw_lines(chosen, color, width)


def _triangles(quads: Ints) -> tuple[Ints, Ints]:
    """Return row and columns of the triangles of all quads, shape (n, 1) and (n, 3)."""
    rows, last = np.nonzero(is_corner(quads)[:, 2:])
    return rows[:, None], np.stack((0 * last, last + 1, last + 2), axis=1)


def _normals(corners: Floats, nodes: Ints, n: int) -> Floats:
    """Return normals of the nodes, of any length, shape (n, 3): sums over their triangles."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    each = np.repeat(normal, 3, axis=0)
    return np.stack([np.bincount(nodes.ravel(), axis, n) for axis in each.T], axis=1)


def whole_camera(
    frames: Sequence[Frame],
    shape: tuple[int, int],
    look: Look,
    balls: Sequence[tuple[Floats, float]] = (),
) -> Camera:
    """Return a camera that shows film and edges of all frames, and the tool near them.

    shape : height and width of the picture [pixel].  balls : centre and radius [mm] of what is to
    be within the picture, too.
    """
    elevation, azimuth = np.radians((look.elevation, look.azimuth))
    level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    axes = view_axes(np.cos(elevation) * level + np.sin(elevation) * up, up)
    parts = [(f.points, f.reference, f.edge_points.reshape(-1, 3)) for f in frames]
    points = np.concatenate([points for part in parts for points in part])
    # A tool's shaft may be many times longer than the film is wide.
    room = _ROOM_FOR_TOOL * np.ptp(points, axis=0).max()
    low, high = points.min(axis=0) - room, points.max(axis=0) + room
    near = [f.tool_points.clip(low, high) for f in frames]
    round_balls = [at + r * sign * axes for at, r in balls for sign in (-1.0, 1.0)]
    across = np.concatenate([points, *near, *round_balls]) @ axes.T
    low, high = across.min(axis=0), across.max(axis=0)
    height, width = (OVERSAMPLING * n for n in shape)
    room = 0.94 * np.array([width, height]) / (high - low)[:2].clip(1e-12)
    return Camera(axes, 0.5 * (low + high) @ axes, look.zoom * float(room.min()), (height, width))


def pixels_of(
    box: tuple[float, float, float, float], size: tuple[float, float], dpi: float
) -> tuple[int, int]:
    """Return height and width in pixels of a box given in fractions of the picture."""
    return round(box[3] * size[1] * dpi), round(box[2] * size[0] * dpi)


def mesh_edges(quads: Ints) -> Ints:
    """Return every side of the quads once, as node ids, shape (n, 2)."""
    return np.unique(np.sort(sides_of(quads), axis=1), axis=0)


def tool_creases(frame: Frame) -> Ints:
    """Return the tool's edges whose faces meet at 20° or more; drawn, they make it look solid."""
    triangles = frame.tool_triangles
    p = frame.tool_points[triangles]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True).clip(1e-30)
    edges = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2), axis=2)
    edges = edges.reshape(-1, 2)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], order // 3
    twice = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    turn = (normal[owner[twice]] * normal[owner[twice + 1]]).sum(axis=1)
    return np.asarray(edges[twice[turn < np.cos(np.radians(20.0))]])


def edge_length(frame: Frame) -> float:
    """Return the median length of the quads' sides [mm]."""
    ends = frame.reference[sides_of(frame.quads)]
    return float(np.median(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)))


def title_parts(frame: Frame) -> list[str]:
    """Return the title of a frame: coordinate, first scalar and time, with units."""
    parts = [f"{frame.coordinate_name} {with_unit(frame.coordinate, frame.coordinate_unit)}"]
    first = list(frame.scalars.items())[:1]
    parts += [f"{name} {with_unit(value, frame.scalar_units[name])}" for name, value in first]
    return [*parts, f"time {1e3 * frame.time:.3f} ms"]


def eight_bit(image: Floats) -> npt.NDArray[np.uint8]:
    """Return red, green and blue in 0..1 as integers up to 255."""
    return np.rint(255.0 * image.clip(0.0, 1.0)).astype(np.uint8)


def show(axes: Any, image: Floats, across: float) -> None:
    """Show an image in axes of its size, with a bar of a round length; ``across``: width [mm]."""
    unit, factor = shown("mm")
    across *= factor
    axes.imshow(eight_bit(image), interpolation="none", aspect="equal")
    axes.set(autoscale_on=False, xticks=[], yticks=[])
    axes.spines[:].set_color("0.75")
    height, width = image.shape[:2]
    decade = 10.0 ** np.floor(np.log10(across / 6.0))
    length = float(decade * max(m for m in (1.0, 2.0, 5.0) if m * decade <= across / 6.0))
    x, y = 0.04 * width, 0.955 * height
    to = x + length / across * width
    axes.plot([x, to], [y, y], color="white", lw=4.5)
    axes.plot([x, to], [y, y], color="black", lw=2.5, solid_capstyle="butt")
    axes.text(
        0.5 * (x + to),
        y - 0.02 * height,
        f"{length:g} {unit}",
        ha="center",
        va="bottom",
        bbox=PAPER,
    )


def add_color_bar(
    figure: Any,
    look: Look,
    limits: tuple[float, float],
    shown: Sequence[Floats],
    box: tuple[float, float, float, float],
    label: str,
) -> None:
    """Add the colour scale, with pointed ends where numbers shown lie beyond it."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    low, high = limits
    below = any((values < low).any() for values in shown)
    above = any((values > high).any() for values in shown)
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max"}
    bar = figure.colorbar(
        ScalarMappable(Normalize(low, high), ListedColormap(look.colors())),
        cax=figure.add_axes(box),
        orientation="horizontal",
        extend=extend.get((below, above), "both"),
    )
    bar.ax.locator_params(nbins=4)  # numbers of five digits stay apart
    bar.set_label(label, labelpad=1)


@dataclass(frozen=True)
class Shown:
    """An entry of the legend."""

    name: str
    part: str
    """One of :data:`PARTS`."""
    color: tuple[float, float, float]
    is_area: bool = False


_LEGEND: tuple[tuple[Shown, Callable[[Frame], Any]], ...] = (
    (Shown("crack flank", "flanks", FLANK_COLOR), lambda f: len(f.crack_edges)),
    (
        Shown("cable, straight", "cables", CABLE_COLORS[STRAIGHT]),
        lambda f: (f.cable_state == STRAIGHT).any(),
    ),
    (
        Shown("cable, bent around the edge", "cables", CABLE_COLORS[JOINTED]),
        lambda f: (f.cable_state == JOINTED).any(),
    ),
    (Shown("cutting edge", "edges", EDGE_COLOR), lambda f: len(f.edge_points)),
    (Shown("tool", "tool", TOOL_COLOR, is_area=True), lambda f: len(f.tool_triangles)),
)
"""Entries of the legend, and whether a frame has such parts."""


def legend_of(frames: Sequence[Frame]) -> list[Shown]:
    """Return the legend entries for the frames."""
    return [shown for shown, is_in in _LEGEND if any(map(is_in, frames))]


def add_legend(figure: Any, frames: Sequence[Frame], look: Look) -> None:
    """Add a legend of what is shown of the frames, in the lower right corner."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles = [
        Patch(color=shown.color, alpha=TOOL_OPACITY, label=shown.name)
        if shown.is_area
        else Line2D([], [], color=shown.color, lw=3, label=shown.name)
        for shown in legend_of(frames)
        if look.shows(shown.part)
    ]
    if handles:
        figure.legend(
            handles=handles,
            loc="lower right",
            bbox_to_anchor=(0.995, 0.025),
            ncols=-(-len(handles) // 2),
            frameon=False,
        )
