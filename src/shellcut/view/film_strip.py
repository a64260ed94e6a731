"""The cut as a film strip: several frames side by side, with one camera and one stress scale."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence

from shellcut.frame import Frame

from ._figure import new_figure, save
from ._panel import add_color_bar, add_legend, caption_of, pixels_of, show
from .panels import Panels, height_over_width

_CAPTION = 0.42  # room above every frame [inch]
_FOOT = 0.95  # room for colour bar and legend [inch]
_GAP = 0.08  # between frames [inch]


def draw_film_strip(
    path: str | os.PathLike[str],
    frames: Sequence[Frame],
    *,
    columns: int = 3,
    stress_limits: tuple[float, float] | None = None,
    width: float = 13.0,
    dpi: float = 90.0,
) -> None:
    """Draw the frames in rows, each with its coordinate and first scalar.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
    frames : sequence of Frame
        Frames of one run, in order of time; all are drawn.
    columns : int
        Frames per row.
    stress_limits : (float, float), optional
        Limits of the colour scale [MPa]; by default 0 and a round number above nearly all quads of
        all frames.
    width : float
        Width of the picture [inch]; the height follows from the number of rows.
    dpi : float
        Pixels per inch.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If there is no frame, or no column.
    """
    if not frames or columns < 1:
        raise ValueError(
            f"a film strip needs at least one frame and one column, got {len(frames)} frames and "
            f"{columns} columns"
        )
    columns = min(columns, len(frames))
    rows = math.ceil(len(frames) / columns)
    each = (width - _GAP) / columns - _GAP
    tall = each * height_over_width(frames)
    size = (width, rows * (tall + _CAPTION + _GAP) + _FOOT)
    figure = new_figure(size, dpi)
    principal = [frame.quad_principal[:, 0] for frame in frames]
    shape = pixels_of((0.0, 0.0, each / size[0], tall / size[1]), size, dpi)
    panels = Panels(frames, shape=shape, stress_limits=stress_limits)
    for k, frame in enumerate(frames):
        row, column = divmod(k, columns)
        left = _GAP + column * (each + _GAP)
        top = size[1] - _CAPTION - row * (tall + _CAPTION + _GAP)
        axes = figure.add_axes(
            (left / size[0], (top - tall) / size[1], each / size[0], tall / size[1])
        )
        panel = panels.whole(frame)
        show(axes, panel.image, panel.bar if k == 0 else None)
        axes.set_title("    ".join(caption_of(frame)), fontsize=12)
    bar = (0.03, 0.52 / size[1], 0.26, 0.14 / size[1])
    add_color_bar(figure, panels.scale, principal, bar)
    add_legend(figure, frames, bbox_to_anchor=(0.995, 0.22 / size[1]))
    save(figure, path)
