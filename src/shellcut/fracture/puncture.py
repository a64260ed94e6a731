"""The force at which a tip pierces whole film, and what it carries under each point of a tool.

Near a tip that presses it, a film takes the shape that its bending and its tension give it, over
the length L = sqrt(D / N), far less than the film is wide. Axisymmetric Föppl-von Kármán plates
(t the slope, n = p/x the radial tension over N, r = L x)

    t'' + t'/x - t/x² = n t - 1/x,      p'' + p'/x - p/x² = -t² / 2x

have n(0) = ``CENTRE`` under the point load F = 2 pi N sqrt(D / B), with the bending stiffness D and
the stretching stiffness B = E h. The film parts when its tension there is sigma_F h:

    F_s = (2 pi / CENTRE) sigma_F h sqrt(D / B),      of one layer 3.96 sigma_F h² at nu = 0.3,

whatever E and however the film is supported. A blunt tip of the radius rho parts a membrane that
lies around it at F_m = 4 pi rho (sigma_F h)² / B. In between

    F_p = sqrt(F_s² + F_m²)

is within +4.3 and -0.1 % of the full problem, which the tests solve.

*An arc of an edge* bears a membrane on a line. Its radius R in the plane of the edge and the radius
r of the edge across that are those of a paraboloid, the larger one called R. By the same equations
in x and y the largest tension at its top is that on a ball of

    rho = (R + 5 R^(1/4) r^(3/4)) / 6,

within 7 % for all r / R, R/6 where the edge is sharp.

*Tension.* Where the film has equal tensions s sigma_F h in all directions far from the tip, the
equations give n(0)² = s² + (F / F_s)² over sigma_F h of a sharp tip within 6 % of F, and
s² + F / F_m of a blunt one, exactly where s is small or large. A shear d far away adds d to the
larger tension at the tip. With s_1 = s + d, s_2 = s - d and q = (1 - d)² - s² = (1 - s_1)(1 + s_2)

    F² = q F_s² + q² F_m².

Shells in statics (``tests/unit/test_puncture.py``) that are tight in one direction or in two have
this F within 4 %, up to s_1 = 0.5.

*Pressure.* Let g be a pressure P over N_F theta / L, theta = sqrt(N_F / B), and let the film carry
it by the curvature k of its bulge. Then g x/2 is added to the load of the first equation and (k x)²
is taken from t² in the second; t is the slope of film and bulge together. A tip that pushes with
the pressure needs less force than in a flat film under the same tension. One that pushes against it
needs more. What counts is P F_p B / (4.17 pi N_F³), of a sharp tip g, with 4.17 = 2 / ``CENTRE``.
At 0.03 (``BULGED``) the force of a sharp tip is up to 9 % less or 10 % more than in a flat film
under the same tension, at 0.1 up to 21 % less or 45 % more.

*Axes.* A film with the stiffnesses B_1 > B_2 along its axes is an isotropic film in coordinates
stretched by (B_1 / B_2)^(1/4) across the first, if its shear modulus is that of such a film: its
tensions at the tip are as sqrt(B_1) to sqrt(B_2). So it parts across the stiff axis, and B is the
largest of all directions; D is the root of D_11 D_22 in its axes. Layers count by B and D of the
section, of bending about the neutral plane.

*Yielding.* F_s is 2 pi N sqrt(D eps / N) / CENTRE, with N = sigma_F h and the strain eps = N / B at
which the section carries it. Around the tip the strains of stretching and of bending at the faces
are of this size, so in a film that yields D and B are those of the layers' secant moduli there, by
deformation theory (:mod:`shellcut.material.secants`): foil that has yielded adds what it carries.
D / B of one layer stays h²/12, so its F_s needs no modulus and no yield stress. The plate's
equations with the section's nonlinear forces and moments (``tests/naive/pressed_plate.py``) have
the tension N at the distance h from the tip at 0.91 to 1.00 of this F_p in single layers, and at
0.87 to 1.13 in laminates with foil, over what an elastic plate of the same L needs; elastic moduli
give 0.3 to 1.6 of the laminates' force. Nearer to the tip a plate means nothing. Where strains
exceed a tenth, slopes are large, and F_p is a guess.

*Energy.* Once the tension is there, the film must also release G: it does where E G / sigma_F² is
longer than L.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, norm, product
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.contact.contact_tables import ToolPoints
from shellcut.material.orthotropic import turned_moduli
from shellcut.material.secants import secants_at
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.small_matrices import inverse
from shellcut.tool.tool import Tool

CENTRE = 0.47994
"""n(0) under a point load, solved in ``tests/unit/test_puncture.py``."""

BULGED = 0.03
"""Measure of a pressure [-] up to which a film counts as flat: 10 % of the force at most."""

_TIGHTEST = 0.98
"""Largest tension of a film over that at its strength that counts: what is solved."""

_ANGLES = range(0, 180, 5)
"""Directions among which the stiffest is sought [deg]."""


@dataclass(frozen=True)
class Puncture:
    """What whole film carries where a tool presses on it."""

    sharp: float
    """F_s [N]."""
    blunt: float
    """F_m over rho [N/mm]."""
    length: float
    """L at the strength [mm]."""
    slope: float
    """Of a membrane at its strength where it leaves a ball, sqrt(2 sigma_F h / B)."""
    impedance: float
    """Force of the sheet at a speed that a point of it gets at once, 8 sqrt(D rho h) [N·s/mm]."""

    @classmethod
    def of(cls, film: ShellMaterial, law: CohesiveTable) -> Puncture:
        """Return that of a film with its stiffness, thickness and strength."""
        tension = law.strength * film.thickness
        stretching, bending = _stiffnesses(film, secants_at(film, tension)[0])
        _, before = _stiffnesses(film, np.ones(len(film.layers)))  # it yields
        return cls(
            sharp=2.0 * math.pi / CENTRE * tension * math.sqrt(bending / stretching),
            blunt=4.0 * math.pi * tension * tension / stretching,
            length=math.sqrt(before / tension),
            slope=math.sqrt(2.0 * tension / stretching),
            impedance=8.0 * math.sqrt(before * film.area_density),
        )

    def force(self, radius: float) -> float:
        """Return F_p of a ball [N].

        radius : rho [mm].
        """
        blunt = self.blunt * radius
        return math.sqrt(self.sharp * self.sharp + blunt * blunt)

    def pressure(self, force: float) -> float:
        """Return the pressure up to which a film counts as flat [MPa].

        force : F_p [N].
        """
        return BULGED * self.blunt**2 / (4.0 * math.pi * CENTRE * self.slope**2 * force)

    def force_left(self, force: float, most: float, least: float) -> float:
        """Return the force that pierces a film under tension [N].

        Parameters
        ----------
        force : float
            F_p of the slack film [N].
        most, least : float
            N_1 and N_2 over sigma_F h; compression counts as none.
        """
        most, least = min(max(most, 0.0), _TIGHTEST), max(least, 0.0)
        left = (1.0 - most) * (1.0 + min(least, most))
        sharp = self.sharp * self.sharp
        return math.sqrt(left * (sharp + left * (force * force - sharp)))


def edge_bluntness(bow: float, radius: float) -> float:
    """Return rho of a place of a cutting edge, that of a ball pierced at the same force [mm].

    Parameters
    ----------
    bow, radius : float
        Radii of the edge in its plane, 0 at a tip, and across it [mm].

    Examples
    --------
    >>> edge_bluntness(6.0, 6.0), edge_bluntness(6.0, 0.0)
    (6.0, 1.0)
    """
    least, most = sorted((bow, radius))
    between = math.sqrt(least * math.sqrt(most * least))
    return (most + 5.0 * between) / 6.0


class PlaceLimits(NamedTuple):
    """The load that the film carries under each point of the tool."""

    force: Floats
    """F_p, inf where the edge is straight, shape (n_of_tool,) [N]."""
    lies: Bools
    """Whether the edge lies on the film over more than L there, shape (n_of_tool,)."""
    width: Floats
    """Of the contact of an arc at F_p, 0 at a tip, shape (n_of_tool,) [mm]."""


class PierceLimits(NamedTuple):
    """The load that whole film carries."""

    puncture: Puncture
    """Under a tip."""
    strength: float
    """Along an edge [MPa]."""
    own: float | None = None
    """The user's own force of a tip, in place of F_p [N]."""

    def at_points(self, points: ToolPoints, tool: Tool) -> PlaceLimits:
        """Return the load that it carries under the points of a tool."""
        film, edge_radius = self.puncture, tool.edge_radius
        length = norm(tool.vertices[tool.edges[:, 1]] - tool.vertices[tool.edges[:, 0]])
        longest = np.bincount(tool.edge_chain, length)[tool.edge_chain[points.segment]]
        with np.errstate(invalid="ignore"):
            width = 2.0 * film.slope * points.radius
        tip = (points.segment >= 0) & (width < longest)
        force = np.full(len(width), np.inf)
        lies = ~tip
        for k in np.flatnonzero(tip).tolist():
            rho = edge_bluntness(float(points.radius[k]), edge_radius)
            force[k] = film.force(rho) if self.own is None else self.own
            lies[k] = self.own is None and points.radius[k] > 0.0 and film.blunt * rho > film.sharp
        return PlaceLimits(force, lies, np.where(tip, width, 0.0))


def puncture_force(film: ShellMaterial, law: CohesiveTable, radius: float = 0.0) -> float:
    """Return F_p [N].

    Parameters
    ----------
    film, law : ShellMaterial, CohesiveTable
        Stiffness, thickness and strength.
    radius : float
        rho of the tip [mm].

    Examples
    --------
    >>> film = ShellMaterial.homogeneous()
    >>> round(puncture_force(film, CohesiveLaw()), 4)
    0.3905
    """
    return Puncture.of(film, law).force(radius)


def bending_length(film: ShellMaterial, law: CohesiveTable) -> float:
    """Return L of a film at its strength [mm], of its moduli before it yields.

    Examples
    --------
    >>> round(bending_length(ShellMaterial.homogeneous(), CohesiveLaw()), 3)
    0.216
    """
    return Puncture.of(film, law).length


def _stiffnesses(film: ShellMaterial, secants: Floats) -> tuple[float, float]:
    """Return B in tension [N/mm] along the stiffest axis, and D [N mm] in the film's axes.

    secants : (n_layer,), of each layer's modulus.
    """
    z, weight, materials = film.thickness_points()
    share = np.repeat(secants, len(z) // len(secants))
    laws = share[:, None, None] * np.array([law.plane_stress() for law in materials])
    membrane = np.einsum("i,ijk->jk", weight, laws)
    coupling = np.einsum("i,ijk->jk", weight * z, laws)
    second = np.einsum("i,ijk->jk", weight * z * z, laws)
    bending = second - product(coupling, inverse(membrane), coupling)
    tension = 1.0 / inverse(np.array([turned_moduli(membrane, a) for a in _ANGLES]))[:, 0, 0]
    along = turned_moduli(bending, _ANGLES[int(np.argmax(tension))])
    return float(tension.max()), math.sqrt(along[0, 0] * along[1, 1])
