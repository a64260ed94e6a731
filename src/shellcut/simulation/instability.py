"""When a solution is given up: it has blown up, or its energy balance is lost.

A step that is too long is not the only way to lose a solution. Forces far beyond what the film can
carry, from a number in the wrong unit say, throw the film about in steps that are each stable, and
it never blows up. The ledger shows it: energy comes from nowhere. It is looked at every
``CHECK_EVERY`` steps, and a run that misses more than ``LOST_SHARE`` of the largest energy it has
seen is stopped. A run that misses a few per cent goes on, and the verdict judges it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .ledger import Ledger

if TYPE_CHECKING:
    from .simulation import Simulation

CHECK_EVERY = 50
"""Steps between two looks at the ledger."""

LOST_SHARE = 0.5
"""Of the largest energy so far, that the ledger may miss: energy that appears from nowhere soon is
the largest there is, so that the share goes to one or beyond, whatever was there before."""

_EXPLODED = 1e6
"""Strain energy over that of a film strained by one everywhere, at which the solution is given up:
far beyond any film, yet within numbers, so that the last frame can be written."""

# The least energy that is looked at: that of one quad strained by so much, or so much of the work
# that tears one edge. Below it, at the first touch and the first splits, works of a few steps are
# compared with each other.
_NOTICED_STRAIN = 0.01
_NOTICED_TEARING = 0.1


class UnstableStep(RuntimeError):
    """The solution has blown up; the message names the first bad quad and the likely cause."""


class BalanceLost(UnstableStep):
    """The ledger misses most of the energy; the message says how much, when and why."""


class BalanceGuard:
    """Looks whether the ledger still closes.

    Parameters
    ----------
    stretching : float
        Membrane stiffness of the film, the sum of E h over its layers [N/mm].
    quad_area : float
        Of a typical quad [mm²].
    tearing : float
        Work that tears the film along a millimetre, 0 if nothing tears it [N].
    """

    def __init__(self, stretching: float, quad_area: float, tearing: float = 0.0) -> None:
        self._least = max(
            stretching * quad_area * _NOTICED_STRAIN**2,
            tearing * math.sqrt(quad_area) * _NOTICED_TEARING,
        )
        self._largest = 0.0
        self._at_start = 0.0

    def begin(self, book: Ledger) -> None:
        """Take the ledger after the first step as the one to compare with.

        What it misses then was put into the film by hand before the run: a strained state, a
        velocity. That is no loss.
        """
        self._at_start = book.imbalance

    def lost(self, book: Ledger) -> bool:
        """Whether what the ledger misses exceeds its share of the largest energy so far."""
        self._largest = max(self._largest, *(abs(energy) for energy in book.entries().values()))
        return not abs(self.missing(book)) < LOST_SHARE * max(self._largest, self._least)

    def missing(self, book: Ledger) -> float:
        """Return what the ledger has come to miss since the first step [N·mm]."""
        return book.imbalance - self._at_start

    def saved(self) -> dict[str, Any]:
        """Return the largest energy so far and what was missing at the start."""
        return {"largest": self._largest, "at_start": self._at_start}

    def restore(self, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self._largest, self._at_start = saved["largest"], saved["at_start"]


def most_strain_energy(stretching: float, area: float) -> float:
    """Return the strain energy [N·mm] at which a film has blown up.

    Parameters
    ----------
    stretching : float
        Membrane stiffness, the sum of E h over the layers [N/mm].
    area : float
        Of the film [mm²].
    """
    return _EXPLODED * stretching * area


def blown_up(sim: Simulation) -> UnstableStep:
    """Return the error of a film that has blown up."""
    s = sim.state
    if s.dt == 0.0:
        return UnstableStep(
            f"the film is strained beyond all measure before the first step: {_worst_quad(sim)} is "
            "not finite or explodes; no step has been taken, it is the positions it starts from: "
            "check what moved its nodes"
        )
    return UnstableStep(
        f"the solution blew up at step {s.step}, t = {s.time:.6g} s, dt = {s.dt:.4g} s: "
        f"{_worst_quad(sim)} is no longer finite or explodes; the safe step was "
        f"{sim.time_step.bound(s):.4g} s: lower Stepping.safety, or leave Stepping.fixed unset"
    )


def balance_lost(sim: Simulation, missing: float) -> BalanceLost:
    """Return the error of a run whose ledger misses so much [N·mm]."""
    s, book = sim.state, sim.ledger
    entries = ", ".join(f"{name} {energy:.4g}" for name, energy in book.entries().items() if energy)
    return BalanceLost(
        f"the energy balance is lost at step {s.step}, t = {s.time:.6g} s, dt = {s.dt:.4g} s: "
        f"{missing:.4g} N·mm are missing, more than {100 * LOST_SHARE:.0f} % of the largest "
        f"energy so far (now {entries} N·mm); {_worst_quad(sim)} is strained most. "
        f"{' '.join(_likely_causes(sim))}"
    )


def _worst_quad(sim: Simulation) -> str:
    s = sim.state
    quad = sim.shell.most_strained_quad(s)
    centre = s.node.X[s.quads[quad]].mean(axis=0)
    return f"quad {quad} at ({centre[0]:.4g}, {centre[1]:.4g}, {centre[2]:.4g}) mm"


def _likely_causes(sim: Simulation) -> list[str]:
    """Return what to look at, what is plainly wrong first."""
    causes = []
    young = max(layer.material.stretching_modulus for layer in sim.material.layers)
    if sim.law is not None and sim.law.strength > young:
        causes.append(
            f"The strength of the cables, {sim.law.strength:.4g} MPa, is above Young's modulus of "
            f"the film, {young:.4g} MPa: is it in Pa?"
        )
    stepping = sim.time_step.stepping
    safe = sim.time_step.bound(sim.state)
    if stepping.fixed is not None and stepping.fixed > safe:
        causes.append(
            f"Stepping.fixed = {stepping.fixed:.4g} s is above the safe step, {safe:.4g} s: "
            "leave it unset."
        )
    causes.append(
        "Else check the units (mm, N, s, t, MPa) of film, cables, loads and motion, put the "
        "blade's path into the mesh (imprint), or lower Stepping.safety, now "
        f"{stepping.safety:.3g}. A state changed by hand between two steps has no balance either."
    )
    return causes
