"""Energy and damping work of the shell, from the sums that its kernels return."""

from __future__ import annotations

from typing import NamedTuple

from shellcut.state import State


class Work(NamedTuple):
    """Energies of one evaluation of the shell's forces, for the energy balance."""

    strain_energy: float
    """Stored energy at t_n [N·mm]."""
    damping: float
    """Work of the damping stress since t_{n-1} [N·mm]."""
    dissipated: float
    """Energy dissipated by the material since t_{n-1} [N·mm]."""


def linear_work(state: State, p0: float, p1: float, p2: float, rho: float) -> Work:
    """Return the shell's work from s_n·r, s_{n-1}·r and s_{n-2}·r, see :mod:`.forces`."""
    a_last, b_last = state.strain_forms
    step, step_before = p0 - p1, p1 - p2
    c = (a_last + (2.0 + rho) * step - p0) / (1.0 + rho) ** 2
    d = (step_before - b_last) / (1.0 + rho)
    b = step - rho * c
    a = p0 - rho * b
    state.strain_forms = a, b
    return Work(0.5 * a, 0.5 * rho * (c + d), 0.0)
