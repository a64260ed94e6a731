"""Frames of a run in one VTKHDF file: ParaView 5.12 or later opens it and plays the time.

One temporal unstructured grid holds everything, told apart by the cell array ``part``: the quads
of the membrane, the straight branches of the cables as lines, the triangles of the tool. Points
are deformed positions, so the crack opens without a filter. Nodes and cables may come and go from
frame to frame.

==================================  ======  ===================================================
array                               on      holds
==================================  ======  ===================================================
``displacement [mm]``               points  3 components; zero on cables and tool
``velocity [mm per s]``             points  3 components; zero on cables and tool
``director``                        points  3 components; zero on cables and tool
``part``                            cells   0 membrane, 1 cable, 2 tool
``membrane stress [MPa]``           cells   s11, s22, s12 in the lamina; zero elsewhere
``largest principal stress [MPa]``  cells   of the membrane; zero elsewhere
``smallest principal stress [MPa]`` cells   of the membrane; zero elsewhere
``traction [MPa]``                  cells   of the cables; zero elsewhere
``cable state``                     cells   0 straight, 1 jointed; zero elsewhere
``time [s]``, ``torque [N*mm]``...  field   time, the frame's coordinate and its scalars
==================================  ======  ===================================================

Points are stored in single precision (1e-6 mm at 10 mm), the other arrays rounded to 12 bits
(1.2e-4 of the value), which makes them half as large; field arrays are exact. A "/" in a unit
becomes "per", because HDF5 reads it as a path.

How the file counts (version 2.3 of the format; VTK 9.3.1, 9.5.2 and 9.7.2 read it back, 9.2
takes all frames for one, without a word):
every dataset is one long column to which frames append, and ``Steps`` says where a frame begins.
The reader finds a frame in ``Offsets``, which has one entry more than there are cells, at the sum
of the frame's cell offset and its *part* offset. A frame with the cells of the one before re-uses
both of them, and adds nothing to ``NumberOf*``; with only one of the two re-used, late frames
cannot be read. Arrays that grow together have the same offsets: one dataset under several names
(hard links), which saves most of the time that a frame would cost. How the columns grow and are
packed is the matter of :mod:`shellcut.hdf_columns`.
"""

from __future__ import annotations

import os
from typing import Any, Literal

import h5py
import numpy as np

from .frame import Floats, Frame
from .growing_file import GrowingFile
from .hdf_columns import Columns

MEMBRANE, CABLE, TOOL = 0, 1, 2
"""Values of the cell array ``part``."""

_VERSION = (2, 3)
_LINE, _TRIANGLE, _QUAD = 3, 5, 9  # VTK's numbers of cell types

_POINT_ARRAYS = ("displacement [mm]", "velocity [mm per s]", "director")
_CELL_ARRAYS: dict[str, tuple[Any, tuple[int, ...]]] = {
    "part": (np.uint8, ()),
    "membrane stress [MPa]": (np.float32, (3,)),
    "largest principal stress [MPa]": (np.float32, ()),
    "smallest principal stress [MPa]": (np.float32, ()),
    "traction [MPa]": (np.float32, ()),
    "cable state": (np.uint8, ()),
}
_TIME = "time [s]"

# The names under which shared offsets are written; the other arrays' are links to them.
_CELL_DATA_OFFSETS = "CellDataOffsets/part"
_SERIES_OFFSETS = f"FieldDataOffsets/{_TIME}"
_SERIES_SIZES = f"FieldDataSizes/{_TIME}"

_KEPT_BITS = 12  # of the 23 in the mantissa of a single, for all arrays but the points


class VtkHdfWriter(GrowingFile):
    """Append frames to one VTKHDF file.

    Every frame is flushed, its entry in ``Steps`` last, so a killed run leaves a readable file.

    Parameters
    ----------
    path : str or Path
        The file, by custom ``*.vtkhdf``.
    mode, until
        As :class:`GrowingFile`, ``until`` in s; what a killed run left of an unfinished frame is
        dropped.

    Raises
    ------
    ValueError
        If the file of mode ``"a"`` was not written by this class.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        mode: Literal["w", "a"] = "w",
        until: float | None = None,
    ) -> None:
        super().__init__(path, mode=mode, until=until)
        self._file = h5py.File(self.path, "r+" if self.goes_on else "w")
        self._series_names: tuple[str, ...] = ()
        self._cells: tuple[Any, Any, int] | None = None  # those of the last frame
        self._cells_entry: dict[str, Any] = {}  # and where they are
        self._last_time = -np.inf
        self._n_frame = 0
        if self.goes_on:
            self._open_old()
            self._drop_after(np.inf if until is None else until)
        else:
            self._create_new()

    @property
    def n_frame(self) -> int:
        """Number of frames in the file."""
        return self._n_frame

    def append(self, frame: Frame) -> None:
        """Write one frame and flush it.

        Raises
        ------
        ValueError
            If the frame's scalars are not those of the first frame, or its time is not later
            than that of the last.
        """
        if frame.time <= self._last_time:
            raise ValueError(
                f"frames must be appended in order of time, got {frame.time} s after "
                f"{self._last_time} s"
            )
        series = _series(frame)
        if not self._series_names:
            self._create_series(tuple(series))
        elif set(series) != set(self._series_names):
            raise ValueError(
                f"every frame must have the scalars {sorted(self._series_names)}, "
                f"got {sorted(series)}"
            )

        entry = self._append_cells(frame)
        point = self._columns.end("Points")
        entry["PointOffsets"] = point
        self._columns.write("Points", point, _points(frame), noise=True)
        for name, rows in _point_arrays(frame).items():
            self._columns.write(f"PointData/{name}", point, rows)
        cell = self._columns.end("CellData/part")
        entry[_CELL_DATA_OFFSETS] = cell
        for name, rows in _cell_arrays(frame).items():
            self._columns.write(f"CellData/{name}", cell, rows)
        entry[_SERIES_OFFSETS] = self._n_frame
        entry[_SERIES_SIZES] = (1, 1)  # components, tuples
        for name, value in series.items():
            self._columns.write(f"FieldData/{name}", self._n_frame, np.array([value]))
        entry["Values"] = frame.time
        for name, value in entry.items():
            self._columns.write(f"Steps/{name}", self._n_frame, np.array([value]))
        # The frame counts only once all of it is in the file.
        self._file.flush()
        self._count(self._n_frame + 1)
        self._last_time = frame.time

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._file.close()

    def _append_cells(self, frame: Frame) -> dict[str, Any]:
        connectivity, types, sizes = _cells(frame)
        n_point = len(frame.points) + 2 * len(frame.cable_segments) + len(frame.tool_points)
        if self._cells is not None:
            old_connectivity, old_types, old_n_point = self._cells
            if (
                n_point == old_n_point
                and np.array_equal(types, old_types)
                and np.array_equal(connectivity, old_connectivity)
            ):
                return dict(self._cells_entry)
        self._cells = connectivity, types, n_point
        part = self._columns.end("NumberOfPoints")
        cell = self._columns.end("Types")
        first_id = self._columns.end("Connectivity")
        self._columns.write("NumberOfPoints", part, np.array([n_point]))
        self._columns.write("NumberOfCells", part, np.array([len(types)]))
        self._columns.write("NumberOfConnectivityIds", part, np.array([len(connectivity)]))
        self._columns.write("Types", cell, types)
        self._columns.write("Offsets", cell + part, np.concatenate(([0], np.cumsum(sizes))))
        self._columns.write("Connectivity", first_id, connectivity)
        self._cells_entry = {
            "PartOffsets": part,
            "NumberOfParts": 1,
            "CellOffsets": (cell,),
            "ConnectivityIdOffsets": (first_id,),
        }
        return dict(self._cells_entry)

    def _count(self, n_frame: int) -> None:
        self._n_frame = n_frame
        self._root["Steps"].attrs["NSteps"] = n_frame
        self._file.flush()

    def _create_new(self) -> None:
        self._root: Any = self._file.create_group("VTKHDF")
        self._root.attrs["Version"] = np.array(_VERSION)
        # VTK wants ASCII of fixed length here, which h5py does not write by default.
        kind = b"UnstructuredGrid"
        self._root.attrs.create("Type", kind, dtype=h5py.string_dtype("ascii", len(kind)))
        self._columns = Columns(self._root)
        create = self._columns.create
        for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
            create(name, np.int64)
        # Not packed: this one cannot begin on a chunk of its own, see above.
        create("Offsets", np.int64, blocks=True)
        create("Connectivity", np.int64, packed=True)
        create("Types", np.uint8, packed=True)
        create("Points", np.float32, (3,), packed=True)
        create("Steps/Values", np.float64)
        for name in ("PartOffsets", "NumberOfParts", "PointOffsets", _CELL_DATA_OFFSETS):
            create(f"Steps/{name}", np.int64)
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            create(f"Steps/{name}", np.int64, (1,))
        for name in _POINT_ARRAYS:
            create(f"PointData/{name}", np.float32, (3,), packed=True)
            self._columns.link(f"Steps/PointDataOffsets/{name}", "Steps/PointOffsets")
        for name, (dtype, shape) in _CELL_ARRAYS.items():
            create(f"CellData/{name}", dtype, shape, packed=True)
            offsets = f"Steps/{_CELL_DATA_OFFSETS}"
            self._columns.link(f"Steps/CellDataOffsets/{name}", offsets)
        self._count(0)

    def _create_series(self, names: tuple[str, ...]) -> None:
        create, link = self._columns.create, self._columns.link
        create(f"Steps/{_SERIES_OFFSETS}", np.int64)
        create(f"Steps/{_SERIES_SIZES}", np.int64, (2,))
        for name in names:
            create(f"FieldData/{name}", np.float64)
            link(f"Steps/FieldDataOffsets/{name}", f"Steps/{_SERIES_OFFSETS}")
            link(f"Steps/FieldDataSizes/{name}", f"Steps/{_SERIES_SIZES}")
        self._series_names = names

    def _open_old(self) -> None:
        root = self._file.get("VTKHDF", {})
        wanted = ["Steps", "Points", *(f"CellData/{name}" for name in _CELL_ARRAYS)]
        if not all(name in root for name in wanted):
            self._file.close()
            raise ValueError(
                f"{self.path} was not written by shellcut; move it away or begin anew with mode 'w'"
            )
        self._root = root
        self._columns = Columns(root)
        self._series_names = tuple(root.get("FieldData", ()))

    def _drop_after(self, until: float) -> None:
        columns = self._columns
        n_frame = int(self._root["Steps"].attrs["NSteps"])  # a killed run may have begun another
        n_frame = int(np.searchsorted(columns["Steps/Values"][:n_frame], until, side="right"))
        # Frames may share cells but never go back to older ones: the last frame kept ends all.
        n_part = n_point = n_cell = n_id = n_cell_row = 0
        if n_frame:
            k = n_frame - 1
            part = int(columns["Steps/PartOffsets"][k])
            n_part = part + 1
            n_point = columns["Steps/PointOffsets"][k] + columns["NumberOfPoints"][part]
            n_cell = columns["Steps/CellOffsets"][k, 0] + columns["NumberOfCells"][part]
            n_id = (
                columns["Steps/ConnectivityIdOffsets"][k, 0]
                + columns["NumberOfConnectivityIds"][part]
            )
            n_cell_row = columns[f"Steps/{_CELL_DATA_OFFSETS}"][k] + columns["NumberOfCells"][part]
            self._last_time = float(columns["Steps/Values"][k])
        ends = {
            "NumberOfPoints": n_part,
            "NumberOfCells": n_part,
            "NumberOfConnectivityIds": n_part,
            "Points": n_point,
            "Types": n_cell,
            "Offsets": n_cell + n_part,
            "Connectivity": n_id,
            "PointData": n_point,
            "CellData": n_cell_row,
            "FieldData": n_frame,
            "Steps": n_frame,
        }
        for name in columns:
            columns.cut(name, int(ends[name.partition("/")[0]]))
        self._count(n_frame)


def _cells(frame: Frame) -> tuple[Any, Any, Any]:
    n_segment = len(frame.cable_segments)
    first_cable = len(frame.points)
    first_tool = first_cable + 2 * n_segment
    connectivity = np.concatenate(
        (
            frame.quads.ravel(),
            np.arange(first_cable, first_tool),
            frame.tool_triangles.ravel() + first_tool,
        )
    )
    counts = (len(frame.quads), n_segment, len(frame.tool_triangles))
    types = np.repeat(np.array([_QUAD, _LINE, _TRIANGLE], dtype=np.uint8), counts)
    return connectivity, types, np.repeat((4, 2, 3), counts)


def _points(frame: Frame) -> Floats:
    return np.concatenate((frame.points, frame.cable_segments.reshape(-1, 3), frame.tool_points))


def _point_arrays(frame: Frame) -> dict[str, Any]:
    zeros = np.zeros((2 * len(frame.cable_segments) + len(frame.tool_points), 3), np.float32)
    values = (frame.displacement, frame.velocity, frame.director)
    return {
        name: np.concatenate((_rounded(value), zeros))
        for name, value in zip(_POINT_ARRAYS, values, strict=True)
    }


def _cell_arrays(frame: Frame) -> dict[str, Any]:
    n_quad, n_segment = len(frame.quads), len(frame.cable_segments)
    n_cell = n_quad + n_segment + len(frame.tool_triangles)
    arrays = {
        name: np.zeros((n_cell, *shape), dtype) for name, (dtype, shape) in _CELL_ARRAYS.items()
    }
    cables = slice(n_quad, n_quad + n_segment)
    arrays["part"][cables] = CABLE
    arrays["part"][n_quad + n_segment :] = TOOL
    arrays["membrane stress [MPa]"][:n_quad] = _rounded(frame.quad_stress)
    arrays["largest principal stress [MPa]"][:n_quad] = _rounded(frame.quad_principal[:, 0])
    arrays["smallest principal stress [MPa]"][:n_quad] = _rounded(frame.quad_principal[:, 1])
    arrays["traction [MPa]"][cables] = _rounded(frame.cable_traction)
    arrays["cable state"][cables] = frame.cable_state
    return arrays


def _rounded(values: Floats) -> Any:
    # To nearest, on the bits of the single: half of the last kept bit is added, the rest cut off.
    dropped = 23 - _KEPT_BITS
    bits = values.astype(np.float32).view(np.int32)
    return ((bits + (1 << (dropped - 1))) & -(1 << dropped)).view(np.float32)


def _series(frame: Frame) -> dict[str, float]:
    series = {
        _TIME: frame.time,
        _array_name(frame.coordinate_name, frame.coordinate_unit): frame.coordinate,
    }
    for name, value in frame.scalars.items():
        series[_array_name(name, frame.scalar_units[name])] = value
    return series


def _array_name(name: str, unit: str) -> str:
    return f"{name} [{unit}]".replace("/", " per ")
