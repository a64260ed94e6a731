"""Which way the cracks of a ready model go: through quads, or along edges under the blade's path.

Left to the model it is along edges where a line of them lies under the whole path already, and
through the quads everywhere else. What exists along edges only has the path put into the mesh.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.criterion import Fracture
from shellcut.imprinting import ImprintError, ImprintResult, blade_path, imprint, lies_in
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool


class CrackWay(NamedTuple):
    """The film, and how its cracks go."""

    mesh: Mesh
    """With the path in it where that was put in, else as it was given."""
    fracture: Fracture
    """Its path is ``"free"`` or ``"edges"``."""
    imprint: ImprintResult | None
    """Of the line of edges under the path; None where none was asked for."""

    @property
    def through_quads(self) -> bool:
        """Whether cracks go through quads."""
        return self.fracture.path == "free"


def crack_way(
    mesh: Mesh,
    tool: Tool,
    motion: Motion,
    duration: float,
    *,
    material: ShellMaterial,
    law: CohesiveLaw | None,
    fracture: Fracture | None,
) -> CrackWay:
    """Return which way cracks go in a film, and the film with a line of edges if they need one.

    Parameters
    ----------
    mesh : Mesh
        The film.
    tool, motion, duration : Tool, Motion, float
        Whose edges cut, and how far [s].
    material, law, fracture : ShellMaterial, CohesiveLaw, Fracture
        Of the film, its cables and cracks.

    Raises
    ------
    ImprintError
        If the path must be put into the mesh and cannot be.
    """
    cracks = fracture or Fracture()
    path = cracks.needed_path
    if cracks.path is None:
        if path == "edges" or (path is None and _is_there(mesh, tool, motion, duration, law)):
            path = "imprint"
        else:
            path = "free"
    if path != "imprint":
        return CrackWay(mesh, replace(cracks, path=path), None)
    result = _with_path(mesh, tool, motion, duration, material, law)
    return CrackWay(result.mesh, replace(cracks, path="edges"), result)


def _is_there(
    mesh: Mesh, tool: Tool, motion: Motion, duration: float, law: CohesiveLaw | None
) -> bool:
    """Return whether a line of edges lies under the whole path; on a curved film it is unknown."""
    try:
        return lies_in(mesh, blade_path(tool, motion, mesh, duration, law=law))
    except ImprintError:
        return False


def _with_path(
    mesh: Mesh,
    tool: Tool,
    motion: Motion,
    duration: float,
    material: ShellMaterial,
    law: CohesiveLaw | None,
) -> ImprintResult:
    """Imprint the path of the tool's edges during a run; a refusal says how to avoid it."""
    try:
        path = blade_path(tool, motion, mesh, duration, law=law)
        return imprint(mesh, path, material=material.layers[0].material)
    except ImprintError as error:
        raise ImprintError(
            f"{error}; fracture.path = 'free' cuts through the quads of any mesh, 'edges' takes "
            "this one as it is, which is right only if a line of its edges lies under the path"
        ) from error
