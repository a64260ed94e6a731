"""Results of statics: linear solutions, points of load paths, free vibrations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mitc4.shell import MITC4Shell


class Film(NamedTuple):
    """A film at the moment of a solution."""

    x: Floats
    """Positions [mm], shape (n_node, 3)."""
    t: Floats
    """Directors, shape (n_node, 3)."""
    quads: Ints
    """Node ids, shape (n_quad, 4)."""
    shell: MITC4Shell


@dataclass(frozen=True)
class LinearSolution:
    """A linear solution about a state; as a sequence: displacement, rotation.

    Examples
    --------
    >>> import shellcut as sc
    >>> from shellcut.mesh.structured import rectangle
    >>> film = sc.ShellMaterial.homogeneous(young=1000.0, poisson=0.0, thickness=0.1)
    >>> strip = sc.Statics(
    ...     rectangle(4.0, 2.0, size=1.0),
    ...     film,
    ...     supports=[sc.Support.clamped("left")],
    ...     loads=[sc.EdgeTraction("right", (0.5, 0.0, 0.0))],
    ... )
    >>> solution = strip.linear()
    >>> round(float(solution.stress([0])[0, 0, 0]), 6)  # 0.5 N/mm over 0.1 mm
    5.0
    >>> round(solution.energy, 6)  # 1 N over 20 µm
    0.01
    """

    displacement: Floats
    """Shape (n_node, 3), [mm]."""
    rotation: Floats
    """Spin vectors of the directors, normal to them, shape (n_node, 3), [rad]."""
    reaction: Floats
    reaction_moment: Floats
    """Change of the forces [N] and moments [N·mm] of the supports on the nodes, zero where
    nothing is supported, shape (n_node, 3)."""
    energy: float
    """½ load · displacement [N·mm]; for an unstressed film the strain energy."""
    residual: float
    """Largest unbalanced force over the largest load or reaction. In very thin films the round-off
    of strains causes large membrane forces: displacements are unaffected, reactions are no more
    accurate than this."""
    condition: float
    """Condition number of the stiffness with scaled freedoms."""
    error: float
    """Estimated relative error of displacement and rotation as a solution of the discrete film,
    without the discretisation error. Above 1e-4 there is no solution but a
    :class:`shellcut.statics.tangent_solver.NoConvergence`."""
    _film: Film = field(repr=False)

    def __iter__(self) -> Iterator[Floats]:
        return iter((self.displacement, self.rotation))

    def __len__(self) -> int:
        return 2

    def __getitem__(self, k: int) -> Floats:
        return (self.displacement, self.rotation)[k]

    def stress(self, quads: Ints | None = None, *, place: str = "mid") -> Floats:
        """Return the Cauchy stress tensors at the centres of quads [MPa], shape (n, 3, 3).

        This is the stress of the state about which the solution was taken, even if the film has
        moved since, and its linear change.

        Parameters
        ----------
        quads : ndarray of int, shape (n,), optional
            Quad ids, all by default.
        place : {"mid", "top", "bottom"}
            Height in the section.

        Raises
        ------
        ValueError
            If there is no such quad or place.
        """
        film = self._film
        which = np.arange(len(film.quads)) if quads is None else np.asarray(quads)
        if not film.shell.material.is_linear:
            raise ValueError(
                "the stress of a linear solution needs layers of linear laws without axes; take "
                "Statics.load_steps and Statics.stress"
            )
        return film.shell.linear_stress(
            film.x, film.t, film.quads, self.displacement, self.rotation, which, place
        )


@dataclass(frozen=True)
class Equilibrium:
    """One point of a load path."""

    factor: float
    """Load factor."""
    displacement: Floats
    """From the reference, shape (n_node, 3), [mm]."""
    director: Floats
    """Unit directors, shape (n_node, 3)."""
    n_iteration: int
    """Number of iterations, including intermediate steps."""
    reaction: Floats
    reaction_moment: Floats
    """Forces [N] and moments [N·mm] of the supports on the nodes, zero where nothing is supported,
    shape (n_node, 3)."""
    energy: float
    """Strain energy [N·mm]."""
    residual: float
    """Largest unbalanced force over the largest force."""
    n_negative: int
    """Number of negative eigenvalues of the tangent stiffness: of motions in which the film is
    unstable. Zero at a stable equilibrium; one is usual between two limit points."""


@dataclass(frozen=True)
class Modes:
    """Free vibrations."""

    frequency: Floats
    """Ascending, shape (n,), [Hz]; -f for a motion with omega² = -(2 pi f)², in which the film is
    unstable: it grows as exp(2 pi f t). Zero for a rigid motion without stiffness."""
    shape: Floats
    """Displacements with largest component 1, shape (n, n_node, 3)."""
