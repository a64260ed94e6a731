"""Quads that are taken out of a run: their energy at that moment, and their empty places.

The place of such a quad keeps its nodes and loses its stiffness, like the place that a cut quad has
left (:mod:`.places`); so does its part of what the kernels sum up from step to step
(:mod:`.forces`): A = s_n·H s_n and B = s_n·H a_n.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.material.law_dispatch import HistoryStep
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.lanes import pick_all
from shellcut.state import State

from .element import N_STRAIN
from .frequency import QuadFrequencies
from .places import Places
from .point_forces import point_resultants
from .present_quads import PresentQuads
from .quad_strains import (
    PointQuads,
    QuadStep,
    dot16,
    minus,
    one_quad,
    stiffness_product,
)


class DroppedQuads:
    """Takes quads and copies out of a run.

    Parameters
    ----------
    places, present, frequencies : Places, PresentQuads, QuadFrequencies
        Of the film.
    damping_beta : float
        Stiffness damping [s].
    """

    def __init__(
        self,
        places: Places,
        present: PresentQuads,
        frequencies: QuadFrequencies,
        damping_beta: float,
    ) -> None:
        self._places, self._present, self._frequencies = places, present, frequencies
        self._damping_beta = damping_beta
        self._has_points = bool(places.points.rule.place.size)
        self._write = BoundOnce(
            _write_point_energies if self._has_points else _write_linear_energies
        )

    def take_out(self, state: State, rows: Ints) -> float:
        """Take some rows out for good; return their strain energy at t_n [N·mm].

        Parameters
        ----------
        state : State
            After the forces at t_n.
        rows : ndarray of int, shape (n,)
            Quads and copies.
        """
        energy, form = np.zeros(rows.size), np.zeros(rows.size)
        # The forces have swapped the strains: these are s_n and s_{n-1}.
        damped = self._damping_beta > 0.0
        step = QuadStep(
            damped, 0.0, state.strain, state.strain_before, state.history, state.dt
        )
        self._write(self._places.blocks.slot[rows], self._present.of(state), step, energy, form)
        gone = float(energy.sum())
        if damped and not self._has_points:
            a, b = state.strain_forms
            state.strain_forms = a - 2.0 * gone, b - float(form.sum())
        self._places.empty(rows)
        self._frequencies.drop(rows)
        return gone

    def restore(self, state: State) -> None:
        """Empty the places of the rows that have been taken out of ``state``."""
        self._places.empty(np.flatnonzero(state.quad.dropped[: state.n_quad]))


def _make_energy_kernel(by_points: bool) -> Any:
    @kernel
    def write_energies(
        slot: Ints, quads: PointQuads, step: QuadStep, energy: Floats, form: Floats
    ) -> None:
        """Write the stored energy at t_n of the quad at slot[i] to energy : (n,).

        And s_n·H a_n to form : (n,), if there is damping.  step : s_n and s_{n-1}.
        """
        linear, history = quads.quads, step.history
        last, before = step.last, step.before
        tables, width = linear.tables, linear.corner.shape[2]
        work = np.empty((2, N_STRAIN, width))
        trial = np.empty((1, history.shape[1], width))
        for i in range(slot.shape[0]):
            b, lane, flat, _, s = one_quad(linear, slot[i])
            if by_points:
                at = HistoryStep(history, trial, b, 0, step.dt)
                _, stored, _ = point_resultants(quads, quads.points, flat, s, at, lane)
                energy[i] = stored
            else:
                energy[i] = 0.5 * dot16(s, stiffness_product(tables, flat, b, lane, s, work))
            if step.damped:
                change = minus(pick_all(last, b, 0, N_STRAIN, lane), pick_all(before, b, 0, N_STRAIN, lane))
                viscous = stiffness_product(tables, flat, b, lane, change, work)
                form[i] = dot16(s, viscous)

    return write_energies


_write_linear_energies = _make_energy_kernel(by_points=False)
"""For linear materials."""
_write_point_energies = _make_energy_kernel(by_points=True)
"""For any material."""
