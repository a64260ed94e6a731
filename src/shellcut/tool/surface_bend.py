"""How much a surface bends over a length: what protrudes between two nodes of a film.

A film whose nodes lie on a convex surface spans it between two of them, at the distance l, with a
straight side. Turns t_i of the surface there, at the distances x_i from the middle, raise it over
the side's middle as kinks raise a beam, by

    sum t_i (l/2 - |x_i|) / 2 = T l/4,    T = sum t_i (1 - |x_i| / (l/2)).

So T, the *bend*, is the turn of an edge that protrudes as much. Of a round of the radius R it is
(l/2)/R, however fine its facets are. Over a quad, z = -(k_1 x² + k_2 y²)/2 is higher at the middle
than the bilinear mean of the corners by (k_1 + k_2) l²/8: the bends in two normal directions add
up, in whichever direction the quad lies.

Here T is added up along straight paths over the triangles: across an edge from a place on it, and
beside the edge, in its direction. An edge that a path crosses at the angle p to its normal bends
the path by t cos p.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, cross, unit

from .surface import Surface

# Film over the start of a path does not reach what is behind a quarter turn.
_QUARTER = 0.5 * np.pi

# Edges that a path crosses; only one that runs on an edge, to and fro, comes to so many.
_MOST_CROSSED = 1000


def bends(surface: Surface, rows: Ints, places: Floats, reach: float, ends: Bools) -> Floats:
    """Return the bend of a closed surface around places on its edges, shape (n,) [rad].

    Parameters
    ----------
    surface : Surface
    rows, places : ndarray, shape (n,) and (n, 3)
        Edge of each, and where on it [mm].
    reach : float
        Half of l: how far the paths go [mm].
    ends : ndarray of bool, shape (n_row,)
        Edges at which paths end, and that are not counted.
    """
    here, there = surface.forward[rows], surface.backward[rows]
    along = unit(surface.vertices[surface.hi[rows]] - surface.vertices[surface.lo[rows]])
    beside = (2.0 * places + surface.vertices[surface.triangles[here]].mean(axis=1)) / 3.0
    walks = (
        (here, places, cross(surface.normals[here], along)),
        (there, places, cross(along, surface.normals[there])),
        (here, beside, along),
        (here, beside, -along),
    )
    triangle, place, direction = (np.concatenate(parts) for parts in zip(*walks, strict=True))
    walked = _walk(surface, triangle, place, direction, reach, ends)
    walked = walked.reshape(len(walks), len(rows))
    return np.asarray(surface.turn[rows] + walked.sum(axis=0))


def _walk(
    surface: Surface, triangle: Ints, place: Floats, direction: Floats, reach: float, ends: Bools
) -> Floats:
    """Return the bend of paths from places in triangles, without what is at their start [rad]."""
    vertices, normals, forward = surface.vertices, surface.normals, surface.forward
    along = unit(vertices[surface.hi] - vertices[surface.lo])
    bend, gone = np.zeros(len(triangle)), np.zeros(len(triangle))
    on = np.arange(len(triangle))  # the paths that go on
    for _ in range(_MOST_CROSSED):
        corners = vertices[surface.triangles[triangle]]
        out = cross(np.roll(corners, -1, axis=1) - corners, normals[triangle][:, None])
        speed = np.add.reduce(out * direction[:, None], axis=-1)
        ahead = np.add.reduce(out * (corners - place[:, None]), axis=-1)
        way = np.full(speed.shape, np.inf)
        np.divide(ahead, speed, out=way, where=speed > 0.0)
        side = way.argmin(axis=1)
        step = np.maximum(way[np.arange(len(on)), side], 0.0)
        row = surface.row_of_side[triangle, side]
        gone[on] += step
        goes = (gone[on] < reach) & (bend[on] < _QUARTER) & ~ends[row]
        on, triangle, row = on[goes], triangle[goes], row[goes]
        if not on.size:
            break
        place, direction = (place + step[:, None] * direction)[goes], direction[goes]
        part = np.add.reduce(direction * along[row], axis=-1)
        normal_part = np.sqrt(np.maximum(1.0 - part * part, 0.0))
        bend[on] += surface.turn[row] * normal_part * (1.0 - gone[on] / reach)
        # On the next triangle the path makes the same angle with the edge.
        triangle = forward[row] + surface.backward[row] - triangle
        inward = cross(normals[triangle], along[row])
        inward *= np.where(forward[row] == triangle, 1.0, -1.0)[:, None]
        direction = part[:, None] * along[row] + normal_part[:, None] * inward
    return bend
