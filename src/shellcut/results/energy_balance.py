"""The energy ledger over a run, from the columns of its history."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shellcut.arrays import Bools, Floats

# Imbalance and kinetic energy are compared with the tool's work once it reaches this part of its
# maximum: at first touch there is almost no work to compare with.
_COMPARED_FROM = 0.1

# A share below this, relative to the largest, is not drawn: it is thinner than a line.
_NEGLIGIBLE_SHARE = 2e-3


def work_put_in(history: Mapping[str, Floats]) -> Floats:
    """Return the work of tool, loads and supports, shape (n_row,), [N·mm]."""
    return np.asarray(history["tool_work"] + history["load_work"] + history["support_work"])


def energy_shares(history: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return the energies by name, each of shape (n_row,), [N·mm].

    Energy dissipated by the film's material or by friction of the cables on the cutting edge, work
    of the film's contact with itself, energy of pieces taken out and work of friction are separate
    shares, if there are any; so is energy that absorbed jumps took from the contact or gave to the
    film, unless it is negligible.
    """
    shares = {
        "cables": history["cohesive_work"] + history["cohesive_start_work"],
        "damping": history["damping_stiffness"] + history["damping_mass"],
        "strain": history["strain"],
        "kinetic": history["kinetic_translation"] + history["kinetic_rotation"],
        "contact": history["contact_work"],
    }
    dissipated = history.get("material_dissipated", np.zeros(0))  # older runs lack it
    if dissipated.any():
        shares["material"] = dissipated
    itself = history.get("self_contact_work", np.zeros(0))  # runs of older versions lack it
    if itself.any():
        shares["self contact"] = itself
    dropped = history.get("dropped", np.zeros(0))
    if dropped.any():
        shares["dropped pieces"] = dropped
    friction = history.get("friction_work", np.zeros(0))  # older runs lack it
    if friction.any():
        shares["friction"] = friction
    rubbed = history.get("joint_friction", np.zeros(0))  # older runs lack it
    if rubbed.any():
        shares["joint friction"] = rubbed
    absorbed = history.get("contact_absorbed", np.zeros(0))  # runs of older versions lack it
    largest = max(np.abs(share).max(initial=0.0) for share in shares.values())
    if np.abs(absorbed).max(initial=0.0) > _NEGLIGIBLE_SHARE * largest:
        shares["contact"] = shares["contact"] - absorbed
        shares["absorbed jumps"] = absorbed
    return shares


def driving_work(history: Mapping[str, Floats]) -> Floats:
    """Return the work of the tool, or that of the supports where no tool works, shape (n_row,)."""
    work = history["tool_work"]
    return history["support_work"] if is_pulled(history) else work


def is_pulled(history: Mapping[str, Floats]) -> bool:
    """Whether supports and no tool drive the run."""
    pulled = history.get("support_work", np.zeros(0))
    return bool(np.any(pulled) and not np.any(history["tool_work"]))


def trusted_rows(history: Mapping[str, Floats]) -> Bools:
    """Return the rows with enough work of tool or supports to compare with, shape (n_row,).

    These are the rows with at least a tenth of the largest work of the run; none if there was no
    work.

    Examples
    --------
    >>> trusted_rows({"tool_work": np.array([0.0, 0.4, 1.0, 9.0])})
    array([False, False,  True,  True])
    """
    work = np.abs(driving_work(history))
    finite = np.isfinite(work)
    most = work[finite].max(initial=0.0)
    return np.asarray(finite & (work > 0.0) & (work >= _COMPARED_FROM * most))


def largest_shares(history: Mapping[str, Floats], trusted: Bools) -> dict[str, float]:
    """Return the largest imbalance and kinetic energy relative to the driving work, [-].

    Empty if no row can be trusted: without work there is no balance to close.

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
    work = np.maximum(np.abs(driving_work(history)[trusted]), np.finfo(float).tiny)
    kinetic = history["kinetic_translation"] + history["kinetic_rotation"]
    return {
        "imbalance_rel": float((np.abs(history["imbalance"][trusted]) / work).max()),
        "kinetic_rel": float((np.abs(kinetic[trusted]) / work).max()),
    }
