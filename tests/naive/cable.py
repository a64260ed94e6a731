"""Cable forces by the formulae in the docstring of shellcut.cables.directional_cable, one cable at
a time."""

from types import SimpleNamespace

import numpy as np
from scipy.optimize import brentq


def corners(law):
    """Lengths [mm] and stresses [MPa] between which a law is straight: as given, or [Frangi2010]
    Fig. 4 by its numbers."""
    if hasattr(law, "plateau"):
        lengths = [0.0, law.opening_a, law.opening_p, law.opening_u]
        return lengths, [law.strength, law.plateau, law.plateau, 0.0]
    return list(law.openings), list(law.tractions)


def envelope(opening, law):
    """Stress of first loading [MPa]."""
    return np.interp(opening, *corners(law))


def stress(opening, largest, law):
    """Stress after the opening ``largest`` [MPa]."""
    if opening >= largest:
        return envelope(opening, law)
    peak = envelope(largest, law)
    if peak == 0.0:
        return 0.0
    cap = corners(law)[1][0] / law.onset if law.onset > 0 else np.inf
    slope = min(peak / largest, cap) if largest > 0 else cap
    return max(peak - slope * (largest - opening), 0.0)


def severed(law, area):
    """The law that a sharp edge cuts off at an area below it [N/mm], found by search for its end.

    It falls as the whole law does and leaves it for a straight line to its end: where the last part
    of the whole law begins, at the same part of its end, or further on where that line would lie
    above the law. Among places some hundred thousandths of the end apart, and the corners.
    """
    lengths, stresses = map(np.array, corners(law))
    rho = lengths[-2] / lengths[-1]

    def ending(end):
        inner = lengths[(lengths > rho * end) & (lengths < end)]
        for leave in np.sort(np.append(np.linspace(rho * end, end, 400, endpoint=False), inner)):
            line = envelope(leave, law) * (end - lengths) / (end - leave)
            after = (lengths > leave) & (lengths < end)
            if (line[after] <= stresses[after] * (1.0 + 1e-12)).all():
                break
        before = lengths < leave
        return SimpleNamespace(
            strength=stresses[0],
            openings=[*lengths[before], leave, end],
            tractions=[*stresses[before], envelope(leave, law), 0.0],
            onset=law.onset,
        )

    def below(end):
        law = ending(end)
        return np.trapezoid(law.tractions, law.openings)

    if below(lengths[-1]) <= area:
        return law
    return ending(brentq(lambda end: below(end) - area, 1e-12, lengths[-1], xtol=1e-15))


def opening(minus, plus, m, onset):
    """Length measure of a straight cable [mm]."""
    return np.linalg.norm(plus - minus + onset * m) - onset


def fade(largest, start_opening):
    """What is left of the force of the equilibrium start after the opening ``largest``."""
    return max(0.0, 1.0 - largest / start_opening)


def met(minus, plus, m, onset, start, along, normal):
    """Joint and slack of a cable that the edge start + s along has just met.

    The joint lies on the edge beside the place where the cable crosses the blade's mid-plane. The
    slack is what the bend adds to the length.
    """
    here, there = (minus - start) @ normal, (plus - start) @ normal
    crossing = minus + here / (here - there) * (plus - minus)
    joint = start + ((crossing - start) @ along) * along
    bent = np.linalg.norm(joint - minus) + np.linalg.norm(plus - joint)
    return joint, bent - opening(minus, plus, m, onset)


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


def place_at_rest(minus, plus, start, along, back, side, place, mu):
    """Where a joint that was at ``place`` on the line start + s along stops, by bisection.

    minus, plus : ends of the cable.  along, back, side : unit vectors of the edge, into the blade
    and normal to its mid-plane.
    """

    def seen(end):
        d = end - start
        return d @ along, np.array([d @ side, d @ back])

    (s_minus, across_minus), (s_plus, across_plus) = seen(minus), seen(plus)
    rho_minus, rho_plus = np.linalg.norm(across_minus), np.linalg.norm(across_plus)
    straight_on = -(across_minus @ across_plus) / (rho_minus * rho_plus)
    turn = np.arccos(np.clip(straight_on, -1.0, 1.0))

    def lean(s):
        theta = np.arctan2([s_minus - s, s_plus - s], [rho_minus, rho_plus])
        return np.sin(theta).sum(), mu * turn * np.cos(theta).mean()

    pull, most = lean(place)
    if abs(pull) <= most:
        return place
    # Free of friction the joint is at the shortest path around the edge.
    stuck, free = place, (s_minus * rho_plus + s_plus * rho_minus) / (rho_minus + rho_plus)
    for _ in range(200):
        middle = 0.5 * (stuck + free)
        pull_there, most = lean(middle)
        if pull_there * np.sign(pull) > most:
            stuck = middle
        else:
            free = middle
    return free
