"""Pictures of frames without text, for figures and pages that add their own."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

from shellcut.arrays import Floats
from shellcut.frame import Frame

from ._close_camera import close_camera
from ._panel import (
    OVERSAMPLING,
    eight_bit,
    picture,
    round_length,
    whole_camera,
)
from ._raster import Camera
from .look import Look


@dataclass(frozen=True, eq=False)
class Panel:
    """One picture and its camera."""

    image: Floats
    """Red, green, blue in 0..1, shape (height, width, 3)."""
    camera: Camera

    @property
    def bar(self) -> tuple[float, float]:
        """A round length of about a sixth of the width [mm], and its share of the width."""
        whole = self.image.shape[1] * OVERSAMPLING / self.camera.scale
        length = round_length(whole / 6.0)
        return length, length / whole

    def png(self) -> bytes:
        """Return the picture as the bytes of a PNG."""
        from PIL import Image

        file = io.BytesIO()
        Image.fromarray(eight_bit(self.image)).save(file, "PNG", optimize=True)
        return file.getvalue()


class Panels:
    """Panels of the frames of a run: the whole film, and a tooth with a camera that follows it.

    Parameters
    ----------
    seen : sequence of Frame
        Frames that the camera of the whole film must cover.
    shape : (int, int)
        Height and width of the picture of the whole film [pixel].
    close_shape : (int, int), optional
        The same for the picture of the tooth.
    look : Look
    """

    def __init__(
        self,
        seen: Sequence[Frame],
        *,
        shape: tuple[int, int],
        close_shape: tuple[int, int] | None = None,
        look: Look,
    ) -> None:
        field = look.field_of(seen[0])
        self.look, self.values = look, [field.values(frame) for frame in seen]
        self.limits = look.limits_for(self.values, field.sign)
        self._camera = whole_camera(seen, shape, look)
        self._close_shape = close_shape or shape

    def whole(self, frame: Frame) -> Panel:
        """Return the picture of the whole film."""
        return self._panel(frame, self._camera)

    def close(self, frame: Frame) -> Panel | None:
        """Return the picture of the first tooth; None without cutting edges."""
        if not len(frame.edge_points):
            return None
        camera = close_camera(frame, self._camera.axes[2], self._close_shape)
        return self._panel(frame, camera)

    def mark(self, close: Panel) -> tuple[float, float, float]:
        """Return a circle in the picture of the whole film that marks a close-up.

        Returns
        -------
        x, y, radius : float
            From the upper left corner [pixel].
        """
        x, y, _ = self._camera.project(close.camera.centre) / OVERSAMPLING
        radius = 0.5 * close.camera.shape[0] / close.camera.scale * self._camera.scale
        return float(x), float(y), radius / OVERSAMPLING

    def _panel(self, frame: Frame, camera: Camera) -> Panel:
        return Panel(picture(frame, camera, self.look, self.limits), camera)
