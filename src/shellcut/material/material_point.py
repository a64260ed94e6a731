"""One point of a material, led by strains or stresses: a law, before a film is made of it.

Strains here are logarithmic, in the film's axes, and the stress is T conjugate to them, the
Kirchhoff stress turned back by the rotation, which for a film that keeps its volume is the true
stress. The law itself is evaluated with the Green-Lagrange strain, as in a film, so that all of it
is exercised. The nominal stress of a pull to the stretch λ is T/λ.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.numerics.jit import kernel

from .law_dispatch import HistoryStep, PointLaws, point_stress, point_thickness
from .material import Material

# Change of strain for the differences of Newton's method.
_STEP = 1e-7
_MOST_TURNS = 60


class PointState(NamedTuple):
    """What a step has led to."""

    strain: Floats
    """Logarithmic (ε_11, ε_22, 2 ε_12), shape (3,)."""
    stress: Floats
    """(T_11, T_22, T_12), shape (3,) [MPa]."""
    stored: float
    """Energy density [N/mm²] at the end."""
    dissipated: float
    """Energy density [N/mm²] of all steps so far."""
    thickness_stretch: float
    """Present over reference thickness."""
    history: dict[str, float]
    """History numbers by name."""


class MaterialPoint:
    """A point that keeps its history from step to step.

    Parameters
    ----------
    material : Material
        Any, with or without history.

    Examples
    --------
    A strip that is pulled to 10 % of true strain with free sides:

    >>> from shellcut.material import Elastic, Plastic, Swift
    >>> foil = Plastic(Elastic(70_000.0, 0.33, 2.7e-9), Swift(150.0, 0.002, 0.2))
    >>> point = MaterialPoint(foil)
    >>> for strain in (0.02, 0.05, 0.1):
    ...     state = point.pull(strain)
    >>> round(float(state.stress[0]), 2)
    94.76
    """

    def __init__(self, material: Material) -> None:
        law = material.law
        self._names = law.history
        row = np.asarray(material.parameters(), float)[None]
        self._laws = PointLaws((law,), np.zeros(1, np.int64), row)
        self._moduli = material.plane_stress()
        self._history = np.zeros((1, len(law.history), 8))
        self._strain, self._lost = np.zeros(3), 0.0

    def strain_to(self, strain: Floats, dt: float = 0.0) -> PointState:
        """Take a step to a logarithmic strain (ε_11, ε_22, 2 ε_12).

        Parameters
        ----------
        strain : array_like, shape (3,)
            At the end of the step.
        dt : float
            Length of the step [s], for laws that depend on the rate; these do not flow in none.
        """
        strain = np.asarray(strain, float)
        stress, stored, lost, stretch, history = self._trial(strain, dt)
        self._strain, self._history = strain, history
        self._lost += lost
        names = zip(self._names, history[0, :, 0].tolist(), strict=True)
        return PointState(strain, stress, stored, self._lost, stretch, dict(names))

    def stress_to(self, stress: Floats, dt: float = 0.0) -> PointState:
        """Take a step to a stress (T_11, T_22, T_12) [MPa].

        Raises
        ------
        RuntimeError
            If no strain is found at which the material carries it.
        """
        return self._solved(np.asarray(stress, float), self._strain.copy(), np.arange(3), dt)

    def pull(self, strain: float, *, sides_held: bool = False, dt: float = 0.0) -> PointState:
        """Take a step to a logarithmic strain along axis 1.

        Parameters
        ----------
        strain : float
            ε_11 at the end of the step.
        sides_held : bool
            Whether the width is fixed, as in a wide strip; else the sides are free.
        dt : float
            As in :meth:`strain_to`.
        """
        start = self._strain.copy()
        start[0] = strain
        free = np.array([2]) if sides_held else np.array([1, 2])
        return self._solved(np.zeros(3), start, free, dt)

    def _solved(self, wanted: Floats, strain: Floats, free: Ints, dt: float) -> PointState:
        """Take a step on which some components of the stress are as wanted, the others free."""
        slope = self._moduli[np.ix_(free, free)]
        size = 1e-10 * max(float(np.abs(wanted).max()), 1e-6 * float(self._moduli.max()))
        miss, step = np.inf, np.zeros(free.size)
        for _ in range(_MOST_TURNS):
            stress = self._trial(strain, dt)[0]
            left = wanted[free] - stress[free]
            if not np.abs(left).max() < miss and miss < np.inf:  # too far: half the step
                step = 0.5 * step
                strain[free] -= step
                if np.abs(step).max() < 1e-15:
                    break
                continue
            miss = float(np.abs(left).max())
            if miss <= size:
                return self.strain_to(strain, dt)
            for m, k in enumerate(free):
                moved = strain.copy()
                moved[k] += _STEP
                slope[:, m] = (self._trial(moved, dt)[0][free] - stress[free]) / _STEP
            step = np.linalg.solve(slope, left)
            strain[free] += step
        if miss <= 1e4 * size:
            return self.strain_to(strain, dt)
        raise RuntimeError(
            f"no strain was found at which the material carries {wanted.tolist()} MPa, "
            f"{miss:.3g} MPa are missing"
        )

    def _trial(self, strain: Floats, dt: float) -> tuple[Floats, float, float, float, Floats]:
        tensor = np.array([[strain[0], 0.5 * strain[2]], [0.5 * strain[2], strain[1]]])
        log, axes = np.linalg.eigh(2.0 * tensor)
        c = np.exp(log)
        green = axes @ np.diag(0.5 * np.expm1(log)) @ axes.T
        after = np.zeros_like(self._history)
        numbers = np.empty(6)
        given = np.array([green[0, 0], green[1, 1], 2.0 * green[0, 1]])
        _evaluate(self._laws, given, self._history, after, dt, numbers)
        # S_ab = θ_ab T_ab in the axes of the strain.
        gap = log[1] - log[0]
        mixed = gap / (c[1] - c[0]) if gap > 1e-12 else 1.0 / c[0]
        theta = np.array([[1.0 / c[0], mixed], [mixed, 1.0 / c[1]]])
        S = np.array([[numbers[0], numbers[2]], [numbers[2], numbers[1]]])
        T = axes @ ((axes.T @ S @ axes) / theta) @ axes.T
        return np.array([T[0, 0], T[1, 1], T[0, 1]]), *numbers[3:6].tolist(), after


@kernel
def _evaluate(
    laws: PointLaws, strain: Floats, before: Floats, after: Floats, dt: float, numbers: Floats
) -> None:
    """Write stress, stored and dissipated energy, and thickness stretch to numbers : (6,).

    strain : (3,).  before, after : (1, n_history, 8), of which the first lane counts.
    """
    e = (strain[0], strain[1], strain[2])
    stress, stored, lost = point_stress(laws, 0, e, HistoryStep(before, after, 0, 0, dt), 0, 0)
    numbers[0], numbers[1], numbers[2] = stress
    numbers[3], numbers[4] = stored, lost
    numbers[5] = point_thickness(laws, 0, e, HistoryStep(after, after, 0, 0, dt), 0, 0)
