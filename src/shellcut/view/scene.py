"""A frame in 3-D, by PyVista: film coloured by a stress, cables, tool, cutting edges.

Where PyVista cannot draw, :func:`draw_snapshot` draws the frame with Matplotlib.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.files.whole_file import atomic_write
from shellcut.frame import Frame

from ._figure import inches_of, new_figure
from ._panel import add_color_bar, add_legend, caption_of, round_limits, stress_scale, whole_camera
from ._stage import Stage
from .renderer import pyvista_or_say
from .snapshot import draw_snapshot

STRESSES: dict[str, Callable[[Frame], Floats]] = {
    "largest principal": lambda frame: frame.quad_principal[:, 0],
    "smallest principal": lambda frame: frame.quad_principal[:, 1],
    "von Mises": lambda frame: _von_mises(frame.quad_principal),
    "largest principal, top": lambda frame: frame.quad_principal_top[:, 0],
    "largest principal, bottom": lambda frame: frame.quad_principal_bottom[:, 0],
}
"""Stresses that can colour the film: name -> values of the quads [MPa], the mean over the thickness
unless a face is named."""

_HEAD, _FOOT = 0.55, 0.85  # room for the title, and for colour bar and legend [inch]


def draw_scene(
    path: str | os.PathLike[str],
    frame: Frame,
    *,
    stress: str = "largest principal",
    stress_limits: tuple[float, float] | None = None,
    together_with: Sequence[Frame] = (),
    view: tuple[float, float] = (42.0, -60.0),
    size: tuple[int, int] = (1280, 800),
) -> None:
    """Draw one frame to a picture file, off screen.

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
    view : (float, float)
        Elevation above the x-y plane and azimuth from the x axis of the camera [deg].
    size : (int, int)
        Width and height [pixel].

    Raises
    ------
    ImportError
        If PyVista cannot draw here and Matplotlib is not installed.
    ValueError
        If there is no such stress.
    """
    _check_stress(stress)
    seen = [frame, *together_with]
    if not pyvista_or_say("drawn by Matplotlib, coloured by the largest principal stress"):
        limits = stress_limits if stress == "largest principal" else None
        inches, dpi = inches_of(size)
        draw_snapshot(
            path,
            frame,
            view=view,
            together_with=together_with,
            stress_limits=limits,
            size=inches,
            dpi=dpi,
        )
        return
    from PIL import Image

    limits = limits_for(seen, stress) if stress_limits is None else stress_limits
    with (
        SceneSeries(seen, stress=stress, stress_limits=limits, view=view, size=size) as series,
        atomic_write(Path(path)) as temporary,
    ):
        Image.fromarray(series.image(frame)).save(temporary)


def limits_for(frames: Sequence[Frame], stress: str) -> tuple[float, float]:
    """Return round limits of the colour scale that enclose nearly all quads of the frames [MPa].

    stress : one of :data:`STRESSES`.
    """
    values = np.concatenate([STRESSES[stress](frame) for frame in frames])
    if stress == "smallest principal":
        low, high = round_limits(-values)
        return -high, low
    return round_limits(values)


class SceneSeries:
    """Frames of a run with one camera, one scale and one legend, drawn one after the other.

    Use it as a context manager, and only if :func:`why_not_pyvista` returns None.

    Parameters
    ----------
    seen : sequence of Frame
        Frames that camera and legend must cover.
    stress, stress_limits, view, size
        As in :func:`draw_scene`; the limits are required.
    """

    def __init__(
        self,
        seen: Sequence[Frame],
        *,
        stress: str,
        stress_limits: tuple[float, float],
        view: tuple[float, float],
        size: tuple[int, int],
    ) -> None:
        self._values = STRESSES[stress]
        inches, dpi = inches_of(size)
        figure, tall = new_figure(inches, dpi), inches[1]
        foot, head = _FOOT / tall, _HEAD / tall
        scale = stress_scale(stress_limits)
        bar = (0.04, 0.62 * foot, 0.27, 0.14 / tall)
        values = [self._values(frame) for frame in seen]
        add_color_bar(figure, scale, values, bar, label=f"{stress} stress [MPa]")
        add_legend(figure, seen, bbox_to_anchor=(0.995, 0.3 * foot))
        figure.canvas.draw()
        self._title = figure.suptitle("", fontsize=15, y=1.0 - 0.4 * head)
        self._canvas = figure.canvas
        self._empty = figure.canvas.copy_from_bbox(figure.bbox)
        self._top = round(head * size[1])
        shape = (size[1] - self._top - round(foot * size[1]), size[0])
        camera = whole_camera(seen, view, shape)
        reach = 4.0 * max(np.ptp(f.points, axis=0).max() for f in seen)
        self._stage = Stage(camera, reach, scale, shape)

    def image(self, frame: Frame) -> npt.NDArray[np.uint8]:
        """Return the picture of a frame, shape (height, width, 3)."""
        self._canvas.restore_region(self._empty)
        self._title.set_text("      ".join(caption_of(frame)))
        self._canvas.figure.draw_artist(self._title)
        image = np.asarray(self._canvas.buffer_rgba())[..., :3].copy()
        drawn = self._stage.picture(frame, self._values(frame))
        image[self._top : self._top + len(drawn)] = drawn
        return image

    def __enter__(self) -> SceneSeries:
        return self

    def __exit__(self, *_: object) -> None:
        self._stage.close()


def _check_stress(stress: str) -> None:
    if stress not in STRESSES:
        raise ValueError(f"stress must be one of {', '.join(STRESSES)}, got {stress!r}")


def _von_mises(principal: Floats) -> Floats:
    a, b = principal[:, 0], principal[:, 1]
    return np.asarray(np.sqrt(a * a - a * b + b * b))
