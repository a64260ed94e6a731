"""Mapped patches that the cases share."""

from collections.abc import Callable

import numpy as np

from harness import Check
from shellcut import Mesh

Place = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def mapped_patch(n_u: int, n_v: int, place: Place, *, exact: bool = True) -> Mesh:
    """Return n_u x n_v quads of the unit square mapped onto a surface.

    ``place(u, v)`` returns positions and unit directors, shape (..., 3). Node sets ``u0``, ``u1``,
    ``v0``, ``v1`` are the sides, in order of the running parameter; node (i, j) of the grid has the
    id i (n_v + 1) + j. With ``exact`` the directors are those of the surface, else left to the
    mesh.
    """
    u, v = np.meshgrid(np.linspace(0, 1, n_u + 1), np.linspace(0, 1, n_v + 1), indexing="ij")
    nodes, directors = place(u, v)
    ids = np.arange(u.size).reshape(u.shape)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    return Mesh.from_arrays(
        nodes.reshape(-1, 3),
        quads.reshape(-1, 4),
        directors=directors.reshape(-1, 3) if exact else None,
        node_sets={"u0": ids[0], "u1": ids[-1], "v0": ids[:, 0], "v1": ids[:, -1]},
    )


def cylinder_place(radius: float, length: float, arc_deg: float) -> Place:
    """Return the map to a cylinder about y; u runs over the arc from the top, v along y."""

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = np.radians(arc_deg) * u
        director = np.stack([np.sin(angle), 0.0 * v, np.cos(angle)], axis=-1)
        nodes = radius * director
        nodes[..., 1] = length * v
        return nodes, director

    return place


def cylinder_patch(
    radius: float, length: float, arc_deg: float, n_arc: int, n_along: int, *, exact: bool = True
) -> Mesh:
    """Return a patch of :func:`cylinder_place`."""
    return mapped_patch(n_arc, n_along, cylinder_place(radius, length, arc_deg), exact=exact)


def same_element(
    name: str,
    deflection: Callable[[Mesh], float],
    patch: Callable[..., Mesh],
    cross_check: dict[int, float],
    published: dict[int, float] | None = None,
) -> list[Check]:
    """Return deflections on n x n quads beside those of others' MITC4, whose directors are exact.

    And one on 16 x 16 quads with directors left to the mesh.
    """
    ours = {n: deflection(patch(n)) for n in cross_check}
    of, same = published or {}, "same element"
    rows = [
        Check(f"{name}, N = {n}, {source} MITC4", value, ours[n], 2e-3, same)
        for source, table in (("published", of), ("cross-check", cross_check))
        for n, value in table.items()
    ]
    left, reference = deflection(patch(16, exact=False)), {**cross_check, **of}[16]
    what = f"{name}, N = 16, directors left to the mesh"
    return [*rows, Check(what, reference, left, 2e-3, "same element, mean normals")]
