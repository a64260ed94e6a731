"""The cohesive law: stress of a cable against its length, a table.

The envelope is straight between points (l_k, sigma_k). It begins at l = 0 with the strength
sigma_F, at which the film parts, never rises and ends with zero at l_U; the area below it is the
fracture energy G. If it rose above sigma_F, the film beside the crack would part first. All that
others ask of a law, and what kernels take, comes from the points. They are one's own
(:class:`CohesiveTable`), or made: the trapezoid of [Frangi2010] Fig. 4 (:class:`CohesiveLaw`),
:meth:`CohesiveTable.linear`, ``bilinear`` and ``exponential``. The trapezoid falls from sigma_F to
sigma_C at l_A, stays there to l_P and falls to zero at l_U:

    G = ½ (sigma_F - sigma_C) l_A + ½ sigma_C (l_P + l_U)        ([Frangi2010] 5.1).

The law is non-holonomic. The paper does not draw the unloading; here a cable unloads along the
secant to the origin: a fibre that has drawn out keeps no permanent length. Below the onset opening
delta_0 the secant is replaced by the slope sigma_F / delta_0: a cable just born would otherwise be
infinitely stiff. Hence it is born with the
energy ½ sigma_F delta_0 A in its elastic part, booked as a negative dissipation that is repaid
while the opening grows past delta_0; a broken cable has dissipated exactly G A. What is dissipated
never falls: over l it grows by ½ (sigma - l sigma') or, with the slope, sigma - sigma sigma'
delta_0/sigma_F, and the envelope has sigma' <= 0.

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
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal, TypeAlias

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

STRENGTH, OPENING_U, CAP, ONSET, SHORT_BRANCH, START_OPENING, AREA = range(7)
"""Places of the numbers of a law as kernels take it: those of :class:`CohesiveTable` by their
names, the steepest slope of unloading, two lengths, and the area below."""
_N_PART, _PARTS = 7, 8
"""Places of the number of straight parts, and of the first of them; l_U follows the last."""
_START, _ANCHOR, _STRESS, _DROP, _WIDTH, _BELOW, _PART = range(7)
"""Of a part: where it starts, a place on it with its stress and the area below the law up to there,
by how much it falls over its width; and how many these are."""

Strength: TypeAlias = Annotated[
    float, Option("MPa", "sigma_F, at which the film parts and a cable begins", above=0)
]
End: TypeAlias = Annotated[float, Option("mm", "l_U, at which the cable breaks", above=0)]


@checked
@dataclass(frozen=True, kw_only=True)
class CohesiveTable:
    """Stress [MPa] of a cable against its length [mm], linear between points.

    Raises
    ------
    ValueError
        If the points make no decreasing law, or joint and friction contradict each other.

    Examples
    --------
    >>> law = CohesiveTable(openings=[0.0, 0.5, 3.0, 4.0], tractions=[18.0, 12.0, 12.0, 0.0])
    >>> law.strength, law.fracture_energy, law.opening_u
    (18.0, 43.5, 4.0)
    >>> CohesiveTable.linear(strength=18.0, opening_u=4.0, joint="free").fracture_energy
    36.0
    """

    openings: Annotated[Sequence[float], Option("mm", "lengths of a cable, from 0", form="numbers")]
    tractions: Annotated[
        Sequence[float],
        Option("MPa", "its stresses at these: the strength first, at last 0", form="numbers"),
    ]
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
            "", "at the cutting edge a cable sticks to its point, slips with friction, or slides"
        ),
    ] = "adhesion"
    joint_friction: Annotated[float, Option("", "mu of joint = slip", least=0)] = 0.0
    cutting_energy: Annotated[
        float | None,
        Option(
            "N/mm",
            "G_0, fracture energy of a cut with a razor, kJ/m²; a cutting edge of radius r severs "
            "cables at G_0 + 2 r H",
            above=0,
            unset="the area below the law",
        ),
    ] = None
    severing_pressure: Annotated[
        float | None,
        Option(
            "MPa",
            "H, pressure under which a cutting edge with a radius severs the film",
            above=0,
            unset="only for cutting edges without a radius",
        ),
    ] = None

    def __post_init__(self) -> None:
        for name in ("openings", "tractions"):
            object.__setattr__(self, name, tuple(float(one) for one in getattr(self, name)))
        problems = self._of_shape()
        if len(self.openings) > 1 and self.onset > 0.1 * self.opening_u:
            problems.append(
                f"onset must be small beside opening_u = {self.opening_u:.4g} mm, a "
                f"tenth at most, got {self.onset}"
            )
        problems += self._of_joint()
        problems += [] if problems else self._of_severing()
        if problems:
            raise ValueError("; ".join(problems))

    def _of_shape(self) -> list[str]:
        length, stress = np.array(self.openings), np.array(self.tractions)
        if len(length) != len(stress) or len(length) < 2:
            return [
                "openings and tractions must have the same number of points, at least 2, got "
                f"{len(length)} and {len(stress)}"
            ]
        rises, falls = np.diff(length) > 0.0, np.diff(stress) <= 0.0
        film = "must not rise (the film beside the crack would part first)"
        rules = (
            ("openings", "mm", "must start at 0 and rise", np.append(length[0] == 0.0, rises)),
            ("openings", "mm", "must be finite", np.isfinite(length)),
            ("tractions", "MPa", "must be positive", np.append(stress[:-1] > 0.0, True)),
            ("tractions", "MPa", "must end with 0", stress[-1:] == 0.0),
            ("tractions", "MPa", film, np.append(True, falls)),
        )
        return [
            f"{name} {must}, got {getattr(self, name)[row]:g} {unit} in row {row + 1}"
            for name, unit, must, kept in rules
            for row in np.flatnonzero(~kept) + len(length) - len(kept)
        ]

    def _of_joint(self) -> list[str]:
        mu, problems = self.joint_friction, []
        if self.joint == "slip" and not mu:
            problems.append(
                "joint = 'slip' needs a joint_friction that is positive, "
                f"got {mu!r}; without friction take joint = 'free'"
            )
        elif self.joint != "slip" and mu:
            problems.append(
                f"joint_friction belongs to joint = 'slip', got {mu!r} with joint = {self.joint!r}"
            )
        return problems

    def _of_severing(self) -> list[str]:
        least, whole = self.cutting_energy, self.fracture_energy
        if least is None:
            given = self.severing_pressure is not None
            return ["severing_pressure needs cutting_energy, of a razor: give both"] * given
        if least > whole:
            return [
                f"cutting_energy must not exceed the fracture energy of the law, {whole:.4g} "
                f"N/mm, got {least}"
            ]
        try:
            self.at_edge(0.0)
        except ValueError as problem:
            return [f"the law cut off at cutting_energy = {least} N/mm: {problem}"]
        return []

    @staticmethod
    @checked
    def linear(*, strength: Strength, opening_u: End, **cables: Any) -> CohesiveTable:
        """Return the law that falls linearly to zero; ``cables`` are arguments of the class."""
        return CohesiveTable(openings=(0.0, opening_u), tractions=(strength, 0.0), **cables)

    @staticmethod
    @checked
    def bilinear(
        *,
        strength: Strength,
        knee_opening: Annotated[float, Option("mm", "cable length at the knee", above=0)],
        knee_traction: Annotated[float, Option("MPa", "stress at the knee", above=0)],
        opening_u: End,
        **cables: Any,
    ) -> CohesiveTable:
        """Return the law of two straight parts; ``cables`` are arguments of the class."""
        if not (knee_opening < opening_u and knee_traction <= strength):
            raise ValueError(
                "the law must decrease: knee_opening < opening_u, knee_traction <= strength, got "
                f"{knee_opening} and {opening_u} mm, {knee_traction} and {strength} MPa"
            )
        openings, tractions = (0.0, knee_opening, opening_u), (strength, knee_traction, 0.0)
        return CohesiveTable(openings=openings, tractions=tractions, **cables)

    @staticmethod
    @checked
    def exponential(
        *,
        strength: Strength,
        fracture_energy: Annotated[float, Option("N/mm", "G, area below the law, kJ/m²", above=0)],
        **cables: Any,
    ) -> CohesiveTable:
        """Return sigma_F exp(-l sigma_F/G) by 100 points; ``cables`` are arguments of the class.

        Stresses are right to 1e-4 of the strength, the area is exact; it ends at 9.4 G/sigma_F.
        """
        # Chords of exp(-s) are off by d² exp(-s)/8, the same for all where the roots of the
        # stresses are at equal distances. The last part has the area of all that is left.
        root = np.linspace(1.0, 0.025, 99)
        length = np.array([-2.0 * math.log(one) for one in (*root, root[-1])])
        length[-1] += 2.0
        stress = np.append(root**2, 0.0)
        length *= fracture_energy / strength / _areas(length, stress)[-1]
        return CohesiveTable(
            openings=length.tolist(), tractions=(strength * stress).tolist(), **cables
        )

    def at_edge(self, radius: float) -> CohesiveTable:
        """Return the law of cables around an edge [mm]: this one, cut off at the area G_s.

        It equals this law up to an opening c, and falls linearly from there to its end l_U'; c is
        that of the flattest line from rho l_U' on, rho = l_{n-1}/l_n. So the law is nowhere above
        this one, and grows with l_U' at every length. Where c jumps, over a bulge of this law, laws
        between are means of both.

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
        low, high = 0.0, self.opening_u
        for _ in range(64):  # to the last bit
            end = 0.5 * (low + high)
            if _areas(*self._cut_off(end))[-1] > area:
                high = end
            else:
                low = end
        less, more = self._cut_off(low), self._cut_off(high)
        least, most = _areas(*less)[-1], _areas(*more)[-1]
        length, stress = more
        if most - least > 1e-9 * most:
            share = (area - least) / (most - least)
            length = np.union1d(more[0], less[0][:-1])
            stress = share * np.interp(length, *more) + (1.0 - share) * np.interp(length, *less)
        return CohesiveTable(
            openings=length.tolist(),
            tractions=stress.tolist(),
            onset=self.onset,
            joint=self.joint,
            joint_friction=self.joint_friction,
        )

    def _cut_off(self, end: float) -> tuple[Floats, Floats]:
        """Return the points of the law that is cut off so as to end at ``end``.

        With a longer end c is no smaller: from a c' < c the line to the shorter end passes over c,
        so the one to the longer end would do so too, and would not be the flattest.
        """
        length, stress = np.array(self.openings), np.array(self.tractions)
        start = length[-2] / length[-1] * end
        at = np.append(start, length[(length > start) & (length < end)])
        height = np.interp(at, length, stress)
        leaves = np.argmin(height / (end - at))
        before = length < at[leaves]
        return (
            np.concatenate([length[before], [at[leaves], end]]),
            np.concatenate([stress[before], [height[leaves], 0.0]]),
        )

    @property
    def blunt_radius(self) -> float:
        """r_c = (G - G_0)/(2 H), radius from which on an edge severs nothing [mm]."""
        if self.cutting_energy is None or self.severing_pressure is None:
            return math.inf
        return 0.5 * (self.fracture_energy - self.cutting_energy) / self.severing_pressure

    @property
    def strength(self) -> float:
        """sigma_F, at which the film parts and a cable begins [MPa]."""
        return self.tractions[0]

    @property
    def opening_u(self) -> float:
        """l_U, at which the cable breaks [mm]."""
        return self.openings[-1]

    @property
    def fracture_energy(self) -> float:
        """G, area below the envelope [N/mm = kJ/m²]."""
        return float(_areas(np.array(self.openings), np.array(self.tractions))[-1])

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
        length, stress = np.array(self.openings), np.array(self.tractions)
        below = _areas(length, stress)
        cap = self.strength / self.onset if self.onset > 0 else math.inf
        start, width, drop = length[:-1], np.diff(length), -np.diff(stress)
        parts = np.stack([start, start, stress[:-1], drop, width, below[:-1]], axis=1)
        # The last part is taken from its end: its stress then goes to zero without round-off.
        parts[-1, [_ANCHOR, _STRESS, _BELOW]] = length[-1], stress[-1], below[-1]
        numbers = [self.strength, self.opening_u, cap, self.onset, self.short_branch]
        numbers += [self.start_opening, float(below[-1]), float(len(parts))]
        return np.concatenate([numbers, parts.ravel(), [self.opening_u]])

    def traction(self, opening: float, opening_max: float | None = None) -> float:
        """Return the stress [MPa] at an opening [mm], unloaded from ``opening_max`` if given."""
        largest = opening if opening_max is None else max(opening, opening_max)
        return float(traction(opening, largest, self.parameters()))

    def energies(self, opening: Floats, opening_max: Floats) -> tuple[Floats, Floats]:
        """Return stored and dissipated energy per area [N/mm] of cables, arrays of one shape."""
        stored, dissipated = np.empty_like(opening), np.empty_like(opening)
        _energies(opening, opening_max, self.parameters(), stored, dissipated)
        return stored, dissipated


@checked
@dataclass(frozen=True, kw_only=True)
class CohesiveLaw(CohesiveTable):
    """The paper's trapezoid; defaults are [Frangi2010] 5.1.

    Raises
    ------
    ValueError
        If the law does not decrease, or joint and friction contradict each other.

    Examples
    --------
    >>> law = CohesiveLaw(strength=18.0, plateau=12.0, opening_a=0.5, opening_p=3.0, opening_u=4.0)
    >>> law.fracture_energy
    43.5
    """

    openings: Sequence[float] = field(init=False, repr=False, compare=False)
    tractions: Sequence[float] = field(init=False, repr=False, compare=False)
    strength: Strength = 18.0
    plateau: Annotated[float, Option("MPa", "sigma_C, constant from l_A to l_P", above=0)] = 12.0
    opening_a: Annotated[float, Option("mm", "l_A, end of the drop", above=0)] = 0.5
    opening_p: Annotated[float, Option("mm", "l_P, end of the plateau", above=0)] = 3.0
    opening_u: End = 4.0

    def __post_init__(self) -> None:
        corners = {0.0: self.strength, self.opening_a: self.plateau, self.opening_p: self.plateau}
        corners[self.opening_u] = 0.0
        object.__setattr__(self, "openings", tuple(corners))
        object.__setattr__(self, "tractions", tuple(corners.values()))
        super().__post_init__()

    def _of_shape(self) -> list[str]:
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
        return problems


def _areas(length: Floats, stress: Floats) -> Floats:
    """Return the areas below straight parts from the first point up to each."""
    return np.append(0.0, np.cumsum(0.5 * (stress[1:] + stress[:-1]) * np.diff(length)))


@inline
def _part_at(opening: float, law: Floats) -> int:
    """Return where the straight part at an opening from 0 to l_U stands; by halving, if many."""
    at, left = _PARTS, int(law[_N_PART])
    while left > 4:
        half = left // 2
        if opening >= law[at + _PART * half]:
            at += _PART * half
        left -= half
    while opening >= law[at + _PART]:
        at += _PART
    return at


@inline
def envelope(opening: float, law: Floats) -> float:
    """Return the stress of first loading [MPa]. [Frangi2010] Fig. 4, for any table."""
    if opening <= 0.0:
        return float(law[STRENGTH])
    if not opening < law[OPENING_U]:
        return 0.0
    at = _part_at(opening, law)
    over = opening - law[at + _ANCHOR]
    return float(law[at + _STRESS] - law[at + _DROP] * over / law[at + _WIDTH])


@inline
def unloading_slope(peak: float, opening_max: float, law: Floats) -> float:
    """Return the slope of unloading [MPa/mm] from the point (opening_max, peak)."""
    if peak < law[CAP] * opening_max:
        return peak / opening_max
    return float(law[CAP])


@inline
def traction(opening: float, opening_max: float, law: Floats) -> float:
    """Return the stress [MPa]; ``opening_max`` >= ``opening`` is the largest so far."""
    peak = envelope(opening_max, law)
    if opening >= opening_max or peak == 0.0:
        return peak
    stress = peak - unloading_slope(peak, opening_max, law) * (opening_max - opening)
    return max(stress, 0.0)


@inline
def area_below(opening: float, law: Floats) -> float:
    """Return the integral of the envelope from 0 to ``opening`` [N/mm]."""
    if opening <= 0.0:
        return 0.0
    if not opening < law[OPENING_U]:
        return float(law[AREA])
    at = _part_at(opening, law)
    over = opening - law[at + _ANCHOR]
    bent = 0.5 * law[at + _DROP] * over * over / law[at + _WIDTH]
    return float(law[at + _BELOW] + (law[at + _STRESS] * over - bent))


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
