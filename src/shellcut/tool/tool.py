"""The cutting tool: a rigid closed triangulated surface with its cutting edges, in its body frame.

Terms: a *body* is a connected component of the surface; a *cutting edge* is a chain of *segments*,
edges where the surface folds back sharply; the triangle that runs along a segment in the direction
of its chain is the *plus* flank there, the other one the *minus* flank. A *tooth* is a cutting edge
with the surface nearest to it, or a body without a cutting edge: forces are summed tooth by tooth.

=====================  ==================================================================
n+, n-                 outward unit normals of the two triangles at a segment
t                      unit vector along the segment, in the direction of its chain
b = (n+ - n-)/|..|     ``edge_normal``: of the mid-plane, which bisects the faces; towards plus
b x t                  ``edge_back``: in the mid-plane, normal to the segment, into the solid
=====================  ==================================================================

The 0.1 mm radius of a real edge is taken as sharp  # [Frangi2010] 5
unless :func:`shellcut.tool.rounded_edge.with_edge_radius` rounds it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import radians
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from shellcut.arguments import checked
from shellcut.arrays import Floats, Ints, SmallInts, angles, product, three
from shellcut.card import TOOL, Figures, card, drawing, extent
from shellcut.formats.errors import counted, point_text
from shellcut.formats.stl import write_stl

from .surface import Surface, chains_of, facing_alike, merge_vertices, rows_of, six_volumes

FARTHEST_SHIFT = 1e6
"""Largest shift in sizes of the tool: coordinates then keep nine digits of its shape."""


class ToolError(ValueError):
    """A surface or a set of parameters that cannot be a tool; the message lists every reason."""

    def __init__(self, problems: list[str], *, what: str = "surface"):
        self.problems = tuple(problems)
        super().__init__(f"the {what} cannot be a tool:\n" + "\n".join(f"- {p}" for p in problems))


@dataclass(frozen=True, eq=False)
class EdgeChain:
    """A cutting edge, in the body frame."""

    chain: int
    """Number from 0, as in ``Tool.edge_chain``; messages count cutting edges and bodies from 1."""
    body: int
    n_segment: int
    length: float
    """[mm]"""
    start: Floats
    """First point, shape (3,), [mm]."""
    end: Floats
    """Last point, shape (3,), [mm]; the first again if closed."""
    centre: Floats
    """Middle of its length, shape (3,), [mm]."""
    closed: bool
    turn_deg: tuple[float, float]
    """Least and largest angle between the outward normals beside it [deg]."""

    def __str__(self) -> str:
        shape = "closed, through" if self.closed else "open,"
        to = "" if self.closed else f" to {point_text(self.end)}"
        least, most = self.turn_deg
        return (
            f"cutting edge {self.chain + 1} (not_cutting = [{self.chain}]) of body "
            f"{self.body + 1}: {counted(self.n_segment, 'segment')}, "
            f"{self.length:.4g} mm, {shape} {point_text(self.start)}{to}, "
            f"turns by {least:.4g} to {most:.4g} deg"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Tool:
    """A rigid cutter: closed surface, cutting edges and flanks in the body frame; read-only.

    Built by :meth:`from_triangles`, which checks the surface; the constructor itself does not.

    Examples
    --------
    >>> from shellcut.tool.shapes import straight_blade
    >>> blade = straight_blade()
    >>> blade.n_body, blade.n_edge
    (1, 1)
    >>> [round(float(b), 12) for b in blade.edge_normal[0]]
    [0.0, 1.0, 0.0]
    """

    vertices: Floats
    """Corners of the triangles, shape (n_vertex, 3), [mm]."""
    triangles: Ints
    """Vertex ids, counter-clockwise seen from outside, shape (n_triangle, 3)."""
    triangle_normals: Floats
    """Outward unit normals, shape (n_triangle, 3)."""
    triangle_body: Ints
    """Body of each triangle, numbered by first appearance, shape (n_triangle,)."""
    triangle_tooth: Ints
    """Tooth of each triangle, numbered by first appearance, shape (n_triangle,)."""
    flank: SmallInts
    """+1 and -1 on the flanks beside the cutting edges, 0 elsewhere, shape (n_triangle,), int8."""
    edges: Ints
    """Vertex ids of the cutting segments, chain after chain, in order, shape (n_edge, 2)."""
    edge_body: Ints
    """Body of each segment, shape (n_edge,)."""
    edge_tooth: Ints
    """Tooth of each segment, shape (n_edge,)."""
    edge_chain: Ints
    """Chain of each segment, shape (n_edge,)."""
    edge_flank_plus: Ints
    """Triangle beside each segment on the plus side, shape (n_edge,)."""
    edge_flank_minus: Ints
    """Triangle beside each segment on the minus side, shape (n_edge,)."""
    edge_normal: Floats
    """Unit normal b of the mid-plane, towards the plus flank, shape (n_edge, 3)."""
    edge_back: Floats
    """Unit vector of the mid-plane, normal to the segment, into the solid, shape (n_edge, 3)."""
    name: str = "tool"
    """Name in reports."""
    flank_angle_deg: float = 40.0
    """Limit of turn up to which flanks extend, from :meth:`from_triangles` [deg]."""
    edge_radius: float = 0.0
    """Radius of the cutting edges, whose segments are then their nose lines; 0 if sharp [mm]."""

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __repr__(self) -> str:
        return (
            f"Tool({self.name!r}, {self.n_body} bodies, {self.n_triangle} triangles, "
            f"{self.n_edge} cutting segments in {self.n_chain} chains)"
        )

    def _repr_html_(self) -> str:
        figures: Figures = [
            ("bodies", self.n_body, ""),
            ("triangles", self.n_triangle, ""),
            ("cutting edges", self.n_chain, ""),
            ("their length", sum(chain.length for chain in self.chains()), "mm"),
            ("their radius", self.edge_radius, "mm"),
            extent(self.vertices),
        ]
        blunt = [("note", "No cutting edge: it pushes and cuts nothing.")] * (not self.n_edge)
        picture = drawing([(self.vertices, self.triangles, TOOL)], self.vertices[self.edges])
        return card(f"Tool {self.name}", figures, blunt, picture)

    @property
    def n_vertex(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @property
    def n_triangle(self) -> int:
        """Number of triangles."""
        return len(self.triangles)

    @property
    def n_body(self) -> int:
        """Number of bodies."""
        return int(self.triangle_body.max()) + 1

    @property
    def n_tooth(self) -> int:
        """Number of teeth."""
        return int(max(self.triangle_tooth.max(), self.edge_tooth.max(initial=0))) + 1

    @property
    def n_edge(self) -> int:
        """Number of cutting segments."""
        return len(self.edges)

    @property
    def n_chain(self) -> int:
        """Number of chains of cutting segments."""
        return int(self.edge_chain.max(initial=-1)) + 1

    @classmethod
    @checked
    def from_triangles(
        cls,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        edges: npt.ArrayLike | Literal["none"] | None = None,
        sharp_angle_deg: float = 100.0,
        flank_angle_deg: float = 40.0,
        name: str = "tool",
    ) -> Tool:
        """Build a tool from a closed surface; merge duplicate vertices, find edges and flanks.

        Parameters
        ----------
        vertices : array_like, shape (n_vertex, 3), [mm]
            May contain duplicates (an STL file does); unused ones are dropped.
        triangles : array_like of int, shape (n_triangle, 3)
            Counter-clockwise seen from outside.
        edges : array_like of int, shape (n_edge, 2), optional
            The cutting segments, as ids into ``vertices``; each chain keeps the direction of its
            first segment, which decides the plus side: the same one where flanks of two chains
            meet. ``"none"``, or none of shape (0, 2), for a blunt tool, which only pushes. By
            default they are found by angle.
        sharp_angle_deg : float, [deg]
            If no edges are given: the least angle between the two outward normals at a convex
            edge that cuts. A wedge of half-angle a turns by 180 - 2a. A chain found in this manner
            starts in the direction of its smallest vertex id; further chains of a body are
            turned so that flanks that meet are on the same side, or, where none meet, so that the
            plus sides face the same direction as that of the first.
        flank_angle_deg : float, [deg]
            A flank extends from its cutting edge over all edges that turn by less. A triangle
            reached from both sides gets the side with the shorter path over triangle centres
            (plus where the paths are equal).
        name : str
            In reports.

        Raises
        ------
        ToolError
            Lists all defects: shapes, non-finite coordinates, degenerate triangles, holes,
            non-manifold edges and vertices, orientation, bodies that touch or overlap, missing
            cutting edges.

        Notes
        -----
        Whether a body intersects itself is not checked.
        """
        as_given = _cast(vertices, triangles, edges, sharp_angle_deg, flank_angle_deg)
        coordinates, ids, given = merge_vertices(*as_given)
        surface = Surface(coordinates, ids)
        problems = surface.problems()
        if given is None:
            segments, missing = surface.sharp_segments(radians(sharp_angle_deg))
        else:
            segments, missing = given, surface.not_cutting(given)
        problems += missing
        if problems:
            raise ToolError(problems)

        segments, chain = chains_of(segments)
        plus, minus = surface.sides(segments)
        normal, back = surface.mid_planes(segments, plus, minus)
        links = surface.links(plus, minus, chain, radians(flank_angle_deg))
        if given is None:
            segments = facing_alike(segments, chain, surface.body[plus], normal, links)
            plus, minus = surface.sides(segments)
            normal, back = surface.mid_planes(segments, plus, minus)
        elif opposite := surface.facing_opposite(segments, chain, links):
            raise ToolError(opposite)
        tooth, edge_tooth = surface.teeth(plus, minus, chain)
        return cls(
            vertices=surface.vertices,
            triangles=surface.triangles,
            triangle_normals=surface.normals,
            triangle_body=surface.body,
            triangle_tooth=tooth,
            flank=surface.flanks(plus, minus, radians(flank_angle_deg)),
            edges=segments,
            edge_body=surface.body[plus],
            edge_tooth=edge_tooth,
            edge_chain=chain,
            edge_flank_plus=plus,
            edge_flank_minus=minus,
            edge_normal=normal,
            edge_back=back,
            name=name,
            flank_angle_deg=flank_angle_deg,
        )

    def chains(self) -> list[EdgeChain]:
        """Return the cutting edges, chain by chain.

        Examples
        --------
        >>> from shellcut.tool.shapes import straight_blade
        >>> print(straight_blade(height=4.0).chains()[0])
        cutting edge 1 (not_cutting = [0]) of body 1: 1 segment, 4 mm, open, (0, 0, 2) to ...
        """
        found = []
        for chain, rows in enumerate(rows_of(self.edge_chain)):
            first, second = (
                self.triangle_normals[side[rows]]
                for side in (self.edge_flank_plus, self.edge_flank_minus)
            )
            turn = np.degrees(angles(first, second))
            ends = self.vertices[self.edges[rows]]
            lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
            found.append(
                EdgeChain(
                    chain=chain,
                    body=int(self.edge_body[rows[0]]),
                    n_segment=len(rows),
                    length=float(lengths.sum()),
                    start=ends[0, 0],
                    end=ends[-1, 1],
                    centre=product(lengths, ends.mean(axis=1)) / lengths.sum(),
                    closed=bool(self.edges[rows[0], 0] == self.edges[rows[-1], 1]),
                    turn_deg=(float(turn.min()), float(turn.max())),
                )
            )
        return found

    def without_cutting(self, *chains: int) -> Tool:
        """Return the tool with some chains not cutting, as ordinary edges of its surface.

        Parameters
        ----------
        *chains : int
            Numbers of :meth:`chains`. The rest keep their order and are renumbered.
        """
        wrong = [c for c in chains if c not in range(self.n_chain)]
        problems = []
        if wrong:
            known = "; ".join(str(chain) for chain in self.chains())
            problems.append(
                f"there are no cutting edges {wrong}, counted from 0; those are: {known}"
            )
        keep = ~np.isin(self.edge_chain, chains)
        if not wrong and not keep.any():
            problems.append(f"at least one edge must cut, got all {self.n_chain} as not cutting")
        if problems:
            raise ToolError(problems)
        rest = Tool.from_triangles(
            self.vertices,
            self.triangles,
            edges=self.edges[keep],
            flank_angle_deg=self.flank_angle_deg,
            name=self.name,
        )
        return replace(rest, edge_radius=self.edge_radius)

    def write(self, path: str | Path) -> None:
        """Write the surface as a binary STL file, in mm.

        The format has single precision and no cutting edges: :func:`shellcut.read_tool` finds them
        again by their angle.
        """
        if Path(path).suffix.lower() != ".stl":
            raise ValueError(f"a tool is written as .stl, got {str(path)!r}")
        write_stl(path, self.vertices, self.triangles, header=f"{self.name}, mm")

    def volume(self) -> Floats:
        """Return the volume of each body, shape (n_body,), [mm³]."""
        parts = six_volumes(self.vertices, self.triangles)
        return np.bincount(self.triangle_body, weights=parts) / 6.0

    def half_thickness(self) -> float:
        """Return V / A of the thinnest body, volume over surface: half of a plate's thickness [mm].

        For a body that is not a plate it is less than half its least width: 1/3 of a ball's radius.
        """
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        return float((self.volume() / np.bincount(self.triangle_body, weights=area)).min())

    def bounding_box(self) -> tuple[Floats, Floats]:
        """Return the least and greatest coordinates in the body frame, shape (3,) each, [mm]."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @checked
    def translated(self, shift: Sequence[float] | Floats) -> Tool:
        """Return the tool moved in its body frame by ``shift``, shape (3,), [mm].

        Raises
        ------
        ValueError
            If the shift is not three finite numbers, or so large that round-off of the coordinates
            would change the tool's shape.
        """
        move = three("shift", shift, "mm")
        size = float(np.ptp(self.vertices, axis=0).max())
        if np.abs(move).max() > FARTHEST_SHIFT * size:
            raise ValueError(
                f"shift must be within {FARTHEST_SHIFT:g} times the tool's size of {size:.4g} mm, "
                f"got {tuple(move.tolist())} mm"
            )
        return replace(self, vertices=self.vertices + move)

    def point(self, edge: int, s: float) -> Floats:
        """Return the point of cutting segment ``edge`` at the fraction ``s`` of its length.

        Parameters
        ----------
        edge : int
            Segment, in [0, n_edge).
        s : float
            0 at its first vertex, 1 at its second.

        Returns
        -------
        ndarray, shape (3,), [mm]
            In the body frame.
        """
        if not 0 <= edge < self.n_edge:
            raise ValueError(f"edge must be in [0, {self.n_edge}), got {edge}")
        if not 0.0 <= s <= 1.0:
            raise ValueError(f"s must be in [0, 1], got {s}")
        i, j = self.edges[edge]
        point: Floats = (1.0 - s) * self.vertices[i] + s * self.vertices[j]
        return point


def _cast(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    edges: npt.ArrayLike | Literal["none"] | None,
    sharp_angle_deg: float,
    flank_angle_deg: float,
) -> tuple[Floats, Ints, Ints | None]:
    problems = []
    coordinates = np.array(vertices, dtype=np.float64)
    if coordinates.ndim != 2 or coordinates.shape[1] != 3:
        problems.append(f"vertices must have shape (n_vertex, 3), got {coordinates.shape}")
    elif not np.isfinite(coordinates).all():
        bad = np.flatnonzero(~np.isfinite(coordinates).all(axis=1))
        problems.append(f"{counted(len(bad), 'vertex', 'vertices')} not finite, first id {bad[0]}")
    n_vertex = coordinates.shape[0] if coordinates.ndim else 0
    ids = _cast_ids(triangles, 3, "triangles", "(n_triangle, 3)", n_vertex, problems)
    given: Ints | None = None
    if isinstance(edges, str) or (edges is not None and np.shape(edges) == (0, 2)):
        given = np.zeros((0, 2), dtype=np.int64)
    elif edges is not None:
        given = _cast_ids(edges, 2, "edges", "(n_edge, 2)", n_vertex, problems)
    if not 0.0 < sharp_angle_deg < 180.0:
        problems.append(f"sharp_angle_deg must be between 0 and 180, got {sharp_angle_deg}")
    if not 0.0 < flank_angle_deg < 90.0:
        problems.append(f"flank_angle_deg must be between 0 and 90, got {flank_angle_deg}")
    if problems:
        raise ToolError(problems)
    return coordinates, ids, given


def _cast_ids(
    values: npt.ArrayLike, width: int, name: str, shape: str, n_vertex: int, problems: list[str]
) -> Ints:
    ids = np.asarray(values)
    if ids.ndim != 2 or ids.shape[1] != width or ids.shape[0] == 0:
        problems.append(f"{name} must have shape {shape} and at least one row, got {ids.shape}")
    elif not np.issubdtype(ids.dtype, np.integer):
        problems.append(f"{name} must hold integer vertex ids, got {ids.dtype}")
    elif ids.min() < 0 or ids.max() >= n_vertex:
        problems.append(
            f"{name} must hold vertex ids in [0, {n_vertex}), got {ids.min()} to {ids.max()}"
        )
    else:
        return np.array(ids, dtype=np.int64, order="C")
    return np.zeros((0, width), dtype=np.int64)
