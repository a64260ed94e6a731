"""One picture of a run: the plain arrays that writers and views share.

A simulation fills a `Frame`; file writers and views read only frames. Reading results therefore
needs no compiler: nothing here imports Numba.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Annotated, Any, get_type_hints

import numpy as np

from .arrays import Bools, Floats, Ints, SmallInts

STRAIGHT = 0
"""State of a cable that the cutting edge has not met."""
JOINTED = 1
"""State of a cable that is bent around the cutting edge."""


SIZED_BY = {
    "node": "points",
    "quad": "quads",
    "segment": "cable_segments",
    "vertex": "tool_points",
    "triangle": "tool_triangles",
    "crack": "crack_edges",
    "edge": "edge_points",
}
"""Entities that rows of an array can belong to, with the array whose length is their number."""


@dataclass(frozen=True)
class Rows:
    """Entity of an array's rows in :class:`Frame`, and its form in result files."""

    of: str
    """A key of :data:`SIZED_BY`; "" for an array that is not a table."""
    shape: tuple[int, ...] = ()
    """Shape of a row."""
    dtype: Any = np.float64
    ids: str = ""
    """Entity whose ids the array contains, a key of :data:`SIZED_BY`."""
    arrays: tuple[str, ...] = ()
    """Names of its arrays in result files (:mod:`shellcut.results.frame_grid`): one, or one per
    column."""
    widens: bool = False
    """Whether rows may have more columns than ``shape`` says."""
    left_out: Any = None
    """Value of every row if the array is not given; or the name of the field to use instead."""


_LEFT_OUT: Any = ()
"""Default of an array that is left out."""


def _principal(place: str) -> tuple[str, str]:
    return f"largest principal stress{place} [MPa]", f"smallest principal stress{place} [MPa]"


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """One picture of the run, everything at one time.

    Arrays are copied, cast and checked on construction and are read-only afterwards, so a frame
    stays valid while the simulation continues. Leave out the arrays of parts that a model does not
    have (cables, a tool).

    To add an array, add one entry here, with :class:`Rows`, and fill it in
    ``recording/frame_capture.py``; checks and result files follow from the entry.

    Raises
    ------
    ValueError
        If a shape, a node id or a state is invalid, or if a number to be drawn, or a scalar, is
        not finite.
    """

    time: float
    """Time [s]."""

    coordinate: float
    """Abscissa of curves, e.g. the tool's angle of rotation, in ``coordinate_unit``."""

    coordinate_name: str
    """Name of ``coordinate``, e.g. ``"angle"``."""

    coordinate_unit: str
    """Unit of ``coordinate``, e.g. ``"deg"``."""

    points: Annotated[Floats, Rows("node", (3,))]
    """Deformed mid-surface positions, shape (n_node, 3), [mm]."""

    reference: Annotated[Floats, Rows("node", (3,))]
    """Reference mid-surface positions, shape (n_node, 3), [mm]."""

    director: Annotated[Floats, Rows("node", (3,), arrays=("director",))]
    """Unit directors, shape (n_node, 3), [-]."""

    velocity: Annotated[Floats, Rows("node", (3,), arrays=("velocity [mm per s]",))]
    """Velocities, shape (n_node, 3), [mm/s]."""

    quads: Annotated[Ints, Rows("quad", (4,), dtype=np.int64, ids="node", widens=True)]
    """Node ids of the quads, shape (n_quad, 4). Cracks through quads make polygons of them: then
    shape (n_quad, n_corner), and one with fewer corners repeats its last node."""

    quad_stress: Annotated[Floats, Rows("quad", (3,), arrays=("membrane stress [MPa]",))]
    """Cauchy membrane stress s11, s22, s12 in the lamina frame, shape (n_quad, 3), [MPa]: the mean
    over the thickness. The frame's first axis runs from the middle of the quad's side 3-0 to that
    of its side 1-2."""

    quad_principal: Annotated[Floats, Rows("quad", (2,), arrays=_principal(""))]
    """Largest and smallest principal membrane stress, shape (n_quad, 2), [MPa]."""

    quad_stress_top: Annotated[
        Floats, Rows("quad", (3,), arrays=("top stress [MPa]",), left_out="quad_stress")
    ] = _LEFT_OUT
    """As ``quad_stress``, at the outer face of the top layer; left out: the membrane's."""

    quad_principal_top: Annotated[
        Floats, Rows("quad", (2,), arrays=_principal(", top"), left_out="quad_principal")
    ] = _LEFT_OUT
    """As ``quad_principal``, at the outer face of the top layer; left out: the membrane's."""

    quad_stress_bottom: Annotated[
        Floats, Rows("quad", (3,), arrays=("bottom stress [MPa]",), left_out="quad_stress")
    ] = _LEFT_OUT
    """As ``quad_stress``, at the outer face of the bottom layer; left out: the membrane's."""

    quad_principal_bottom: Annotated[
        Floats, Rows("quad", (2,), arrays=_principal(", bottom"), left_out="quad_principal")
    ] = _LEFT_OUT
    """As ``quad_principal``, at the outer face of the bottom layer; left out: the membrane's."""

    quad_thickness: Annotated[Floats, Rows("quad", arrays=("thickness [mm]",), left_out=0.0)] = (
        _LEFT_OUT
    )
    """Present thickness at the centre, shape (n_quad,), [mm]; left out: 0."""

    held: Annotated[Bools, Rows("node", dtype=np.bool_, arrays=("held",), left_out=False)] = (
        _LEFT_OUT
    )
    """Whether a support prescribes any motion of the node, shape (n_node,); left out: none."""

    crack_edges: Annotated[Ints, Rows("crack", (2, 2), dtype=np.int64, ids="node")] = _LEFT_OUT
    """Node ids ((a_minus, b_minus), (a_plus, b_plus)) of the two flanks of each side along a crack,
    shape (n_crack, 2, 2); a flank that ends at a crack tip shares that node with the other."""

    cable_segments: Annotated[Floats, Rows("segment", (2, 3))] = _LEFT_OUT
    """End points of the straight branches of the cables, shape (n_segment, 2, 3), [mm]; a straight
    cable is one segment, a jointed one two."""

    cable_state: Annotated[SmallInts, Rows("segment", dtype=np.int8, arrays=("cable state",))] = (
        _LEFT_OUT
    )
    """State of the cable of each segment, shape (n_segment,): 0 straight, 1 jointed."""

    cable_traction: Annotated[Floats, Rows("segment", arrays=("traction [MPa]",))] = _LEFT_OUT
    """Traction that the cable of each segment carries, shape (n_segment,), [MPa]."""

    cable_opening: Annotated[Floats, Rows("segment", arrays=("opening [mm]",), left_out=0.0)] = (
        _LEFT_OUT
    )
    """Opening of the cable of each segment, the length that its law sees, shape (n_segment,),
    [mm]; of a jointed one that of both branches together. Left out: 0."""

    tool_points: Annotated[Floats, Rows("vertex", (3,))] = _LEFT_OUT
    """Vertices of the tool in their present position, shape (n_vertex, 3), [mm]."""

    tool_triangles: Annotated[Ints, Rows("triangle", (3,), dtype=np.int64, ids="vertex")] = (
        _LEFT_OUT
    )
    """Vertex ids of the tool's triangles, normals outward, shape (n_triangle, 3)."""

    tool_tooth: Annotated[Ints, Rows("triangle", dtype=np.int64, arrays=("tooth",), left_out=0)] = (
        _LEFT_OUT
    )
    """Tooth of each triangle, counted from 1 as in the history, shape (n_triangle,); left out:
    0, unknown."""

    tool_rotation: Annotated[Floats, Rows("", (3, 3))] = field(default_factory=lambda: np.eye(3))
    """Rotation R of the tool, x = R X + r from its body frame, shape (3, 3)."""

    tool_translation: Annotated[Floats, Rows("", (3,))] = field(default_factory=lambda: np.zeros(3))
    """Translation r of the tool, shape (3,), [mm]."""

    edge_points: Annotated[Floats, Rows("edge", (2, 3))] = _LEFT_OUT
    """End points of the segments of the cutting edges in their present position, shape
    (n_edge, 2, 3), [mm]."""

    edge_tooth: Annotated[Ints, Rows("edge", dtype=np.int64, arrays=("tooth",), left_out=0)] = (
        _LEFT_OUT
    )
    """Tooth of each of these segments, as ``tool_tooth``, shape (n_edge,)."""

    quad_history: Mapping[str, Floats] = field(default_factory=dict)
    """Means of the material's history numbers by name and unit, shape (n_quad,) each, e.g.
    ``{"damage [-]": ...}``."""

    scalars: Mapping[str, float] = field(default_factory=dict)
    """Figures of the whole model by name, e.g. ``{"torque": 143.6}``."""

    scalar_units: Mapping[str, str] = field(default_factory=dict)
    """Unit of every scalar by the same names, e.g. ``{"torque": "N*mm"}``; ``"-"`` for none."""

    def __post_init__(self) -> None:
        n = {entity: len(getattr(self, array)) for entity, array in SIZED_BY.items()}
        for name, rows in ROWS.items():
            value, shape = getattr(self, name), ((n[rows.of],) if rows.of else ()) + rows.shape
            if not len(value) and isinstance(rows.left_out, str):
                value = getattr(self, rows.left_out)
            elif not len(value):
                empty = rows.left_out is None
                value = np.full(
                    (0, *rows.shape) if empty else shape, rows.left_out or 0, rows.dtype
                )
            if rows.widens:
                shape = (*shape[:-1], max(shape[-1], *np.shape(value)[-1:]))
            array = _checked(name, value, rows.dtype, shape)
            object.__setattr__(self, name, array)
        history = {
            name: _checked(f"quad_history {name!r}", numbers, np.float64, (n["quad"],))
            for name, numbers in self.quad_history.items()
        }
        object.__setattr__(self, "quad_history", MappingProxyType(history))
        for name, rows in ROWS.items():
            ids = getattr(self, name) if rows.ids else np.zeros(0)
            if ids.size and (ids.min() < 0 or ids.max() >= n[rows.ids]):
                span = f"{ids.min()}..{ids.max()}"
                raise ValueError(f"{name} must lie in 0..{n[rows.ids] - 1}, got {span}")
        if not np.isin(self.cable_state, (STRAIGHT, JOINTED)).all():
            raise ValueError("cable_state must be 0 (straight) or 1 (jointed)")
        for name in ("time", "coordinate"):
            if not np.isfinite(getattr(self, name)):
                raise ValueError(f"{name} must be finite, got {getattr(self, name)}")
        if unpaired := sorted(set(self.scalars) ^ set(self.scalar_units)):
            raise ValueError(f"scalars and scalar_units must have the same names, not {unpaired}")
        scalars = {name: float(value) for name, value in self.scalars.items()}
        for name, value in scalars.items():
            if not np.isfinite(value):
                raise ValueError(f"scalar {name!r} must be finite, got {value}")
        object.__setattr__(self, "scalars", MappingProxyType(scalars))
        object.__setattr__(self, "scalar_units", MappingProxyType(dict(self.scalar_units)))

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to make it again: a mapping that is read only cannot be pickled."""
        values = {one.name: getattr(self, one.name) for one in fields(self)}
        plain = {k: dict(v) if isinstance(v, Mapping) else v for k, v in values.items()}
        return _of_fields, (type(self), plain)

    @property
    def displacement(self) -> Floats:
        """Displacement, shape (n_node, 3), [mm]."""
        return self.points - self.reference


def _of_fields(kind: type[Frame], values: Mapping[str, Any]) -> Frame:
    return kind(**values)


def is_corner(quads: Ints) -> Bools:
    """Return which columns of :attr:`Frame.quads` are no repetition, of the shape of quads."""
    own = np.ones(quads.shape, np.bool_)
    own[:, 1:] = quads[:, 1:] != quads[:, :-1]
    return own


def sides_of(quads: Ints) -> Ints:
    """Return the sides of all :attr:`Frame.quads`, one after the other, shape (n, 2)."""
    sides = np.stack((quads, np.roll(quads, -1, axis=1)), axis=2).reshape(-1, 2)
    return np.asarray(sides[sides[:, 0] != sides[:, 1]])


def _checked(name: str, value: Any, dtype: Any, shape: tuple[int, ...]) -> Any:
    """Return a read-only copy of an array, cast to its type; refuse what does not fit."""
    given = np.asarray(value)
    if given.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, got {given.shape}")
    if np.issubdtype(dtype, np.integer) and not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"{name} must hold integers, got {given.dtype}")
    if dtype == np.bool_ and given.dtype != np.bool_:
        raise ValueError(f"{name} must hold bools, got {given.dtype}")
    array = np.array(given, dtype=dtype, order="C")
    # Any nan would silently become a hole in files and pictures.
    if dtype == np.float64 and not np.isfinite(array).all():
        row = int(np.argwhere(~np.isfinite(array))[0, 0])
        raise ValueError(f"{name} must be finite, row {row} is {array[row]}")
    array.flags.writeable = False
    return array


ROWS: dict[str, Rows] = {
    name: hint.__metadata__[0]
    for name, hint in get_type_hints(Frame, include_extras=True).items()
    if hasattr(hint, "__metadata__")
}
"""The arrays of a frame by name, in the order of its fields."""
