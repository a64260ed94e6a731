"""The guillotine: a straight blade cuts a clamped strip along its middle.

Steady cutting takes the force F = G h for any blade, speed or mesh: all work goes into the new
crack, G h per millimetre. The plateau begins after about 8 mm of cut, because a cable breaks only
after some 2 mm of drag; the force is a sawtooth with the node spacing, so average it over whole
periods. With classical cables, which the blade never meets, the flanks open by at most the blade's
width w, and F = h ∫_0^w sigma dl. A blade that also moves along its cutting edge slices
(:mod:`shellcut.cables.joint_slip`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import norm, unit
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.checks.row import ON_ROW
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.outline import QuadSize
from shellcut.mesh.structured import rectangle
from shellcut.tool.motion import StraightMotion
from shellcut.tool.shapes import straight_blade
from shellcut.tool.tool import Tool

from .case import PAPER_DAMPING, Case, Clamp, CutOptions, Notch, damped_by, time_of_travel
from .free_cut import free_cut, with_path

if TYPE_CHECKING:
    from typing_extensions import Unpack

# Gap between the cutting edge and the film's end at the start, over opening_u: 0.05 mm with the law
# of the paper, little beside the distance to the first cable.
_CLEARANCE = 1.0 / 80.0

# Distance from the blade's last place to the end of the strip, over opening_u: the cables that it
# drags reach half of that behind it, and it must not run out of film. 2.5 mm with the law of the
# paper.
_LEFT = 0.625

# Of a coordinate, over the extent of the strip: round-off.
_ON_LINE = 1e-9

# Edge that must be left beyond the film at the end of a slicing cut, over opening_u.
_EDGE_LEFT = 1.0 / 8.0

_RAMP = 1e-4  # duration of the blade's acceleration [s]

BLADE_HEIGHT = 3.0
"""Height of the default blade [mm]; it is as long as the strip."""


def strip_of(length: float, width: float, size: float) -> Mesh:
    """Return a strip from x = 0 to ``length``, y about 0, with quads of a side length [mm]."""
    return rectangle(length, width, size=size)


@checked
def guillotine(
    size: QuadSize = 0.4,
    *,
    mesh: Mesh | None = None,
    length: Annotated[float, Option("mm", "length along the cut", above=0)] = 30.0,
    width: Annotated[float, Option("mm", "width between the clamped sides", above=0)] = 8.0,
    notch: Notch = 2.0,
    travel: Annotated[
        float | None,
        Option(
            "mm",
            "travel of the blade",
            above=0,
            unset="up to 0.625 opening_u before the end of the strip",
        ),
    ] = None,
    speed: Annotated[float, Option("mm/s", "speed after a ramp of 0.1 ms", above=0)] = 6000.0,
    slice_ratio: Annotated[
        float, Option("", "speed of the blade up its cutting edge over its speed along the strip")
    ] = 0.0,
    clamp: Clamp = ("bottom", "top"),
    tool: Tool | None = None,
    material: ShellMaterial | None = None,
    law: CohesiveTable | None = None,
    **options: Unpack[CutOptions],
) -> Case:
    """Build the guillotine.

    Along quad sides the notch ends at the last node of the path within its length, through quads at
    the first side of the mesh at or beyond it. A cutting edge that slices must be long enough for
    it.

    Parameters
    ----------
    mesh : Mesh, optional
        A flat strip of your own in z = 0 instead; ``size``, ``length`` and ``width`` are then
        unused. The blade enters at the strip's end, on the y of its cutting edge, 0 by default.
    tool : Tool, optional
        Moves along +x from x = 0, where its cutting edge must be, on the y where that passes
        through the film; the notch lies there too. :func:`straight_blade` by default: cutting edge
        at 90° to the film, half-angle 10°, half thickness 0.3 mm, as long as the strip, because
        flanks closing behind a short blade push it forward, and 3 mm high or as high as it slides.
    material, law : ShellMaterial, CohesiveTable, optional
        The paper's film by default.
    **options
        Options of :class:`Simulation`. Without a ``fracture.path`` cracks follow quad sides if a
        line of them lies on that y, as in the strip with an even ``width / size``, and else run
        through quads.

    Returns
    -------
    Case

    Examples
    --------
    >>> case = guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=1.5)
    >>> case.simulation.mesh.n_quad
    24
    """
    if mesh is None:
        options, strip = damped_by(PAPER_DAMPING, options), strip_of(length, width, size)
    else:
        strip = mesh
    cables = law or CohesiveLaw()
    blade, motion, duration = blade_before(
        strip, tool, travel=travel, speed=speed, slice_ratio=slice_ratio, law=cables
    )
    fracture = with_path(strip, blade, motion, duration, options.get("fracture"))
    options["fracture"] = fracture
    y, through_quads = _lane_of(blade, strip), fracture.path == "free"
    film = strip if through_quads or notch <= 0.0 else _notched(strip, y, notch)
    cut = free_cut(
        film,
        tool=blade,
        motion=motion,
        duration=duration,
        clamp=clamp,
        material=material,
        law=cables,
        **options,
    )
    if notch > 0.0 and through_quads:
        begin, extent = film.nodes[:, 0].min(), np.ptp(film.nodes[:, 0])
        cut.simulation.notch((begin - extent, y, 0.0), (begin + notch, y, 0.0))
    return replace(cut, name="guillotine")


def blade_before(
    film: Mesh,
    tool: Tool | None,
    *,
    travel: float | None,
    speed: float,
    slice_ratio: float = 0.0,
    law: CohesiveTable,
) -> tuple[Tool, StraightMotion, float]:
    """Return the blade just before a strip, its motion along it, and the duration [s]."""
    start, extent = float(film.nodes[:, 0].min()), float(np.ptp(film.nodes[:, 0]))
    distance = extent - _LEFT * law.opening_u if travel is None else travel
    duration = time_of_travel(distance, speed, _RAMP)
    blade = tool or straight_blade(
        length=extent, height=BLADE_HEIGHT + 2.0 * abs(slice_ratio) * distance
    )
    direction = np.array([1.0, 0.0, 0.0])
    if slice_ratio != 0.0:
        ends = blade.vertices[blade.edges.ravel()]
        if not len(ends):
            raise ValueError("slice_ratio needs a cutting edge, and this tool has none")
        heights = ends[:, 2]
        along = unit(ends[heights.argmax()] - ends[heights.argmin()])  # up the edge
        rise, left = slice_ratio * distance * along[2], _EDGE_LEFT * law.opening_u
        below, above = -heights.min() - max(rise, 0.0), heights.max() + min(rise, 0.0)
        if min(below, above) < left:
            raise ValueError(
                f"the cutting edge must reach {left:.3g} mm beyond the film to the end of the cut, "
                f"but it slides by {abs(rise):.4g} mm from {heights.min():.4g} to "
                f"{heights.max():.4g} mm about the film: give the blade a height of "
                f"{2.0 * (abs(rise) + left):.4g} mm or more, or lower slice_ratio or travel"
            )
        direction += slice_ratio * along
    motion = StraightMotion(direction.tolist(), speed=speed * float(norm(direction)), ramp=_RAMP)
    return blade.translated((start - _CLEARANCE * law.opening_u, 0.0, 0.0)), motion, duration


def _lane_of(blade: Tool, film: Mesh) -> float:
    """Return the y at which a blade passes through the film z = 0 [mm]; 0 without cutting edges.

    Raises ValueError if it passes beside the film.
    """
    low, high = film.nodes[:, 1].min(), film.nodes[:, 1].max()
    ends = blade.vertices[blade.edges]
    z = ends[:, :, 2]
    through = ends[(z.min(axis=1, initial=0.0) <= 0.0) & (z.max(axis=1, initial=0.0) >= 0.0)]
    if not len(through):
        return 0.0
    rise = through[:, 1, 2] - through[:, 0, 2]
    part = np.divide(-through[:, 0, 2], rise, out=np.zeros(len(rise)), where=rise != 0.0)
    places = through[:, 0] + part[:, None] * (through[:, 1] - through[:, 0])
    y = float(places[places[:, 0].argmax(), 1])
    if not low < y < high:
        raise ValueError(
            f"the tool's cutting edge must pass through the strip, between y = {low:.4g} and "
            f"{high:.4g} mm, got y = {y:.4g} mm: move the tool by {0.5 * (low + high) - y:.4g} mm "
            "in y ([tool] shift)"
        )
    return y if abs(y) > _ON_LINE * float(np.ptp(film.nodes[:, 0])) else 0.0


def _notched(mesh: Mesh, lane: float, notch: float) -> Mesh:
    """Return the strip cut along the first nodes on y = ``lane``."""
    off = ON_ROW * float(np.median(mesh.edge_lengths()))
    line = mesh.nodes_where(lambda x, y, z: np.abs(y - lane) < off)
    line = line[np.argsort(mesh.nodes[line, 0], kind="stable")]
    x = mesh.nodes[line, 0]
    within = line[x <= mesh.nodes[:, 0].min() + notch + _ON_LINE * float(np.ptp(mesh.nodes[:, 0]))]
    if len(within) < 2:
        raise ValueError(
            f"the notch of {notch} mm must follow a line of quad sides in the middle and be at "
            f"least one side long, got nodes there at x = {np.array2string(x[:2], precision=4)} "
            "mm: lengthen it, make width / size even, take fracture.path = 'free', or pass 0"
        )
    return mesh.cut(within)
