"""An orthographic camera and a canvas with a depth buffer.

Matplotlib sorts whole collections, so it cannot draw a tool that sticks through a film. Here every
pixel stores the depth of its content: triangles may intersect, and a semi-transparent part is a
separate canvas, laid over the other where it is nearer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Numbers
from shellcut.numerics.jit import kernel

# How far a pixel may lie outside a triangle, relative to its height: a pixel centre on the seam of
# two triangles is then in one of them in spite of round-off.
_SEAM = 1e-9


@dataclass(frozen=True, eq=False)
class Camera:
    """An orthographic camera.

    Attributes
    ----------
    axes : ndarray, shape (3, 3), [-]
        Unit vectors to the right, up, and toward the viewer, as rows.
    centre : ndarray, shape (3,), [mm]
        The point in the middle of the picture.
    scale : float
        Pixels per mm.
    shape : (int, int)
        Height and width of the picture in pixels.
    """

    axes: Floats
    centre: Floats
    scale: float
    shape: tuple[int, int]

    def project(self, points: Floats) -> Floats:
        """Return pixel column, pixel row and depth [pixel], larger is nearer; shape (..., 3)."""
        out = (points - self.centre) @ self.axes.T * self.scale
        out[..., 0] += 0.5 * self.shape[1]
        out[..., 1] = 0.5 * self.shape[0] - out[..., 1]
        return out


def view_axes(toward: Floats, up: Floats) -> Floats:
    """Return the camera's axes for a direction toward the viewer and an upward direction."""
    toward = toward / np.linalg.norm(toward)
    right = np.cross(up, toward)
    length = np.linalg.norm(right)
    if length < 1e-6:  # seen along "up": any direction will do
        right = np.cross(np.roll(up, 1), toward)
        length = np.linalg.norm(right)
    right = right / length
    return np.stack((right, np.cross(toward, right), toward))


class Canvas:
    """Colours and depths of the pixels of one picture.

    Single precision is enough for a picture, and halves the memory that drawing moves.

    Attributes
    ----------
    color : ndarray of float32, shape (height * width, 3), [-]
        Red, green, blue in 0..1.
    depth : ndarray of float32, shape (height * width,), [pixel]
        Depth of each pixel; minus infinity where nothing is drawn.
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self.color = np.ones((shape[0] * shape[1], 3), np.float32)
        self.depth = np.full(shape[0] * shape[1], -np.inf, np.float32)

    def draw(self, corners: Floats, color: Floats) -> None:
        """Draw opaque triangles.

        corners : (n, 3, 3), projected.  color : (n, 3) or (3,).
        """
        height, width = self.shape
        each = np.ascontiguousarray(np.broadcast_to(color, (len(corners), 3)), float)
        _fill(np.ascontiguousarray(corners, float), each, width, height, self.depth, self.color)

    def draw_lines(self, ends: Floats, color: Any, width: float) -> None:
        """Draw opaque segments, shifted forward by their width so that surfaces do not hide them.

        ends : (n, 2, 3), projected.  width : [pixel].
        """
        along = ends[:, 1, :2] - ends[:, 0, :2]
        length = np.linalg.norm(along, axis=1, keepdims=True)
        along = np.divide(along, length, out=np.zeros_like(along), where=length > 0.0)
        along[length[:, 0] == 0.0, 0] = 1.0
        along *= 0.5 * width
        across = np.stack((-along[:, 1], along[:, 0]), axis=1)
        box = np.repeat(ends, 2, axis=1)  # a, a, b, b
        box[:, 0, :2] += -along - across
        box[:, 1, :2] += -along + across
        box[:, 2, :2] += along - across
        box[:, 3, :2] += along + across
        box[..., 2] += width
        corners = np.concatenate((box[:, [0, 1, 2]], box[:, [1, 3, 2]]))
        self.draw(corners, np.asarray(color, dtype=float))

    def blend(self, layer: Canvas, opacity: float, *, through: bool = False) -> None:
        """Lay another canvas over this one where it is nearer, or everywhere if ``through``."""
        _blend(layer.color, layer.depth, opacity, through, self.depth, self.color)

    def image(self, oversampling: int) -> Floats:
        """Return the picture, shape (height / oversampling, width / oversampling, 3)."""
        n = oversampling
        blocks = self.color.reshape(self.shape[0] // n, n, self.shape[1] // n, n, 3)
        # One pixel of each block at a time takes a fifth of the time of a mean over two axes.
        parts = [blocks[:, i, :, j] for i in range(n) for j in range(n)]
        return np.asarray(sum(parts[1:], start=parts[0]) / n**2)


def shade(corners: Floats, axes: Floats, color: Floats) -> Floats:
    """Return colours shaded by a lamp above the viewer's left shoulder (Lambert).

    corners : (n, m, 3), [mm], polygons of m = 3 or 4.  color : (n, 3) or (3,).
    """
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    length = np.linalg.norm(normal, axis=1)
    lamp = np.array([-0.45, 0.6, 0.66]) @ axes
    facing = np.abs(normal @ lamp) / np.where(length > 0.0, length, 1.0)
    return np.asarray((0.45 + 0.55 * facing)[:, np.newaxis] * color)


@kernel
def _fill(
    corners: Floats, color: Floats, width: int, height: int, depth: Numbers, pixels: Numbers
) -> None:
    """Colour the pixels with their centre in a triangle, where it is nearer than their content.

    corners : (n, 3, 3), projected.  color : (n, 3).  depth : (height * width,), written.
    pixels : (height * width, 3), written.
    """
    weight = np.empty((3, 3))  # barycentric k at (x, y): weight[k] . (x, y, 1)
    plane = np.empty(3)
    for t in range(len(corners)):
        p = corners[t]
        ab_x, ab_y = p[1, 0] - p[0, 0], p[1, 1] - p[0, 1]
        ac_x, ac_y = p[2, 0] - p[0, 0], p[2, 1] - p[0, 1]
        area = ab_x * ac_y - ab_y * ac_x
        if area == 0.0:
            continue
        plane[:] = 0.0
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            weight[k, 0] = (p[i, 1] - p[j, 1]) / area
            weight[k, 1] = (p[j, 0] - p[i, 0]) / area
            weight[k, 2] = (p[i, 0] * p[j, 1] - p[i, 1] * p[j, 0]) / area
            for m in range(3):
                plane[m] += p[k, 2] * weight[k, m]
        first_x = max(0, int(np.ceil(min(p[0, 0], p[1, 0], p[2, 0]) - 0.5)))
        last_x = min(width - 1, int(np.floor(max(p[0, 0], p[1, 0], p[2, 0]) - 0.5)))
        first_y = max(0, int(np.ceil(min(p[0, 1], p[1, 1], p[2, 1]) - 0.5)))
        last_y = min(height - 1, int(np.floor(max(p[0, 1], p[1, 1], p[2, 1]) - 0.5)))
        for row in range(first_y, last_y + 1):
            y = row + 0.5
            for column in range(first_x, last_x + 1):
                x = column + 0.5
                least = 1.0
                for k in range(3):
                    least = min(least, weight[k, 0] * x + (weight[k, 1] * y + weight[k, 2]))
                if least < -_SEAM:
                    continue
                z = plane[0] * x + (plane[1] * y + plane[2])
                pixel = row * width + column
                if z >= depth[pixel]:
                    depth[pixel] = z
                    for m in range(3):
                        pixels[pixel, m] = color[t, m]


@kernel
def _blend(
    color: Numbers,
    depth: Numbers,
    opacity: float,
    through: bool,
    depth_below: Numbers,
    pixels: Numbers,
) -> None:
    """Lay color : (n, 3) over pixels : (n, 3), where it is nearer or everywhere if ``through``.

    depth, depth_below : (n,), minus infinity where nothing is drawn.
    """
    for i in range(len(depth)):
        if depth[i] > -np.inf and (through or depth[i] > depth_below[i]):
            for m in range(3):
                pixels[i, m] += opacity * (color[i, m] - pixels[i, m])
