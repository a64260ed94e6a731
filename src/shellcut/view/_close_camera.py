"""The camera that follows the first tooth and shows its edge."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats
from shellcut.frame import Frame

from ._panel import OVERSAMPLING, edge_length
from ._raster import Camera, view_axes
from ._teeth import teeth_of

_VIEW = (40.0, 50.0)
"""Elevation above the film and bearing from the cut [deg]: 0 looks straight at the edge, 90 from
the left of its path."""


def close_camera(frame: Frame, toward: Floats, shape: tuple[int, int]) -> Camera:
    """Return a camera that follows the first tooth, on the side of the film that faces ``toward``.

    shape : height and width of the picture [pixel].
    """
    edge = frame.edge_points[teeth_of(frame.edge_points) == 0]
    middles = edge.mean(axis=1)
    distance = np.linalg.norm(middles[:, np.newaxis] - frame.points, axis=2)
    focus = middles[np.argmin(distance.min(axis=1))]  # where the edge meets the film
    normal = _membrane_normal(frame, focus)
    if normal @ toward < 0.0:  # both panels show the same side
        normal = -normal
    forward = _cutting_direction(frame, focus)
    forward = forward - (forward @ normal) * normal
    if np.linalg.norm(forward) < 1e-6:
        forward = np.cross(normal, np.roll(normal, 1))
    forward /= np.linalg.norm(forward)
    elevation, bearing = np.radians(_VIEW)
    level = np.cos(bearing) * forward + np.sin(bearing) * np.cross(normal, forward)
    axes = view_axes(np.cos(elevation) * level + np.sin(elevation) * normal, normal)
    length = np.linalg.norm(edge[:, 1] - edge[:, 0], axis=1).sum()
    # From constant data only, so that all pictures of a run have the same scale.
    whole = np.ptp(frame.reference, axis=0).max()
    close_width = max(min(1.3 * length, 0.25 * whole), 8.0 * edge_length(frame))
    height, width = (OVERSAMPLING * n for n in shape)
    # Show more of the cut than of the film ahead: shift the edge off the middle, forward.
    centre = focus - 0.12 * close_width * forward
    # The top of the tooth should be in the picture, if it is not much longer than its edge.
    half = 0.5 * close_width * height / width
    tooth = frame.tool_points[frame.tool_triangles[frame.tool_tooth == frame.edge_tooth[0]]]
    top = ((tooth.reshape(-1, 3) - centre) @ axes[1]).max(initial=0.0)
    more = min(max(1.06 * top - half, 0.0), 2.0 * half)
    scale = height / (2.0 * half + more)
    return Camera(axes, centre + 0.5 * more * axes[1], scale, (height, width))


def _membrane_normal(frame: Frame, focus: Floats) -> Floats:
    # In the reference, where no flaps hang, over about ten quads around the edge.
    near = np.argsort(np.linalg.norm(frame.points[frame.quads].mean(axis=1) - focus, axis=1))[:12]
    p = frame.reference[frame.quads[near]]
    normal = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]).sum(axis=0)
    return np.asarray(normal / np.linalg.norm(normal))


def _cutting_direction(frame: Frame, focus: Floats) -> Floats:
    # Direction out of the wedge: mean outward normal of the two faces at the edge.
    if not len(frame.tool_triangles):
        return np.zeros(3)
    p = frame.tool_points[frame.tool_triangles]
    along = np.roll(p, -1, axis=1) - p
    s = ((focus - p) * along).sum(axis=2) / (along**2).sum(axis=2).clip(1e-30)
    foot = p + s.clip(0.0, 1.0)[..., np.newaxis] * along
    distance = np.linalg.norm(foot - focus, axis=2).min(axis=1)
    faces = p[distance <= distance.min() + 1e-6 * np.ptp(p)]
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True).clip(1e-30)
    return np.asarray(normal.sum(axis=0))
