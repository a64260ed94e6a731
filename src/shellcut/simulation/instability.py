"""When a solution is given up: it has blown up, or its energy balance is lost.

A step that is too long is not the only cause of a lost solution. Forces far beyond what the film
can carry, from a number in the wrong unit say, throw the film about in steps that are each stable,
and it never blows up. The energy balance shows it: energy appears from nowhere. It is checked every
``CHECK_EVERY`` steps, and a run that misses more than ``LOST_SHARE`` of the largest energy it has
seen is stopped. A run that misses a few per cent continues, and the verdict judges it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.mesh.mesh import Mesh
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.kept import Kept
from shellcut.state import State

from .ledger import Ledger
from .stable_step import StableStep

CHECK_EVERY = 50
"""Steps between two checks of the energy balance."""

LOST_SHARE = 0.5
"""Of the largest energy so far, that the energy balance may miss: energy that appears from nowhere
soon is the largest there is, so that the share rises to 1 or beyond, whatever was there before."""

_EXPLODED = 1e6
"""Strain energy over that of a film strained by 1 everywhere, at which the solution is given up:
far beyond any film, yet within numbers, so that the last frame can be written."""

# The least energy that is compared: that of one quad strained by so much, or so much of the work
# that tears one edge. Below it, at the first touch and the first splits, works of a few steps are
# compared with each other.
_NOTICED_STRAIN = 0.01
_NOTICED_TEARING = 0.1

# Strain of the quad whose energy is used for the work of a run that has not done any.
_LARGE_STRAIN = 0.03


class UnstableStep(RuntimeError):
    """The solution has blown up; the message names the first bad quad and the likely cause."""


class BalanceLost(UnstableStep):
    """The energy balance misses most of the energy; the message says how much, when and why."""


class BalanceGuard(Kept):
    """Checks whether the energy balance still closes.

    Parameters
    ----------
    stretching : float
        Membrane stiffness of the film, the sum of E h over its layers [N/mm].
    quad_area : float
        Of a typical quad [mm²].
    tearing : float
        Work that tears the film along a millimetre, 0 if nothing tears it [N].
    """

    kept_names = "largest", "_at_start"

    def __init__(self, stretching: float, quad_area: float, tearing: float = 0.0) -> None:
        self.least = max(
            stretching * quad_area * _NOTICED_STRAIN**2,
            tearing * math.sqrt(quad_area) * _NOTICED_TEARING,
        )
        """Energy below which there is nothing to compare with [N·mm]."""
        self.largest = 0.0
        """Energy at the checks so far [N·mm]."""
        self._at_start = 0.0

    def begin(self, book: Ledger) -> None:
        """Take the energy balance after the first step as the reference.

        What it misses then was put into the film by hand before the run: a strained state, a
        velocity. That is no loss.
        """
        self._at_start = book.imbalance

    def lost(self, book: Ledger) -> bool:
        """Whether what the energy balance misses exceeds its share of the largest energy so far."""
        self.largest = max(self.largest, *(abs(energy) for energy in book.entries().values()))
        return not abs(self.missing(book)) < LOST_SHARE * max(self.largest, self.least)

    def missing(self, book: Ledger) -> float:
        """Return what the energy balance has missed since the first step [N·mm]."""
        return book.imbalance - self._at_start


class StabilityGuard:
    """Gives up a solution that has blown up or lost its energy balance, and says why.

    Parameters
    ----------
    mesh : Mesh
        Reference mid-surface.
    shell : MITC4Shell
        Knows the material and the strained quads.
    law : CohesiveTable, optional
        Of the cables.
    time_step : StableStep
        Knows the safe step.
    """

    def __init__(
        self, mesh: Mesh, shell: MITC4Shell, law: CohesiveTable | None, time_step: StableStep
    ) -> None:
        self._shell, self._law, self._time_step = shell, law, time_step
        material, areas = shell.material, mesh.quad_areas()
        stretching = material.stretching_stiffness
        tearing = law.fracture_energy * material.thickness if law else 0.0
        self.most_strain = _EXPLODED * stretching * float(areas.sum())
        """Strain energy at which the film has blown up [N·mm]."""
        area = float(np.median(areas))
        self.balance = BalanceGuard(stretching, area, tearing)
        """Of the energy, which a checkpoint keeps."""
        self._one_edge = max(stretching * area * _LARGE_STRAIN**2, tearing * math.sqrt(area))

    @property
    def scale(self) -> float:
        """Largest energy at the checks so far, or what tears an edge or strains a quad [N·mm]."""
        return max(self.balance.largest, self._one_edge)

    def imbalance(self, book: Ledger) -> float | None:
        """Return the imbalance over the energy put in, None while that is too little."""
        is_enough = book.put_through >= self.balance.least
        return book.relative(book.imbalance) if is_enough else None

    def check_strain(self, state: State, book: Ledger) -> None:
        """Raise UnstableStep if the film has blown up."""
        if not book.strain <= self.most_strain:
            raise self._blown_up(state)

    def check_balance(self, state: State, book: Ledger) -> None:
        """Raise BalanceLost if too much energy is missing, UnstableStep if a quad has collapsed.

        Both are checked every CHECK_EVERY steps.
        """
        if state.step == 1:
            self.balance.begin(book)
        if state.step % CHECK_EVERY:
            return
        self._check_area(state)
        if self.balance.lost(book):
            raise self._balance_lost(state, book)

    def _check_area(self, s: State) -> None:
        collapsed = self._shell.collapsed_quad(s)
        if collapsed is None:
            return
        quad, ratio = collapsed
        raise UnstableStep(
            f"{self._said(s, quad)} has been folded flat at step {s.step}, t = {s.time:.6g} s: "
            f"{100.0 * ratio:.2g} % of its area is left, and the logarithmic strain of the film's "
            "law has no bound there; use smaller quads where the film folds, or a tool and motion "
            "that do not crush it"
        )

    def _blown_up(self, s: State) -> UnstableStep:
        worst = self._worst_quad(s)
        if s.dt == 0.0:
            return UnstableStep(
                f"the film is strained beyond all measure before the first step: {worst} is not "
                "finite or explodes; no step has been taken, so its initial positions are the "
                "cause: check what moved its nodes"
            )
        return UnstableStep(
            f"the solution blew up at step {s.step}, t = {s.time:.6g} s, worst in {worst}. "
            + " ".join(self._causes(s))
        )

    def _balance_lost(self, s: State, book: Ledger) -> BalanceLost:
        entries = ", ".join(
            f"{name} {energy:.4g}" for name, energy in book.entries().items() if energy
        )
        return BalanceLost(
            f"the energy balance is lost at step {s.step}, t = {s.time:.6g} s, dt = {s.dt:.4g} s: "
            f"{self.balance.missing(book):.4g} N·mm are missing, more than "
            f"{100 * LOST_SHARE:.0f} % of the largest energy so far (now {entries} N·mm); "
            f"{self._worst_quad(s)} is strained most. "
            + " ".join(self._causes(s))
            + " Else check the units (mm, N, s, t, MPa) of film, cables, loads and motion. A state "
            "changed by hand between two steps has no balance either."
        )

    def _worst_quad(self, s: State) -> str:
        return self._said(s, s.most_strained_quad())

    def _said(self, s: State, quad: int) -> str:
        centre = s.node.X[s.quads[quad]].mean(axis=0)
        return f"quad {quad} at ({centre[0]:.4g}, {centre[1]:.4g}, {centre[2]:.4g}) mm"

    def _causes(self, s: State) -> Iterator[str]:
        """Yield what is plainly wrong, or what may be done about the step."""
        layers, law = self._shell.material.layers, self._law
        young = max(layer.material.stretching_modulus for layer in layers)
        if law is not None and law.strength > young:
            yield (
                f"The strength of the cables, {law.strength:.4g} MPa, is above Young's modulus of "
                f"the film, {young:.4g} MPa: is it in Pa?"
            )
        fixed, safe = self._time_step.stepping.fixed, self._time_step.bound(s)
        if fixed is not None and fixed > safe:
            yield (
                f"The step of {fixed:.4g} s is longer than the safe one, {safe:.4g} s: leave out "
                "time.fixed."
            )
        else:
            key = "safety" if fixed is None else "fixed"
            if s.dt > safe:
                yield f"The step was {s.dt:.4g} s, {safe:.4g} s is safe: lower time.{key}."
            else:
                yield (
                    f"The step of {s.dt:.4g} s was as short as the stiffness of film and force "
                    f"terms needs, {safe:.4g} s: is a term stiffer than it says (ForceTerm."
                    f"stiffness)? Else lower time.{key}."
                )
