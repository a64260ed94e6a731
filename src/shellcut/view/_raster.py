"""An orthographic camera and a canvas with a depth buffer, in NumPy.

Matplotlib sorts whole collections, so a tool that sticks through a sheet cannot be drawn by it.
Here every pixel keeps the depth of what it shows: triangles may cut through each other, and a
semi-transparent part is a canvas of its own, laid over the other where it is nearer. A million
pixels of sheet cost about 0.2 s.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from shellcut.frame import Floats, Ints

# Pixels tried at once; keeps the temporaries within the cache and some 10 MB.
_BATCH = 1_000_000


@dataclass(frozen=True, eq=False)
class Camera:
    """An orthographic camera.

    Attributes
    ----------
    axes : ndarray, shape (3, 3), [-]
        Unit vectors to the right, up, and toward the viewer, as rows.
    centre : ndarray, shape (3,), [mm]
        The point shown in the middle of the picture.
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
        """Return pixel column, pixel row and depth [pixel], nearer is more; shape (..., 3)."""
        out = (points - self.centre) @ self.axes.T * self.scale
        out[..., 0] += 0.5 * self.shape[1]
        out[..., 1] = 0.5 * self.shape[0] - out[..., 1]
        return out


def view_axes(toward: Floats, up: Floats) -> Floats:
    """Return the camera's axes for a direction toward the viewer and one that is to point up."""
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

    Attributes
    ----------
    color : ndarray, shape (height * width, 3), [-]
        Red, green, blue in 0..1.
    depth : ndarray, shape (height * width,), [pixel]
        Depth of what each pixel shows; minus infinity where nothing is.
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self.color = np.ones((shape[0] * shape[1], 3))
        self.depth = np.full(shape[0] * shape[1], -np.inf)

    def draw(self, corners: Floats, color: Floats) -> None:
        """Draw opaque triangles.

        corners : (n, 3, 3), projected.  color : (n, 3) or (3,).
        """
        color = np.broadcast_to(color, (len(corners), 3))
        for pixel, depth, triangle in _fragments(corners, self.shape):
            np.maximum.at(self.depth, pixel, depth)
            seen = depth == self.depth[pixel]
            self.color[pixel[seen]] = color[triangle[seen]]

    def draw_lines(self, ends: Floats, color: Any, width: float) -> None:
        """Draw opaque segments, brought forward by their width so that surfaces do not eat them.

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
        drawn = np.isfinite(layer.depth)
        seen = drawn if through else drawn & (layer.depth > self.depth)
        self.color[seen] += opacity * (layer.color[seen] - self.color[seen])

    def image(self, oversampling: int) -> Floats:
        """Return the picture, shape (height / oversampling, width / oversampling, 3)."""
        h, w = self.shape[0] // oversampling, self.shape[1] // oversampling
        blocks = self.color.reshape(h, oversampling, w, oversampling, 3)
        return np.asarray(blocks.mean(axis=(1, 3)))


def shade(corners: Floats, axes: Floats, color: Floats) -> Floats:
    """Return colours darkened by a lamp above the viewer's left shoulder (Lambert).

    corners : (n, m, 3), [mm], polygons of m = 3 or 4.  color : (n, 3) or (3,).
    """
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    length = np.linalg.norm(normal, axis=1)
    lamp = np.array([-0.45, 0.6, 0.66]) @ axes
    facing = np.abs(normal @ lamp) / np.where(length > 0.0, length, 1.0)
    return np.asarray((0.45 + 0.55 * facing)[:, np.newaxis] * color)


def _fragments(corners: Floats, shape: tuple[int, int]) -> Iterator[tuple[Ints, Floats, Ints]]:
    # The pixels whose middle lies in a triangle, with depth and triangle id. Triangles whose boxes
    # have like sizes are tried together, one array operation for all.
    height, width = shape
    low = np.ceil(corners[..., :2].min(axis=1) - 0.5).clip(0)
    high = np.floor(corners[..., :2].max(axis=1) - 0.5).clip(None, (width - 1, height - 1))
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    ids = np.flatnonzero((high >= low).all(axis=1) & (area != 0.0))
    if not len(ids):
        return
    low, high, area = low[ids], high[ids], area[ids]
    # barycentric coordinate k at (x, y) = slope[k, 0] x + slope[k, 1] y + offset[k]
    p, q = corners[ids][:, [1, 2, 0]], corners[ids][:, [2, 0, 1]]
    slope = np.stack((p[..., 1] - q[..., 1], q[..., 0] - p[..., 0]), axis=-1)
    slope /= area[:, np.newaxis, np.newaxis]
    offset = (p[..., 0] * q[..., 1] - q[..., 0] * p[..., 1]) / area[:, np.newaxis]
    z = corners[ids, :, 2]
    z_slope = np.einsum("nk,nkd->nd", z, slope)
    z_offset = np.einsum("nk,nk->n", z, offset)

    size = np.ceil(np.log2(high - low + 1)).astype(int)
    kind = size[:, 0] * 64 + size[:, 1]
    for one in np.unique(kind):
        n_x, n_y = 2 ** (one // 64), 2 ** (one % 64)
        members = np.flatnonzero(kind == one)
        for batch in np.array_split(members, -(-len(members) * n_x * n_y // _BATCH)):
            x = low[batch, 0, np.newaxis] + np.arange(n_x)
            y = low[batch, 1, np.newaxis] + np.arange(n_y)
            inside = (y <= high[batch, 1, np.newaxis])[:, :, np.newaxis] & (
                x <= high[batch, 0, np.newaxis]
            )[:, np.newaxis, :]
            for k in range(3):
                of_x = slope[batch, k, 0, np.newaxis] * (x + 0.5) + offset[batch, k, np.newaxis]
                of_y = slope[batch, k, 1, np.newaxis] * (y + 0.5)
                inside &= of_x[:, np.newaxis, :] >= -of_y[:, :, np.newaxis]
            t, row, column = np.nonzero(inside)
            x_in, y_in, t_in = x[t, column], y[t, row], batch[t]
            depth = (
                z_slope[t_in, 0] * (x_in + 0.5) + z_slope[t_in, 1] * (y_in + 0.5) + z_offset[t_in]
            )
            yield (y_in * width + x_in).astype(np.int64), depth, ids[t_in]
