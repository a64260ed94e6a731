"""The oscillating cut: a blunt bar driven through a clamped film tears a wavy crack.

docs/theory/oscillating.md says why, and what of it has been measured. The quads must be small
beside two lengths: that over which this film bends at its crack, about 8 h, 0.8 mm here, and the
process zone, 1.8 mm here. On quads of 0.75 and 1 mm some bursts behind bars of 9 to 18 mm end in a
tip that points backwards.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.contact.settings import Contact
from shellcut.fracture.options import Fracture
from shellcut.loads.supports import Support
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import rectangle
from shellcut.simulation.simulation import Simulation
from shellcut.tool.motion import StraightMotion
from shellcut.tool.shapes import Diameter, Tilt, round_bar
from shellcut.tool.tool import Tool

from .case import Case, ModelOptions, damped_by, time_of_travel

if TYPE_CHECKING:
    from typing_extensions import Unpack

BAR_LAW = CohesiveLaw(
    strength=60.0, plateau=30.0, opening_a=0.05, opening_p=0.0501, opening_u=0.1, onset=0.008
)
"""Default law: 3.0 N/mm, softening over 0.1 mm. With an onset of 0.002 mm young cables are so stiff
that the step is a quarter shorter."""

BAR_FILM: dict[str, Any] = {"young": 2200.0, "poisson": 0.35, "density": 0.9e-9, "thickness": 0.1}
"""Default film: modulus [MPa] and density [t/mm³] as of bi-oriented polypropylene."""

BAR_FRACTURE = Fracture(path="free", check_every=20, fibres=6)
"""Default. With cables at the ends of segments quads snap, and 1.5 times as much work is damped."""

BAR_CONTACT = Contact(penalty=200.0)
"""Default: the bar presses with tenths of a newton."""

STIFFNESS_DAMPING = 3e-9
"""Default stiffness damping [s]. With less, 1e-9 s, the film swings so much that runs fail."""

# Growth of the rows outside the band from one to the next, and their largest breadth over its own.
_GROWTH, _WIDEST = 1.6, 5.0

# How far nodes in the film are moved at random, over the size of its quads: no line of nodes leads
# the crack.
_MOVED = 0.2

_NOTCH, _OFFSET, _LEFT = 1.5, 0.35, 2.0  # over the diameter
_CLEARANCE, _RAMP = 0.02, 1e-3  # of the bar before the film [mm], of its speed [s]


def film_before(
    diameter: float,
    *,
    size: float,
    length: float | None = None,
    width: float | None = None,
    band: float | None = None,
) -> Mesh:
    """Return the strip for a bar, its quads fine within ``band`` of its middle line.

    The parameters are those of :func:`oscillating`. Outside, rows grow broader. Nodes inside are
    moved at random, the same at every call. Node sets are those of :func:`rectangle`.
    """
    length = 125.0 / 6.0 * diameter if length is None else length
    width = 6.0 * diameter if width is None else width
    band = 1.2 * diameter if band is None else band
    if not 0.0 < size < band < 0.5 * width:
        raise ValueError(
            "size, band and half the width must increase from 0, got "
            f"{size:g}, {band:g} and {0.5 * width:g} mm"
        )
    y = _rows(0.5 * width, size, band)
    n_x = max(1, round(length / size))
    mesh = rectangle(length, width, n_x=n_x, n_y=len(y) - 1)
    X = mesh.nodes.copy()
    X[:, 1] = np.repeat(y, n_x + 1)
    inside = np.setdiff1d(np.arange(mesh.n_node), mesh.boundary_nodes())
    shift = np.random.default_rng(3).uniform(-_MOVED, _MOVED, (inside.size, 2))
    X[inside, :2] += size * shift
    return Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)


def _rows(half: float, size: float, band: float) -> Floats:
    """Return y of all rows of nodes, shape (n,), [mm]."""
    n = round(band / size)
    y = [k * size for k in range(n + 1)]
    breadth = size
    while y[-1] < half:
        breadth = min(_GROWTH * breadth, _WIDEST * size)
        y.append(y[-1] + breadth)
    up = np.array(y)
    up[n:] = up[n] + (up[n:] - up[n]) * (half - up[n]) / (up[-1] - up[n])
    return np.concatenate([-up[:0:-1], up])


@checked
def oscillating(
    size: Annotated[float, Option("mm", "side length of the fine quads", above=0)] = 0.5,
    *,
    mesh: Mesh | None = None,
    diameter: Diameter = 6.0,
    tilt_deg: Tilt = 10.0,
    length: Annotated[
        float | None, Option("mm", "length along the cut", unset="125/6 diameters of the bar")
    ] = None,
    width: Annotated[
        float | None, Option("mm", "width between the clamped sides", unset="6 diameters")
    ] = None,
    band: Annotated[
        float | None, Option("mm", "half the width of the fine quads", unset="1.2 diameters")
    ] = None,
    notch: Annotated[
        float | None,
        Option("mm", "length of the cut in which the bar starts", unset="1.5 diameters"),
    ] = None,
    offset: Annotated[
        float | None,
        Option(
            "mm",
            "distance of that cut from the bar's line, which starts the oscillation",
            unset="0.35 diameters",
        ),
    ] = None,
    travel: Annotated[
        float | None,
        Option("mm", "of the bar", above=0, unset="up to 2 diameters before the end of the strip"),
    ] = None,
    speed: Annotated[float, Option("mm/s", "speed after a ramp of 1 ms", above=0)] = 3000.0,
    material: ShellMaterial | None = None,
    law: CohesiveTable | None = None,
    **options: Unpack[ModelOptions],
) -> Case:
    """Build the oscillating cut.

    Parameters
    ----------
    mesh : Mesh, optional
        A flat strip of your own in z = 0, from x = 0 on and about y = 0, with node sets ``bottom``
        and ``top`` at its long sides; ``size``, ``width`` and ``band`` are then unused.
    material, law : ShellMaterial, CohesiveTable, optional
        By default a film of 0.1 mm with modulus and density of bi-oriented polypropylene, and 3
        N/mm with 60 MPa: less strength than such a film has, so that its process zone is some
        quads long.
    **options
        Options of :class:`Simulation`. ``fracture`` has ``path="free"`` by default, six fibres a
        segment, and a check every 20 steps; ``contact`` a penalty of 200 N/mm³, ``damping_beta`` is
        3e-9 s.

    Returns
    -------
    Case

    Examples
    --------
    >>> case = oscillating(1.5, length=40.0)
    >>> case.simulation.mesh.n_quad, round(1e3 * case.duration, 2)
    (432, 9.83)
    """
    if mesh is None:
        mesh = film_before(diameter, size=size, length=length, width=width, band=band)
    extent = float(np.ptp(mesh.nodes[:, 0]))
    duration = duration_of(diameter, extent, travel=travel, speed=speed)
    fracture = options.get("fracture") or BAR_FRACTURE
    options["fracture"] = fracture
    chosen: ModelOptions = {"contact": BAR_CONTACT, **damped_by(STIFFNESS_DAMPING, options)}
    if fracture.needed_path not in (None, "free"):
        raise ValueError("the oscillating cut needs fracture.path = 'free': nothing steers it")
    simulation = Simulation(
        mesh,
        material or ShellMaterial.homogeneous(**BAR_FILM),
        supports=[Support.clamped("bottom"), Support.clamped("top")],
        tool=bar_before(diameter, tilt_deg),
        motion=motion_of(speed),
        law=law or BAR_LAW,
        **chosen,
    )
    y = _OFFSET * diameter if offset is None else offset
    end = _NOTCH * diameter if notch is None else notch
    simulation.notch((-extent, y, 0.0), (end, y, 0.0))
    return Case("oscillating", simulation, duration)


def bar_before(diameter: float, tilt_deg: float) -> Tool:
    """Return the bar just before the strip."""
    bar = round_bar(diameter=diameter, height=8.0 * diameter, tilt_deg=tilt_deg)
    return bar.translated((-_CLEARANCE, 0.0, 0.0))


def motion_of(speed: float) -> StraightMotion:
    """Return the motion of the bar."""
    return StraightMotion((1.0, 0.0, 0.0), speed=speed, ramp=_RAMP)


def duration_of(diameter: float, extent: float, *, travel: float | None, speed: float) -> float:
    """Return the duration of a run [s] on a strip of the length ``extent`` [mm]."""
    distance = extent - _LEFT * diameter if travel is None else travel
    return time_of_travel(distance, speed, _RAMP)
