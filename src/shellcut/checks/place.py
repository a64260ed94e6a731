"""What would bring the cutting edges into a film that they never meet, and a film off their axis.

A remedy is tried before it is named: with it, edges pass through the film during the motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from shellcut.arrays import Floats, norm, product
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.quad_geometry import plane_normal
from shellcut.tool.motion import Motion, ScrewMotion, StraightMotion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool
from shellcut.unit import LENGTH

from .finding import Finding, note
from .sweep import Sweep

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

INCH = float(LENGTH["in"])

_TIMES = 60  # of the motion
_DIGITS = 2  # of a shift
_BEFORE = 0.01  # mm from the tool at its start to a film that is moved to it
_UPRIGHT = math.cos(math.radians(60.0))
"""Cosine between axis and normal below which a screw goes along a film rather than through it."""

_Change: TypeAlias = tuple[str, Mesh, Tool, Motion]
"""In words, and the model with it."""


def meeting_remedy(sim: Simulation, until: float) -> str:
    """Return what makes the cutting edges meet a film that keeps its place; "" if nothing found."""
    if sim.tool is None or sim.motion is None or sim.film_motion is not None:
        return ""
    found = []
    for slip in _slips(sim.mesh, sim.tool, sim.motion):
        found += _tried(slip, until)
    for move in _moves(sim.mesh, sim.tool, sim.motion, until):
        if told := _tried(move, until):
            found += told
            break
    return "; or ".join(found)


def _tried(change: _Change, until: float) -> list[str]:
    """Return the words with the number of edges that meet the film; empty if none does."""
    words, mesh, tool, motion = change
    fates = Sweep.of(mesh, tool, motion, until).fates
    n = sum(fate.meets for fate in fates)
    return [f"{words}: then {n} of {len(fates)} cutting edges meet the film"] if n else []


def check_axis(mesh: Mesh, motion: Motion) -> Iterator[Finding]:
    """Yield a note if a screw advances along a flat film instead of through it."""
    normal = plane_normal(mesh.nodes, mesh.quads)
    if normal is None or type(motion) is not ScrewMotion or not motion.pitch:
        return
    axis = np.array(motion.axis, float)
    cosine = abs(float(product(axis, normal))) / float(norm(axis))
    if cosine < _UPRIGHT:
        yield note(
            f"the film's normal {_listed(normal, 4)} is at {math.degrees(math.acos(cosine)):.3g}° "
            "to the axis of the screw, which advances along the film",
            'if that is not meant, turn a film from a file: membrane.axis = "normal"',
        )


def in_inches(size: float, what: str) -> str:
    """Return the question whether the file of a part is in inches, with both sizes."""
    return f"is {what} in inches? It would be {INCH * size:.3g} mm across, not {size:.3g} mm"


def _slips(mesh: Mesh, tool: Tool, motion: Motion) -> Iterator[_Change]:
    """Yield the model without a wrong sign, or with a part in another unit."""
    if type(motion) is ScrewMotion and motion.pitch:
        words = f"turn the sign of the pitch (motion.pitch = {-motion.pitch:g} mm)"
        yield words, mesh, tool, replace(motion, pitch=-motion.pitch)
    if type(motion) is StraightMotion:
        back = tuple(-float(part) for part in motion.direction)
        words = f"reverse the motion (motion.direction = {_listed(back, 4)})"
        yield words, mesh, tool, replace(motion, direction=back)
    film_size, tool_size = (float(np.ptp(x, axis=0).max()) for x in (mesh.nodes, tool.vertices))
    if tool_size > film_size:
        film = replace(mesh, nodes=INCH * mesh.nodes)
        yield f'{in_inches(film_size, "the film")} (membrane.unit = "in")', film, tool, motion
        words = f"is the tool in mm? It would be {tool_size / INCH:.3g} mm across (tool.unit)"
        yield words, mesh, replace(tool, vertices=tool.vertices / INCH), motion


def _moves(mesh: Mesh, tool: Tool, motion: Motion, until: float) -> Iterator[_Change]:
    """Yield the film, or the same of the tool, moved to where the edges are."""
    for shift in _shifts(mesh, tool, motion, until):
        of_film = f"add {_listed(shift)} mm to membrane.shift"
        of_tool = f"add {_listed(-shift)} mm to tool.shift"
        words = of_film
        if isinstance(motion, StraightMotion):  # some strips have their own place
            words = of_tool
        elif isinstance(motion, ScrewMotion) and not np.cross(motion.axis, shift).any():
            words = f"{of_film}, or {of_tool.removeprefix('add ')}"
        yield words, replace(mesh, nodes=mesh.nodes + shift), tool, motion


def _shifts(mesh: Mesh, tool: Tool, motion: Motion, until: float) -> Iterator[Floats]:
    """Yield shifts of a flat film to the edges: along its normal, and under their middle too."""
    normal = plane_normal(mesh.nodes, mesh.quads)
    if normal is None:
        return
    edges = tool.vertices[np.unique(tool.edges)]
    times = np.linspace(0.0, until, _TIMES + 1).tolist()
    poses = [pose_at(motion, t) for t in times]
    places = np.array([pose.to_space(edges) for pose in poses])
    level = mesh.nodes.mean(axis=0)
    height = product(places - level, normal)
    lift = 0.0
    if height.min() > 0.0 or height.max() < 0.0:
        ahead = height[-1].mean() - height[0].mean()
        whole = product(poses[0].to_space(tool.vertices) - level, normal)
        if abs(ahead) > _BEFORE:  # the film waits before the whole tool
            lift = float(whole.max() + _BEFORE if ahead > 0.0 else whole.min() - _BEFORE)
        else:
            lift = 0.5 * float(height.min() + height.max())
    along = lift * normal
    swept = places.reshape(-1, 3)
    off = 0.5 * (swept.min(axis=0) + swept.max(axis=0) - mesh.nodes.min(axis=0)) - 0.5 * (
        mesh.nodes.max(axis=0)
    )
    across = off - product(off, normal) * normal
    for shift in (along, along + across):
        if (rounded := shift.round(_DIGITS) + 0.0).any():
            yield rounded


def _listed(vector: Sequence[float] | Floats, digits: int = _DIGITS) -> str:
    numbers = (f"{round(float(x), digits) + 0.0:g}" for x in vector)
    return f"[{', '.join(numbers)}]"
