"""Whether a film that yields can carry the strength at which it is to crack.

The strength of the law of cables is a nominal stress, and so is what
:mod:`shellcut.material.nominal_stress` says a film carries at most (docs/theory/yielding.md). A
film below its strength does not crack by the criterion; under a blade it is cut all the same.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.material.nominal_stress import (
    LargestNominalStress,
    largest_nominal_stress,
    nominal_curve,
)
from shellcut.material.shell_material import ShellMaterial

from .finding import Finding, doubt, note

_PLASTIC = 0.02
"""Strain beyond the elastic one from which a film is said to yield before it cracks."""


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
