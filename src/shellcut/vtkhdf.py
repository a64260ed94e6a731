"""Frames of a run in one VTKHDF file: ParaView 5.12 or later opens it and plays the time.

One temporal unstructured grid holds everything, as :mod:`shellcut.frame_grid` lays it out; nodes,
cables and cracks may come and go from frame to frame. Time, the frame's coordinate and its scalars
are field arrays (``time [s]``, ``torque [N*mm]``), exact. Beside the grid a group ``shellcut``, of
no interest to VTK, keeps per frame what reading back needs besides: how many of each part there
are, and the tool's rotation and translation.

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
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal, TypeVar

import h5py
import numpy as np

from .frame import Floats, Frame
from .frame_grid import (
    CELL_ARRAYS,
    POINT_ARRAYS,
    Counts,
    FrameGrid,
    array_name,
    frame_of,
    grid_of,
    series_of,
)
from .growing_file import GrowingFile
from .hdf_columns import Columns

_VERSION = (2, 3)
_TIME = "time [s]"
_BESIDE = "shellcut"  # the group beside VTK's own

# The names under which shared offsets are written; the other arrays' are links to them.
_CELL_DATA_OFFSETS = "CellDataOffsets/part"
_SERIES_OFFSETS = f"FieldDataOffsets/{_TIME}"
_SERIES_SIZES = f"FieldDataSizes/{_TIME}"

# A file is read while its run goes on writing: it must not have changed meanwhile, as told by its
# time stamp, which the system counts in ticks of up to 10 ms.
_TICK_S = 0.02
_MOST_TRIES = 250


_Value = TypeVar("_Value")


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

    @property
    def last_time(self) -> float:
        """Time of the last frame [s]; minus infinity without one."""
        return self._last_time

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
        series = series_of(frame)
        if not self._series_names:
            self._create_series(tuple(series))
            self._describe(frame)
        elif set(series) != set(self._series_names):
            raise ValueError(
                f"every frame must have the scalars {sorted(self._series_names)}, "
                f"got {sorted(series)}"
            )

        grid = grid_of(frame)
        entry = self._append_cells(grid)
        point = self._columns.end("Points")
        entry["PointOffsets"] = point
        self._columns.write("Points", point, grid.points, noise=True)
        for name, rows in grid.point_arrays.items():
            self._columns.write(f"PointData/{name}", point, rows)
        cell = self._columns.end("CellData/part")
        entry[_CELL_DATA_OFFSETS] = cell
        for name, rows in grid.cell_arrays.items():
            self._columns.write(f"CellData/{name}", cell, rows)
        entry[_SERIES_OFFSETS] = self._n_frame
        entry[_SERIES_SIZES] = (1, 1)  # components, tuples
        for name, value in series.items():
            self._columns.write(f"FieldData/{name}", self._n_frame, np.array([value]))
        entry["Values"] = frame.time
        for name, value in entry.items():
            self._columns.write(f"Steps/{name}", self._n_frame, np.array([value]))
        self._beside.write("counts", self._n_frame, np.array([grid.counts]))
        pose = np.concatenate((frame.tool_rotation.ravel(), frame.tool_translation))
        self._beside.write("pose", self._n_frame, pose[None])
        # The frame counts only once all of it is in the file.
        self._file.flush()
        self._count(self._n_frame + 1)
        self._last_time = frame.time

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._file.close()

    def _append_cells(self, grid: FrameGrid) -> dict[str, Any]:
        connectivity, types, n_point = grid.connectivity, grid.types, len(grid.points)
        if self._cells is not None:
            old_connectivity, old_types, old_n_point = self._cells
            if (
                n_point == old_n_point
                and np.array_equal(types, old_types)
                and np.array_equal(connectivity, old_connectivity)
            ):
                return dict(self._cells_entry)
        part = self._columns.end("NumberOfPoints")
        cell = self._columns.end("Types")
        first_id = self._columns.end("Connectivity")
        self._columns.write("NumberOfPoints", part, np.array([n_point]))
        self._columns.write("NumberOfCells", part, np.array([len(types)]))
        self._columns.write("NumberOfConnectivityIds", part, np.array([len(connectivity)]))
        self._columns.write("Types", cell, types)
        self._columns.write("Offsets", cell + part, np.concatenate(([0], np.cumsum(grid.sizes))))
        self._columns.write("Connectivity", first_id, connectivity)
        self._cells_entry = {
            "PartOffsets": part,
            "NumberOfParts": 1,
            "CellOffsets": (cell,),
            "ConnectivityIdOffsets": (first_id,),
        }
        self._cells = connectivity, types, n_point
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
        self._beside = Columns(self._file.create_group(_BESIDE))
        self._file[_BESIDE].attrs["version"] = version("shellcut")
        self._beside.create("counts", np.int64, (len(Counts._fields),))
        self._beside.create("pose", np.float64, (12,))
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
        for name, (dtype, shape) in POINT_ARRAYS.items():
            create(f"PointData/{name}", dtype, shape, packed=True)
            self._columns.link(f"Steps/PointDataOffsets/{name}", "Steps/PointOffsets")
        for name, (dtype, shape) in CELL_ARRAYS.items():
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

    def _describe(self, frame: Frame) -> None:
        self._file[_BESIDE].attrs.update(
            coordinate=[frame.coordinate_name, frame.coordinate_unit],
            scalar_names=list(frame.scalars),
            scalar_units=[frame.scalar_units[name] for name in frame.scalars],
        )

    def _open_old(self) -> None:
        if not _is_ours(self._file):
            self._file.close()
            raise ValueError(
                f"{self.path} was not written by shellcut; move it away or begin anew with mode 'w'"
            )
        self._root = self._file["VTKHDF"]
        self._columns = Columns(self._root)
        self._beside = Columns(self._file[_BESIDE])
        self._series_names = tuple(self._root.get("FieldData", ()))

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
        for name in self._beside:
            self._beside.cut(name, n_frame)
        self._count(n_frame)


class VtkHdfReader:
    """Read the frames of a file, also of a killed run and of one that is still writing it.

    What is in the file when it is opened here is read; frames that come later are not seen.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    FileNotFoundError
        If it is not there.
    ValueError
        If it was not written by :class:`VtkHdfWriter`.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self.times: Floats = np.zeros(0)
        """Time of every frame, shape (n_frame,), [s]."""
        self.coordinates: Floats = np.zeros(0)
        """Coordinate of every frame, shape (n_frame,), in ``coordinate_unit``."""
        self.coordinate_name = self.coordinate_unit = ""
        self._scalar_units: dict[str, str] = {}
        self._settled(self._read_steps)

    @property
    def n_frame(self) -> int:
        """Number of complete frames."""
        return len(self.times)

    def frame(self, k: int) -> Frame:
        """Return frame ``k``, counted from 0, or from -1 backwards from the end.

        It is the frame that was written: points in single precision, other floating-point arrays
        of 12 bits, ``reference`` (points minus displacement) accordingly, scalars exact.

        Raises
        ------
        IndexError
            If there is no such frame.
        """
        k = self._index(k)
        return self._settled(lambda file: self._read_frame(file, k))

    def pose(self, k: int) -> tuple[Floats, Floats] | None:
        """Return rotation (3, 3) and translation (3,) [mm] of the tool at frame ``k``, exact.

        None if the frame has no tool.

        Raises
        ------
        IndexError
            If there is no such frame.
        """
        k = self._index(k)

        def read(file: Any) -> tuple[Any, Any]:
            return Counts(*file[_BESIDE]["counts"][k].tolist()), file[_BESIDE]["pose"][k]

        counts, row = self._settled(read)
        return (row[:9].reshape(3, 3), row[9:]) if counts.vertex else None

    def _index(self, k: int) -> int:
        if not -self.n_frame <= k < self.n_frame:
            there = f"0 to {self.n_frame - 1}" if self.n_frame else "none yet"
            raise IndexError(f"frame must be one of those in {self.path}, {there}, got {k}")
        return k % self.n_frame

    def _settled(self, read: Callable[[Any], _Value]) -> _Value:
        """Return what ``read`` finds in the open file, none of it half written."""
        for _ in range(_MOST_TRIES):
            before = self.path.stat()
            if time.time() - before.st_mtime < _TICK_S:
                time.sleep(_TICK_S)
                before = self.path.stat()
            failed: Exception | None = None
            try:
                with _opened(self.path) as file:
                    value = read(file)
            except (OSError, KeyError, RuntimeError) as error:
                failed = error
            after = self.path.stat()
            if (before.st_mtime_ns, before.st_size) == (after.st_mtime_ns, after.st_size):
                if failed is not None:
                    raise ValueError(
                        f"{self.path} must be a result file of shellcut, and whole; HDF5 says: "
                        f"{failed}"
                    ) from failed
                return value
        raise ValueError(f"{self.path} is being written without a pause; read it again later")

    def _read_steps(self, file: Any) -> None:
        if not _is_ours(file):
            raise ValueError(f"{self.path} was not written by shellcut, or by an older version")
        steps, beside = file["VTKHDF/Steps"], file[_BESIDE].attrs
        n_frame = int(steps.attrs["NSteps"])
        self.times = steps["Values"][:n_frame]
        if n_frame:
            self.coordinate_name, self.coordinate_unit = beside["coordinate"]
            self._scalar_units = dict(
                zip(beside["scalar_names"], beside["scalar_units"], strict=True)
            )
            name = array_name(self.coordinate_name, self.coordinate_unit)
            self.coordinates = file[f"VTKHDF/FieldData/{name}"][:n_frame]

    def _read_frame(self, file: Any, k: int) -> Frame:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        counts = Counts(*file[_BESIDE]["counts"][k].tolist())
        part = int(steps["PartOffsets"][k])

        def rows(column: Any, begin: Any, count: int) -> Any:
            return column[int(begin) : int(begin) + count]

        first_id, n_id = steps["ConnectivityIdOffsets"][k, 0], root["NumberOfConnectivityIds"][part]
        point, n_point = steps["PointOffsets"][k], counts.points[-1]
        arrays = {name: rows(root["PointData"][name], point, n_point) for name in POINT_ARRAYS} | {
            name: rows(root["CellData"][name], steps[_CELL_DATA_OFFSETS][k], counts.cells[-1])
            for name in CELL_ARRAYS
        }
        pose = file[_BESIDE]["pose"][k]
        scalars = {
            name: float(root[f"FieldData/{array_name(name, unit)}"][k])
            for name, unit in self._scalar_units.items()
        }
        return frame_of(
            counts,
            rows(root["Points"], point, n_point),
            rows(root["Connectivity"], first_id, int(n_id)),
            arrays,
            time=float(self.times[k]),
            coordinate=float(self.coordinates[k]),
            coordinate_name=self.coordinate_name,
            coordinate_unit=self.coordinate_unit,
            tool_rotation=pose[:9].reshape(3, 3),
            tool_translation=pose[9:],
            scalars=scalars,
            scalar_units=self._scalar_units,
        )


def _opened(path: Path) -> Any:
    try:
        # Without a lock: the run that writes the file holds one.
        return h5py.File(path, "r", locking=False)
    except OSError:
        # That run may be of this very process, in which HDF5 wants a file opened alike each time.
        return h5py.File(path, "r")


def _is_ours(file: Any) -> bool:
    wanted = [f"VTKHDF/CellData/{name}" for name in CELL_ARRAYS]
    return all(name in file for name in ("VTKHDF/Steps", f"{_BESIDE}/counts", *wanted))
