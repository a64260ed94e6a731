"""One frame drawn with one camera, with colours, scale bar and legend."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats, Ints
from shellcut.frame import JOINTED, STRAIGHT, Frame, is_corner, sides_of

from ._figure import with_unit
from ._raster import Camera, Canvas, shade, view_axes

OVERSAMPLING = 2  # pixels per side averaged into one, for smooth outlines

MESH_COLOR = (0.1, 0.1, 0.15)
FLANK_COLOR = (0.05, 0.05, 0.05)
CABLE_COLORS = {STRAIGHT: (0.0, 0.75, 1.0), JOINTED: (1.0, 0.55, 0.0)}
_HALO_COLOR = (0.05, 0.05, 0.05)
EDGE_COLOR = (0.9, 0.0, 0.1)
TOOL_COLOR = (0.62, 0.64, 0.68)
TOOL_OPACITY = 0.55
_HIDDEN_OPACITY = 0.3  # of edges and cables behind the film
_VIEW = (48.0, -60.0)
"""Elevation above the x-y plane and azimuth from the x axis, camera of the whole film [deg]."""
_ROOM_FOR_TOOL = 0.05  # margin around film and edges, relative to their extent


def picture(frame: Frame, camera: Camera, quad_colors: Floats) -> Floats:
    """Return one frame as an image, shape (height, width, 3), without axes and text."""
    axes = camera.axes
    line = camera.shape[0] / 640.0  # line width grows with the picture
    canvas = Canvas(camera.shape)
    quads = frame.points[frame.quads]
    corners = camera.project(quads)
    color = shade(quads, axes, quad_colors)
    own = is_corner(frame.quads)
    for k in range(2, corners.shape[1]):
        canvas.draw(corners[own[:, k]][:, [0, k - 1, k]], color[own[:, k]])

    mesh = Canvas(camera.shape)
    mesh.draw_lines(camera.project(frame.points[mesh_edges(frame.quads)]), MESH_COLOR, 0.6 * line)
    canvas.blend(mesh, 0.35)
    flanks = camera.project(frame.points[frame.crack_edges.reshape(-1, 2)])
    canvas.draw_lines(flanks, FLANK_COLOR, 2.2 * line)

    thin = Canvas(camera.shape)
    ends = camera.project(frame.cable_segments)
    close = camera.scale * edge_length(frame) > 20.0  # room for a halo around each cable
    cable_width = 2.8 * line if close else 1.6 * line
    if close:
        halo = ends.copy()
        halo[..., 2] -= 6.0 * line  # behind all cables, not only its own
        thin.draw_lines(halo, _HALO_COLOR, cable_width + 1.8 * line)
    for state, cable_color in CABLE_COLORS.items():
        chosen = ends[frame.cable_state == state]
        chosen[..., 2] += 2.0 * line
        thin.draw_lines(chosen, cable_color, cable_width)
    edges = camera.project(frame.edge_points)
    edges[..., 2] += 2.0 * line
    thin.draw_lines(edges, EDGE_COLOR, 3.2 * line if close else 2.4 * line)

    tool = Canvas(camera.shape)
    triangles = frame.tool_points[frame.tool_triangles]
    tool.draw(camera.project(triangles), shade(triangles, axes, np.array(TOOL_COLOR)))
    creases = frame.tool_points[tool_creases(frame)]
    tool.draw_lines(camera.project(creases), (0.3, 0.3, 0.33), 1.0 * line)

    # Hidden lines first, so that everything in front of the film covers them.
    canvas.blend(thin, _HIDDEN_OPACITY, through=True)
    canvas.blend(tool, TOOL_OPACITY)
    canvas.blend(thin, 0.9)
    return canvas.image(OVERSAMPLING)


def whole_camera(frames: Sequence[Frame], shape: tuple[int, int]) -> Camera:
    """Return a camera that shows film and edges of all frames, and the tool near them.

    shape : height and width of the picture [pixel].
    """
    elevation, azimuth = np.radians(_VIEW)
    level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    axes = view_axes(np.cos(elevation) * level + np.sin(elevation) * up, up)
    parts = [(f.points, f.reference, f.edge_points.reshape(-1, 3)) for f in frames]
    points = np.concatenate([points for part in parts for points in part])
    # A tool's shaft may be many times longer than the film is wide.
    room = _ROOM_FOR_TOOL * np.ptp(points, axis=0).max()
    low, high = points.min(axis=0) - room, points.max(axis=0) + room
    near = [f.tool_points.clip(low, high) for f in frames]
    across = np.concatenate([points, *near]) @ axes.T
    low, high = across.min(axis=0), across.max(axis=0)
    height, width = (OVERSAMPLING * n for n in shape)
    room = 0.94 * np.array([width, height]) / (high - low)[:2].clip(1e-12)
    return Camera(axes, 0.5 * (low + high) @ axes, float(room.min()), (height, width))


def pixels_of(
    box: tuple[float, float, float, float], size: tuple[float, float], dpi: float
) -> tuple[int, int]:
    """Return height and width in pixels of a box given in fractions of the figure."""
    return round(box[3] * size[1] * dpi), round(box[2] * size[0] * dpi)


def mesh_edges(quads: Ints) -> Ints:
    """Return every edge of the quads once, as node ids, shape (n, 2)."""
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
    """Return the median length of the quads' edges [mm]."""
    ends = frame.reference[sides_of(frame.quads)]
    return float(np.median(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)))


def stress_scale(limits: tuple[float, float]) -> Any:
    """Return Matplotlib's map from stress [MPa] to colour."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    # Light enough at both ends for black, blue, orange and red lines to stand out.
    colormap = ListedColormap(colormaps["YlGn"](np.linspace(0.02, 0.85, 256)))
    return ScalarMappable(Normalize(*limits), colormap)


def caption_of(frame: Frame) -> list[str]:
    """Return the caption of a frame: coordinate and first scalar, with units."""
    parts = [f"{frame.coordinate_name} {with_unit(frame.coordinate, frame.coordinate_unit)}"]
    for name in list(frame.scalars)[:1]:
        parts.append(f"{name} {with_unit(frame.scalars[name], frame.scalar_units[name])}")
    return parts


def title_parts(frame: Frame) -> list[str]:
    """Return the caption and the time."""
    return [*caption_of(frame), f"time {1e3 * frame.time:.3f} ms"]


def round_length(wanted: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that does not exceed a length."""
    unit = 10.0 ** np.floor(np.log10(wanted))
    return float(unit * max(m for m in (1.0, 2.0, 5.0) if m * unit <= wanted))


def eight_bit(image: Floats) -> npt.NDArray[np.uint8]:
    """Return red, green and blue in 0..1 as integers up to 255."""
    return np.rint(255.0 * image.clip(0.0, 1.0)).astype(np.uint8)


def show(axes: Any, image: Floats, bar: tuple[float, float] | None) -> None:
    """Show an image in axes of its size; ``bar``: length [mm] and share of the width, or None."""
    axes.imshow(eight_bit(image), interpolation="none", aspect="equal")
    axes.set_autoscale_on(False)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color("0.75")
    if bar is None:
        return
    height, width = image.shape[:2]
    x, y = 0.04 * width, 0.955 * height
    to = x + bar[1] * width
    axes.plot([x, to], [y, y], color="black", lw=2.5, solid_capstyle="butt")
    axes.text(0.5 * (x + to), y - 0.012 * height, f"{bar[0]:g} mm", ha="center")


def add_color_bar(
    figure: Any,
    scale: Any,
    shown: Sequence[Floats],
    box: tuple[float, float, float, float],
    *,
    label: str = "largest principal stress [MPa]",
) -> None:
    """Add the stress scale, with pointed ends where quads shown lie beyond it."""
    low, high = scale.get_clim()
    below = any((stress < low).any() for stress in shown)
    above = any((stress > high).any() for stress in shown)
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max"}
    bar = figure.colorbar(
        scale,
        cax=figure.add_axes(box),
        orientation="horizontal",
        extend=extend.get((below, above), "both"),
    )
    bar.set_label(label, labelpad=1)


@dataclass(frozen=True)
class Shown:
    """An entry of the legend."""

    name: str
    color: tuple[float, float, float]
    is_area: bool = False


def legend_of(frames: Sequence[Frame]) -> list[Shown]:
    """Return the legend entries for the frames."""
    found = []
    if any(len(f.crack_edges) for f in frames):
        found.append(Shown("crack flank", FLANK_COLOR))
    if any(len(f.cable_segments) for f in frames):
        names = {STRAIGHT: "cable, straight", JOINTED: "cable, bent around the edge"}
        found += [Shown(name, CABLE_COLORS[state]) for state, name in names.items()]
    if any(len(f.edge_points) for f in frames):
        found.append(Shown("cutting edge", EDGE_COLOR))
    if any(len(f.tool_triangles) for f in frames):
        found.append(Shown("tool", TOOL_COLOR, is_area=True))
    return found


def add_legend(figure: Any, frames: Sequence[Frame], **where: Any) -> None:
    """Add a legend for the frames; ``where`` goes to Matplotlib's ``legend``."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles = [
        Patch(color=shown.color, alpha=TOOL_OPACITY, label=shown.name)
        if shown.is_area
        else Line2D([], [], color=shown.color, lw=3, label=shown.name)
        for shown in legend_of(frames)
    ]
    if handles:
        where = {"loc": "lower right", "ncol": len(handles), "frameon": False} | where
        figure.legend(handles=handles, **where)
