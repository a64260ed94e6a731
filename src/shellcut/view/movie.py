"""Movie of the cut: MP4 by ffmpeg, WebP and GIF by Pillow."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.files.distribution import optional
from shellcut.files.whole_file import atomic_write
from shellcut.frame import Frame

from .look import Look
from .progress import Progress
from .snapshot import SnapshotSeries

Image = npt.NDArray[np.uint8]
_LOOK = Look()


def draw_movie(
    path: str | os.PathLike[str],
    frames: Sequence[Frame],
    *,
    fps: float = 12.0,
    look: Look = _LOOK,
    size: tuple[int, int] | None = None,
) -> None:
    """Draw the frames one after the other, with one camera and one scale; say how far it is.

    Parameters
    ----------
    path : str or Path
        ``.mp4`` (H.264; needs ffmpeg), ``.webp`` or ``.gif``, which has 256 colours; the finished
        file replaces an old one.
    frames : sequence of Frame
        Frames of one run, in order of time.
    fps : float
        Frames per second.
    look : Look
        As in :func:`draw_scene`; default limits are computed from all frames.
    size : (int, int), optional
        Width and height, even numbers [pixel]; by default 1920 x 1080 of an MP4, 960 x 540 of
        others.

    Raises
    ------
    ImportError
        If a package to draw or write is not installed, with the command to install it.
    ValueError
        If there is no frame, or suffix, field or size is invalid.
    OSError
        If ffmpeg fails.
    """
    path = Path(path)
    problems = []
    kind = path.suffix.lower()
    size = size or ((1920, 1080) if kind == ".mp4" else (960, 540))
    if kind not in MOVIES:
        problems.append(f"a movie's file ends with {' or '.join(MOVIES)}, got {path.name!r}")
    if not len(frames):
        problems.append("a movie needs at least one frame, got none")
    if size[0] % 2 or size[1] % 2:
        problems.append(f"width and height must be even numbers of pixels, got {size}")
    if not fps > 0.0:
        problems.append(f"fps must be positive, got {fps}")
    if problems:
        raise ValueError("; ".join(problems))
    series = SnapshotSeries(frames, look=look, size=size)

    def images() -> Iterator[Image]:
        with Progress(path.name) as progress:
            progress.update(0.0, step=0)
            for k, frame in enumerate(frames, start=1):
                yield series.image(frame)
                progress.update(k / len(frames), step=k)

    with atomic_write(path) as temporary:
        MOVIES[kind](temporary, images(), fps, size)


def _write_mp4(path: Path, images: Iterator[Image], fps: float, size: tuple[int, int]) -> None:
    raw = f"-f rawvideo -pix_fmt rgb24 -s {size[0]}x{size[1]} -r {fps} -i -"
    coded = "-an -c:v libx264 -pix_fmt yuv420p -movflags +faststart"
    command = [_ffmpeg(), "-y", "-loglevel", "error", *raw.split(), *coded.split(), str(path)]
    with (
        tempfile.TemporaryFile() as said,
        subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as coder,
    ):
        assert coder.stdin is not None
        try:
            for image in images:
                coder.stdin.write(np.ascontiguousarray(image).tobytes())
            coder.stdin.close()
        except BrokenPipeError:  # ffmpeg has stopped; its message is raised below
            pass
        failed = coder.wait() != 0
        said.seek(0)
        why = said.read().decode(errors="replace").strip()
    if failed:
        raise OSError(f"ffmpeg could not write {path}: {why}")


def _ffmpeg() -> str:
    needed = "an MP4 needs ffmpeg, which is not installed"
    instead = "; a .webp or .gif needs nothing more"
    try:
        return str(optional("imageio_ffmpeg", needed, "movie", instead=instead).get_ffmpeg_exe())
    except ImportError:
        if found := shutil.which("ffmpeg"):
            return found
        raise


def _write_by_pillow(path: Path, images: Iterator[Image], fps: float, _: tuple[int, int]) -> None:
    from PIL import Image as Pillow

    first, *others = map(Pillow.fromarray, images)
    how: dict[str, Any] = {"duration": round(1000.0 / fps), "loop": 0, "quality": 70, "method": 4}
    first.save(path, save_all=True, append_images=others, **how)


MOVIES: dict[str, Any] = {".mp4": _write_mp4, ".webp": _write_by_pillow, ".gif": _write_by_pillow}
"""Writers of movies by suffix."""
