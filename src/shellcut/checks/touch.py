"""Whether the tool ever approaches a film that keeps its shape, wherever its supports move it.

Points on both surfaces tell how far they are apart at some times of the motion.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import scipy

from shellcut.arrays import Floats, norm, product
from shellcut.formats.errors import point_text
from shellcut.tool.pose_of_motion import pose_at

from .finding import Finding, doubt

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_POINTS = 4000  # on a surface, besides its corners: 0.3 mm apart on the opening's film
_WHOLE = 1e-3  # of the largest velocity by which nodes of a film that moves as a whole may differ
_TIMES = 60  # of the motion; a step of it is also as near as can be told


def check_touch(sim: Simulation, until: float, remedy: str = "") -> Iterator[Finding]:
    """Yield a doubt if the tool stays away from the film, which nothing else deforms.

    Where the distance is below that of the points, or of a step of the motion, it may touch.
    A remedy that is known is named; else the distance to the nearest place.
    """
    tool, motion = sim.tool, sim.motion_in_film(until)
    if tool is None or motion is None or sim.inputs["loads"] or _changes_shape(sim, until):
        return
    film, film_apart = _points(sim.mesh.nodes[sim.mesh.quads])
    solid, solid_apart = _points(tool.vertices[tool.triangles[:, [0, 1, 2, 2]]])
    poses = [pose_at(motion, t) for t in np.linspace(0.0, until, _TIMES + 1).tolist()]
    places = [pose.to_space(solid) for pose in poses]
    tree = scipy.spatial.cKDTree(film)
    gaps, nearest = zip(*(tree.query(at) for at in places), strict=True)
    least = np.array([gap.min() for gap in gaps])
    step = max(float(norm(b - a).max()) for a, b in itertools.pairwise(places))
    k = int(least.argmin())
    near = max((film_apart + solid_apart) / 2**0.5, step)
    if least[k] <= near:
        return
    i = int(gaps[k].argmin())
    shift = product(film[nearest[k][i]] - places[k][i], poses[k].rotation)
    shift = np.where(np.abs(shift) < near, 0.0, shift.round(2))
    yield doubt(
        "",
        f"the tool never touches the film: at its nearest, at {1e3 * until * k / _TIMES:.3g} ms "
        f"of {1e3 * until:.3g} ms, {least[k]:.2g} mm lie between them",
        remedy
        or f"move it by {point_text(shift)} mm ([tool] shift), or change its motion (direction, "
        "axis, pitch, duration)",
    )


def _changes_shape(sim: Simulation, until: float) -> bool:
    """Whether supports or velocities at the start move the film other than as a whole."""
    film, velocity = sim.film_motion, sim.inputs["velocity"]
    if film is None:
        return velocity is not None
    whole = film.velocity_at(sim.mesh.nodes, 0.0)
    starts = np.zeros_like(whole) if velocity is None else np.asarray(velocity)
    most = float(norm(whole).max())
    return not film.is_rigid(until) or bool(norm(starts - whole).max() > _WHOLE * most)


def _points(faces: Floats) -> tuple[Floats, float]:
    """Return points on faces, shape (n, 4, 3), and how far neighbours are apart at most [mm]."""
    side = norm(np.roll(faces, -1, axis=1) - faces)
    apart = (
        float(((side[:, 0] + side[:, 2]) * (side[:, 1] + side[:, 3])).sum() / _POINTS) ** 0.5 / 2
    )
    n = np.ceil(np.maximum(side[:, :2], side[:, 2:]) / apart).astype(np.int64)
    found = []
    for a, b in np.unique(n, axis=0).tolist():
        u, v = np.meshgrid(np.linspace(0.0, 1.0, a + 1), np.linspace(0.0, 1.0, b + 1))
        shares = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=-1)
        mine = faces[(n == (a, b)).all(axis=1)]
        found.append((shares[..., None] * mine[:, None, None]).sum(axis=3).reshape(-1, 3))
    return np.unique(np.concatenate(found), axis=0), apart
