"""One picture of a run: the plain arrays that writers and views share.

Who simulates fills a `Frame`; who writes a file or draws a picture reads it and nothing else.
Reading results therefore needs no compiler: nothing here imports Numba.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from .arrays import Bools, Floats, Ints, SmallInts

STRAIGHT = 0
"""State of a cable that the cutting edge has not met."""
JOINTED = 1
"""State of a cable that is bent around the cutting edge."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """One picture of the run, everything at one time.

    Arrays are copied, cast and checked on construction and are read-only afterwards, so that a
    frame stays true while the simulation goes on. What a model does not have (cables, a tool)
    is left out.

    Raises
    ------
    ValueError
        If a shape, a node id or a state does not fit, or if a number that will be drawn, or a
        scalar, is not finite.
    """

    time: float
    """Time [s]."""

    coordinate: float
    """What the curves are drawn over, e.g. the tool's angle of rotation, in ``coordinate_unit``."""

    coordinate_name: str
    """Name of ``coordinate``, e.g. ``"angle"``."""

    coordinate_unit: str
    """Unit of ``coordinate``, e.g. ``"deg"``."""

    points: Floats
    """Deformed mid-surface positions, shape (n_node, 3), [mm]."""

    reference: Floats
    """Reference mid-surface positions, shape (n_node, 3), [mm]."""

    director: Floats
    """Unit directors, shape (n_node, 3), [-]."""

    velocity: Floats
    """Velocities, shape (n_node, 3), [mm/s]."""

    quads: Ints
    """Node ids of the quads, shape (n_quad, 4)."""

    quad_stress: Floats
    """Cauchy membrane stress s11, s22, s12 in the lamina frame, shape (n_quad, 3), [MPa]: the mean
    over the thickness. The frame's first axis runs from the middle of the quad's edge 3-0 to that
    of its edge 1-2."""

    quad_principal: Floats
    """Largest and smallest principal membrane stress, shape (n_quad, 2), [MPa]."""

    quad_stress_top: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    """As ``quad_stress``, at the outer face of the top layer; left out: the membrane's."""

    quad_principal_top: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    """As ``quad_principal``, at the outer face of the top layer; left out: the membrane's."""

    quad_stress_bottom: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    """As ``quad_stress``, at the outer face of the bottom layer; left out: the membrane's."""

    quad_principal_bottom: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    """As ``quad_principal``, at the outer face of the bottom layer; left out: the membrane's."""

    quad_thickness: Floats = field(default_factory=lambda: np.zeros(0))
    """Present thickness at the centre, shape (n_quad,), [mm]; left out: 0."""

    held: Bools = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))
    """Whether a support prescribes any motion of the node, shape (n_node,); left out: none."""

    crack_edges: Ints = field(default_factory=lambda: np.zeros((0, 2, 2), dtype=np.int64))
    """Node ids ((a_minus, b_minus), (a_plus, b_plus)) of the two flanks of each crack edge,
    shape (n_crack, 2, 2); a flank that ends at a crack tip shares that node with the other."""

    cable_segments: Floats = field(default_factory=lambda: np.zeros((0, 2, 3)))
    """End points of the straight branches of the cables, shape (n_segment, 2, 3), [mm]; a straight
    cable is one segment, a jointed one two."""

    cable_state: SmallInts = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    """State of the cable of each segment, shape (n_segment,): 0 straight, 1 jointed."""

    cable_traction: Floats = field(default_factory=lambda: np.zeros(0))
    """Traction that the cable of each segment carries, shape (n_segment,), [MPa]."""

    cable_opening: Floats = field(default_factory=lambda: np.zeros(0))
    """Opening of the cable of each segment, the length that its law sees, shape (n_segment,),
    [mm]; of a jointed one that of both branches together. Left out: 0."""

    tool_points: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    """Vertices of the tool in their present position, shape (n_vertex, 3), [mm]."""

    tool_triangles: Ints = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))
    """Vertex ids of the tool's triangles, normals outward, shape (n_triangle, 3)."""

    tool_tooth: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Tooth of each triangle, counted from 1 as in the history, shape (n_triangle,); left out:
    0, not told."""

    tool_rotation: Floats = field(default_factory=lambda: np.eye(3))
    """Rotation R of the tool, x = R X + r from its body frame, shape (3, 3)."""

    tool_translation: Floats = field(default_factory=lambda: np.zeros(3))
    """Translation r of the tool, shape (3,), [mm]."""

    edge_points: Floats = field(default_factory=lambda: np.zeros((0, 2, 3)))
    """End points of the segments of the cutting edges in their present position, shape
    (n_edge, 2, 3), [mm]."""

    edge_tooth: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Tooth of each of these segments, as ``tool_tooth``, shape (n_edge,)."""

    scalars: Mapping[str, float] = field(default_factory=dict)
    """Figures of the whole model by name, e.g. ``{"torque": 143.6}``."""

    scalar_units: Mapping[str, str] = field(default_factory=dict)
    """Unit of every scalar by the same names, e.g. ``{"torque": "N*mm"}``; ``"-"`` for none."""

    def __post_init__(self) -> None:
        n_node = len(self.points)
        n_quad = len(self.quads)
        n_crack = len(self.crack_edges)
        n_segment = len(self.cable_segments)
        n_vertex = len(self.tool_points)
        n_triangle = len(self.tool_triangles)
        n_edge = len(self.edge_points)
        self._fill_in(n_node, n_quad, n_segment, n_triangle, n_edge)
        self._cast("points", np.float64, (n_node, 3))
        self._cast("reference", np.float64, (n_node, 3))
        self._cast("director", np.float64, (n_node, 3))
        self._cast("velocity", np.float64, (n_node, 3))
        self._cast("quads", np.int64, (n_quad, 4))
        self._cast("quad_stress", np.float64, (n_quad, 3))
        self._cast("quad_principal", np.float64, (n_quad, 2))
        for side in ("top", "bottom"):
            self._cast(f"quad_stress_{side}", np.float64, (n_quad, 3))
            self._cast(f"quad_principal_{side}", np.float64, (n_quad, 2))
        self._cast("quad_thickness", np.float64, (n_quad,))
        self._cast("held", np.bool_, (n_node,))
        self._cast("crack_edges", np.int64, (n_crack, 2, 2))
        self._cast("cable_segments", np.float64, (n_segment, 2, 3))
        self._cast("cable_state", np.int8, (n_segment,))
        self._cast("cable_traction", np.float64, (n_segment,))
        self._cast("cable_opening", np.float64, (n_segment,))
        self._cast("tool_points", np.float64, (n_vertex, 3))
        self._cast("tool_triangles", np.int64, (n_triangle, 3))
        self._cast("tool_tooth", np.int64, (n_triangle,))
        self._cast("tool_rotation", np.float64, (3, 3))
        self._cast("tool_translation", np.float64, (3,))
        self._cast("edge_points", np.float64, (n_edge, 2, 3))
        self._cast("edge_tooth", np.int64, (n_edge,))
        self._check_ids("quads", n_node)
        self._check_ids("crack_edges", n_node)
        self._check_ids("tool_triangles", n_vertex)
        if not np.isin(self.cable_state, (STRAIGHT, JOINTED)).all():
            raise ValueError("cable_state must be 0 (straight) or 1 (jointed)")
        for name in ("time", "coordinate"):
            if not np.isfinite(getattr(self, name)):
                raise ValueError(f"{name} must be finite, got {getattr(self, name)}")
        self._check_scalars()

    def _fill_in(
        self, n_node: int, n_quad: int, n_segment: int, n_triangle: int, n_edge: int
    ) -> None:
        left_out: dict[str, Any] = {
            "quad_stress_top": self.quad_stress,
            "quad_stress_bottom": self.quad_stress,
            "quad_principal_top": self.quad_principal,
            "quad_principal_bottom": self.quad_principal,
            "quad_thickness": np.zeros(n_quad),
            "held": np.zeros(n_node, dtype=np.bool_),
            "cable_opening": np.zeros(n_segment),
            "tool_tooth": np.zeros(n_triangle, dtype=np.int64),
            "edge_tooth": np.zeros(n_edge, dtype=np.int64),
        }
        for name, value in left_out.items():
            if len(getattr(self, name)) == 0:
                object.__setattr__(self, name, value)

    def _cast(self, name: str, dtype: Any, shape: tuple[int, ...]) -> None:
        given = np.asarray(getattr(self, name))
        if given.shape != shape:
            raise ValueError(f"{name} must have shape {shape}, got {given.shape}")
        if np.issubdtype(dtype, np.integer) and not np.issubdtype(given.dtype, np.integer):
            raise ValueError(f"{name} must hold integers, got {given.dtype}")
        if dtype == np.bool_ and given.dtype != np.bool_:
            raise ValueError(f"{name} must hold bools, got {given.dtype}")
        array = np.array(given, dtype=dtype, order="C")
        # A nan anywhere would reach the file and the eyes as a hole without a word.
        if dtype == np.float64 and not np.isfinite(array).all():
            row = int(np.argwhere(~np.isfinite(array))[0, 0])
            raise ValueError(f"{name} must be finite, row {row} is {array[row]}")
        array.flags.writeable = False
        object.__setattr__(self, name, array)

    def _check_ids(self, name: str, n: int) -> None:
        ids = getattr(self, name)
        if ids.size and (ids.min() < 0 or ids.max() >= n):
            raise ValueError(f"{name} must lie in 0..{n - 1}, got {ids.min()}..{ids.max()}")

    def _check_scalars(self) -> None:
        unpaired = sorted(set(self.scalars) ^ set(self.scalar_units))
        if unpaired:
            raise ValueError(f"scalars and scalar_units must have the same names, not {unpaired}")
        scalars = {name: float(value) for name, value in self.scalars.items()}
        for name, value in scalars.items():
            if not np.isfinite(value):
                raise ValueError(f"scalar {name!r} must be finite, got {value}")
        object.__setattr__(self, "scalars", MappingProxyType(scalars))
        object.__setattr__(self, "scalar_units", MappingProxyType(dict(self.scalar_units)))

    @property
    def displacement(self) -> Floats:
        """Displacement, shape (n_node, 3), [mm]."""
        return self.points - self.reference
