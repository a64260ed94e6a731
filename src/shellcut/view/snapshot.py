"""One picture of the cut: on the left the whole model, on the right one tooth at work."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import IO, Any

import numpy as np

from shellcut.frame import Floats, Frame

from ._figure import new_figure, save
from ._panel import (
    OVERSAMPLING,
    add_color_bar,
    add_legend,
    edge_length,
    picture,
    pixels_of,
    round_limits,
    show,
    stress_colors,
    stress_scale,
    title_of,
    whole_camera,
)
from ._raster import Camera, view_axes
from ._teeth import teeth_of


def draw_snapshot(
    path: str | os.PathLike[str] | IO[bytes],
    frame: Frame,
    *,
    view: tuple[float, float] = (48.0, -60.0),
    close_view: tuple[float, float] = (40.0, 50.0),
    close_width: float | None = None,
    tooth: int = 0,
    together_with: Sequence[Frame] = (),
    stress_limits: tuple[float, float] | None = None,
    title: str | None = None,
    size: tuple[float, float] = (13.0, 7.0),
    dpi: float = 90.0,
) -> None:
    """Draw one frame to a picture file.

    The membrane is coloured by its largest principal stress, the flanks of the crack are bold,
    the cables tell straight from bent around the edge, the tool is a semi-transparent solid
    whose cutting edges are red. What the membrane hides of edges and cables shines through.

    Parameters
    ----------
    path : str, Path or binary file
        The picture, ``.png`` or another ending that Matplotlib knows; replaced if it exists.
        An open file gets a PNG.
    frame : Frame
        What to draw. Without a cutting edge only the whole model is drawn.
    view : (float, float)
        Elevation above the x-y plane and azimuth from the x axis, of the camera of the left
        panel [deg].
    close_view : (float, float)
        Elevation above the membrane and bearing from the direction of the cut, of the camera of
        the right panel [deg]; it goes with the tooth. Bearing 0 looks straight at the edge, 90
        from the left of its way.
    close_width : float, optional
        Width of the right panel [mm]; by default the edge and some room, the same all through a
        run.
    tooth : int
        Which connected cutting edge the right panel follows, in the order of ``edge_points``.
    together_with : sequence of Frame
        Other frames of the run that the left camera must hold, so that their pictures make a film.
    stress_limits : (float, float), optional
        Ends of the colour scale [MPa]; by default 0 and a round number above nearly all quads.
        Give them to compare pictures of one run.
    title : str, optional
        By default the frame's coordinate, its first scalar and the time.
    size : (float, float)
        Width and height [inch].
    dpi : float
        Pixels per inch.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If there is no such tooth.
    """
    figure = new_figure(size, dpi)
    principal = frame.quad_principal[:, 0]
    scale = stress_scale(round_limits(principal) if stress_limits is None else stress_limits)
    colors = stress_colors(frame, scale)
    figure.suptitle(title_of(frame) if title is None else title, fontsize=15, y=0.975)

    low, high = 0.12, 0.92
    if len(frame.edge_points):
        whole_box, close_box = (0.01, low, 0.545, high - low), (0.565, low, 0.425, high - low)
    else:
        whole_box, close_box = (0.01, low, 0.98, high - low), None
    camera = whole_camera([frame, *together_with], view, pixels_of(whole_box, size, dpi))
    whole = figure.add_axes(whole_box)
    show(whole, picture(frame, camera, colors), camera)
    if close_box is not None:
        shape = pixels_of(close_box, size, dpi)
        close = _close_camera(frame, tooth, close_view, camera.axes[2], close_width, shape)
        axes = figure.add_axes(close_box)
        show(axes, picture(frame, close, colors), close)
        axes.text(0.03, 0.955, f"tooth {tooth + 1}", transform=axes.transAxes, fontsize=12)
        _mark(whole, camera, close)
    add_color_bar(figure, scale, [principal], (0.04, 0.075, 0.30, 0.02))
    add_legend(figure, [frame], bbox_to_anchor=(0.995, 0.025))
    save(figure, path)


def _close_camera(
    frame: Frame,
    tooth: int,
    close_view: tuple[float, float],
    toward: Floats,
    close_width: float | None,
    shape: tuple[int, int],
) -> Camera:
    edge = _tooth_edge(frame, tooth)
    middles = edge.mean(axis=1)
    distance = np.linalg.norm(middles[:, np.newaxis] - frame.points, axis=2)
    focus = middles[np.argmin(distance.min(axis=1))]  # where the edge meets the membrane
    normal = _membrane_normal(frame, focus)
    if normal @ toward < 0.0:  # both panels look at the same side
        normal = -normal
    forward = _cutting_direction(frame, focus)
    forward = forward - (forward @ normal) * normal
    if np.linalg.norm(forward) < 1e-6:
        forward = np.cross(normal, np.roll(normal, 1))
    forward /= np.linalg.norm(forward)
    elevation, bearing = np.radians(close_view)
    level = np.cos(bearing) * forward + np.sin(bearing) * np.cross(normal, forward)
    axes = view_axes(np.cos(elevation) * level + np.sin(elevation) * normal, normal)
    length = np.linalg.norm(edge[:, 1] - edge[:, 0], axis=1).sum()
    if close_width is None:
        # Of what does not change in a run, so that the pictures of one run make a film.
        whole = np.ptp(frame.reference, axis=0).max()
        close_width = max(min(1.3 * length, 0.25 * whole), 8.0 * edge_length(frame))
    height, width = (OVERSAMPLING * n for n in shape)
    # The way already cut is what there is to see: the edge stands off the middle, toward its front.
    centre = focus - 0.12 * close_width * forward
    return Camera(axes, centre, width / close_width, (height, width))


def _tooth_edge(frame: Frame, tooth: int) -> Floats:
    label = teeth_of(frame.edge_points)
    if not 0 <= tooth <= label.max():
        raise ValueError(f"tooth must be in 0..{label.max()}, got {tooth}")
    return np.asarray(frame.edge_points[label == tooth])


def _membrane_normal(frame: Frame, focus: Floats) -> Floats:
    # Of the reference, where flaps do not yet hang, over some ten quads around the edge.
    near = np.argsort(np.linalg.norm(frame.points[frame.quads].mean(axis=1) - focus, axis=1))[:12]
    p = frame.reference[frame.quads[near]]
    normal = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]).sum(axis=0)
    return np.asarray(normal / np.linalg.norm(normal))


def _cutting_direction(frame: Frame, focus: Floats) -> Floats:
    # Out of the wedge: the mean of the outward normals of the two faces that share the edge.
    if not len(frame.tool_triangles):
        return np.zeros(3)
    p = frame.tool_points[frame.tool_triangles]
    along = np.roll(p, -1, axis=1) - p
    s = ((focus - p) * along).sum(axis=2) / (along**2).sum(axis=2).clip(1e-30)
    foot = p + s.clip(0.0, 1.0)[..., np.newaxis] * along
    distance = np.linalg.norm(foot - focus, axis=2).min(axis=1)
    faces = p[distance <= distance.min() + 1e-6 * np.ptp(p)]
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True).clip(1e-30)
    return np.asarray(normal.sum(axis=0))


def _mark(axes: Any, whole: Camera, close: Camera) -> None:
    # A circle in the picture of the whole around what the close picture shows.
    from matplotlib.patches import Circle

    x, y, _ = whole.project(close.centre) / OVERSAMPLING
    radius = 0.5 * close.shape[0] / close.scale * whole.scale / OVERSAMPLING
    axes.add_patch(Circle((x, y), radius, fill=False, ls="--", lw=1.2, ec="0.25"))
