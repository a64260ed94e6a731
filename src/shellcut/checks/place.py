"""What would bring the cutting edges into a film that they never meet.

A remedy is tried before it is named: with it, edges pass through the film during the motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from shellcut.arrays import Floats, product
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.quad_geometry import plane_normal
from shellcut.tool.motion import Motion, ScrewMotion, StraightMotion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool
from shellcut.unit import LENGTH

from .sweep import Sweep

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

INCH = float(LENGTH["in"])

_FAR_LARGER = math.sqrt(INCH)  # a tool than its film: then an inch is nearer than a millimetre

_TIMES = 60  # of the motion
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
