"""What a Simulation refuses before it is built: sentences, all of them at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from shellcut.arguments import checked
from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.contact.settings import Contact
from shellcut.fracture.options import Fracture
from shellcut.material.material import refuse
from shellcut.material.shell_material import ShellMaterial
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool


def check_parts(
    tool: Tool | None,
    motion: Motion | None,
    law: CohesiveTable | None,
    contact: Contact | None,
    fracture: Fracture | None,
) -> None:
    """Raise ValueError if what a simulation is given is not consistent."""
    problems = []
    if (tool is None) != (motion is None):
        problems.append("tool and motion go together: give both or none")
    if law is None and fracture is not None:
        problems.append("fracture needs a law for the cables: give law=CohesiveLaw() too")
    if tool is None and contact is not None and not contact.self_contact:
        problems.append(
            "contact needs a tool to be in contact with: give tool and motion too, or "
            "self_contact=True for contact of the film with itself"
        )
    if tool is not None and fracture is not None and fracture.anisotropy is not None:
        problems.append(
            "fracture.anisotropy is for cracks that no blade drives, got a tool: leave out one of "
            "them"
        )
    is_razor = law is not None and law.cutting_energy is not None and law.severing_pressure is None
    if is_razor and tool is not None and tool.edge_radius:
        problems.append(
            "cutting_energy is the value of a razor: a cutting edge with a radius needs "
            f"severing_pressure too, got edge_radius = {tool.edge_radius:.4g} mm"
        )
    refuse(problems)


def check_damping(beta: float | None, share: float | None) -> None:
    """Raise ValueError if the stiffness damping is given twice."""
    if beta is not None and share is not None:
        raise ValueError(
            f"damping_beta or damping_share must be given, not both: got {beta:g} s and {share:g}"
        )


def check_quasi_static(material: ShellMaterial, velocity: Floats | None) -> None:
    """Raise ValueError if a film needs time or inertia of its own."""
    problems = []
    if laws := material.timed_laws:
        problems.append(
            "layers whose stress does not depend on the rate of strain: leave out the rate factor "
            f"of {', '.join(laws)}"
        )
    if velocity is not None:
        problems.append("a film at rest: leave out velocity")
    if problems:
        raise ValueError(
            "a quasi-static run must have " + "; ".join(problems) + "; or leave out quasi_static"
        )


@checked
def points_of_notch(points: tuple[npt.ArrayLike, ...]) -> Floats:
    """Return the points of a notch, shape (n, 3) [mm]; refuse those that are none."""
    every = [np.asarray(point, float) for point in points]
    if (
        len(every) < 2
        or any(point.shape != (3,) for point in every)
        or not np.isfinite(every).all()
        or (np.diff(every, axis=0) == 0.0).all(axis=1).any()
    ):
        said = ", ".join(repr(point) for point in points[:4])
        raise ValueError(f"a notch needs two different points in mm or more, got {said}")
    return np.array(every)
