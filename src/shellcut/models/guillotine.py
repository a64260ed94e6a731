"""The guillotine: a straight blade cuts a clamped strip along its middle.

Steady cutting takes the force F = G h whatever blade, speed or mesh: all work goes into the new
crack, G h a millimetre. About 8 mm of cut pass before the plateau, because a cable breaks only
after some 2 mm of drag; the force is a sawtooth with the node spacing, so it is averaged over whole
periods. With classical cables, which the blade never meets, the flanks open by no more than the
blade's width w and F = h ∫_0^w sigma dl.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.cohesive_law import CohesiveLaw
from shellcut.material import ShellMaterial
from shellcut.mesh import Mesh
from shellcut.meshing import rectangle
from shellcut.motion import StraightMotion
from shellcut.simulation import Simulation
from shellcut.support import Support
from shellcut.tool import Tool
from shellcut.tool_shapes import straight_blade

from .case import Case

# Gap between the cutting edge and the film's end at the start [mm].
_CLEARANCE = 0.05


def notched_strip(length: float, width: float, size: float, notch: float) -> Mesh:
    """Return a strip, x from 0 to ``length``, cut from x = 0 to ``notch`` along its middle [mm]."""
    mesh = rectangle(length, width, size=size)
    on_line = mesh.nodes_where(lambda x, y, z: (np.abs(y) < 1e-9) & (x <= notch + 1e-9))
    if on_line.size < 2:
        raise ValueError(
            f"the notch of {notch} mm must follow a mesh line in the middle of the strip: make "
            f"width / size even, got {width} / {size}, and the notch at least one edge long"
        )
    return mesh.cut(on_line[np.argsort(mesh.nodes[on_line, 0])])


def guillotine(
    size: float = 0.4,
    *,
    length: float = 30.0,
    width: float = 8.0,
    notch: float = 2.0,
    travel: float | None = None,
    speed: float = 6000.0,
    tool: Tool | None = None,
    material: ShellMaterial | None = None,
    law: CohesiveLaw | None = None,
    **options: Any,
) -> Case:
    """Build the guillotine.

    Parameters
    ----------
    size : float
        Edge length of the quads [mm].
    length, width, notch : float
        Of the strip and of the cut at its end [mm]; the long sides are clamped.
    travel : float, optional
        Way of the blade [mm]; up to 2.5 mm before the end of the strip by default.
    speed : float
        After a ramp of 0.1 ms [mm/s].
    tool : Tool, optional
        Moves along +x with its edge at the origin; :func:`straight_blade` by default: edge at 90°
        to the sheet, half-angle 10°, half thickness 0.3 mm, as long as the strip: flanks that close
        behind a short blade push it forward.
    material, law : ShellMaterial, CohesiveLaw, optional
        The film of the paper by default.
    **options
        Of :class:`Simulation`.

    Returns
    -------
    Case
    """
    ramp = 1e-4
    way = length - 2.5 if travel is None else travel
    blade = tool or straight_blade(length=length, height=3.0)
    simulation = Simulation(
        notched_strip(length, width, size, notch),
        material or ShellMaterial.homogeneous(),
        supports=[Support.clamped("bottom"), Support.clamped("top")],
        tool=blade.translated((-_CLEARANCE, 0.0, 0.0)),
        motion=StraightMotion((1.0, 0.0, 0.0), speed=speed, ramp=ramp),
        law=law or CohesiveLaw(),
        **options,
    )
    return Case("guillotine", simulation, way / speed + 0.5 * ramp)
