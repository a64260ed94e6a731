"""Builders of structured meshes with named node sets: sheets, discs, rings and cylinders.

All lengths in mm. Plane meshes lie in z = 0 with normals along +z.

The disc is a butterfly mesh: a core of n x n quads, a rounded square, surrounded by layers of 4 n
quads. The shape of the core maximises the time step. With u, v in [-1, 1] over the core and r the
radius of the innermost circle,

    x = w r u (1 + b1 v² + b2 u⁴ + b3 u² v² + b4 v⁴),    y likewise with u and v exchanged,

with straight layers between core and circle. w and b1 .. b4 maximise the smallest step of a single
plane stress quad (2 / omega of its stiffness on lumped masses), for five discs together with 560 to
8,625 quads and 2 to 11 layers, with the constraints, in units of the mean spacing s = sqrt(area /
quads): shortest side >= 0.825 s, longest about 1.55 s, scaled Jacobian >= 0.76. Result: a step of
0.60 to 0.64 s / c with c = sqrt(E / density), shortest side 0.825 to 0.86 s, Jacobian >= 0.816.
Maximising the shortest side alone (0.887 s) leaves slender, slanted quads in the core's corners and
a step 11 % shorter; a shortest side of 0.76 s would lengthen the step by 2 %.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, cos, pi, sin, sqrt
from typing import Annotated, Literal

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import ArrayLike, Floats, Ints, each

from .checks import MOST_QUADS, check_film_size
from .mesh import Mesh, MeshError

_CORE_SHAPE = ((-0.396, 0.20), (0.101, 0.57), (-0.146, -0.21), (0.226, 0.01))
"""b1 .. b4 above: value for a fine core, slope over 1/n_side."""
_COARSEST_STUDIED = 18  # n_side; the slopes are not used below it
_LAYER_THICKNESS = 0.927  # of a free layer at the middle of a core side, over the mean spacing

OpeningName = Literal["quick", "M1", "M2"]

# n_side, n_layer, ring_radii [mm]: the path of the teeth is the ring of quad sides at 9.4
OPENING_RADIUS = 10.2
_OPENING_PATH = 9.4
_OPENINGS: dict[str, tuple[int, int, tuple[float, ...]]] = {
    "quick": (18, 4, (9.4, 8.6)),
    "M1": (38, 8, (9.8, 9.4, 9.0, 8.6, 8.2)),
    "M2": (69, 14, (10.0, 9.8, 9.6, 9.4, 9.2, 9.0)),
}


@checked
def rectangle(
    length: Annotated[float, Option("mm", "length along x", above=0)],
    width: Annotated[float, Option("mm", "width along y", above=0)],
    *,
    size: Annotated[
        float | None,
        Option("mm", "side length of the quads, about", above=0, unset="from n_x, n_y"),
    ] = None,
    n_x: Annotated[
        int | None, Option("", "quads along x", least=1, most=MOST_QUADS, unset="from size")
    ] = None,
    n_y: Annotated[
        int | None,
        Option(
            "",
            "quads along y; an even n_y has nodes on y = 0",
            least=1,
            most=MOST_QUADS,
            unset="from size",
        ),
    ] = None,
) -> Mesh:
    """Return a plane sheet, 0 <= x <= length, -width/2 <= y <= width/2.

    Returns
    -------
    Mesh
        Node sets "left" (x = 0), "right" (x = length), "bottom" and "top" (y = -/+ width/2), each
        in order of the coordinate that varies. Node ``j * (n_x + 1) + i`` is the i-th of row j.

    Examples
    --------
    >>> rectangle(20.0, 8.0, size=0.8).n_quad
    250
    """
    if size is not None:
        if n_x is not None or n_y is not None:
            raise MeshError("specify either size or n_x and n_y, got both; leave one out")
        check_film_size(length / size * (width / size), "enlarge size, or shrink the sheet")
        n_x, n_y = max(1, round(length / size)), max(1, round(width / size))
    elif n_x is None or n_y is None:
        raise MeshError("specify either size or both n_x and n_y, got neither; add size=...")
    check_film_size(n_x * n_y, "lower n_x or n_y, or enlarge size")
    x = length * (np.arange(n_x + 1) / n_x)
    y = width * ((2 * np.arange(n_y + 1) - n_y) / (2 * n_y))
    ids = np.arange((n_x + 1) * (n_y + 1)).reshape(n_y + 1, n_x + 1)
    nodes = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return Mesh.from_arrays(nodes, _strip_quads(ids), node_sets=_four_sides(ids))


@checked
def disc(
    radius: Annotated[float, Option("mm", "radius of the border", above=0)],
    *,
    n_side: Annotated[int, Option("", "quads along a side of the core", least=1, most=MOST_QUADS)],
    n_layer: Annotated[
        int | None,
        Option("", "layers of quads around the core", least=1, unset="square quads"),
    ] = None,
    ring_radii: Annotated[
        Sequence[float], Option("mm", "circles on which nodes lie, decreasing", form="numbers")
    ] = (),
) -> Mesh:
    """Return a plane disc about the origin: a core of quads with layers of quads around it.

    Every circle has 4 n_side evenly spaced nodes, the first on the x axis. The layers between the
    innermost ring and the core are free; ``ring_radii`` may include the border.

    Returns
    -------
    Mesh
        With n_side² + 4 n_side n_layer quads. Node sets ``rim``; ``ring_9.4`` and the like for
        every ring inside it, all by angle from 0; ``centre``, the middle node, or the four around
        the middle if n_side is odd.

    Notes
    -----
    Inside the innermost ring the shortest side is about 0.83 of the mean spacing (see the module's
    notes). Measured, lengths in mm:

    =============================  ======  =============  ============  ==============
    disc                           quads   shortest side  longest side  least Jacobian
    =============================  ======  =============  ============  ==============
    radius 10.2, 34 x 34, 11       2,652   0.290          0.531         0.826
    ``opening_disc("quick")``      612     0.581          1.096         0.816
    ``opening_disc("M1")``         2,660   0.276          0.522         0.827
    ``opening_disc("M2")``         8,625   0.164          0.300         0.833
    =============================  ======  =============  ============  ==============

    With more layers than a third of n_side the quads at the border are flat: the core shrinks until
    its sides are as short as the layers are thick.

    Examples
    --------
    >>> mesh = disc(10.2, n_side=38, ring_radii=[10.2, 9.8, 9.4, 9.0, 8.6, 8.2])
    >>> mesh.n_quad, len(mesh.node_set("ring_9.4"))
    (2660, 152)
    """
    given = [float(r) for r in ring_radii]
    if any(not 0.0 < r <= radius for r in given):
        raise MeshError(
            f"ring_radii must lie above 0 and within the radius {radius:g}, got {given}"
        )
    if any(outer <= inner for outer, inner in pairwise(given)):
        raise MeshError(f"ring_radii must decrease from the border inwards, got {given}; sort them")
    rings = [float(radius), *(r for r in given if r < radius)]
    n_exact = len(rings) - 1
    n_free = ceil(n_side * (1.0 / pi - 0.25))  # chord of the ring = mean spacing inside, or above
    if n_layer is not None:
        n_free = n_layer - n_exact
        if n_free < 1:
            raise MeshError(
                f"n_layer must exceed the {n_exact} layers between the rings, got {n_layer}; give "
                f"{n_exact + 1} or more, or fewer ring_radii"
            )
    n_quad = n_side**2 + 4 * n_side * (n_free + n_exact)
    check_film_size(n_quad, "lower n_side or n_layer")
    core, grid = _core(n_side, n_free)
    around = circle(4 * n_side)
    # from the corner at -45 degrees counter-clockwise, then rotated to begin at angle 0
    sides = (grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1], grid[:-1, 0])
    inner = np.roll(np.concatenate(sides), -(n_side // 2))

    innermost = rings[-1]
    steps = np.arange(1, n_free + 1)[:, None, None] / n_free
    free = innermost * ((1.0 - steps) * core[inner] + steps * around)
    exact = np.array(rings[-2::-1])[:, None, None] * around if n_exact else np.empty((0, 2))
    nodes = np.concatenate([innermost * core, free.reshape(-1, 2), exact.reshape(-1, 2)])

    circles = len(core) + np.arange((n_free + n_exact) * 4 * n_side).reshape(-1, 4 * n_side)
    layers = np.concatenate([inner[None, :], circles])
    quads = np.concatenate([_strip_quads(grid.T), _strip_quads(_closed(layers).T)])
    low, high = n_side // 2, (n_side + 1) // 2 + 1
    node_sets = {"rim": circles[-1], "centre": grid[low:high, low:high].ravel()}
    for k, ring in enumerate(rings[1:], start=2):
        node_sets[f"ring_{ring:g}"] = circles[-k]
    return Mesh.from_arrays(nodes, quads, node_sets=node_sets)


@checked
def opening_disc(
    name: Annotated[OpeningName, Option("", "612, 2660 or 8625 quads")],
) -> Mesh:
    """Return the sheet of the opening problem: radius 10.2 mm, a ring of quad sides at r = 9.4 mm.

    The meshes of [Frangi2010] have 2,634 (M1) and 8,647 (M2) quads. The ring has 72, 152 or 276
    nodes: four teeth a quarter turn apart all start on nodes. Rows every 0.8, 0.4 or 0.2 mm from
    the border down to 8.6, 8.2 or 9.0 mm.

    Returns
    -------
    Mesh
        As from :func:`disc`, with a further node set "ring", the nodes at r = 9.4 by angle from 0.
    """
    n_side, n_layer, ring_radii = _OPENINGS[name]
    mesh = disc(OPENING_RADIUS, n_side=n_side, n_layer=n_layer, ring_radii=ring_radii)
    return mesh.with_sets(node_sets={"ring": mesh.node_set(f"ring_{_OPENING_PATH:g}")})


@checked
def annulus(
    r_inner: Annotated[float, Option("mm", "inner radius", above=0)],
    r_outer: Annotated[float, Option("mm", "outer radius", above=0)],
    *,
    n_around: Annotated[int, Option("", "quads around", least=3, most=MOST_QUADS)],
    n_radial: Annotated[int, Option("", "quads across", least=1, most=MOST_QUADS)],
) -> Mesh:
    """Return a plane ring about the origin, nodes evenly spaced by angle and by radius.

    Returns
    -------
    Mesh
        Node sets "inner" and "outer", by angle from 0.
    """
    if r_inner >= r_outer:
        raise MeshError(f"r_inner must be below r_outer, got {r_inner:g} and {r_outer:g}")
    check_film_size(n_around * n_radial, "lower n_around or n_radial")
    t = np.arange(n_radial + 1) / n_radial
    radii = (1.0 - t) * r_inner + t * r_outer
    nodes = radii[:, None, None] * circle(n_around)
    ids = np.arange((n_radial + 1) * n_around).reshape(n_radial + 1, n_around)
    return Mesh.from_arrays(
        nodes.reshape(-1, 2),
        _strip_quads(_closed(ids).T),
        node_sets={"inner": ids[0], "outer": ids[-1]},
    )


@checked
def cylinder(
    radius: Annotated[float, Option("mm", "radius of the cylinder", above=0)],
    length: Annotated[float, Option("mm", "length along the axis", above=0)],
    *,
    n_around: Annotated[int, Option("", "quads around the arc", least=1, most=MOST_QUADS)],
    n_along: Annotated[int, Option("", "quads along the axis", least=1, most=MOST_QUADS)],
    arc_deg: Annotated[
        float, Option("deg", "angle of the arc; 360 closes the cylinder", above=0, most=360)
    ] = 360.0,
) -> Mesh:
    """Return a cylinder or a barrel roof: a sheet bent about the y axis, directors outward.

    The middle of the arc is at the top, (0, y, radius), and -length/2 <= y <= length/2. The
    directors are radial to round-off, not means of quad normals.

    Returns
    -------
    Mesh
        Node sets "bottom" and "top" (y = -/+ length/2); unless closed, "left" and "right" (the
        straight sides at smaller and larger x for an arc up to 180 degrees).
    """
    check_film_size(n_around * n_along, "lower n_around or n_along")
    closed = arc_deg == 360.0
    n_column = n_around if closed else n_around + 1
    angle = np.radians(arc_deg) * ((2 * np.arange(n_column) - n_around) / (2 * n_around))
    y = length * ((2 * np.arange(n_along + 1) - n_along) / (2 * n_along))
    radial = np.stack([each(sin, angle), np.zeros(n_column), each(cos, angle)], axis=1)
    directors = np.tile(radial, (n_along + 1, 1))
    nodes = radius * directors
    nodes[:, 1] = np.repeat(y, n_column)
    ids = np.arange(len(nodes)).reshape(n_along + 1, n_column)
    node_sets = {"bottom": ids[0], "top": ids[-1]} if closed else _four_sides(ids)
    quads = _strip_quads(_closed(ids) if closed else ids)
    return Mesh.from_arrays(nodes, quads, node_sets=node_sets, directors=directors)


# --- the disc ------------------------------------------------------------------------------------


def _core(n_side: int, n_free: int) -> tuple[Floats, Ints]:
    # Positions ((n_side + 1)², 2) within a circle of radius 1 and their ids as a grid [u, v].
    # An odd core is rotated by half a spacing: its sides have no middle node to put on the x axis.
    t = (2 * np.arange(n_side + 1) - n_side) / n_side
    b1, b2, b3, b4 = (b + slope / max(n_side, _COARSEST_STUDIED) for b, slope in _CORE_SHAPE)
    spacing = sqrt(pi / (n_side**2 + 4 * n_side * n_free))
    w = (1.0 - n_free * _LAYER_THICKNESS * spacing) / (1.0 + b2)  # half width: w (1 + b2)
    if 3 * n_free >= n_side:
        # many layers on a small core are flat and wide: make them as thick as its sides, 2 w / n
        w = 1.0 / (1.0 + 2.0 * n_free / n_side)

    def place(u: Floats, v: Floats) -> Floats:
        p, q = u * u, v * v
        return np.asarray(w * u * (1.0 + b1 * q + b2 * p * p + b3 * p * q + b4 * q * q))

    u, v = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
    x, y = place(u, v), place(v, u)
    turn = 0.25 * pi / n_side if n_side % 2 else 0.0
    c, s = cos(turn), sin(turn)
    grid = np.arange((n_side + 1) ** 2).reshape(n_side + 1, n_side + 1)
    return np.stack([c * x - s * y, s * x + c * y], axis=1), grid


def circle(n: int) -> Floats:
    """Return n points of the unit circle by angle from 0, shape (n, 2).

    They are exact on the axes if n is a multiple of 4.
    """
    k = np.arange(n)
    if n % 4:
        angle = 2.0 * pi * k / n
        return np.stack([each(cos, angle), each(sin, angle)], axis=1)
    angle = 2.0 * pi * np.arange(n // 4) / n
    x, y = each(cos, angle), each(sin, angle)
    return np.stack([np.concatenate([x, -y, -x, y]), np.concatenate([y, x, -y, -x])], axis=1)


# --- grids of node ids ---------------------------------------------------------------------------


def _strip_quads(ids: Ints) -> Ints:
    # quads of a grid of ids [row, column], counter-clockwise with columns along x and rows along y
    corners = (ids[:-1, :-1], ids[:-1, 1:], ids[1:, 1:], ids[1:, :-1])
    return np.stack(corners, axis=-1).reshape(-1, 4).astype(np.int64)


def _closed(ids: Ints) -> Ints:
    return np.concatenate([ids, ids[:, :1]], axis=1)


def _four_sides(ids: Ints) -> dict[str, ArrayLike]:
    return {"left": ids[:, 0], "right": ids[:, -1], "bottom": ids[0], "top": ids[-1]}
