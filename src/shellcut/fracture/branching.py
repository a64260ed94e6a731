"""When a tear becomes two, and where the two go.

A crack that no blade drives runs the faster the more energy comes to its tip; what it does not take
up moves the film. Two slow cracks in place of a fast one take up more, so a crack may branch once
the film could feed two that start from rest. With Griffith's energy for each of the three, and
branches that start in pure opening, this is ([Katzav2007])

    v_b = 0.518 c_R,    each branch at 0.13 pi = 23° to the crack,

c_R being the speed of Rayleigh waves along a rim of the film.

The length that counts is that of the process zone, E G / sigma_F², or ``EDGES`` edges if these are
longer. A crack branches when

1. it has run at v_b or faster, as a mean over this length, since it began or branched: a tip that
   jumps ahead within its own process zone has not released anything yet;
2. no other tip is within twice this length: the theory is of one crack, with a field of its own;
3. there is stress to open the film in both directions: both trial cuts (:mod:`.trial_cut`) are due.

Then it is cut along both at once. Each branch goes on in the direction of its last segment until no
other tip is within this length: before, the force on a tip (:mod:`.tip_force`) is that on both.
"""

from __future__ import annotations

import math

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.material.shell_material import ShellMaterial

from .options import Fracture
from .tip import Pace, Tip

SHARE = 0.518
"""Of the speed of Rayleigh waves, from which a crack may branch."""

ANGLE = 0.13 * math.pi
"""Of each branch to the crack [rad]."""

EDGES = 5.0
"""The length that counts is that of so many edges at least."""


class Branching:
    """Decides which tears branch.

    Parameters
    ----------
    material : ShellMaterial
        Of the film.
    law : CohesiveLaw
        Of the cables.
    fracture : Fracture
        How often is looked.

    Raises
    ------
    ValueError
        If the film has axes.
    """

    def __init__(self, material: ShellMaterial, law: CohesiveLaw, fracture: Fracture) -> None:
        if material.has_axes:
            raise ValueError(
                "branching works in films that are alike in all directions, got one with axes: "
                "leave branching out, or take a film without"
            )
        modulus = material.stretching_stiffness / material.thickness
        self._zone = modulus * law.fracture_energy / law.strength**2
        self._check_every = fracture.check_every
        self.speed = SHARE * rayleigh_speed(material)
        """From which a crack may branch [mm/s]."""

    def require_checks(self, step: float, size: float) -> None:
        """Refuse checks so rare that no crack runs as fast as one that branches.

        Parameters
        ----------
        step : float
            Of time [s].
        size : float
            Of the edges [mm].

        Raises
        ------
        ValueError
            If a quad in ``check_every`` steps is slower.
        """
        if self._check_every * step * self.speed > size:
            enough = max(int(size / (step * self.speed)), 1)
            raise ValueError(
                f"cracks must be able to run at {self.speed:.4g} mm/s to branch, got one quad of "
                f"{size:.3g} mm in check_every = {self._check_every} steps of {step:.3g} s at "
                f"most: set check_every to {enough} or less"
            )

    def pace_after(self, tip: Tip, time: float, length: float, size: float) -> Pace:
        """Return a tip's pace after one more segment, no longer than it takes.

        Parameters
        ----------
        tip : Tip
            Before it.
        time : float
            Of the cut [s].
        length, size : float
            Of the segment, and of an edge there [mm].
        """
        # Twice what counts: the edges ahead may be larger.
        return _latest((*tip.pace, (time, length)), 2.0 * self._length(size))

    def may_branch(self, tip: Tip, time: float, size: float, nearest: float) -> bool:
        """Whether a crack that is about to go on has run far and fast enough, and alone.

        Each segment took the time until the next one was cut.

        Parameters
        ----------
        tip : Tip
            Of the crack.
        time : float
            Now [s].
        size, nearest : float
            Of an edge there, and distance of the nearest other tip [mm].
        """
        least = self._length(size)
        pace = _latest(tip.pace, least)
        way = _way(pace)
        if way < least or nearest < 2.0 * least:
            return False
        return way >= self.speed * (time - pace[0][0])

    def is_alone(self, size: float, nearest: float) -> bool:
        """Whether a branch has a field of its own.

        Parameters
        ----------
        size, nearest : float
            Of an edge there, and distance of the nearest other tip [mm].
        """
        return nearest >= self._length(size)

    def _length(self, size: float) -> float:
        """Return the length that counts [mm]."""
        return max(EDGES * size, self._zone)


def ways(way: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Return the directions of the branches to the left and to the right of a way, shape (3,) each.

    Parameters
    ----------
    way, t : ndarray, shape (3,)
        Unit direction in the sheet and unit director, in space.
    """
    along, aside = math.cos(ANGLE) * way, math.sin(ANGLE) * np.cross(t, way)
    return along + aside, along - aside


def rayleigh_speed(material: ShellMaterial) -> float:
    """Return the speed of Rayleigh waves along the rim of a film under plane stress [mm/s].

    With the film's stiffness C and X = rho h c² the root of

        (C_33 - X) [C_11 (C_11 - X) - C_12²]² = C_11 C_33 X² (C_11 - X)

    below C_33 and C_11 - C_12²/C_11, that of a body whose moduli are those of plane stress.

    Parameters
    ----------
    material : ShellMaterial
        Of the film, which has no axes.
    """
    plane = material.membrane_stiffness
    along, across, shear = plane[0, 0], plane[0, 1], plane[2, 2]

    def beyond(x: float) -> float:
        """Return the left side less the right one, both over C_11⁵."""
        a, g, b = x / along, shear / along, across / along
        return float((g - a) * (1.0 - a - b * b) ** 2 - g * a * a * (1.0 - a))

    x = scipy.optimize.brentq(beyond, 0.0, min(shear, along - across**2 / along), rtol=1e-14)
    return float(np.sqrt(x / material.area_density))


def _latest(pace: Pace, way: float) -> Pace:
    """Return the last segments, as many as are a way [mm] long, or all."""
    while _way(pace[1:]) >= way:
        pace = pace[1:]
    return pace


def _way(pace: Pace) -> float:
    """Return the length of some segments together [mm]."""
    return float(np.add.reduce([length for _, length in pace]))
