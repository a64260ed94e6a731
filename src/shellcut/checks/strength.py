"""What a film and its glue carry: strength, piercing, peeling.

*Strength.* That of the law of cables is a nominal stress, and so is what
:mod:`shellcut.material.nominal_stress` says a film carries at most (docs/theory/yielding.md). A
film below its strength does not crack by the criterion; under a blade it is cut all the same.

*Piercing.* F_p (:mod:`shellcut.fracture.puncture`) of an end, apex or arc of an edge is that of a
film that is flat, stretched little and stiff in transverse shear, and that tears no farther by
itself. A force that the user gives needs none of this, nor do edges that all enter the film at its
border.

*Peeling.* What the film's quads resolve of a glue that may peel (docs/theory/adhesion.md), and of
the fold of a flap that tears (tests/predictions/torn_flap.py).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, cast

import numpy as np

from shellcut.arrays import norm, off_segments, product
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.loads.adhesion import ZONE_SIDES, GluePoints
from shellcut.loads.loads import Pressure
from shellcut.material.nominal_stress import (
    LargestNominalStress,
    largest_nominal_stress,
    nominal_curve,
)
from shellcut.material.plastic import Plastic
from shellcut.material.secants import secants_at
from shellcut.material.shell_material import ShellMaterial
from shellcut.tool.force_term import ForceTerm

from .finding import Finding, doubt, note
from .sweep import Sweep

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_PLASTIC = 0.02
"""Strain beyond the elastic one from which a film is said to yield before it cracks."""

SHEAR_SOFT = 0.2
"""Largest tension at the strength over the section's transverse shear stiffness: 0.03 of one layer
at a strain of 1 %, 0.16 of PET on five times as much PE, 0.5 of foil, PE and foil."""

FARTHEST_STRAIN = 0.1
"""Largest strain at the strength of a film that yields: slopes are sqrt(2 strain), 0.45 there."""

_BAND = "0.91 to 1.00", "0.87 to 1.13"
"""Of one layer and of several (``tests/unit/test_puncture.py``)."""

_MEASURE = "measure the force of piercing, if you need it, and give it, fracture.puncture_force"

_N_INSTANT = 65
"""Instants of the run at which the pressure is taken."""

_FROM_RIM = 0.25
"""Sides of quads from the film's border beyond which a cutting edge meets the film's face."""

# Of sqrt(tau / (rho h)), at which the moving film takes as much energy as the glue.
_SLOW = 0.1


def check_strength(material: ShellMaterial, law: CohesiveTable | None) -> Iterator[Finding]:
    """Yield what a film that yields carries, where that matters to its cracks."""
    if law is None or material.is_linear:
        return
    most = largest_nominal_stress(material)
    if most is None:
        return
    if law.strength > most.stress:
        in_strip = largest_nominal_stress(material, "plane strain", across=most.across)
        shown = most if in_strip is None else in_strip
        yield doubt(
            "a film must be able to carry the strength at which it cracks, or it necks and parts "
            "only where a blade has passed",
            f"{_carries(shown)}, a crack needs {law.strength:.4g} MPa",
            "lower [cohesive] strength below what the film carries, or look at its hardening; both "
            "are forces over the undeformed section",
        )
        return
    found = []  # strains at which it first carries the strength in plane strain
    for across in (False, True):
        curve = nominal_curve(material, "plane strain", across=across)
        assert curve is not None
        above = np.flatnonzero(curve[1] >= law.strength)
        if len(above):
            found.append(float(curve[0][above[0]]))
    reached = min(found, default=None)
    elastic = law.strength * material.thickness / material.stretching_stiffness
    if reached is None:
        yield note(
            f"{_carries(most)}, less in plane strain; a crack needs {law.strength:.4g} MPa",
            "the film cracks only where it is stretched in both directions, elsewhere it necks",
        )
    elif reached > elastic + _PLASTIC:
        yield note(
            f"the film yields before it cracks: in plane strain it carries the strength, "
            f"{law.strength:.4g} MPa, at {_per_cent(reached)} strain",
            f"the work of stretching it so far is not in the cables' energy; {_carries(most)}",
        )


def _carries(most: LargestNominalStress) -> str:
    where = f"{most.pull}, at {_per_cent(most.strain)} strain"
    where += ", across its direction" if most.across else ""
    return f"this film carries {most.stress:.3g} MPa at most ({where})"


def _per_cent(strain: float) -> str:
    return f"{100 * strain:.0f} %" if strain >= 0.1 else f"{100 * strain:.2g} %"


def check_piercing(sim: Simulation, law: CohesiveTable, sweep: Sweep) -> Iterator[Finding]:
    """Yield where F_p of the strength is not the force at which a tip pierces the film."""
    if sim.cracks is None or not _on_face(sim, sweep):
        return
    film, strength = sim.material, law.strength
    young = film.stretching_stiffness / film.thickness
    films = [layer.material for layer in film.layers]
    secants, strain = secants_at(film, strength * film.thickness)
    yields = [
        one.law.name
        for one, secant in zip(films, secants.tolist(), strict=True)
        if secant < 1.0 - 1e-9 or (one.law.history and not isinstance(one, Plastic))
    ]
    if yields:
        names = ", ".join(sorted(set(yields)))
        if strain > FARTHEST_STRAIN:
            text = (
                "the force at which a tip pierces this film is a guess, because the film is "
                f"stretched by {100.0 * np.expm1(strain):.0f} % before it parts ({names}): the "
                f"formula holds up to {100.0 * FARTHEST_STRAIN:.0f} %"
            )
        else:
            text = (
                "the force at which a tip pierces this film is known roughly, because the film "
                f"yields before its strength ({names}): in films that were solved it was "
                f"{_BAND[len(films) > 1]} times what is computed"
            )
        yield doubt("", text, _MEASURE)
    crack, bent = young * law.fracture_energy / strength**2, sim.cracks.bending_length
    if crack < bent:
        yield doubt(
            "a film must not tear on by itself once a tip has pierced it: modulus times fracture "
            "energy over strength² must exceed the length over which the film bends there",
            f"{crack:.3g} mm and {bent:.3g} mm",
            "such a film tears on by itself once it is pierced, which a run does only from tips "
            "that no edge drives: look at units of strength and openings, or " + _MEASURE,
        )
    pressure, flat = _pressure(sim, sweep), sim.cracks.flat_pressure
    if pressure > flat:
        yield doubt(
            "",
            f"a pressure of {pressure:.3g} MPa bulges this film, and the force at which a tip "
            "pierces it is computed for a flat film under the same tension: a tip that pushes with "
            "the pressure needs less force, one that pushes against it needs more, by more than "
            f"10 % above {flat:.2g} MPa",
            _MEASURE,
        )
    soft = strength * film.thickness / float(np.diag(film.shear_stiffness).min())
    if soft > SHEAR_SOFT:
        yield doubt(
            "",
            "the force at which a tip pierces this film is probably smaller than computed, because "
            "the film is soft in shear through its thickness: strength times thickness is "
            f"{soft:.2g} of its shear stiffness, the formula holds up to {SHEAR_SOFT:g}",
            _MEASURE,
        )


def _pressure(sim: Simulation, sweep: Sweep) -> float:
    """Return the largest pressure, without its sign, on a quad that an edge passes [MPa]."""
    every = cast("Iterable[object]", sim.inputs["loads"])
    loads = [load for load in every if isinstance(load, Pressure)]
    on_quads = np.zeros((len(loads), sim.mesh.n_quad))
    for k, load in enumerate(loads):
        quads = slice(None) if load.quads is None else sim.mesh.quad_set(load.quads)
        on_quads[k, quads] = load.value
    times = np.linspace(0.0, sweep.duration, _N_INSTANT).tolist()
    factors = np.array([[load.factor(time) for load in loads] for time in times])
    passed = on_quads[:, np.unique(sweep.quad)]
    return float(np.abs(product(factors, passed)).max(initial=0.0))


def _on_face(sim: Simulation, sweep: Sweep) -> bool:
    """Return whether a cutting edge first meets the film away from its border."""
    first, edges = np.unique(sweep.chain, return_index=True)[1], sim.mesh.edges()
    ends = sim.mesh.nodes[edges.nodes[edges.n_quad == 1]]
    gap, _ = off_segments(sweep.place[first, None], ends[:, 0], ends[:, 1] - ends[:, 0])
    off = norm(gap).min(axis=1, initial=np.inf)
    return bool((off > _FROM_RIM * sweep.edge_length[first]).any())


def check_glue(
    material: ShellMaterial, terms: Iterable[ForceTerm], tears: bool
) -> Iterator[Finding]:
    """Yield what each glue needs where it peels, and where tears bound the film that peels.

    The first is no doubt: a glue that nowhere reaches its strength needs none of it. After the run,
    its answer is doubtful where it is damaged and the quads are too large.

    tears : whether the film may crack where no cutting edge leads the crack.
    """
    for term in terms:
        if not isinstance(term, GluePoints):
            continue
        slow = _SLOW * math.sqrt(term.law.energy / material.area_density)
        came = (
            f"{term.name}: strength {term.law.strength:.3g} MPa; where it peels, it lets go over "
            f"{term.zone:.3g} mm, the film bends with a radius of {term.fold:.3g} mm, and "
            f"{ZONE_SIDES:g} sides of the quads are {ZONE_SIDES * term.side:.3g} mm"
        )
        if term.resolved < 1.0:
            needed = f"to see it peel, make its quads {term.side * term.resolved:.2g} mm small"
            yield note(came, needed)
        else:
            yield note(came, f"it peels without inertia below {slow:.2g} mm/s")
        if tears and term.fold < ZONE_SIDES * term.side:
            yield doubt(
                f"the fold of a flap that tears off {term.name} should have a radius of at least "
                f"{ZONE_SIDES:g} sides of its quads, or the mesh leads the tears; with 0.7 and "
                "0.5 sides they run too straight, or curl up at a node and end",
                f"{term.fold / term.side:.2g} sides",
                f"make the quads {term.fold / ZONE_SIDES:.2g} mm small",
            )
