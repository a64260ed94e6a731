"""The law of a glue to a rigid base, one point after another (docs/theory/adhesion.md)."""

import numpy as np


def damaged(largest, energy, strength, stiffness):
    """Return D after a largest separation."""
    first, last = strength / stiffness, 2.0 * energy / strength
    if largest <= first:
        return 0.0
    if largest >= last:
        return 1.0
    return last * (largest - first) / (largest * (last - first))


def traction(u, normal, largest, energy, strength, stiffness, shear):
    """Return the force on the film per area, and the new largest separation."""
    across = float(np.dot(u, normal))
    aside = u - across * normal
    separation = np.hypot(max(across, 0.0), shear * np.linalg.norm(aside))
    largest = max(largest, separation)
    held = (1.0 - damaged(largest, energy, strength, stiffness)) * stiffness
    on_film = -held * (max(across, 0.0) * normal + shear**2 * aside)
    return on_film + stiffness * max(-across, 0.0) * normal, largest
