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
from shellcut.numerics.jit import inline, kernel

# How far a pixel may lie outside a triangle, relative to its height: a pixel centre on the seam of
# two triangles is then in one of them in spite of round-off.
_SEAM = 1e-9

_AMBIENT, _HEAD = 0.35, 0.25  # shares of the light that come from all sides and from the viewer
_THROUGH = 0.7  # share of the lamp's light that shines through the film
_GLEAM, _GLOSS = 0.3, 14.0  # the gleam and its exponent
_SHADE = 0.4  # of the light that a shadow takes
_SOFT = 3  # half the width of a shadow's rim [pixel]
_NEAR = 10.0  # how far the owner of a shadow is in front [pixel]


@dataclass(frozen=True, eq=False)
class Camera:
    """An orthographic camera."""

    axes: Floats
    """Unit vectors to the right, up, and toward the viewer, as rows, shape (3, 3)."""
    centre: Floats
    """The point in the middle of the picture, shape (3,)."""
    scale: float
    """Pixels per mm."""
    shape: tuple[int, int]
    """Height and width of the picture in pixels."""

    def project(self, points: Floats) -> Floats:
        """Return pixel column, pixel row and depth [pixel], larger is nearer; shape (..., 3)."""
        out = (points - self.centre) @ self.axes.T * self.scale
        out[..., 0] += 0.5 * self.shape[1]
        out[..., 1] = 0.5 * self.shape[0] - out[..., 1]
        return out

    def points(self, pixels: Floats) -> Floats:
        """Return the points [mm] whose projections are given, shape (..., 3)."""
        middle = 0.5 * np.array([self.shape[1], self.shape[0], 0.0])
        return self.centre + (pixels - middle) * [1.0, -1.0, 1.0] @ self.axes / self.scale


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


LAMP = np.array([-0.45, 0.6, 0.66]) / np.linalg.norm([-0.45, 0.6, 0.66])
"""Unit vector to the lamp, above the viewer's left shoulder, along the camera's axes."""
_LAMP = tuple(LAMP.tolist())
_BETWEEN = LAMP + np.array([0.0, 0.0, 1.0])  # lamp and viewer
_HALF = tuple((_BETWEEN / np.linalg.norm(_BETWEEN)).tolist())


class Canvas:
    """Colours and depths of the pixels of one picture.

    Single precision is enough for a picture, and halves the memory that drawing moves.
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self.color = np.ones((shape[0] * shape[1], 3), np.float32)
        """Red, green, blue in 0..1 of each pixel."""
        self.depth = np.full(shape[0] * shape[1], -np.inf, np.float32)
        """Of each pixel [pixel]; minus infinity where nothing is drawn."""

    def draw(
        self,
        corners: Floats,
        colors: Floats,
        values: Floats | None = None,
        normals: Floats | None = None,
    ) -> None:
        """Draw opaque triangles.

        corners : (n, 3, 3), projected.  colors : (3,), or (m, 3), along which values pick.
        values : (n, 3), at the corners, 0..1.  normals : (n, 3, 3), along the camera's axes, for
        light and shade; without them a colour stays as it is.
        """
        height, width = self.shape
        table = np.ascontiguousarray(np.atleast_2d(colors), float)
        shape = corners.shape[:2]
        values = np.zeros(shape) if values is None else np.ascontiguousarray(values)
        lit = normals is not None
        normals = np.ascontiguousarray(normals) if lit else np.zeros((*shape, 3))
        corners = np.ascontiguousarray(corners, float)
        _fill(corners, values, normals, lit, table, width, height, self.depth, self.color)

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

    def darken(self, camera: Camera, lamp: Camera, seen: Canvas) -> None:
        """Put into the shade what the lamp does not see; ``seen`` : what it sees, its picture."""
        origin = lamp.project(camera.points(np.zeros(3)))
        turn = lamp.project(camera.points(np.eye(3))) - origin
        _darken(self.shape[1], turn, origin, seen.shape[1], seen.depth, self.depth, self.color)

    def image(self, oversampling: int) -> Floats:
        """Return the picture, shape (height / oversampling, width / oversampling, 3)."""
        n = oversampling
        blocks = self.color.reshape(self.shape[0] // n, n, self.shape[1] // n, n, 3)
        # One pixel of each block at a time takes a fifth of the time of a mean over two axes.
        parts = [blocks[:, i, :, j] for i in range(n) for j in range(n)]
        return np.asarray(sum(parts[1:], start=parts[0]) / n**2)


@inline
def _light(x: float, y: float, z: float) -> float:
    """Return how bright a surface is (Lambert), with the gleam on it (Blinn and Phong).

    Its normal, of any length, is turned toward the viewer.
    """
    length = np.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return 1.0
    length = length if z >= 0.0 else -length
    x, y, z = x / length, y / length, z / length
    facing = x * _LAMP[0] + y * _LAMP[1] + z * _LAMP[2]
    facing = max(facing, -_THROUGH * facing)
    half = max(0.0, x * _HALF[0] + y * _HALF[1] + z * _HALF[2])
    bright = _AMBIENT + _HEAD * z + (1.0 - _AMBIENT - _HEAD) * facing / _LAMP[2]
    return float(bright * (1.0 + _GLEAM * half**_GLOSS))


@kernel
def _fill(
    corners: Floats,
    values: Floats,
    normals: Floats,
    lit: bool,
    table: Floats,
    width: int,
    height: int,
    depth: Numbers,
    pixels: Numbers,
) -> None:
    """Colour the pixels with their centre in a triangle, where it is nearer than their content.

    corners : (n, 3, 3), projected.  values : (n, 3).  normals : (n, 3, 3).  table : (m, 3).
    depth : (height * width,), written.  pixels : (height * width, 3), written.
    """
    weight = np.empty((3, 3))  # barycentric k at (x, y): weight[k] . (x, y, 1)
    plane = np.empty((5, 3))  # depth, value and normal at (x, y), likewise
    at = np.empty(5)
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
                plane[0, m] += p[k, 2] * weight[k, m]
                plane[1, m] += values[t, k] * weight[k, m]
                for axis in range(3):
                    plane[2 + axis, m] += normals[t, k, axis] * weight[k, m]
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
                z = plane[0, 0] * x + (plane[0, 1] * y + plane[0, 2])
                pixel = row * width + column
                if z >= depth[pixel]:
                    depth[pixel] = z
                    for k in range(1, 5):
                        at[k] = plane[k, 0] * x + (plane[k, 1] * y + plane[k, 2])
                    bright = _light(at[2], at[3], at[4]) if lit else 1.0
                    place = int(min(max(at[1], 0.0), 1.0) * (len(table) - 1) + 0.5)
                    # Light up to where one of the three is full keeps the hue, which is read.
                    most = max(table[place, 0], table[place, 1], table[place, 2])
                    bright = min(bright, 1.0 / most) if most > 0.0 else 0.0
                    for m in range(3):
                        pixels[pixel, m] = table[place, m] * bright


@kernel
def _darken(
    width: int,
    turn: Floats,
    origin: Floats,
    lamp_width: int,
    seen: Numbers,
    depth: Numbers,
    pixels: Numbers,
) -> None:
    """Darken the pixels by the share of nine places around them that the lamp does not see.

    turn : (3, 3), origin : (3,), from a pixel and its depth to those of the lamp's picture.
    seen : depths of that, (lamp_height * lamp_width,).  depth, pixels : of the picture, as above.
    """
    lamp_height = len(seen) // lamp_width
    for pixel in range(len(depth)):
        if depth[pixel] == -np.inf:
            continue
        x, y, z = pixel % width + 0.5, pixel // width + 0.5, depth[pixel]
        column = int(origin[0] + x * turn[0, 0] + y * turn[1, 0] + z * turn[2, 0])
        row = int(origin[1] + x * turn[0, 1] + y * turn[1, 1] + z * turn[2, 1])
        behind = origin[2] + x * turn[0, 2] + y * turn[1, 2] + z * turn[2, 2] + _NEAR
        hidden = 0
        for i in range(row - _SOFT, row + _SOFT + 1, _SOFT):
            for j in range(column - _SOFT, column + _SOFT + 1, _SOFT):
                if 0 <= i < lamp_height and 0 <= j < lamp_width:
                    hidden += seen[i * lamp_width + j] > behind
        for m in range(3):
            pixels[pixel, m] *= 1.0 - _SHADE * hidden / 9.0


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
