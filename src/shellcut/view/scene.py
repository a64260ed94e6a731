"""A frame in three dimensions, by PyVista: film coloured by a stress, cables, tool, cutting edges.

Where PyVista cannot draw, the same frame is drawn by :func:`draw_snapshot`, which needs Matplotlib
only.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.frame import Floats, Frame

from ._figure import new_figure, pixels
from ._panel import (
    CABLE_COLORS,
    EDGE_COLOR,
    FLANK_COLOR,
    MESH_COLOR,
    TOOL_COLOR,
    add_color_bar,
    add_legend,
    caption_of,
    edge_length,
    pixels_of,
    round_limits,
    stress_scale,
    tool_creases,
    whole_camera,
)
from .renderer import pyvista_or_say, quiet_vtk
from .snapshot import draw_snapshot

STRESSES: dict[str, Callable[[Frame], Floats]] = {
    "largest principal": lambda frame: frame.quad_principal[:, 0],
    "smallest principal": lambda frame: frame.quad_principal[:, 1],
    "von Mises": lambda frame: _von_mises(frame.quad_principal),
    "largest principal, top": lambda frame: frame.quad_principal_top[:, 0],
    "largest principal, bottom": lambda frame: frame.quad_principal_bottom[:, 0],
}
"""What the film can be coloured by: name -> values of the quads [MPa], the mean over the thickness
unless a face is named."""

_TOOL_OPACITY = 0.4  # that what it does can be seen through it
_INCHES = 13.0  # width of the picture that words are measured by, whatever its pixels
_HEAD, _FOOT = 0.55, 0.85  # room for the title, and for colour bar and legend [inch]


def draw_scene(
    path: str | os.PathLike[str],
    frame: Frame,
    *,
    stress: str = "largest principal",
    stress_limits: tuple[float, float] | None = None,
    view: tuple[float, float] = (42.0, -60.0),
    size: tuple[int, int] = (1280, 800),
) -> None:
    """Draw one frame to a picture file, off screen.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another ending that Pillow knows; replaced if it exists.
    frame : Frame
        What to draw.
    stress : str
        One of :data:`STRESSES`.
    stress_limits : (float, float), optional
        Ends of the colour scale [MPa]; by default a round number around nearly all quads.
    view : (float, float)
        Elevation above the x-y plane and azimuth from the x axis, of the camera [deg].
    size : (int, int)
        Width and height [pixel].

    Raises
    ------
    ImportError
        If neither PyVista can draw here nor Matplotlib is installed.
    ValueError
        If there is no such stress.
    """
    _check_stress(stress)
    if not pyvista_or_say("drawn by Matplotlib, coloured by the largest principal stress"):
        limits = stress_limits if stress == "largest principal" else None
        inches = (size[0] / 100.0, size[1] / 100.0)
        draw_snapshot(path, frame, view=view, stress_limits=limits, size=inches, dpi=100.0)
        return
    from PIL import Image

    limits = limits_for([frame], stress) if stress_limits is None else stress_limits
    image = render(frame, [frame], stress=stress, stress_limits=limits, view=view, size=size)
    Image.fromarray(image).save(path)


def limits_for(frames: Sequence[Frame], stress: str) -> tuple[float, float]:
    """Return round ends of the colour scale that hold nearly all quads of the frames [MPa]."""
    values = np.concatenate([STRESSES[stress](frame) for frame in frames])
    if stress == "smallest principal":
        low, high = round_limits(-values)
        return -high, low
    return round_limits(values)


def render(
    frame: Frame,
    seen: Sequence[Frame],
    *,
    stress: str,
    stress_limits: tuple[float, float],
    view: tuple[float, float],
    size: tuple[int, int],
) -> npt.NDArray[np.uint8]:
    """Return the picture of one frame, shape (height, width, 3), by a camera that holds all seen.

    To be called only where :func:`why_not_pyvista` says None.
    """
    dpi = size[0] / _INCHES
    inches = (_INCHES, size[1] / dpi)
    foot, head = _FOOT / inches[1], _HEAD / inches[1]
    box = (0.0, foot, 1.0, 1.0 - foot - head)
    scale = stress_scale(stress_limits)
    values = STRESSES[stress](frame)
    figure = new_figure(inches, dpi)
    axes = figure.add_axes(box)
    axes.axis("off")
    height, width = pixels_of(box, inches, dpi)
    axes.imshow(_rendered(frame, values, seen, scale, view, (height, width)), aspect="auto")
    figure.suptitle("      ".join(caption_of(frame)), fontsize=15, y=1.0 - 0.4 * head)
    bar = (0.04, 0.62 * foot, 0.27, 0.14 / inches[1])
    add_color_bar(figure, scale, [values], bar, label=f"{stress} stress [MPa]")
    add_legend(figure, [frame], bbox_to_anchor=(0.995, 0.3 * foot))
    return pixels(figure)


def _rendered(
    frame: Frame,
    values: Floats,
    seen: Sequence[Frame],
    scale: Any,
    view: tuple[float, float],
    shape: tuple[int, int],
) -> npt.NDArray[np.uint8]:
    import pyvista

    with quiet_vtk():
        plotter: Any = pyvista.Plotter(off_screen=True, window_size=[shape[1], shape[0]])
        try:
            plotter.background_color = "white"
            _add_film(plotter, frame, values, scale)
            _add_lines(plotter, frame)
            _add_tool(plotter, frame)
            _set_camera(plotter, seen, view, shape)
            plotter.enable_anti_aliasing("ssaa")
            return np.asarray(plotter.screenshot(return_img=True))[..., :3]
        finally:
            plotter.close()


def _check_stress(stress: str) -> None:
    if stress not in STRESSES:
        raise ValueError(f"stress must be one of {', '.join(STRESSES)}, got {stress!r}")


def _von_mises(principal: Floats) -> Floats:
    a, b = principal[:, 0], principal[:, 1]
    return np.asarray(np.sqrt(a * a - a * b + b * b))


def _add_film(plotter: Any, frame: Frame, values: Floats, scale: Any) -> None:
    film = _surface(frame.points, frame.quads)
    film.cell_data["stress"] = values
    plotter.add_mesh(
        film,
        scalars="stress",
        cmap=scale.cmap,
        clim=scale.get_clim(),
        show_scalar_bar=False,
        smooth_shading=True,  # else the two triangles of a warped quad differ
        ambient=0.35,
        diffuse=0.65,
        specular=0.0,
        show_edges=True,
        edge_color=MESH_COLOR,
        edge_opacity=0.35,
    )


def _add_lines(plotter: Any, frame: Frame) -> None:
    # Tubes, as thick as a part of a quad: lines of pixels vanish in the film they lie on.
    thick = 0.03 * edge_length(frame)
    bright: dict[str, Any] = {"lighting": False}
    if len(frame.crack_edges):
        flanks = _segments(frame.points, frame.crack_edges.reshape(-1, 2))
        plotter.add_mesh(flanks.tube(radius=thick), color=FLANK_COLOR)
    for state, color in CABLE_COLORS.items():
        chosen = frame.cable_segments[frame.cable_state == state]
        if len(chosen):
            plotter.add_mesh(_tubes(chosen, 1.3 * thick), color=color, **bright)
    if len(frame.edge_points):
        plotter.add_mesh(_tubes(frame.edge_points, 1.6 * thick), color=EDGE_COLOR, **bright)


def _add_tool(plotter: Any, frame: Frame) -> None:
    if not len(frame.tool_triangles):
        return
    tool = _surface(frame.tool_points, frame.tool_triangles)
    plotter.add_mesh(tool, color=TOOL_COLOR, opacity=_TOOL_OPACITY, ambient=0.45)
    creases = tool_creases(frame)
    if len(creases):
        lines = _segments(frame.tool_points, creases)
        plotter.add_mesh(lines, color=(0.3, 0.3, 0.33), line_width=1)
    plotter.enable_depth_peeling(8)


def _set_camera(
    plotter: Any, seen: Sequence[Frame], view: tuple[float, float], shape: tuple[int, int]
) -> None:
    camera = whole_camera(seen, view, shape)
    reach = 4.0 * max(np.ptp(f.points, axis=0).max() for f in seen)
    plotter.camera.focal_point = camera.centre
    plotter.camera.position = camera.centre + reach * camera.axes[2]
    plotter.camera.up = camera.axes[1]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.5 * camera.shape[0] / camera.scale
    plotter.reset_camera_clipping_range()


def _surface(points: Floats, faces: npt.NDArray[np.int64]) -> Any:
    import pyvista

    count = np.full((len(faces), 1), faces.shape[1])
    return pyvista.PolyData(np.asarray(points), np.hstack((count, faces)))


def _segments(points: Floats, ids: npt.NDArray[np.int64]) -> Any:
    import pyvista

    cells = np.column_stack((np.full(len(ids), 2), ids))
    return pyvista.PolyData(np.asarray(points), lines=cells)


def _tubes(segments: Floats, radius: float) -> Any:
    ids = np.arange(2 * len(segments)).reshape(-1, 2)
    return _segments(segments.reshape(-1, 3), ids).tube(radius=radius)
