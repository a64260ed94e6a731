"""A small shape of the film out of its plane, without which a flat film cannot buckle.

The forces on an exactly flat film that is pushed in its plane lie in the plane: in exact arithmetic
it stays flat under any push, in floating point round-off decides whether and into which mode it
buckles. So a film begins with a displacement along its directors, far above round-off and far below
its thickness h, with X the reference position and K waves:

    w = (a / K) sum_k cos(2 pi (u_k · (X - O) / lambda_k + phi_k)),   a = h / 1000.

The lengths lambda_k range from the root of the film's area to a third of it, and never below six
edges, so that the mesh can represent them, or 20 h, so that faces are strained by less than 5e-5.
The unit vectors u_k and the phases phi_k are fractional parts of multiples of 1/g, 1/g², 1/g³ with
g⁴ = g + 1 (an additive sequence, even in the cube); a number chooses which multiples, and so the
shape. Supported nodes are moved like all others, and supported there: what swings in the film is
damped, the shape that a wavy border gives it is not.

O is the centroid of the film, and the components of u_k are along axes that move with the model:
the mean director, across it the direction to the centroid of the tool's surface at t = 0, and the
normal to both. Where one of these says nothing, as for a ring of teeth over the middle of a disc,
the first vertex of the tool that lies across is used instead, or the first node of the film where
the tool is too small beside the film to show a direction, and without a tool. Axes
of the film alone, of its inertia say, are free where it is square or round, and round-off would
choose them. So a shift or turn of the whole model and other numbers of film and tool change w by
round-off, and w has none of the symmetries of film, tool and motion.
"""

from __future__ import annotations

import math
from itertools import chain
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option
from shellcut.arrays import Floats, each, norm, product
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.state import State
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

_MOST = 1_000_000  # number of a shape
_SHARE = 1e-3  # a / h
_N_WAVE = 6  # K
_SHORTEST = 1.0 / 3.0  # of the root of the film's area
_EDGES, _THICKNESSES = 6.0, 20.0  # that the shortest wave covers at least
_ROOT = 1.2207440846057596  # g
_SEEN = 1e-6  # of 1, or of the root of the film's area: what is shorter has no direction


class Imperfection:
    """The shape with a number.

    Parameters
    ----------
    number : int
        Of the shape, from 1 on; 0 for none.
    mesh, material : Mesh, ShellMaterial
        The film.
    tool, pose : Tool, Pose
        The tool, if there is one, and where it starts.
    """

    def __init__(
        self, number: int, mesh: Mesh, material: ShellMaterial, tool: Tool | None, pose: Pose
    ) -> None:
        thickness = material.thickness
        self.number = number
        """Of the shape; 0: none."""
        self.amplitude = _SHARE * thickness if number else 0.0
        """Bound of the displacement [mm]."""
        shortest = max(_EDGES * float(mesh.edge_lengths().max()), _THICKNESSES * thickness)
        longest = np.sqrt(mesh.quad_areas().sum())
        lengths = np.maximum(longest * np.linspace(1.0, _SHORTEST, _N_WAVE), shortest)
        multiples = (number - 1) * _N_WAVE + np.arange(1.0, _N_WAVE + 1.0)
        steps = [math.pow(_ROOT, -k) for k in (1, 2, 3)]
        height, turn, self._phase = np.outer(steps, multiples) % 1.0
        along, round_ = 2.0 * height - 1.0, 2.0 * np.pi * turn
        across = np.sqrt(1.0 - along**2)
        units = np.stack(
            [across * each(math.cos, round_), across * each(math.sin, round_), along], axis=1
        )
        self._origin, axes = _frame(mesh, tool, pose)
        self._waves = product(units, axes) / lengths[:, None]

    def displace(self, state: State) -> None:
        """Add the shape to the positions of a film at rest."""
        if not self.number:
            return
        n = state.node
        turns = product(n.X[: n.count] - self._origin, self._waves.T) + self._phase
        w = self.amplitude * each(math.cos, 2.0 * np.pi * turns).mean(axis=1)
        n.x[: n.count] += w[:, None] * n.t[: n.count]


ImperfectionNumber: TypeAlias = Annotated[
    int | None,
    Option(
        "",
        "number of the small out-of-plane shape that the film has at the start, so that it can "
        "buckle; 0: none",
        least=0,
        most=_MOST,
        unset="1 with a tool and a film that parts, otherwise 0",
    ),
]


def _frame(mesh: Mesh, tool: Tool | None, pose: Pose) -> tuple[Floats, Floats]:
    """Return the film's centroid, shape (3,) [mm], and orthonormal axes, one a row, (3, 3)."""
    areas = mesh.quad_areas()
    origin = product(areas, mesh.nodes[mesh.quads].mean(axis=1)) / areas.sum()
    places, centre = mesh.nodes, origin
    if tool is not None:
        corners = pose.to_space(tool.vertices)
        places = np.vstack([corners, places])
        a, b, c = np.moveaxis(corners[tool.triangles], 1, 0)
        areas_of_tool = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        centre = product(areas_of_tool, a + b + c) / (3.0 * areas_of_tool.sum())
    size, axes = float(np.sqrt(areas.sum())), np.zeros((0, 3))
    for vector in chain(
        [mesh.directors.mean(axis=0)], (np.vstack([centre, places]) - origin) / size
    ):
        across = vector - product(axes.T, product(axes, vector))
        if (length := float(norm(across))) > _SEEN:
            axes = np.vstack([axes, across / length])
        if len(axes) == 2:
            break
    return origin, np.vstack([axes, np.cross(*axes)])
