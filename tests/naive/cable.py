"""Cable forces by the formulae in the docstring of shellcut.cables.directional_cable, one cable at
a time."""

import numpy as np


def envelope(opening, law):
    """Stress of first loading [MPa]: the four corners of [Frangi2010] Fig. 4."""
    return np.interp(
        opening,
        [0.0, law.opening_a, law.opening_p, law.opening_u],
        [law.strength, law.plateau, law.plateau, 0.0],
    )


def stress(opening, largest, law):
    """Stress after the opening ``largest`` [MPa]."""
    if opening >= largest:
        return envelope(opening, law)
    peak = envelope(largest, law)
    if peak == 0.0:
        return 0.0
    cap = law.strength / law.onset if law.onset > 0 else np.inf
    slope = min(peak / largest, cap) if largest > 0 else cap
    if law.unloading == "elastic":
        slope = law.unloading_stiffness
    return max(peak - slope * (largest - opening), 0.0)


def straight(minus, plus, m, area, largest, law):
    """Length measure and forces on the minus and plus node of a straight cable."""
    d = plus - minus + law.onset * m
    length = np.linalg.norm(d)
    ell = length - law.onset
    unit = d / length if length > 0 else m
    force = stress(ell, max(ell, largest), law) * area * unit
    return ell, force, -force


def jointed(minus, plus, joint, slack, area, largest, law):
    """Length measure and forces on the minus and plus node of a cable bent at ``joint``."""
    to_minus, to_plus = joint - minus, joint - plus
    ell = np.linalg.norm(to_minus) + np.linalg.norm(to_plus) - slack
    pull = stress(ell, max(ell, largest), law) * area
    return (
        ell,
        pull * to_minus / np.linalg.norm(to_minus),
        pull * to_plus / np.linalg.norm(to_plus),
    )
