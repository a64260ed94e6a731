"""The ledger over a run, from the columns of its history: what was put in, where it went."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ._jit import Bools, Floats

# Imbalance and kinetic energy are compared with the tool's work from this angle on [degrees], or
# after a tenth of a straight way: at the start next to no work has been done to compare with.
_TRUSTED_FROM_DEG = 10.0
_TRUSTED_FROM_SHARE = 0.1


def work_put_in(history: Mapping[str, Floats]) -> Floats:
    """Return the work of tool, loads and supports, shape (n_row,), [N·mm]."""
    return np.asarray(history["tool_work"] + history["load_work"] + history["support_work"])


def energy_shares(history: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return where the work is by name, each of shape (n_row,), [N·mm]."""
    return {
        "cables": history["cohesive_work"] + history["cohesive_start_work"],
        "damping": history["damping_stiffness"] + history["damping_mass"],
        "strain": history["strain"],
        "kinetic": history["kinetic_translation"] + history["kinetic_rotation"],
        "contact": history["contact_work"],
    }


def trusted_rows(coordinate: Floats, unit: str, end: float) -> Bools:
    """Return in which rows the tool has done enough work to compare with, shape (n_row,).

    Parameters
    ----------
    coordinate : ndarray, shape (n_row,)
        Angle or path.
    unit : str
        ``"deg"`` or ``"mm"``.
    end : float
        Where the run ends, in that unit.
    """
    start = _TRUSTED_FROM_DEG if unit == "deg" else _TRUSTED_FROM_SHARE * end
    return np.asarray(coordinate >= start)


def largest_shares(history: Mapping[str, Floats], trusted: Bools) -> dict[str, float]:
    """Return the largest imbalance and kinetic energy relative to the tool's work, [-].

    Nothing if no row can be trusted: a run that ended so early has closed no balance.

    Examples
    --------
    >>> columns = {"tool_work": [0.0, 10.0], "imbalance": [0.2, -0.1]}
    >>> columns |= {"kinetic_translation": [0.0, 0.4], "kinetic_rotation": [0.0, 0.1]}
    >>> history = {name: np.array(column) for name, column in columns.items()}
    >>> largest_shares(history, np.array([False, True]))
    {'imbalance_rel': 0.01, 'kinetic_rel': 0.05}
    """
    if not trusted.any():
        return {}
    work = np.maximum(np.abs(history["tool_work"][trusted]), np.finfo(float).tiny)
    kinetic = history["kinetic_translation"] + history["kinetic_rotation"]
    return {
        "imbalance_rel": float((np.abs(history["imbalance"][trusted]) / work).max()),
        "kinetic_rel": float((np.abs(kinetic[trusted]) / work).max()),
    }
