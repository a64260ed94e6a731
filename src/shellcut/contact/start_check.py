"""The tool must start outside the film: no node lies in it, and it passes through no quad."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product, unit
from shellcut.mesh.mesh import Mesh
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .unfelt_depth import ToolWires

# Of the tool's extent along its direction of motion: a start this far in is no small error of its
# place; of the speed: an advance along the axis below it is none; steps of the search for a free
# start, along the tool's extent and past the film.
_FAR, _ROUND_OFF, _STEPS = 0.25, 1e-9, (20, 40)


def check_tool_outside(
    mesh: Mesh,
    tool: Tool,
    grid: ClosestTriangleGrid,
    pose: Pose,
    motion: Motion | None = None,
) -> None:
    """Raise ValueError if a node lies in the tool or an edge of the tool passes through a quad.

    Parameters
    ----------
    mesh, tool, grid, pose
        The pose is that of the start.
    motion : Motion, optional
        Tells how far back along its path the tool is free.
    """
    wires = ToolWires(tool)

    def overlap(at: Pose) -> tuple[Ints, Ints]:
        _, inside, _, _ = grid.query(at.to_body(mesh.nodes))
        nowhere = np.zeros(mesh.n_node, np.bool_)
        return np.flatnonzero(inside), wires.crossed_quads(mesh.nodes, mesh.quads, nowhere, at)[0]

    problems = []
    inside, pierced = overlap(pose)
    if inside.size:
        problems.append(f"nodes {_some(inside, mesh.nodes)} lie inside the tool")
    if pierced.size:
        centres = mesh.nodes[mesh.quads].mean(axis=1)
        problems.append(f"the tool passes through quads {_some(pierced, centres)}")
    if not problems:
        return
    along = _first_direction(motion)
    reach = float(np.ptp(product(pose.to_space(tool.vertices), along)))
    past = 1.01 * (reach + float(np.ptp(product(mesh.nodes, along))))
    fine, coarse = (
        np.linspace(0.0, end, n + 1)[1:] for end, n in zip((reach, past), _STEPS, strict=True)
    )
    back = np.union1d(fine, coarse)  # all of it: what lies beyond the film passes through it too
    starts = (Pose(pose.rotation, pose.translation - s * along) for s in back)
    touches = np.append(True, [any(ids.size for ids in overlap(start)) for start in starts])
    free = np.append(back, 0.0)[np.flatnonzero(touches)[-1]]
    raise ValueError(
        f"the tool must start outside the sheet, but {' and '.join(problems)}: "
        f"{_cure(-free * product(along, pose.rotation), reach)}"
    )


def _first_direction(motion: Motion | None) -> Floats:
    # unit vector of the first advance, along the axis of a screw; 0 of a tool that only turns
    for time in 2.0 ** np.arange(-20, 1) if motion else ():  # from a microsecond to a second
        spin, velocity = map(np.asarray, motion.twist(float(time)))  # type: ignore[union-attr]
        speed = float(norm(velocity))
        if spin.any():
            axis = unit(spin)
            velocity = axis * (product(axis, velocity))
        if (length := float(norm(velocity))) > _ROUND_OFF * speed:
            return np.asarray(velocity / length)
    return np.zeros(3)


def _cure(shift: Floats, reach: float) -> str:
    slot = "leave a slot for it out of the film's mesh (a notch has no width)"
    turn = (
        "turn it or the film: its axis, the direction of its motion or the film's plane "
        "([membrane] axis) may be wrong"
    )
    if not shift.any():
        return f"move the tool's start, {turn}, or {slot}"
    x, y, z = shift + 0.0
    move = f"move the tool's start back by ({x:.3g}, {y:.3g}, {z:.3g}) mm ([tool] shift)"
    is_small = norm(shift) <= _FAR * reach
    return f"{move}, or {slot}" if is_small else f"{move}, or {turn}; or {slot}"


def _some(ids: Ints, places: Floats) -> str:
    shown = ", ".join(
        f"{i} at ({places[i, 0]:.4g}, {places[i, 1]:.4g}, {places[i, 2]:.4g})"
        for i in ids[:5].tolist()
    )
    more = f" and {ids.size - 5} more" if ids.size > 5 else ""
    return shown + more
