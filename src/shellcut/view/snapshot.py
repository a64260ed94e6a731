"""One picture of the cut: on the left the whole model, on the right one tooth at work."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from shellcut.frame import JOINTED, STRAIGHT, Floats, Frame, Ints

from ._figure import new_figure, pretty, save, with_unit
from ._raster import Camera, Canvas, shade, view_axes

_OVERSAMPLING = 2  # pixels per side that are averaged into one: smooth outlines

_MESH_COLOR = (0.1, 0.1, 0.15)
_FLANK_COLOR = (0.05, 0.05, 0.05)
_CABLE_COLORS = {STRAIGHT: (0.0, 0.75, 1.0), JOINTED: (1.0, 0.55, 0.0)}
_HALO_COLOR = (0.05, 0.05, 0.05)
_EDGE_COLOR = (0.9, 0.0, 0.1)
_TOOL_COLOR = (0.62, 0.64, 0.68)
_TOOL_OPACITY = 0.55
_HIDDEN_OPACITY = 0.3  # of edges and cables behind the membrane


def draw_snapshot(
    path: str | os.PathLike[str],
    frame: Frame,
    *,
    view: tuple[float, float] = (48.0, -60.0),
    close_view: tuple[float, float] = (40.0, 50.0),
    close_width: float | None = None,
    tooth: int = 0,
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
    path : str or Path
        The picture, ``.png`` or another ending that Matplotlib knows; replaced if it exists.
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
    limits = _stress_limits(frame) if stress_limits is None else stress_limits
    colors, mappable = _stress_colors(frame, limits)
    figure.suptitle(_title(frame) if title is None else title, fontsize=15, y=0.975)

    low, high = 0.12, 0.92
    if len(frame.edge_points):
        whole_box, close_box = (0.01, low, 0.545, high - low), (0.565, low, 0.425, high - low)
    else:
        whole_box, close_box = (0.01, low, 0.98, high - low), None
    camera = _whole_camera(frame, view, _pixels(whole_box, size, dpi))
    whole = figure.add_axes(whole_box)
    _show(whole, _picture(frame, camera, colors), camera)
    if close_box is not None:
        shape = _pixels(close_box, size, dpi)
        close = _close_camera(frame, tooth, close_view, camera.axes[2], close_width, shape)
        axes = figure.add_axes(close_box)
        _show(axes, _picture(frame, close, colors), close)
        axes.text(0.03, 0.955, f"tooth {tooth + 1}", transform=axes.transAxes, fontsize=12)
        _mark(whole, camera, close)
    _add_color_bar(figure, mappable, limits, frame)
    _add_legend(figure, frame)
    save(figure, path)


def _picture(frame: Frame, camera: Camera, quad_colors: Floats) -> Floats:
    axes = camera.axes
    line = camera.shape[0] / 640.0  # a line is as bold in a large picture as in a small one
    canvas = Canvas(camera.shape)
    quads = frame.points[frame.quads]
    corners = camera.project(quads)
    color = shade(quads, axes, quad_colors)
    canvas.draw(corners[:, [0, 1, 2]], color)
    canvas.draw(corners[:, [0, 2, 3]], color)

    mesh = Canvas(camera.shape)
    mesh.draw_lines(camera.project(frame.points[_mesh_edges(frame.quads)]), _MESH_COLOR, 0.6 * line)
    canvas.blend(mesh, 0.35)
    flanks = camera.project(frame.points[frame.crack_edges.reshape(-1, 2)])
    canvas.draw_lines(flanks, _FLANK_COLOR, 2.2 * line)

    thin = Canvas(camera.shape)
    ends = camera.project(frame.cable_segments)
    close = camera.scale * _edge_length(frame) > 20.0  # room for a halo around each cable
    cable_width = 2.8 * line if close else 1.6 * line
    if close:
        halo = ends.copy()
        halo[..., 2] -= 6.0 * line  # behind every cable, not only its own
        thin.draw_lines(halo, _HALO_COLOR, cable_width + 1.8 * line)
    for state, cable_color in _CABLE_COLORS.items():
        chosen = ends[frame.cable_state == state]
        chosen[..., 2] += 2.0 * line
        thin.draw_lines(chosen, cable_color, cable_width)
    edges = camera.project(frame.edge_points)
    edges[..., 2] += 2.0 * line
    thin.draw_lines(edges, _EDGE_COLOR, 3.2 * line if close else 2.4 * line)

    tool = Canvas(camera.shape)
    triangles = frame.tool_points[frame.tool_triangles]
    tool.draw(camera.project(triangles), shade(triangles, axes, np.array(_TOOL_COLOR)))
    creases = frame.tool_points[_creases(frame)]
    tool.draw_lines(camera.project(creases), (0.3, 0.3, 0.33), 1.0 * line)

    # Hidden lines first, so that what is in front of the membrane covers them.
    canvas.blend(thin, _HIDDEN_OPACITY, through=True)
    canvas.blend(tool, _TOOL_OPACITY)
    canvas.blend(thin, 0.9)
    return canvas.image(_OVERSAMPLING)


def _pixels(
    box: tuple[float, float, float, float], size: tuple[float, float], dpi: float
) -> tuple[int, int]:
    return round(box[3] * size[1] * dpi), round(box[2] * size[0] * dpi)


def _direction(view: tuple[float, float]) -> Floats:
    elevation, azimuth = np.radians(view)
    return np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )


def _whole_camera(frame: Frame, view: tuple[float, float], shape: tuple[int, int]) -> Camera:
    axes = view_axes(_direction(view), np.array([0.0, 0.0, 1.0]))
    points = np.concatenate((frame.points, frame.reference, frame.edge_points.reshape(-1, 3)))
    across = points @ axes.T
    low, high = across.min(axis=0), across.max(axis=0)
    height, width = (_OVERSAMPLING * n for n in shape)
    room = 0.94 * np.array([width, height]) / (high - low)[:2].clip(1e-12)
    return Camera(axes, 0.5 * (low + high) @ axes, float(room.min()), (height, width))


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
        close_width = max(min(1.3 * length, 0.25 * whole), 8.0 * _edge_length(frame))
    height, width = (_OVERSAMPLING * n for n in shape)
    # The way already cut is what there is to see: the edge stands off the middle, toward its front.
    centre = focus - 0.12 * close_width * forward
    return Camera(axes, centre, width / close_width, (height, width))


def _tooth_edge(frame: Frame, tooth: int) -> Floats:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = frame.edge_points.reshape(-1, 3)
    _, ids = np.unique(ends.round(6), axis=0, return_inverse=True)
    ids = ids.reshape(-1, 2)
    graph = coo_array((np.ones(len(ids)), (ids[:, 0], ids[:, 1])), shape=(2 * len(ids),) * 2)
    _, label = connected_components(graph, directed=False)
    label = label[ids[:, 0]]
    _, first = np.unique(label, return_index=True)
    if not 0 <= tooth < len(first):
        raise ValueError(f"tooth must be in 0..{len(first) - 1}, got {tooth}")
    return np.asarray(frame.edge_points[label == label[np.sort(first)[tooth]]])


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


def _mesh_edges(quads: Ints) -> Ints:
    edges = np.stack((quads, np.roll(quads, -1, axis=1)), axis=2).reshape(-1, 2)
    return np.unique(np.sort(edges, axis=1), axis=0)


def _creases(frame: Frame) -> Ints:
    # Edges of the tool between faces more than 20 degrees apart: they make it read as a solid.
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


def _edge_length(frame: Frame) -> float:
    p = frame.reference[frame.quads]
    return float(np.median(np.linalg.norm(np.roll(p, -1, axis=1) - p, axis=2)))


def _stress_limits(frame: Frame) -> tuple[float, float]:
    # Nearly all: the few quads at a crack tip would darken the rest.
    high = float(np.quantile(frame.quad_principal[:, 0], 0.998))
    if high <= 0.0:
        return 0.0, 1.0
    unit = 10.0 ** np.floor(np.log10(high))
    return 0.0, float(np.ceil(2.0 * high / unit) / 2.0 * unit)


def _stress_colors(frame: Frame, limits: tuple[float, float]) -> tuple[Floats, Any]:
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    # Light enough at both ends for black, blue, orange and red lines to stand out.
    colormap = ListedColormap(colormaps["YlGn"](np.linspace(0.02, 0.85, 256)))
    mappable = ScalarMappable(Normalize(*limits), colormap)
    return np.asarray(mappable.to_rgba(frame.quad_principal[:, 0]))[:, :3], mappable


def _title(frame: Frame) -> str:
    parts = [f"{frame.coordinate_name} {with_unit(frame.coordinate, frame.coordinate_unit)}"]
    for name in list(frame.scalars)[:1]:
        parts.append(f"{name} {with_unit(frame.scalars[name], frame.scalar_units[name])}")
    parts.append(f"time {1e3 * frame.time:.3f} ms")
    return "      ".join(parts)


def _show(axes: Any, image: Floats, camera: Camera) -> None:
    axes.imshow(image.clip(0.0, 1.0), interpolation="none", aspect="equal")
    axes.set_autoscale_on(False)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color("0.75")
    # A scale bar of a round length, about a sixth of the width.
    height, width = image.shape[:2]
    scale = camera.scale / _OVERSAMPLING
    wanted = width / 6.0 / scale
    unit = 10.0 ** np.floor(np.log10(wanted))
    length = unit * max(m for m in (1.0, 2.0, 5.0) if m * unit <= wanted)
    x, y = 0.04 * width, 0.955 * height
    axes.plot([x, x + length * scale], [y, y], color="black", lw=2.5, solid_capstyle="butt")
    axes.text(x + 0.5 * length * scale, y - 0.012 * height, f"{length:g} mm", ha="center")


def _mark(axes: Any, whole: Camera, close: Camera) -> None:
    # A circle in the picture of the whole around what the close picture shows.
    from matplotlib.patches import Circle

    x, y, _ = whole.project(close.centre) / _OVERSAMPLING
    radius = 0.5 * close.shape[0] / close.scale * whole.scale / _OVERSAMPLING
    axes.add_patch(Circle((x, y), radius, fill=False, ls="--", lw=1.2, ec="0.25"))


def _add_color_bar(figure: Any, mappable: Any, limits: tuple[float, float], frame: Frame) -> None:
    stress = frame.quad_principal[:, 0]
    below, above = bool((stress < limits[0]).any()), bool((stress > limits[1]).any())
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max"}
    bar = figure.colorbar(
        mappable,
        cax=figure.add_axes((0.04, 0.075, 0.30, 0.02)),
        orientation="horizontal",
        extend=extend.get((below, above), "both"),
    )
    bar.set_label(f"largest principal stress [{pretty('MPa')}]", labelpad=1)


def _add_legend(figure: Any, frame: Frame) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if len(frame.crack_edges):
        handles.append(Line2D([], [], color=_FLANK_COLOR, lw=2.5, label="crack flank"))
    if len(frame.cable_segments):
        names = {STRAIGHT: "cable, straight", JOINTED: "cable, bent around the edge"}
        for state, label in names.items():
            handles.append(Line2D([], [], color=_CABLE_COLORS[state], lw=3, label=label))
    if len(frame.edge_points):
        handles.append(Line2D([], [], color=_EDGE_COLOR, lw=3, label="cutting edge"))
    if len(frame.tool_triangles):
        handles.append(Patch(color=_TOOL_COLOR, alpha=_TOOL_OPACITY, label="tool"))
    if handles:
        figure.legend(
            handles=handles,
            loc="lower right",
            bbox_to_anchor=(0.995, 0.025),
            ncol=len(handles),
            frameon=False,
        )
