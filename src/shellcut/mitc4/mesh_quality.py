"""Shape of a film's quads, and the stable step of each: :func:`mesh_quality`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh

from .shell import MITC4Shell

LISTED = 10
"""Number of quads listed as the worst."""
CLEARLY = 0.9
"""Share of the median step below which a quad is listed."""


@dataclass(frozen=True, eq=False)
class MeshQuality:
    """Shape and stable step of every quad; ``str()`` is a report of one screen."""

    scaled_jacobian: Floats
    """Least sine of the corner angles, shape (n_quad,); 1 for a rectangle."""
    shortest_edge: Floats
    """Length of the shortest side of each quad [mm], shape (n_quad,)."""
    longest_edge: Floats
    """Length of the longest side of each quad [mm], shape (n_quad,)."""
    step: Floats
    """Stable step of each quad by itself, unloaded, without contact [s], shape (n_quad,)."""
    centre: Floats
    """Mean of the corners [mm], shape (n_quad, 3)."""
    worst: Ints
    """Quads whose steps are clearly below the median, shortest first, ten at most."""

    @property
    def aspect(self) -> Floats:
        """Longest over shortest side of each quad, shape (n_quad,)."""
        return np.asarray(self.longest_edge / self.shortest_edge)

    @property
    def stable_step(self) -> float:
        """Shortest step of all quads [s]; a safe bound for the film before contact."""
        return float(self.step.min())

    @property
    def median_step(self) -> float:
        """Step of the median quad [s]."""
        return float(np.median(self.step))

    @property
    def step_cost(self) -> float:
        """Stable step over that of the median quad: 0.5 means twice as many steps."""
        return self.stable_step / self.median_step

    def __str__(self) -> str:
        def spread(values: Floats) -> str:
            least, middle, most = values.min(), np.median(values), values.max()
            return f"{least:<10.4g}{middle:<10.4g}{most:<10.4g}"

        lines = [
            f"{len(self.step)} quads            least     median    most",
            f"scaled Jacobian      {spread(self.scaled_jacobian)}",
            f"shortest side [mm]   {spread(self.shortest_edge)}",
            f"longest side [mm]    {spread(self.longest_edge)}",
            f"aspect               {spread(self.aspect)}",
            f"stable step [s]      {spread(self.step)}",
            f"the worst quad shortens the step to {self.step_cost:.2f} of the median quad's",
        ]
        if self.worst.size:
            lines += [
                f"quads with steps below {CLEARLY:g} of the median, the shortest first:",
                "  quad    step [s]  of median  Jacobian  aspect  centre [mm]",
            ]
        for e in self.worst.tolist():
            place = ", ".join(f"{c:.4g}" for c in self.centre[e])
            lines.append(
                f"  {e:<6}  {self.step[e]:.3g}  {self.step[e] / self.median_step:<9.2f}  "
                f"{self.scaled_jacobian[e]:<8.3f}  {self.aspect[e]:<6.2f}  ({place})"
            )
        return "\n".join(lines)


def mesh_quality(
    mesh: Mesh, material: ShellMaterial | None = None, *, damping_beta: float | None = None
) -> MeshQuality:
    """Return the shape and the stable step of every quad.

    The step follows from the bound used in a run: the largest eigenvalue of a quad's stiffness on
    its share of the mass, with the stiffness damping. Contact and pre-stress shorten it in a run.

    Parameters
    ----------
    mesh : Mesh
    material : ShellMaterial, optional
        The film of the paper by default.
    damping_beta : float, optional
        Stiffness-proportional damping [s], as of :class:`Simulation`.

    Returns
    -------
    MeshQuality

    Examples
    --------
    >>> from shellcut.mesh.structured import rectangle
    >>> quality = mesh_quality(rectangle(4.0, 2.0, n_x=4, n_y=2))
    >>> round(quality.step_cost, 6), float(quality.aspect.max())
    (1.0, 1.0)
    """
    shell = MITC4Shell(mesh, material or ShellMaterial.homogeneous(), damping_beta=damping_beta)
    omega2 = shell.frequencies.squared
    damped = shell.damping_beta * omega2
    step = (np.sqrt(damped**2 + 4.0 * omega2) - damped) / omega2
    lengths, order = mesh.edge_lengths(), np.argsort(step, kind="stable")
    return MeshQuality(
        scaled_jacobian=mesh.scaled_jacobian(),
        shortest_edge=lengths.min(axis=1),
        longest_edge=lengths.max(axis=1),
        step=step,
        centre=mesh.nodes[mesh.quads].mean(axis=1),
        worst=order[step[order] < CLEARLY * np.median(step)][:LISTED],
    )
