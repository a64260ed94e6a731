"""Imprint the blade's path in a model's mesh, where cracks follow its edges."""

from __future__ import annotations

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.criterion import Fracture
from shellcut.imprinting import ImprintError, ImprintResult, blade_path, imprint
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool


def needs_path(fracture: Fracture | None) -> bool:
    """Return whether cracks follow edges, so that the blade's path must be a line of them."""
    return fracture is None or fracture.path == "edges"


def with_path(
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
            f"{error}; imprint=False uses the mesh as it is, but the cut is then right only if a "
            "line of its edges lies under the blade's path"
        ) from error
