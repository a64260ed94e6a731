"""The cohesive law of [Frangi2010] Fig. 4: stress of a cable against its length.

The envelope falls linearly from sigma_F to sigma_C at l_A, stays there to l_P and falls linearly to
zero at l_U; the area below it is the fracture energy

    G = ½ (sigma_F - sigma_C) l_A + ½ sigma_C (l_P + l_U)        ([Frangi2010] 5.1).

The law is non-holonomic. The paper does not draw the unloading; here a cable unloads along the
secant to the origin: a fibre that has drawn out keeps no permanent length. Below the onset opening
delta_0 the secant is replaced by the slope sigma_F / delta_0: a cable just born would otherwise be
infinitely stiff. Hence it is born with the
energy ½ sigma_F delta_0 A in its elastic part, booked as a negative dissipation that is repaid
while the opening grows past delta_0; a broken cable has dissipated exactly G A.

**Severed at a sharp edge.** Cables wrapped around an edge of radius r lie one upon the other; the
oldest lies on the edge and bears the pull of all. A steady cut has one of length l at l/2 behind
the nose, and each pulls by sigma A in both branches, so they load the edge by A(l) a length, on the
2r that its nose is wide: the pressure A(l)/2r. Severed at the pressure H, with G_0 what is left for
a razor, a cable takes

    G_s = min(G, G_0 + 2 r H),

however thick the film is. It follows the law cut off at that area, see :meth:`CohesiveLaw.at_edge`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Literal, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.numerics.jit import inline, kernel

Joint: TypeAlias = Literal["adhesion", "slip", "free"]

# Over onset: a short branch is then stiffer than a cable at its birth, sigma_F A / delta_0, by no
# more than this, and the step is short for that cable anyway.
_SHORT_BRANCH = 0.2
# Over opening_u, for the literal form of the paper, which has no onset.
_SHORT_BRANCH_WITHOUT_ONSET = 1.0 / 4000.0

# Over opening_u: the force of the equilibrium start has vanished when the law has hardly begun,
# after more openings than a cable makes in a step.
_START_OPENING = 1.0 / 80.0

# Over opening_u: friction around the edge sets in over this distance. Its stiffness at the start,
# sigma A / stick, is below that of a new cable.
_STICK = 1.0 / 400.0

STRENGTH, PLATEAU, OPENING_A, OPENING_P, OPENING_U = 0, 1, 2, 3, 4
CAP, ONSET, SHORT_BRANCH, START_OPENING, AREA = 5, 6, 7, 8, 9
"""Places of the numbers of a law as kernels take it: those of :class:`CohesiveLaw` by their names,
the steepest slope of unloading, two lengths, and the area below."""


@checked
@dataclass(frozen=True, kw_only=True)
class CohesiveLaw:
    """Stress [MPa] of a cable against its length [mm]; defaults are [Frangi2010] 5.1.

    Raises
    ------
    ValueError
        If the law does not decrease, or the joint does not fit its friction.

    Examples
    --------
    >>> law = CohesiveLaw(strength=18.0, plateau=12.0, opening_a=0.5, opening_p=3.0, opening_u=4.0)
    >>> law.fracture_energy
    43.5
    """

    strength: Annotated[
        float, Option("MPa", "sigma_F, at which the film parts and a cable begins", above=0)
    ] = 18.0
    plateau: Annotated[float, Option("MPa", "sigma_C, constant from l_A to l_P", above=0)] = 12.0
    opening_a: Annotated[float, Option("mm", "l_A, end of the drop", above=0)] = 0.5
    opening_p: Annotated[float, Option("mm", "l_P, end of the plateau", above=0)] = 3.0
    opening_u: Annotated[float, Option("mm", "l_U, at which the cable breaks", above=0)] = 4.0
    onset: Annotated[
        float,
        Option(
            "mm",
            "delta_0, over which the force turns from the flanks' normal m to the opening w; 0: as "
            "in the paper, m at the first step, w from then on",
            least=0,
        ),
    ] = 5e-3
    joint: Annotated[
        Joint,
        Option(
            "",
            "what a cable does at the cutting edge: stick to its point, slip with friction, slide",
        ),
    ] = "adhesion"
    joint_friction: Annotated[float, Option("", "mu of joint = slip", least=0)] = 0.0
    cutting_energy: Annotated[
        float | None,
        Option(
            "N/mm",
            "G_0, taken by a cut with a razor, kJ/m²: an edge of radius r severs cables at G_0 + 2 "
            "r H",
            above=0,
            unset="a cut needs the area of the law",
        ),
    ] = None
    severing_pressure: Annotated[
        float | None,
        Option(
            "MPa",
            "H, under which an edge with a radius severs the film",
            above=0,
            unset="only for edges without a radius",
        ),
    ] = None

    def __post_init__(self) -> None:
        problems = []
        if not self.plateau <= self.strength:
            problems.append(
                "the law must decrease: 0 < plateau <= strength, got "
                f"plateau {self.plateau} MPa, strength {self.strength} MPa"
            )
        if not self.opening_a <= self.opening_p < self.opening_u:
            problems.append(
                "the law must decrease: 0 < opening_a <= opening_p < opening_u, got "
                f"{self.opening_a}, {self.opening_p}, {self.opening_u} mm"
            )
        if self.onset > 0.1 * self.opening_u:
            problems.append(
                f"onset must be small beside opening_u = {self.opening_u:.4g} mm, a "
                f"tenth at most, got {self.onset}"
            )
        problems += self._of_joint()
        problems += [] if problems else self._of_severing()
        if problems:
            raise ValueError("; ".join(problems))

    def _of_joint(self) -> list[str]:
        mu, problems = self.joint_friction, []
        if self.joint == "slip" and not mu:
            problems.append(
                "joint = 'slip' needs a joint_friction that is positive, "
                f"got {mu!r}; without friction take joint = 'free'"
            )
        elif self.joint != "slip" and mu:
            problems.append(
                f"joint_friction is of joint = 'slip', got {mu!r} with joint = {self.joint!r}"
            )
        return problems

    def _of_severing(self) -> list[str]:
        least, whole = self.cutting_energy, self.fracture_energy
        if least is None:
            given = self.severing_pressure is not None
            return ["severing_pressure needs cutting_energy, that of a razor: give both"] * given
        if least > whole:
            return [
                "cutting_energy must not exceed the fracture energy of the law, which tears it, "
                f"{whole:.4g} N/mm, got {least}"
            ]
        try:
            self.at_edge(0.0)
        except ValueError as problem:
            return [f"the law cut off at cutting_energy = {least} N/mm: {problem}"]
        return []

    def at_edge(self, radius: float) -> CohesiveLaw:
        """Return the law of cables around an edge [mm]: this law, cut off at the area G_s.

        It falls as this one does and ends where its area is G_s, with the same l_P/l_U = rho. Short
        laws end on the drop, at l_A' = l_P' = rho l_U'. Where it would then fall more slowly than
        the drop, which a law with a low plateau does, it ends at l_P' = l_A instead; so it is
        nowhere above this law, and l_U' grows steadily with G_s.

        Examples
        --------
        >>> law = CohesiveLaw(cutting_energy=1.0, severing_pressure=400.0)
        >>> sharp = law.at_edge(5e-3)
        >>> round(sharp.fracture_energy, 9), round(sharp.opening_u, 4), round(law.blunt_radius, 4)
        (5.0, 0.3531, 0.0531)
        """
        if self.cutting_energy is None:
            return self
        area = self.cutting_energy + 2.0 * radius * (self.severing_pressure or 0.0)
        if area >= self.fracture_energy:
            return replace(self, cutting_energy=None, severing_pressure=None)
        rho, drop = self.opening_p / self.opening_u, self.strength - self.plateau
        slope, plateau = drop / self.opening_a, self.plateau
        end = (area - 0.5 * drop * self.opening_a) / (0.5 * self.plateau * (1.0 + rho))
        a, p = self.opening_a, rho * end
        if p < a:
            b = 0.5 * self.strength * (1.0 + rho)
            end = 2.0 * area / (b + math.sqrt(max(b * b - 2.0 * slope * rho * area, 0.0)))
            a = p = rho * end
            plateau = self.strength - slope * a
            if slope * end > self.strength:
                a = p = self.opening_a
                plateau, end = self.plateau, (2.0 * area - self.strength * a) / self.plateau
        return replace(
            self,
            plateau=plateau,
            opening_a=a,
            opening_p=p,
            opening_u=end,
            cutting_energy=None,
            severing_pressure=None,
        )

    @property
    def blunt_radius(self) -> float:
        """r_c = (G - G_0)/(2 H), from which on an edge severs nothing [mm]."""
        if self.cutting_energy is None or self.severing_pressure is None:
            return math.inf
        return 0.5 * (self.fracture_energy - self.cutting_energy) / self.severing_pressure

    @property
    def fracture_energy(self) -> float:
        """G, area below the envelope [N/mm = kJ/m²]."""
        return 0.5 * (self.strength - self.plateau) * self.opening_a + 0.5 * self.plateau * (
            self.opening_p + self.opening_u
        )

    @property
    def short_branch(self) -> float:
        """Length below which a branch keeps its last direction [mm]; bounds sigma A / ell^±."""
        return _SHORT_BRANCH * self.onset or _SHORT_BRANCH_WITHOUT_ONSET * self.opening_u

    @property
    def start_opening(self) -> float:
        """ell_b, opening over which the force of the equilibrium start fades [mm]."""
        return _START_OPENING * self.opening_u

    @property
    def stick(self) -> float:
        """Sliding distance of a cable around the edge over which friction sets in [mm]."""
        return _STICK * self.opening_u

    def parameters(self) -> Floats:
        """Return the law as kernels take it, in the order of ``STRENGTH`` and the rest."""
        cap = self.strength / self.onset if self.onset > 0 else math.inf
        return np.array(
            [
                self.strength,
                self.plateau,
                self.opening_a,
                self.opening_p,
                self.opening_u,
                cap,
                self.onset,
                self.short_branch,
                self.start_opening,
                self.fracture_energy,
            ]
        )

    def traction(self, opening: float, opening_max: float | None = None) -> float:
        """Return the stress [MPa] at an opening [mm], unloaded from ``opening_max`` if given."""
        largest = opening if opening_max is None else max(opening, opening_max)
        return float(traction(opening, largest, self.parameters()))

    def energies(self, opening: Floats, opening_max: Floats) -> tuple[Floats, Floats]:
        """Return stored and dissipated energy per area [N/mm] of cables, arrays of one shape."""
        stored, dissipated = np.empty_like(opening), np.empty_like(opening)
        _energies(opening, opening_max, self.parameters(), stored, dissipated)
        return stored, dissipated


@inline
def envelope(opening: float, law: Floats) -> float:
    """Return the stress of first loading [MPa]. [Frangi2010] Fig. 4."""
    if opening <= 0.0:
        return float(law[STRENGTH])
    if opening < law[OPENING_A]:
        return float(law[STRENGTH] - (law[STRENGTH] - law[PLATEAU]) * opening / law[OPENING_A])
    if opening < law[OPENING_P]:
        return float(law[PLATEAU])
    if opening < law[OPENING_U]:
        return float(law[PLATEAU] * (law[OPENING_U] - opening) / (law[OPENING_U] - law[OPENING_P]))
    return 0.0


@inline
def unloading_slope(peak: float, opening_max: float, law: Floats) -> float:
    """Return the slope of unloading [MPa/mm] from the point (opening_max, peak)."""
    if peak < law[CAP] * opening_max:
        return peak / opening_max
    return float(law[CAP])


@inline
def traction(opening: float, opening_max: float, law: Floats) -> float:
    """Return the stress [MPa]; ``opening_max`` >= ``opening`` is the largest so far."""
    if opening >= opening_max:
        return envelope(opening, law)
    peak = envelope(opening_max, law)
    if peak == 0.0:
        return 0.0
    stress = peak - unloading_slope(peak, opening_max, law) * (opening_max - opening)
    return max(stress, 0.0)


@inline
def area_below(opening: float, law: Floats) -> float:
    """Return the integral of the envelope from 0 to ``opening`` [N/mm]."""
    if opening <= 0.0:
        return 0.0
    la, lp, lu = law[OPENING_A], law[OPENING_P], law[OPENING_U]
    a = min(opening, la)
    area = law[STRENGTH] * a - 0.5 * (law[STRENGTH] - law[PLATEAU]) * a * a / la
    if opening > la:
        area += law[PLATEAU] * (min(opening, lp) - la)
    if opening > lp:
        left = lu - min(opening, lu)
        area += 0.5 * law[PLATEAU] * ((lu - lp) - left * left / (lu - lp))
    return float(area)


@inline
def energies(opening: float, opening_max: float, law: Floats) -> tuple[float, float]:
    """Return the stored (recoverable) and the dissipated energy per area [N/mm]."""
    peak = envelope(opening_max, law)
    dissipated = area_below(opening_max, law)
    if not peak > 0.0:
        return 0.0, dissipated
    slope = unloading_slope(peak, opening_max, law)
    stress = traction(opening, max(opening, opening_max), law)
    return 0.5 * stress * stress / slope, dissipated - 0.5 * peak * peak / slope


@kernel
def _energies(
    opening: Floats, opening_max: Floats, law: Floats, stored: Floats, dissipated: Floats
) -> None:
    """Write stored (recoverable) and dissipated energy per area, all arrays of shape (n,)."""
    for c in range(opening.shape[0]):
        stored[c], dissipated[c] = energies(opening[c], opening_max[c], law)
