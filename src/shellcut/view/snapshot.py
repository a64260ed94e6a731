"""One picture of the cut: the whole film alone, or with one tooth on its right."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats, norm
from shellcut.files.whole_file import atomic_write
from shellcut.frame import Frame
from shellcut.unit import in_unit

from ._figure import new_figure
from ._panel import (
    OVERSAMPLING,
    PAPER,
    add_color_bar,
    add_legend,
    edge_length,
    eight_bit,
    picture,
    pixels_of,
    show,
    title_parts,
    whole_camera,
)
from ._raster import Camera
from .look import Look

# Left, bottom, width and height of the panels, relative to the figure.
_LEFT_BOX, _RIGHT_BOX = (0.01, 0.12, 0.545, 0.80), (0.565, 0.12, 0.425, 0.80)
_ONLY_BOX = (0.01, 0.12, 0.98, 0.80)
_INCHES = 10.5  # width of a figure: its text is legible where it is shown 700 pixels wide
_SMALLEST = 160  # height and width [pixel]: less cannot be read
_LOOK = Look()
# Radius of what a close-up shows: over that of the tooth, in edges of quads at least, over the
# film's extent at most.
_AROUND, _QUADS, _MOST = 1.1, 4.0, 0.3


def draw_scene(
    path: str | os.PathLike[str],
    frame: Frame,
    *,
    look: Look = _LOOK,
    together_with: Sequence[Frame] = (),
    close_up: bool = False,
    size: tuple[int, int] = (1280, 800),
) -> None:
    """Draw one frame to a picture file.

    The flanks of the crack are bold, colours distinguish straight cables from those bent around the
    edge, the tool is a semi-transparent solid with red cutting edges. Edges and cables hidden by
    the film shine through.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Pillow knows; replaced if it exists.
    frame : Frame
        The frame to draw.
    look : Look
        Field, colours, camera, hidden parts.
    together_with : sequence of Frame
        Other frames of the run that camera, scale and legend must cover. With all of them the
        picture equals the frame of :func:`draw_movie`.
    close_up : bool
        Whether the first tooth is shown beside the whole, where there are cutting edges.
    size : (int, int)
        Width and height [pixel].

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If there is no such field, colour map or suffix, or the picture is too small to be read.
    """
    series = SnapshotSeries([frame, *together_with], look=look, size=size, close_up=close_up)
    from PIL import Image

    path = Path(path)
    if Image.registered_extensions().get(path.suffix.lower()) not in Image.SAVE:
        raise ValueError(
            "a picture's file ends with .png, .jpg, .tif, .pdf or another suffix that Pillow "
            f"writes, a movie's with .mp4, .webp or .gif, a page's with .html; got {path.name!r}"
        )
    with atomic_write(path) as temporary:
        Image.fromarray(series.image(frame)).save(temporary)


def png_of(frame: Frame, look: Look, shape: tuple[int, int]) -> bytes:
    """Return a frame without axes and text as a PNG; ``shape`` is height and width [pixel]."""
    from PIL import Image

    file = io.BytesIO()
    image = picture(frame, whole_camera([frame], shape, look), look, limits_of([frame], look)[0])
    Image.fromarray(eight_bit(image)).save(file, "PNG", optimize=True)
    return file.getvalue()


class SnapshotSeries:
    """Snapshots of a run with one camera, one scale and one legend.

    Left camera and legend cover all frames ``seen``. The picture is created once; each frame
    changes its pictures, title and circle.
    """

    def __init__(
        self, seen: Sequence[Frame], *, look: Look, size: tuple[int, int], close_up: bool = False
    ) -> None:
        if min(size) < _SMALLEST:
            raise ValueError(f"a picture has at least {_SMALLEST} x {_SMALLEST} pixels, got {size}")
        dpi = size[0] / _INCHES
        # Half a pixel more, because the canvas rounds down and round-off could lose a whole pixel.
        inches = (size[0] + 0.5) / dpi, (size[1] + 0.5) / dpi
        with_edge = close_up and any(len(frame.edge_points) for frame in seen)
        box = _LEFT_BOX if with_edge else _ONLY_BOX
        balls = [tooth_ball(f) for f in seen if with_edge and len(f.edge_points)]
        self._camera = whole_camera(seen, pixels_of(box, inches, dpi), look, balls)
        self._close_shape = pixels_of(_RIGHT_BOX, inches, dpi)
        self._look, (self._limits, values) = look, limits_of(seen, look)
        self._figure = new_figure(inches, dpi)
        if look.shows("film"):
            field = look.field_of(seen[0])
            bar, label = (0.04, 0.075, 0.30, 0.02), in_unit(field.label, field.unit)
            add_color_bar(self._figure, look, self._limits, values, bar, label)
        add_legend(self._figure, seen, look)
        self._title = self._figure.suptitle("", fontsize=14, x=0.012, y=0.975, ha="left")
        self._left = self._figure.add_axes(box)
        self._right = self._figure.add_axes(_RIGHT_BOX) if with_edge else None

    def figure(self, frame: Frame) -> Any:
        """Return the picture of a frame as a Matplotlib ``Figure``; the next call changes it."""
        self._title.set_text("      ".join(title_parts(frame)))
        self._put(self._left, frame, self._camera)
        if self._right is not None:
            close = bool(len(frame.edge_points))
            self._right.set_visible(close)
            for patch in self._left.patches:
                patch.remove()
            if close:
                camera = close_camera(frame, self._camera, self._close_shape)
                self._put(self._right, frame, camera, "tooth 1")
                from matplotlib.patches import Circle

                at = self._camera.project(camera.centre)[:2] / OVERSAMPLING  # a circle around it
                seen = 0.5 * min(camera.shape) / camera.scale * self._camera.scale / OVERSAMPLING
                self._left.add_patch(
                    Circle(tuple(at), seen, fill=False, ls="--", lw=1.2, ec="0.25")
                )
        return self._figure

    def image(self, frame: Frame) -> npt.NDArray[np.uint8]:
        """Return the picture of a frame, shape (height, width, 3)."""
        canvas = self.figure(frame).canvas
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()

    def _put(self, axes: Any, frame: Frame, camera: Camera, label: str = "") -> None:
        image = picture(frame, camera, self._look, self._limits)
        if axes.images:
            axes.images[0].set_data(eight_bit(image))
            return
        show(axes, image, camera.shape[1] / camera.scale)
        if label:
            axes.text(0.03, 0.955, label, transform=axes.transAxes, fontsize=12, bbox=PAPER)


def limits_of(seen: Sequence[Frame], look: Look) -> tuple[tuple[float, float], list[Floats]]:
    """Return the ends of the colour scale of some frames, and the numbers that it shows."""
    field = look.field_of(seen[0])
    values = [field.values(frame) for frame in seen]
    return look.limits_for(values, field.sign), values


def close_camera(frame: Frame, whole: Camera, shape: tuple[int, int]) -> Camera:
    """Return a camera that looks in the same direction at the first tooth.

    shape : height and width of the picture [pixel].
    """
    centre, radius = tooth_ball(frame)
    height, width = (OVERSAMPLING * n for n in shape)
    scale = min(height, width) / (2.0 * radius)
    return replace(whole, centre=centre, scale=scale, shape=(height, width))


def tooth_ball(frame: Frame) -> tuple[Floats, float]:
    """Return centre and radius [mm] of what a close-up shows: the first tooth, near its edge.

    Of a tooth that is large beside the film, it is where its edge meets the film. The radius is the
    same in all frames of a run, so all its close-ups have one scale.
    """
    edge = frame.edge_points[frame.edge_tooth == frame.edge_tooth[0]]
    faces = frame.tool_triangles[frame.tool_tooth == frame.edge_tooth[0]]
    # Along the tool's own axes, where a tooth keeps its place.
    ends, body = (
        (points.reshape(-1, 3) - frame.tool_translation) @ frame.tool_rotation
        for points in (edge, frame.tool_points[faces])
    )
    low, high = ends.min(axis=0), ends.max(axis=0)
    reach = np.linalg.norm(high - low)
    points = np.concatenate([ends, body.clip(low - reach, high + reach)])
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = max(_AROUND * norm(points - middle).max(), _QUADS * edge_length(frame))
    most = _MOST * np.ptp(frame.reference, axis=0).max()
    if radius <= most:
        return middle @ frame.tool_rotation.T + frame.tool_translation, float(radius)
    middles = edge.mean(axis=1)
    distance = np.linalg.norm(middles[:, np.newaxis] - frame.points, axis=2)
    return middles[np.argmin(distance.min(axis=1))], float(most)
