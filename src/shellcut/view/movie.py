"""Movie of the cut: MP4 by ffmpeg, GIF by Pillow."""

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

from shellcut.files.whole_file import atomic_write
from shellcut.frame import Frame

from .fields import STRESSES
from .progress import Progress
from .snapshot import scene_series

Image = npt.NDArray[np.uint8]


def draw_movie(
    path: str | os.PathLike[str],
    frames: Sequence[Frame],
    *,
    fps: float = 12.0,
    stress: str = "largest principal",
    stress_limits: tuple[float, float] | None = None,
    size: tuple[int, int] = (960, 640),
    progress: bool = True,
) -> None:
    """Draw the frames one after the other, with one camera and one stress scale.

    Parameters
    ----------
    path : str or Path
        ``.mp4`` (H.264; needs ffmpeg) or ``.gif``; the finished file replaces an old one.
    frames : sequence of Frame
        Frames of one run, in order of time.
    fps : float
        Frames per second.
    stress, stress_limits
        As in :func:`draw_scene`; default limits are computed from all frames.
    size : (int, int)
        Width and height, even numbers [pixel].
    progress : bool
        Whether to show progress on standard error.

    Raises
    ------
    ImportError
        If a package to draw or write is not installed, with the command to install it.
    ValueError
        If there is no frame, or suffix, stress or size is invalid.
    OSError
        If ffmpeg fails.
    """
    path = Path(path)
    problems = []
    if path.suffix.lower() not in _WRITERS:
        problems.append(f"a movie's file ends with .mp4 or .gif, got {path.name!r}")
    if not len(frames):
        problems.append("a movie needs at least one frame, got none")
    if stress not in STRESSES:
        problems.append(f"stress must be one of {', '.join(STRESSES)}, got {stress!r}")
    if size[0] % 2 or size[1] % 2 or min(size) < 2:
        problems.append(f"width and height must be even numbers of pixels, got {size}")
    if not fps > 0.0:
        problems.append(f"fps must be positive, got {fps}")
    if problems:
        raise ValueError("; ".join(problems))
    series = scene_series(frames, stress, stress_limits, size)
    images = (series.image(frame) for frame in frames)
    shown = _followed(images, len(frames), path.name) if progress else images
    with atomic_write(path) as temporary:
        _WRITERS[path.suffix.lower()](temporary, shown, fps, size)


def _followed(images: Iterator[Image], n: int, name: str) -> Iterator[Image]:
    """Yield the images and show their count on standard error."""
    with Progress(name, step_name="frames") as progress:
        progress.update(0.0, step=0)
        for k, image in enumerate(images, start=1):
            yield image
            progress.update(k / n, step=k)


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
    try:
        import imageio_ffmpeg
    except ImportError as error:
        found = shutil.which("ffmpeg")
        if found is None:
            raise ImportError(
                "an MP4 needs ffmpeg, which is not installed: pip install shellcut[movie]; "
                "a .gif needs nothing more"
            ) from error
        return found
    return str(imageio_ffmpeg.get_ffmpeg_exe())


def _write_gif(path: Path, images: Iterator[Image], fps: float, _: tuple[int, int]) -> None:
    # Frames in full colour would fill the memory.
    pictures = [_of_256_colours(image) for image in images]
    pictures[0].save(
        path, save_all=True, append_images=pictures[1:], duration=round(1000.0 / fps), loop=0
    )


def _of_256_colours(image: Image) -> Any:
    """Return a Pillow picture with its own palette and no dithering.

    Pillow's palettes either weigh areas and lose the few pixels of a cable, or weigh the spread of
    colours and make a smooth film blotchy. So the palette is the median cut of colours weighted by
    the square root of their number of pixels.
    """
    from PIL import Image as Pillow

    colours = image.reshape(-1, 3)
    coarse = (colours >> 3).astype(np.int64) @ [1 << 10, 1 << 5, 1]
    _, which, n_pixel = np.unique(coarse, return_inverse=True, return_counts=True)
    sums = [np.bincount(which, weights=colours[:, k]) for k in range(3)]
    means = np.rint(np.stack(sums, axis=1) / n_pixel[:, None]).astype(np.uint8)
    counted = np.repeat(means, np.ceil(np.sqrt(n_pixel)).astype(np.int64), axis=0)
    palette = Pillow.fromarray(counted[None]).quantize(method=Pillow.Quantize.MEDIANCUT, kmeans=1)
    return Pillow.fromarray(image).quantize(palette=palette, dither=Pillow.Dither.NONE)


_WRITERS: dict[str, Any] = {".mp4": _write_mp4, ".gif": _write_gif}
