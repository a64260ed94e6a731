"""One picture of the cut: the whole film alone, or with one tooth on its right."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.files.whole_file import atomic_write
from shellcut.frame import Frame
from shellcut.unit import in_unit

from ._figure import inches_of, new_figure
from ._panel import (
    PAPER,
    add_color_bar,
    add_legend,
    color_scale,
    eight_bit,
    pixels_of,
    show,
    title_parts,
)
from .look import Look
from .panels import Panel, Panels

# Left, bottom, width and height of the panels, relative to the figure.
_LEFT_BOX, _RIGHT_BOX = (0.01, 0.12, 0.545, 0.80), (0.565, 0.12, 0.425, 0.80)
_ONLY_BOX = (0.01, 0.12, 0.98, 0.80)
_LOOK = Look()


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
        If there is no such field or colour map.
    """
    series = SnapshotSeries([frame, *together_with], look=look, size=size, close_up=close_up)
    from PIL import Image

    with atomic_write(Path(path)) as temporary:
        Image.fromarray(series.image(frame)).save(temporary)


class SnapshotSeries:
    """Snapshots of a run with one camera, one scale and one legend.

    The figure is created once; each frame changes its pictures, title and circle.

    Parameters
    ----------
    seen : sequence of Frame
        Frames that the left camera and the legend must cover.
    look, size, close_up
        As in :func:`draw_scene`.
    """

    def __init__(
        self, seen: Sequence[Frame], *, look: Look, size: tuple[int, int], close_up: bool = False
    ) -> None:
        inches, dpi = inches_of(size)
        with_edge = close_up and any(len(frame.edge_points) for frame in seen)
        box = _LEFT_BOX if with_edge else _ONLY_BOX
        self._panels = Panels(
            seen,
            shape=pixels_of(box, inches, dpi),
            close_shape=pixels_of(_RIGHT_BOX, inches, dpi),
            look=look,
        )
        self._figure = new_figure(inches, dpi)
        if look.shows("film"):
            field = look.field_of(seen[0])
            bar, label = (0.04, 0.075, 0.30, 0.02), in_unit(field.label, field.unit)
            scale = color_scale(look, self._panels.limits)
            add_color_bar(self._figure, scale, self._panels.values, bar, label)
        add_legend(self._figure, seen, look, bbox_to_anchor=(0.995, 0.025))
        self._title = self._figure.suptitle("", fontsize=15, y=0.975)
        self._left = self._figure.add_axes(box)
        self._right = self._figure.add_axes(_RIGHT_BOX) if with_edge else None
        self._circle: Any = None

    def figure(self, frame: Frame) -> Any:
        """Return the picture of a frame as a Matplotlib figure; the next call changes it."""
        self._title.set_text("      ".join(title_parts(frame)))
        _put(self._left, self._panels.whole(frame))
        close = None
        if self._right is not None:
            close = self._panels.close(frame)
            self._right.set_visible(close is not None)
            if self._circle is not None:
                self._circle.set_visible(close is not None)
        if close is not None:
            _put(self._right, close, "tooth 1")
            self._circle = _circle(self._left, self._circle, *self._panels.mark(close))
        return self._figure

    def image(self, frame: Frame) -> npt.NDArray[np.uint8]:
        """Return the picture of a frame, shape (height, width, 3)."""
        canvas = self.figure(frame).canvas
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _put(axes: Any, panel: Panel, label: str = "") -> None:
    if axes.images:
        axes.images[0].set_data(eight_bit(panel.image))
        return
    show(axes, panel.image, panel.bar)
    if label:
        axes.text(0.03, 0.955, label, transform=axes.transAxes, fontsize=12, bbox=PAPER)


def _circle(axes: Any, circle: Any, x: float, y: float, radius: float) -> Any:
    from matplotlib.patches import Circle

    if circle is None:
        look = {"fill": False, "ls": "--", "lw": 1.2, "ec": "0.25", "clip_on": False}
        circle = axes.add_patch(Circle((x, y), radius, **look))
    circle.center, circle.radius = (x, y), radius
    return circle
