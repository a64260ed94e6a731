"""A cut through any film by any tool on any motion; what is imprinted must be flat."""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.simulation.simulation import Simulation
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool

from .case import Case, check_length
from .imprinted_path import needs_path, with_path


def free_cut(
    mesh: Mesh,
    *,
    tool: Tool,
    motion: Motion,
    duration: float,
    imprint: bool = True,
    notch: float = 0.0,
    material: ShellMaterial | None = None,
    law: CohesiveLaw | None = None,
    **options: Any,
) -> Case:
    """Build a cut from its parts.

    Parameters
    ----------
    mesh : Mesh
        Flat, unless ``imprint`` is False.
    tool, motion : Tool, Motion
        The cutter and how it moves.
    duration : float
        End of the run [s].
    imprint : bool
        Put the path of the cutting edges into the mesh, unless cracks go through quads
        (``fracture.path``); the result is ``Case.imprint``.
    notch : float
        Length of a cut along the path, from the blade's start [mm]; needs ``imprint``.
    material, law : ShellMaterial, CohesiveLaw, optional
        The paper's film by default.
    **options
        Options of :class:`Simulation`: ``supports``, ``loads``, ``contact``, ...

    Returns
    -------
    Case

    Raises
    ------
    ImprintError
        If the path cannot be put into the mesh.
    """
    if not (np.isfinite(duration) and duration > 0):
        raise ValueError(f"duration must be a positive time in s, got {duration!r}")
    if not (np.isfinite(notch) and notch >= 0):
        raise ValueError(f"notch must be a length in mm, 0 for none, got {notch!r}")
    imprint = imprint and needs_path(options.get("fracture"))
    if notch and not imprint:
        raise ValueError(
            "a notch follows the imprinted path: give notch=0, or imprint=True and path = 'edges'"
        )
    section = material or ShellMaterial.homogeneous()
    result = with_path(mesh, tool, motion, duration, section, law) if imprint else None
    film = mesh if result is None else result.mesh
    if result is not None and notch:
        chain = result.chains[0][result.first[0] :]
        film = film.cut(_start_of(film.nodes, chain, notch))
    simulation = Simulation(
        film, section, tool=tool, motion=motion, law=law or CohesiveLaw(), **options
    )
    check_length(simulation, duration)
    return Case("free", simulation, duration, result)


def _start_of(nodes: Floats, chain: Ints, notch: float) -> Ints:
    way = np.cumsum(np.linalg.norm(np.diff(nodes[chain], axis=0), axis=1))
    first = chain[: 1 + np.searchsorted(way, notch * (1.0 + 1e-9), side="right")]
    if len(first) < 2:
        raise ValueError(
            f"the notch of {notch} mm must be at least one edge of the path long, "
            f"{way[0]:.4g} mm: lengthen it, or pass 0"
        )
    return np.asarray(first)
