"""Whether the tool meets the film, and what would bring its cutting edges there.

It is asked of a film that keeps its shape, wherever its supports move it: points on both surfaces
tell how far they are apart at some times of the motion. A remedy is tried before it is named: with
it, edges pass through the film during the motion.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import scipy

from shellcut.arrays import Floats, norm, product
from shellcut.formats.errors import point_text
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.quad_geometry import plane_normal
from shellcut.tool.motion import Motion, ScrewMotion, StraightMotion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool
from shellcut.unit import LENGTH

from .finding import Finding, doubt
from .sweep import Sweep

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

INCH = float(LENGTH["in"])

_FAR_LARGER = math.sqrt(INCH)  # a tool than its film: then an inch is nearer than a millimetre

_TIMES = 60  # of the motion; a step of it is also as near as can be told
_POINTS = 4000  # on a surface, besides its corners: 0.3 mm apart on the opening's film
_WHOLE = 1e-3  # of the largest velocity by which nodes of a film that moves as a whole may differ
_DIGITS = 2  # of a shift
_BEFORE = 0.01  # mm from the tool at its start to a film that is moved to it

_Change: TypeAlias = tuple[str, Mesh, Tool, Motion]
"""In words, and the model with it."""


def meeting_remedy(sim: Simulation, until: float) -> str:
    """Return what makes the cutting edges meet a film that keeps its place; "" if nothing found."""
    if sim.tool is None or sim.motion is None or sim.film_motion is not None:
        return ""
    parts = sim.mesh, sim.tool, sim.motion
    found = []
    for words, mesh, tool, motion in (*_slips(*parts), *_moves(*parts, until)):
        fates = Sweep.of(mesh, tool, motion, until).fates
        if n := sum(fate.meets for fate in fates):
            found.append(f"{words}: then {n} of {len(fates)} cutting edges meet the film")
    return "; or ".join(found)


def in_inches(size: float, what: str) -> str:
    """Return the question whether the file of a part is in inches, with both sizes."""
    return f"is {what} in inches? It would be {INCH * size:.3g} mm across, not {size:.3g} mm"


def _slips(mesh: Mesh, tool: Tool, motion: Motion) -> Iterator[_Change]:
    """Yield the model with another sign of the motion, and with a part in another unit."""
    if type(motion) is ScrewMotion and motion.pitch:
        words = f"turn the sign of the pitch (motion.pitch = {-motion.pitch:g} mm)"
        yield words, mesh, tool, replace(motion, pitch=-motion.pitch)
    if type(motion) is StraightMotion:
        back = tuple(-float(part) for part in motion.direction)
        words = f"reverse the motion (motion.direction = {_listed(back)})"
        yield words, mesh, tool, replace(motion, direction=back)
    film_size, tool_size = (float(np.ptp(x, axis=0).max()) for x in (mesh.nodes, tool.vertices))
    if tool_size > _FAR_LARGER * film_size:
        words = f'{in_inches(film_size, "the film")} (membrane.unit = "in")'
        yield words, replace(mesh, nodes=INCH * mesh.nodes), tool, motion
        words = f"is the tool in mm? It would be {tool_size / INCH:.3g} mm across (tool.unit)"
        yield words, mesh, replace(tool, vertices=tool.vertices / INCH), motion


def _moves(mesh: Mesh, tool: Tool, motion: Motion, until: float) -> Iterator[_Change]:
    """Yield it with a flat film moved to the edges: along its normal, or under their middle too.

    The tool may be moved instead where it goes straight, or the shift is along its axis.
    """
    normal = plane_normal(mesh.nodes, mesh.quads)
    if normal is None:
        return
    poses = [pose_at(motion, t) for t in np.linspace(0.0, until, _TIMES + 1).tolist()]
    edges = tool.vertices[np.unique(tool.edges)]
    places, level = np.array([pose.to_space(edges) for pose in poses]), mesh.nodes.mean(axis=0)
    height, lift = product(places - level, normal), 0.0
    if height.min() > 0.0 or height.max() < 0.0:
        lift, ahead = 0.5 * (height.min() + height.max()), height[-1].mean() - height[0].mean()
        if abs(ahead) > _BEFORE:  # the film waits before the whole tool
            whole = product(poses[0].to_space(tool.vertices) - level, normal)
            lift = whole.max() + _BEFORE if ahead > 0.0 else whole.min() - _BEFORE
    off = _middle(places.reshape(-1, 3)) - _middle(mesh.nodes)
    across = off - product(off, normal) * normal
    shifts = (lift * normal, lift * normal + across)
    for shift in np.unique(np.round(shifts, _DIGITS) + 0.0, axis=0):
        of_tool = f"add {_listed(-shift)} mm to tool.shift"
        words = f"add {_listed(shift)} mm to membrane.shift"
        if isinstance(motion, StraightMotion):  # strips of the package have their own place
            words = of_tool
        elif isinstance(motion, ScrewMotion) and not np.cross(motion.axis, shift).any():
            words = f"{words} or {of_tool}"
        if shift.any():
            yield words, replace(mesh, nodes=mesh.nodes + shift), tool, motion


def _middle(points: Floats) -> Floats:
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def _listed(vector: Sequence[float] | Floats) -> str:
    return f"[{', '.join(f'{x + 0.0:g}' for x in vector)}]"


def check_touch(sim: Simulation, until: float, remedy: str = "") -> Iterator[Finding]:
    """Yield a doubt if the tool stays away from the film, which nothing else deforms.

    Where the distance is below that of the points, or of a step of the motion, it may touch.
    A remedy that is known is named; else the distance to the nearest place.
    """
    tool, motion = sim.tool, sim.motion_in_film
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
