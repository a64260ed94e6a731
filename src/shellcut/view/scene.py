"""A frame in 3-D as one picture: film coloured by a stress, cables, tool, cutting edges."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from shellcut.files.whole_file import atomic_write
from shellcut.frame import Frame

from ._figure import inches_of
from .fields import STRESSES
from .snapshot import SnapshotSeries


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
    """Return pictures of the whole film that share camera, scale and legend."""
    inches, dpi = inches_of(size)
    return SnapshotSeries(
        seen, close_up=False, stress=stress, stress_limits=limits, size=inches, dpi=dpi
    )
