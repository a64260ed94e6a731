"""One picture of the cut: the whole film alone, or with one tooth on its right."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt

from shellcut.files.whole_file import atomic_write
from shellcut.frame import Frame

from ._figure import inches_of, new_figure, save
from ._panel import add_color_bar, add_legend, eight_bit, pixels_of, show, title_parts
from .fields import STRESSES
from .panels import Panel, Panels

# Left, bottom, width and height of the panels, relative to the figure.
_LEFT_BOX, _RIGHT_BOX = (0.01, 0.12, 0.545, 0.80), (0.565, 0.12, 0.425, 0.80)
_ONLY_BOX = (0.01, 0.12, 0.98, 0.80)
_SCALE = "stress scale"  # keyword of a PNG's text


def draw_snapshot(
    path: str | os.PathLike[str] | IO[bytes],
    frame: Frame,
    *,
    stress_limits: tuple[float, float] | None = None,
    size: tuple[float, float] = (13.0, 7.0),
    dpi: float = 90.0,
) -> None:
    """Draw one frame to a picture file.

    The film is coloured by its largest principal stress, the flanks of the crack are bold, colours
    distinguish straight cables from those bent around the edge, the tool is a semi-transparent
    solid with red cutting edges. Edges and cables hidden by the film shine through.

    Parameters
    ----------
    path : str, Path or binary file
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
        An open file gets a PNG.
    frame : Frame
        The frame to draw. Without a cutting edge only the whole model is drawn.
    stress_limits : (float, float), optional
        Limits of the colour scale [MPa]; by default 0 and a round number above nearly all quads.
        Give them to compare pictures of one run.
    size : (float, float)
        Width and height [inch].
    dpi : float
        Pixels per inch.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    series = SnapshotSeries([frame], stress_limits=stress_limits, size=size, dpi=dpi)
    low, high = series.stress_limits
    save(series.figure(frame), path, {_SCALE: f"{low!r} to {high!r} MPa"})


def draw_scene(
    path: str | os.PathLike[str],
    frame: Frame,
    *,
    stress: str = "largest principal",
    stress_limits: tuple[float, float] | None = None,
    together_with: Sequence[Frame] = (),
    size: tuple[int, int] = (1280, 800),
) -> None:
    """Draw one frame to a picture file.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Pillow knows; replaced if it exists.
    frame : Frame
        The frame to draw.
    stress : str
        One of :data:`STRESSES`.
    stress_limits : (float, float), optional
        Limits of the colour scale [MPa]; by default round numbers around nearly all quads.
    together_with : sequence of Frame
        Other frames of the run that camera, scale and legend must cover. With all of them the
        picture equals the frame of :func:`draw_movie`.
    size : (int, int)
        Width and height [pixel].

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If there is no such stress.
    """
    if stress not in STRESSES:
        raise ValueError(f"stress must be one of {', '.join(STRESSES)}, got {stress!r}")
    series = scene_series([frame, *together_with], stress, stress_limits, size)
    from PIL import Image

    with atomic_write(Path(path)) as temporary:
        Image.fromarray(series.image(frame)).save(temporary)


def scene_series(
    seen: Sequence[Frame],
    stress: str,
    limits: tuple[float, float] | None,
    size: tuple[int, int],
) -> SnapshotSeries:
    """Return pictures of the whole film that share camera, scale and legend; size in pixels."""
    inches, dpi = inches_of(size)
    return SnapshotSeries(
        seen, close_up=False, stress=stress, stress_limits=limits, size=inches, dpi=dpi
    )


def snapshot_limits(path: str | os.PathLike[str]) -> tuple[float, float] | None:
    """Return the limits of the stress scale of a snapshot [MPa].

    Parameters
    ----------
    path : str or Path
        A PNG written by :func:`draw_snapshot`.

    Returns
    -------
    (float, float) or None
        None if the picture does not contain them.

    Raises
    ------
    OSError
        If the file is no picture.
    """
    from PIL import Image

    with Image.open(path) as picture:
        found = re.fullmatch(r"(\S+) to (\S+) MPa", str(picture.info.get(_SCALE, "")))
    return (float(found[1]), float(found[2])) if found else None


class SnapshotSeries:
    """Snapshots of a run with one camera, one scale and one legend.

    The figure is created once; each frame changes its pictures, title and circle.

    Parameters
    ----------
    seen : sequence of Frame
        Frames that the left camera and the legend must cover.
    size, dpi
        As in :func:`draw_snapshot`.
    close_up : bool
        Whether a tooth is shown beside the whole, where there are cutting edges.
    stress, stress_limits
        As in :class:`Panels`.
    """

    def __init__(
        self,
        seen: Sequence[Frame],
        *,
        size: tuple[float, float],
        dpi: float,
        close_up: bool = True,
        stress: str = "largest principal",
        stress_limits: tuple[float, float] | None = None,
    ) -> None:
        with_edge = close_up and any(len(frame.edge_points) for frame in seen)
        box = _LEFT_BOX if with_edge else _ONLY_BOX
        self._panels = Panels(
            seen,
            shape=pixels_of(box, size, dpi),
            close_shape=pixels_of(_RIGHT_BOX, size, dpi),
            stress=stress,
            stress_limits=stress_limits,
        )
        self._figure = new_figure(size, dpi)
        values = [self._panels.values(frame) for frame in seen]
        bar = (0.04, 0.075, 0.30, 0.02)
        add_color_bar(self._figure, self._panels.scale, values, bar, label=f"{stress} stress [MPa]")
        add_legend(self._figure, seen, bbox_to_anchor=(0.995, 0.025))
        self._title = self._figure.suptitle("", fontsize=15, y=0.975)
        self._left = self._figure.add_axes(box)
        self._right = self._figure.add_axes(_RIGHT_BOX) if with_edge else None
        self._circle: Any = None

    @property
    def stress_limits(self) -> tuple[float, float]:
        """Limits of the colour scale [MPa]."""
        return self._panels.stress_limits

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
        axes.text(0.03, 0.955, label, transform=axes.transAxes, fontsize=12)


def _circle(axes: Any, circle: Any, x: float, y: float, radius: float) -> Any:
    from matplotlib.patches import Circle

    if circle is None:
        circle = axes.add_patch(Circle((x, y), radius, fill=False, ls="--", lw=1.2, ec="0.25"))
    circle.center, circle.radius = (x, y), radius
    return circle
