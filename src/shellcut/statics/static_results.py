"""What statics finds: linear answers, points of load paths, free vibrations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mitc4.shell import MITC4Shell


class Film(NamedTuple):
    """A film where it was when a solution was taken."""

    x: Floats
    """Positions [mm], shape (n_node, 3)."""
    t: Floats
    """Directors, shape (n_node, 3)."""
    quads: Ints
    """Node ids, shape (n_quad, 4)."""
    shell: MITC4Shell


@dataclass(frozen=True)
class LinearSolution:
    """A linear answer about a state; as a sequence it is its displacement and its rotation.

    Attributes
    ----------
    displacement : ndarray, shape (n_node, 3)
        [mm].
    rotation : ndarray, shape (n_node, 3)
        Spin vectors of the directors, normal to them [rad].
    reaction, reaction_moment : ndarray, shape (n_node, 3)
        What the supports hold the nodes [N] and the directors [N·mm] with, beyond what they did
        before; zero where nothing is held.
    energy : float
        ½ load · displacement [N·mm]: of an unstressed film the strain energy.
    residual : float
        Largest force that is not balanced over the largest load or reaction. In very thin films
        last digits of strains make large membrane forces: displacements do not mind, reactions
        are no better than this.
    condition : float
        Of the stiffness, freedoms scaled: largest over least.
    error : float
        Estimate of the relative error of displacement and rotation as a solution of the discrete
        film, which says nothing of the mesh. Above 1e-4 there is no solution but a
        :class:`shellcut.statics.tangent_solver.NoConvergence`.

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
    rotation: Floats
    reaction: Floats
    reaction_moment: Floats
    energy: float
    residual: float
    condition: float
    error: float
    _film: Film = field(repr=False)

    def __iter__(self) -> Iterator[Floats]:
        return iter((self.displacement, self.rotation))

    def __len__(self) -> int:
        return 2

    def __getitem__(self, k: int) -> Floats:
        return (self.displacement, self.rotation)[k]

    def stress(self, quads: Ints | None = None, *, place: str = "mid") -> Floats:
        """Return the Cauchy stress tensors at the centres of quads [MPa], shape (n, 3, 3).

        That of the state the solution was taken about, wherever the film has gone since, and its
        linear change.

        Parameters
        ----------
        quads : ndarray of int, shape (n,), optional
            Which quads, all by default.
        place : {"mid", "top", "bottom"}
            Height at which it is taken.

        Raises
        ------
        ValueError
            If there is no such quad or place.
        """
        film = self._film
        which = np.arange(len(film.quads)) if quads is None else np.asarray(quads)
        return film.shell.linear_stress(
            film.x, film.t, film.quads, self.displacement, self.rotation, which, place
        )


@dataclass(frozen=True)
class Equilibrium:
    """One point of a load path.

    Attributes
    ----------
    factor : float
        Load factor.
    displacement : ndarray, shape (n_node, 3)
        From the reference [mm].
    director : ndarray, shape (n_node, 3)
        Unit directors.
    n_iteration : int
        Iterations it took, those of intermediate steps included.
    reaction, reaction_moment : ndarray, shape (n_node, 3)
        What the supports hold the nodes [N] and the directors [N·mm] with; zero where nothing is
        held.
    energy : float
        Strain energy [N·mm].
    residual : float
        Largest force that is not balanced over the largest there is.
    """

    factor: float
    displacement: Floats
    director: Floats
    n_iteration: int
    reaction: Floats
    reaction_moment: Floats
    energy: float
    residual: float


@dataclass(frozen=True)
class Modes:
    """Free vibrations.

    Attributes
    ----------
    frequency : ndarray, shape (n,)
        Ascending [Hz].
    shape : ndarray, shape (n, n_node, 3)
        Displacements, of largest component 1.
    """

    frequency: Floats
    shape: Floats
