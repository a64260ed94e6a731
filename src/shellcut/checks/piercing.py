"""Whether the force at which a tip pierces whole film is that of the film's strength.

F_p (:mod:`shellcut.fracture.puncture`) of an end, apex or arc of an edge is that of an elastic
film, stiff in transverse shear and without tension far from the tip, which tears no farther by
itself. A force of one's own needs none of this, nor do edges that all come in over the rim.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from shellcut.arrays import norm, off_segments
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.material.material import Material
from shellcut.material.plastic import Plastic

from .finding import Finding, doubt
from .sweep import Sweep

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

SHEAR_SOFT = 0.2
"""Largest tension at the strength over the section's transverse shear stiffness: 0.03 of one layer
at a strain of 1 %, 0.16 of PET on five times as much PE, 0.5 of foil, PE and foil."""
TIGHT = 0.3
"""Largest tension before the tool comes, over that at the strength: takes 5 % off F_p."""

_MEASURE = "measure the force of piercing, if you need it, and give it, fracture.puncture_force"

_FROM_RIM = 0.25
"""Edges of the film from its rim beyond which a cutting edge comes down on its face."""


def check_piercing(sim: Simulation, law: CohesiveLaw, sweep: Sweep) -> Iterator[Finding]:
    """Yield where F_p of the strength is not the force at which a tip goes through."""
    if sim.cracks is None or not _on_face(sim, sweep):
        return
    film, strength = sim.material, law.strength
    young = film.stretching_stiffness / film.thickness
    films = [layer.material for layer in film.layers]
    if laws := {one.law.name for one in films if _yields(one, strength / young)}:
        yield doubt(
            "",
            f"the force at which a tip pierces this film is probably larger than computed, because "
            f"the film yields before its strength ({', '.join(sorted(laws))}): in films that were "
            "tried it was 1.1 to 1.4 times as large",
            _MEASURE,
        )
    crack, bent = young * law.fracture_energy / strength**2, sim.cracks.bending_length
    if crack < bent:
        yield doubt(
            "a film must not tear on by itself once a tip has pierced it: modulus times fracture "
            "energy over strength² must exceed the length over which the film bends there",
            f"{crack:.3g} mm and {bent:.3g} mm",
            "such a film tears on by itself once it is pierced, which a run does only from tips "
            "that no edge drives: look at units of strength and openings, or " + _MEASURE,
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
    stress = sim.shell.stress(sim.state, np.arange(sim.mesh.n_quad), place="nominal")
    tight = float(np.linalg.eigvalsh(stress).max()) / strength
    if tight > TIGHT:
        yield doubt(
            "the film should not be tight before the tool comes, at most "
            f"{TIGHT:g} of its strength, or a tip pierces it sooner",
            f"a tension of {tight:.2g} of it",
            f"a tip takes {math.sqrt(max(1.0 - tight * tight, 0.0)):.2g} of the usual force then "
            "(docs/howto/pierce.md): give it, fracture.puncture_force",
        )


def _yields(material: Material, strain: float) -> bool:
    """Return whether a layer may yield before a strain; of a law that is not ours, whether ever."""
    if isinstance(material, Plastic):
        return material.hardening.first_yield < material.stretching_modulus * strain
    return bool(material.law.history)


def _on_face(sim: Simulation, sweep: Sweep) -> bool:
    """Return whether a cutting edge first comes to the film away from its rim."""
    first, edges = np.unique(sweep.chain, return_index=True)[1], sim.mesh.edges()
    ends = sim.mesh.nodes[edges.nodes[edges.n_quad == 1]]
    gap, _ = off_segments(sweep.place[first, None], ends[:, 0], ends[:, 1] - ends[:, 0])
    off = norm(gap).min(axis=1, initial=np.inf)
    return bool((off > _FROM_RIM * sweep.edge_length[first]).any())
