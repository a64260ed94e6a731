"""The penalty law of the contact, and how it follows film and tool ([Frangi2010] 5.2).

A node inside the tool by g gets the force k f(g), with

    f(g) = (g/g_M)³ (3 g_M - 2 g)  below g_M,  g above,

which is continuous in value and slope, with the steepest slope 27/16 at ¾ g_M. [Frangi2010] has one
film, 74 µm of 1678 MPa: k = lambda A with lambda = 1e4 N/mm³, A = ¼ of the mean area of the node's
quads, g_M = h/4. For other films they scale as follows:

*lambda follows E h.* The film resists with forces of E h times strain times length. So with lambda
in proportion to E h the depth depends neither on thickness nor on modulus: a film that tears at the
strain eps pushes with about eps E h l on a node of quads of edge l and penetrates by 4 eps E h /
(lambda l), 1 µm to 10 µm in the paper. The same holds for the step: lambda A over the node's mass
rho h l² is (E / rho l²) lambda l² / (4 E h), in the same ratio to the film's own (E / rho l²) as in
the paper for all h, E and rho. A fixed lambda would cost a film of 5 µm a third of its step, and be
soft for a film of 1 mm.

*k is bounded by* ``SOFTEST`` *and* ``STIFFEST`` *times E h.* The contact is along a line, the
flank of the cut; the share of a node is a length. With the area alone it would become soft as l
goes to zero (depth as 1/l), and needlessly stiff as l grows, with a short step. Quads of 0.16 to
1.1 mm are between the bounds.

*g_M follows the film, and stays small beside the tool.* It is the depth over which the force sets
in. With more than an eighth of the tool's half thickness (V / A of the thinnest body, the half
thickness of a plate) a node could be halfway through the tool before the force acts.

*A jump* is a growth of the depth without motion of node or tool: a split assigns the node to the
other flank. It must not be loaded at once. Its size is compared with g_M: up to ``NOTICED`` g_M,
the force sets in so softly that it stores at most 1e-3 k g_M². The offset fades with the distance
from where the node was in the tool when it jumped, as exp(-d² / 2 l²) with l of ``FADES_OVER``
edges: 14 % is left after an edge. A node jumps by a fifth of an edge at most, twice what it may lie
over the mid-plane; so the flank that it feels rises by 0.61 · 0.2 / 0.5, a quarter of the distance,
at most, and the contact is 6 % stiffer there.

*An impact* is a change of the depth by as much in one step, all of it by motion. The steps are
stable for a node that rests on the spring, k dt² / m up to 3, but a node in contact for only a step
or two may leave with several times its initial energy: the spring pushes for the whole last step,
most of which the node spends outside. So in these steps the force is limited so that the spring
returns no more than has been put in, see :func:`largest_rebound`.

*Film on film.* Two mid-surfaces may come as close as the thickness h, half of it on either side. A
point deeper than that by g is pushed out by k f(g) with g_M = h/4 and k = ``OF_FILM`` E h m / (rho
h l²), with the mass m that the force feels at the point and the edge length l of its quads. So k /
m is the same at every node, a fixed part of (E / rho l²), a tenth or so of the largest frequency²
of the film: a sliver at a crack shortens the step as little as a whole node. At a split the halves
share the mass, hence the stiffness, and at the same depth their forces and energies add up to what
they were. It need not be stiffer: a point that arrives at the speed v penetrates by v / sqrt(k /
m), 9 µm at 10 m/s with edges of 0.4 mm and a wave speed of 1300 m/s, whatever the thickness. A film
thinner than that is not passed: the side from which a point came is remembered.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.jit import inline
from shellcut.state import NodeTable, local_edge_length
from shellcut.tool.tool import Tool

STEEPEST = 27.0 / 16.0
"""Largest slope of the smoothing function f, at g = ¾ g_M."""

SOFTEST, STIFFEST = 0.5, 25.0
"""Bounds of a node's stiffness over E h of the film."""

NOTICED = 0.2
"""Change of the depth in a step, over g_M, from which it is treated as a jump or an impact. No node
of the opening test of [Frangi2010] reaches it."""

ROUNDING = 2.0
"""Radius over g_M by which the tool's convex edges are rounded for the depth: half the thickness of
the film, twice the depth at which the force has set in, at most a quarter of the tool's half
thickness. The lip of a right angle that is lost with it is 0.8 g_M high."""

FADES_OVER = 0.5
"""Distance in the tool over which the offset of a jump fades to exp(-½), over an edge of a quad."""

OF_FILM = 0.125
"""Stiffness of a whole node against other film, over E h."""

# lambda [N/mm³] of [Frangi2010] 5.2, and the E h [N/mm] of its film.
_PENALTY, _STRETCHING = 1e4, 1678.0 * 0.074

# Largest g_M over half the thickness of the tool.
_THIN = 0.125


@checked
@dataclass(frozen=True)
class Contact:
    """Parameters of the penalty contact; see the modules ``*_contact`` and ``*_friction``.

    Examples
    --------
    >>> Contact(penalty=2e4).friction
    0.0
    """

    penalty: Annotated[
        float | None,
        Option(
            "N/mm^3",
            "lambda: a node of area A has the contact stiffness lambda A",
            above=0,
            unset="1e4 for 74 um and 1678 MPa, in proportion to E h; lambda A is 0.5 to 25 E h",
        ),
    ] = None
    smoothing: Annotated[
        float,
        Option(
            "",
            "depth over which contact becomes stiff, as a fraction of the film's thickness; less "
            "for a thin tool",
            above=0,
        ),
    ] = 0.25
    friction: Annotated[
        float, Option("", "Coulomb coefficient between tool and film; 0 for none", least=0)
    ] = 0.0
    tool_points: Annotated[
        bool, Option("", "whether the tool's corners and edges press between nodes")
    ] = True
    film_edges: Annotated[
        bool | None,
        Option(
            "",
            "whether borders and crack flanks touch the tool's edges between their nodes; without "
            "it, their depth in the tool is measured and the verdict reports it",
            unset="in the opening test only",
        ),
    ] = None
    self_contact: Annotated[
        bool, Option("", "whether film near cracks, and each piece, touch other film")
    ] = False
    self_friction: Annotated[
        float, Option("", "Coulomb coefficient between film and film; 0 for none", least=0)
    ] = 0.0

    def __post_init__(self) -> None:
        if self.self_friction and not self.self_contact:
            raise ValueError(
                f"self_friction = {self.self_friction!r} needs self_contact = true: without it "
                "the film does not touch itself; contact.friction is the coefficient with the tool"
            )


class PenaltyLaw(NamedTuple):
    """Parameters of the contact of one film with one tool."""

    penalty: float
    """lambda [N/mm³]; kernels get it as the stiffness of each point, by :meth:`of_nodes`."""
    softest: float
    """Least stiffness of a node, whatever its area [N/mm]."""
    stiffest: float
    """Largest stiffness of a node, whatever its area [N/mm]."""
    smoothing_depth: float
    """g_M [mm]."""
    rounding: float
    """r of the tool's convex edges, see :mod:`shellcut.tool.rounded_depth` [mm]."""
    tool_half_thickness: float
    """V / A of the thinnest body [mm]."""

    @classmethod
    def of(cls, contact: Contact, film: ShellMaterial, tool: Tool) -> PenaltyLaw:
        """Return the law for a film and a tool.

        Examples
        --------
        >>> from shellcut.tool.shapes import straight_blade
        >>> film = ShellMaterial.homogeneous(thickness=0.037)
        >>> law = PenaltyLaw.of(Contact(), film, straight_blade())
        >>> law.penalty, law.smoothing_depth
        (5000.0, 0.00925)
        """
        stretching = film.stretching_stiffness
        if contact.penalty is None:
            penalty = _PENALTY * (stretching / _STRETCHING)
            softest, stiffest = SOFTEST * stretching, STIFFEST * stretching
        else:  # a value given holds for every node: no bounds
            penalty, softest, stiffest = float(contact.penalty), 0.0, math.inf
        half = tool.half_thickness()
        depth = min(contact.smoothing * film.thickness, _THIN * half)
        return cls(
            penalty=penalty,
            softest=softest,
            stiffest=stiffest,
            smoothing_depth=depth,
            rounding=ROUNDING * depth,
            tool_half_thickness=half,
        )

    def of_nodes(self, area: Floats) -> Floats:
        """Return k of nodes from their area [mm²], (n,) [N/mm]."""
        return np.asarray(np.clip(self.penalty * area, self.softest, self.stiffest))

    def steepest(self, area: Floats) -> Floats:
        """Return the largest slope of the nodes' force from their area [mm²], (n,) [N/mm]."""
        law, softest, stiffest = STEEPEST * self.penalty, self.softest, self.stiffest
        return np.asarray(np.clip(law * area, STEEPEST * softest, STEEPEST * stiffest))


class SheetLaw(NamedTuple):
    """Parameters of the contact of points with sheets of film, for kernels."""

    thickness: float
    """Distance from the mid-surface within which a point touches: h of nodes, 0 of the tool
    [mm]."""
    smoothing_depth: float
    """g_M [mm]."""
    capture: float = math.inf
    """Distance from the film beyond which a point of the tool has passed elsewhere [mm]."""
    undecided: float = math.inf
    """Distance moved after which a point without a side is evaluated again [mm]."""


def film_stiffness(nodes: NodeTable, which: Ints, film: ShellMaterial) -> Floats:
    """Return k of some nodes or flank points against other film [N/mm], which : (n,)."""
    whole = film.area_density * local_edge_length(nodes.contact_area[which]) ** 2
    part = np.minimum(nodes.contact_mass[which] / whole, 1.0)
    return np.asarray(OF_FILM * film.stretching_stiffness * part)


@inline
def smoothed(g: float, g_m: float) -> float:
    """Return f(g) [mm]. [Frangi2010] 5.2."""
    if g >= g_m:
        return g
    r = g / g_m
    return r * r * r * (3.0 * g_m - 2.0 * g)


@inline
def smoothed_integral(g: float, g_m: float) -> float:
    """Return ∫_0^g f [mm²]."""
    if g >= g_m:
        # ∫_0^{g_m} f = g_m² (3/4 - 2/5)
        return 0.35 * g_m * g_m + 0.5 * (g * g - g_m * g_m)
    r = g / g_m
    return g_m * g_m * r * r * r * r * (0.75 - 0.4 * r)


@inline
def largest_rebound(put_in: float, moved: float, pushed: float, mass: float, dt: float) -> float:
    """Return the largest contact force that gives a node no more energy than it has put in [N].

    Let moved' = moved + (pushed - f) dt²/m be the motion of the node into the face over the next
    step if the tool continues as it does. The spring receives ½ f moved by f over the last step and
    returns at least -½ f moved' over the next. The condition

        put_in + ½ f moved + ½ f moved' >= 0

    holds for f up to the larger root of a quadratic equation.

    Parameters
    ----------
    put_in : float
        Work done on the node's spring up to t_{n-1}, and by half the force at t_{n-1} over the last
        step [N·mm].
    moved : float
        Motion of the node into the face over the last step [mm].
    pushed : float
        All other force on the node, into the face [N].
    mass, dt : float
        Mass of the node [t] and length of the step [s].
    """
    give = dt * dt / mass
    linear = 2.0 * moved + give * pushed
    root = linear * linear + 8.0 * give * put_in
    if root <= 0.0:
        return 0.0
    return max(0.5 * (linear + math.sqrt(root)) / give, 0.0)
