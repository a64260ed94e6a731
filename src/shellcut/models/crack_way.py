"""Which way the cracks of a ready model go: through quads, or along edges under the blade's path.

Left to the model it is along edges where another option asks for them, or where a row of them lies
under the whole path of the cutting edges; it is through the quads everywhere else.
"""

from __future__ import annotations

from dataclasses import replace

from shellcut.checks.row import lies_under
from shellcut.checks.sweep import Sweep
from shellcut.fracture.options import Fracture
from shellcut.mesh.mesh import Mesh
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool


def crack_way(
    mesh: Mesh, tool: Tool, motion: Motion, duration: float, fracture: Fracture | None
) -> Fracture:
    """Return the options of the cracks with their path, ``"free"`` or ``"edges"``.

    Parameters
    ----------
    mesh : Mesh
        The film.
    tool, motion, duration : Tool, Motion, float
        Whose edges cut, and how far [s].
    fracture : Fracture, optional
        As it was asked for.
    """
    cracks = fracture or Fracture()
    if cracks.needed_path is None and lies_under(Sweep.of(mesh, tool, motion, duration)):
        return replace(cracks, path="edges")
    return cracks.decided()
