"""Whether the tool ever comes to a film that stays where it is.

Points on both surfaces tell how far they are apart; then the motion goes on until the tool may have
come nearer by a fifth of that. Where they are closer than their spacing, nodes in the tool and its
edges in quads tell whether the two touch.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import scipy

from shellcut.arrays import Floats, norm, product
from shellcut.contact.unfelt_depth import ToolWires, overlap
from shellcut.formats.errors import point_text
from shellcut.tool.pose_of_motion import pose_at

from .finding import Finding, doubt

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_POINTS = 4000  # on a surface, besides its corners
_TIMES = 400
_NEARER = 0.2  # share of the least distance by which it may be missed


def check_touch(sim: Simulation, until: float) -> Iterator[Finding]:
    """Yield a doubt if the tool never touches the film, which nothing else moves."""
    supports, loads = sim.inputs["supports"], sim.inputs["loads"]
    tool, motion, contact = sim.tool, sim.motion, sim.contact
    moves = any(one.velocity for one in supports) or sim.inputs["velocity"] is not None  # type: ignore[attr-defined]
    if tool is None or motion is None or contact is None or loads or moves:
        return
    film, film_apart = _points(sim.mesh.nodes[sim.mesh.quads])
    solid, solid_apart = _points(tool.vertices[tool.triangles[:, [0, 1, 2, 2]]])
    near = (film_apart + solid_apart) / 2**0.5
    poses = [pose_at(motion, t) for t in np.linspace(0.0, until, _TIMES + 1).tolist()]
    box = np.array(list(itertools.product(*np.stack([solid.min(axis=0), solid.max(axis=0)], 1))))
    steps = norm(np.diff([pose.to_space(box) for pose in poses], axis=0)).max(axis=1)
    way = np.append(0.0, steps.cumsum())  # of no point of the tool is it longer
    tree, wires = scipy.spatial.cKDTree(film), ToolWires(tool)
    k, least, at, shift = 0, np.inf, 0, np.zeros(3)
    while True:
        places = poses[k].to_space(solid)
        gaps, nearest = tree.query(places)
        i = int(gaps.argmin())
        gap = float(gaps[i])
        if gap <= near and any(
            ids.size for ids in overlap(sim.mesh, wires, contact.grid, poses[k])
        ):
            return
        if gap < least:
            least, at = gap, k
            shift = product(film[nearest[i]] - places[i], poses[k].rotation)
            shift = np.where(np.abs(shift) < near, 0.0, shift.round(2))
        if k == _TIMES:
            break
        free = way[k] + min(gap - near, gap - (1.0 - _NEARER) * least)
        k = min(max(k + 1, int(np.searchsorted(way, free, side="right")) - 1), _TIMES)
    far = f"{least:.2g} mm" if shift.any() else f"less than {near:.1g} mm"
    move = f"move it by {point_text(shift)} mm" if shift.any() else "move it nearer"
    yield doubt(
        "",
        f"the tool never touches the film: at its nearest, at {1e3 * until * at / _TIMES:.3g} ms "
        f"of {1e3 * until:.3g} ms, {far} lie between them",
        f"{move} ([tool] shift), or change its motion (direction, axis, pitch, duration)",
    )


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
