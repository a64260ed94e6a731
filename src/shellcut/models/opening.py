"""The opening test of [Frangi2010] 5: a ring of teeth screws down through a clamped film.

docs/theory/opening.md tells the tooth and the motion, which the paper shows without numbers, and
derives the work of the cables in steady cutting.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

from shellcut.arguments import Option, checked
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.contact.settings import Contact
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import OPENING_RADIUS, opening_disc
from shellcut.tool.motion import Pitch, ScrewMotion
from shellcut.tool.shapes import tooth_ring
from shellcut.tool.tool import Tool

from .case import PAPER_DAMPING, Case, Clamp, CutOptions, damped_by
from .free_cut import free_cut
from .path_film import film_along_path

if TYPE_CHECKING:
    from typing_extensions import Unpack

OpeningMesh = Literal["quick", "M1", "M2", "path"]


@checked
def opening_test(
    mesh: Annotated[
        OpeningMesh | Mesh,
        Option("", "612, 2660 or 8625 quads; path: by Gmsh, small along the path"),
    ] = "M1",
    *,
    tool: Tool | None = None,
    pitch: Pitch = 12.0,
    angle_deg: Annotated[float, Option("deg", "angle of the whole motion", above=0)] = 95.0,
    duration: Annotated[float, Option("s", "duration of the run", above=0)] = 6.0e-3,
    clamp: Clamp = ("rim",),
    material: ShellMaterial | None = None,
    law: CohesiveTable | None = None,
    **options: Unpack[CutOptions],
) -> Case:
    """Build the opening test: a disc of the package, or a flat film of your own.

    For quads of other sizes along the path see :func:`film_along_path`.

    Parameters
    ----------
    tool : Tool, optional
        The default is :func:`tooth_ring` with its defaults.
    material, law : ShellMaterial, CohesiveTable, optional
        The paper's film by default.
    **options
        Options of :class:`Simulation`: ``fracture``, ``contact``, ``stepping``, ``terms``, ...
        Without a ``fracture.path`` cracks follow quad sides if a line of them lies under the whole
        path, as in the package's discs under the default teeth, and else run through quads. Borders
        and flanks of the film touch the tool's edges unless ``Contact(film_edges=False)`` says
        otherwise: flanks of the cuts cross the teeth's bottom edges between their nodes.

    Returns
    -------
    Case

    Examples
    --------
    >>> case = opening_test("quick", angle_deg=40.0)
    >>> case.simulation.mesh.n_quad
    612
    """
    cutter = tool or tooth_ring()
    motion = ScrewMotion.over(angle_deg=angle_deg, duration=duration, pitch=pitch)
    film: Mesh
    if isinstance(mesh, Mesh):
        film = mesh
    elif mesh == "path":
        film = film_along_path(
            OPENING_RADIUS,
            tool=cutter,
            motion=motion,
            duration=duration,
            material=material,
            law=law,
        )
    else:
        options, film = damped_by(PAPER_DAMPING, options), opening_disc(mesh)
    contact = options.get("contact") or Contact()
    if isinstance(contact, Contact) and contact.film_edges is None:  # the simulation checks types
        contact = replace(contact, film_edges=True)
    options["contact"] = contact
    cut = free_cut(
        film,
        tool=cutter,
        motion=motion,
        duration=duration,
        clamp=clamp,
        material=material,
        law=law,
        **options,
    )
    return replace(cut, name="opening")


def steady_work_per_radian(
    *,
    n_teeth: int = 4,
    radius: float = 9.4,
    pitch: float = 12.0,
    edge_inclination_deg: float = 60.0,
    thickness: float = 0.074,
    law: CohesiveTable | None = None,
) -> float:
    """Return n G h (r + (p/2 pi) cot eta), the cables' work per radian of steady cutting [N·mm].

    Examples
    --------
    >>> round(steady_work_per_radian(), 1)
    135.2
    """
    lead = pitch / (2.0 * math.pi) / math.tan(math.radians(edge_inclination_deg))
    return n_teeth * (law or CohesiveLaw()).fracture_energy * thickness * (radius + lead)
