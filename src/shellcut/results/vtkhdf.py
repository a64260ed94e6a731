"""Frames of a run in one VTKHDF file: ParaView 5.12 or later opens it and plays the time.

One temporal unstructured grid contains everything, laid out by :mod:`shellcut.results.frame_grid`;
nodes, cables and cracks may come and go from frame to frame. Time, the frame's coordinate and its
scalars are exact field arrays (``time [s]``, ``torque [N*mm]``). A group ``shellcut`` beside the
grid, which VTK ignores, stores further data per frame for reading back: the number of each part,
the tool's rotation and translation, and digests that reveal damage.

Each frame has two digests, 32-bit CRCs (zlib): one of its row (time, coordinate, values, pose,
counts, positions of its arrays, names and units) and one of its arrays. They are computed from the
numbers as a reader gets them, and so cover everything in between: data, shapes of the columns, and
the index of their chunks, which HDF5 itself does not protect.

Offsets in the file (version 2.3 of the format; VTK 9.3.1, 9.5.2 and 9.7.2 read it back, 9.2
silently takes all frames for one):
every dataset is one long column to which frames append, and ``Steps`` gives the start of a frame.
The reader finds a frame in ``Offsets``, which has one entry more than there are cells, at the sum
of the frame's cell offset and its *part* offset. A frame with the same cells as the previous one
re-uses both offsets and adds nothing to ``NumberOf*``; if only one of the two is re-used, later
frames cannot be read. Arrays that grow together have the same offsets: one dataset under several
names (hard links), which saves most of the time per frame. :mod:`shellcut.results.hdf_columns`
grows and packs the columns.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Literal

import h5py
import numpy as np

from shellcut.files.distribution import VERSION
from shellcut.files.hdf_target import HdfTarget
from shellcut.frame import Frame
from shellcut.signals import SignalsDeferred

from .frame_grid import CELL_ARRAYS, POINT_ARRAYS, Arrays, Counts, grid_of, is_history, series_of
from .hdf_columns import Columns, Written

_VERSION = (2, 3)
_TIME = "time [s]"
BESIDE = "shellcut"
"""The group beside VTK's own."""
ENDED = "n_frame"
"""Its attribute with the number of frames; :data:`NOT_ENDED` while a run writes the file."""
NOT_ENDED = -1

# Shared offsets are written under these names; those of the other arrays are links.
_OF_CELLS = "PartOffsets", "NumberOfParts", "CellOffsets", "ConnectivityIdOffsets"
_CELL_DATA_OFFSETS = "CellDataOffsets/part"
_SERIES_OFFSETS = f"FieldDataOffsets/{_TIME}"
_SERIES_SIZES = f"FieldDataSizes/{_TIME}"

DIGESTS = "crc32"
"""Column of the digests of row and arrays, beside VTK's own columns."""

_PLACES = (
    "PartOffsets",
    "NumberOfParts",
    "PointOffsets",
    _CELL_DATA_OFFSETS,
    "CellOffsets",
    "ConnectivityIdOffsets",
    _SERIES_OFFSETS,
    _SERIES_SIZES,
)
"""Columns of ``Steps`` with the positions of a frame's arrays."""

_SIZES = ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
"""Columns with the lengths of the parts."""

_COLUMNS: dict[str, tuple[Any, tuple[int, ...], Written]] = {
    **dict.fromkeys(_SIZES, (np.int64, (), "rows")),
    # Not packed: this column cannot start on a new chunk, see above.
    "Offsets": (np.int64, (), "blocks"),
    "Connectivity": (np.int64, (), "packed"),
    "Types": (np.uint8, (), "packed"),
    "Points": (np.float32, (3,), "packed"),
    "Steps/Values": (np.float64, (), "rows"),
    "Steps/PartOffsets": (np.int64, (), "rows"),
    "Steps/NumberOfParts": (np.int64, (), "rows"),
    "Steps/PointOffsets": (np.int64, (), "rows"),
    f"Steps/{_CELL_DATA_OFFSETS}": (np.int64, (), "rows"),
    "Steps/CellOffsets": (np.int64, (1,), "rows"),
    "Steps/ConnectivityIdOffsets": (np.int64, (1,), "rows"),
    **{f"PointData/{name}": (*kind, "packed") for name, kind in POINT_ARRAYS.items()},
    **{f"CellData/{name}": (*kind, "packed") for name, kind in CELL_ARRAYS.items()},
}
"""Columns of every file: type and shape of a row, and how rows come."""

_BESIDE: dict[str, tuple[Any, tuple[int, ...]]] = {
    "counts": (np.int64, (len(Counts._fields),)),
    "pose": (np.float64, (12,)),
    DIGESTS: (np.uint32, (2,)),
}
"""Type and shape of the rows beside VTK's own."""


class VtkHdfWriter:
    """Append frames to one VTKHDF file.

    Every frame is in the file as a whole or not at all, also if the run is killed or the disk is
    full. Signals are delayed while HDF5, which calls :class:`HdfTarget`,
    is at work: an exception in between would leave its file half open.

    With ``until`` frames are appended to the file of an interrupted run, which this class has
    written: frames later than this are dropped [s], and an unfinished one. Without it a file that
    is there is replaced.
    """

    def __init__(self, path: str | os.PathLike[str], *, until: float | None = None) -> None:
        self.path = Path(path)
        self._series_names: tuple[str, ...] = ()
        self._cells_written: dict[str, Any] = {}  # cells of the last frame, as they are in the file
        self._cells_entry: dict[str, Any] = {}  # their offsets
        self._cells_sizes = [0, 0, 0]  # numbers of points, cells and ids
        self.n_frame = 0
        """Number of frames in the file."""
        how: Literal["r+", "w"] = "w" if until is None else "r+"
        with ExitStack() as on_signal:
            with SignalsDeferred(), ExitStack() as on_error:
                self._target = HdfTarget(self.path, how)
                on_error.callback(self._target.close)
                self._file = h5py.File(self._target, how)
                on_error.callback(self._file.close)
                if until is None:
                    self._create_new()
                else:
                    self._open_again(until)
                on_error.pop_all()
                on_signal.callback(self.close)
            on_signal.pop_all()

    def append(self, frame: Frame) -> None:
        """Write one frame and flush it.

        Its scalars and history numbers are those of the first frame, its time is later than that of
        the last one. After an OSError, as of a full disk, the earlier frames stay in the file, and
        no more can be added.
        """
        self._target.check()
        with SignalsDeferred():
            counts, points, cells, of_points, of_cells = grid_of(frame)
            if not self._series_names:
                self._begin(frame, tuple(series_of(frame)), {*filter(is_history, of_cells)})
            entry = self._append_cells(cells, len(points))
            written = dict(self._cells_written)
            entry["PointOffsets"] = point = self._columns.end("Points")
            written["Points"] = self._columns.write("Points", point, points)
            entry[_CELL_DATA_OFFSETS] = cell = self._columns.end("CellData/part")
            for of, at, arrays in (("Point", point, of_points), ("Cell", cell, of_cells)):
                for name, rows in arrays.items():
                    written[name] = self._columns.write(f"{of}Data/{name}", at, rows)
            self._append_row(frame, counts, entry, digest_of_arrays(written))
            self._count(self.n_frame + 1)

    def sync(self) -> None:
        """Wait until all frames are on the disk."""
        self._target.sync()

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        with SignalsDeferred():
            try:
                if self._file:  # the number of frames is now final
                    self._file[BESIDE].attrs.modify(ENDED, np.int64(self.n_frame))  # in place
            finally:
                self._file.close()
                self._target.close()

    def _append_row(
        self, frame: Frame, counts: Counts, entry: dict[str, Any], of_arrays: int
    ) -> None:
        k, series = self.n_frame, series_of(frame)
        entry[_SERIES_OFFSETS] = k
        entry[_SERIES_SIZES] = (1, 1)  # components, tuples
        for name, value in series.items():
            self._columns.write(f"FieldData/{name}", k, np.array([value]))
        for name, value in {**entry, "Values": frame.time}.items():
            self._columns.write(f"Steps/{name}", k, np.array([value]))
        self._beside.write("counts", k, np.array([counts]))
        pose = np.concatenate((frame.tool_rotation.ravel(), frame.tool_translation))
        self._beside.write("pose", k, pose[None])
        places = np.hstack([counts, *(entry[name] for name in _PLACES), self._cells_sizes])
        numbers = [frame.time, *(series[name] for name in sorted(series)), *pose.tolist()]
        of_row = _digest_of_row(
            _described(self._file[BESIDE].attrs, self._series_names), numbers, places.tolist()
        )
        self._beside.write(DIGESTS, k, np.array([(of_row, of_arrays)]))

    def _append_cells(self, cells: Arrays, n_point: int) -> dict[str, Any]:
        if n_point == self._cells_sizes[0] and all(
            np.array_equal(rows, self._cells_written[name]) for name, rows in cells.items()
        ):
            return dict(self._cells_entry)
        part = self._columns.end("NumberOfPoints")
        cell = self._columns.end("Types")
        first_id = self._columns.end("Connectivity")
        self._cells_sizes = [n_point, len(cells["Types"]), len(cells["Connectivity"])]
        for name, size in zip(_SIZES, self._cells_sizes, strict=True):
            self._columns.write(name, part, np.array([size]))
        begins = {"Types": cell, "Offsets": cell + part, "Connectivity": first_id}
        self._cells_written = {
            name: self._columns.write(name, begins[name], rows) for name, rows in cells.items()
        }
        places = part, 1, (cell,), (first_id,)
        self._cells_entry = dict(zip(_OF_CELLS, places, strict=True))
        return dict(self._cells_entry)

    def _count(self, n_frame: int) -> None:
        self._root["Steps"].attrs["NSteps"] = n_frame
        self._file.flush()
        self._target.keep()
        self.n_frame = n_frame

    def _create_new(self) -> None:
        self._root = self._file.create_group("VTKHDF")
        self._root.attrs["Version"] = np.array(_VERSION)
        # VTK needs ASCII of fixed length here, which h5py does not write by default.
        kind = b"UnstructuredGrid"
        self._root.attrs.create("Type", kind, dtype=h5py.string_dtype("ascii", len(kind)))
        self._columns = Columns(self._root)
        self._beside = Columns(self._file.create_group(BESIDE))
        self._file[BESIDE].attrs["version"] = VERSION
        self._file[BESIDE].attrs[ENDED] = np.int64(NOT_ENDED)
        for name, (dtype, shape) in _BESIDE.items():
            self._beside.create(name, dtype, shape)
        for name, (dtype, shape, written) in _COLUMNS.items():
            self._columns.create(name, dtype, shape, written)
        for name in POINT_ARRAYS:
            self._columns.link(f"Steps/PointDataOffsets/{name}", "Steps/PointOffsets")
        for name in CELL_ARRAYS:
            offsets = f"Steps/{_CELL_DATA_OFFSETS}"
            self._columns.link(f"Steps/CellDataOffsets/{name}", offsets)
        self._count(0)

    def _begin(self, frame: Frame, series_names: tuple[str, ...], of_material: set[str]) -> None:
        """Create the columns that depend on the model, by its first frame."""
        create, link = self._columns.create, self._columns.link
        begun = filter(is_history, self._root["CellData"])  # by a run that was killed
        for name in sorted(of_material - {*begun}):
            create(f"CellData/{name}", np.float32, written="packed")
            link(f"Steps/CellDataOffsets/{name}", f"Steps/{_CELL_DATA_OFFSETS}")
        create(f"Steps/{_SERIES_OFFSETS}", np.int64)
        create(f"Steps/{_SERIES_SIZES}", np.int64, (2,))
        for name in series_names:
            create(f"FieldData/{name}", np.float64)
            link(f"Steps/FieldDataOffsets/{name}", f"Steps/{_SERIES_OFFSETS}")
            link(f"Steps/FieldDataSizes/{name}", f"Steps/{_SERIES_SIZES}")
        self._series_names = series_names
        self._file[BESIDE].attrs.update(
            coordinate=[frame.coordinate_name, frame.coordinate_unit],
            scalar_names=list(frame.scalars),
            scalar_units=[frame.scalar_units[name] for name in frame.scalars],
        )

    def _open_again(self, until: float) -> None:
        """Drop all after this time [s] and after the last whole frame."""
        if not is_ours(self._file) or not all(n in self._file["VTKHDF"] for n in _COLUMNS):
            raise ValueError(
                f"{self.path} was not written by shellcut, or by an older version; move it "
                "away or start anew"
            )
        self._root = self._file["VTKHDF"]
        self._columns = columns = Columns(self._root)
        self._beside = Columns(self._file[BESIDE])
        self._series_names = tuple(self._root.get("FieldData", ()))
        n_frame = int(self._root["Steps"].attrs["NSteps"])  # a killed run may have begun another
        n_frame = int(np.searchsorted(columns["Steps/Values"][:n_frame], until, side="right"))
        if damaged_row(self._root, self._file[BESIDE], n_frame) is not None:
            raise ValueError(f"{self.path} is damaged; start anew")
        last = columns["Steps/Values"][n_frame - 1] if n_frame else -np.inf
        if last < until < np.inf:  # as after a power cut, or when an older copy has been put there
            end = f"ends at {last:.6g} s" if n_frame else "is empty"
            raise ValueError(
                f"{self.path} must reach to the checkpoint, that is to {until:.6g} s, but {end}; "
                "run it from the beginning"
            )
        self._file[BESIDE].attrs.modify(ENDED, np.int64(NOT_ENDED))
        # Frames may share cells but never return to older ones: the last frame kept marks the end.
        n_part = n_point = n_cell = n_id = n_cell_row = 0
        if n_frame:
            k = n_frame - 1
            # The next frame may share the cells, as it does in a run that nothing interrupts.
            self._cells_entry = {name: columns[f"Steps/{name}"][k] for name in _OF_CELLS}
            part, _, (cell,), (first_id,) = self._cells_entry.values()
            n_part, self._cells_sizes = part + 1, [columns[name][part] for name in _SIZES]
            n_point = columns["Steps/PointOffsets"][k] + self._cells_sizes[0]
            n_cell, n_id = cell + self._cells_sizes[1], first_id + self._cells_sizes[2]
            n_cell_row = columns[f"Steps/{_CELL_DATA_OFFSETS}"][k] + self._cells_sizes[1]
            self._cells_written = {
                "Types": columns["Types"][cell:n_cell],
                "Offsets": columns["Offsets"][cell + part : n_cell + n_part],
                "Connectivity": columns["Connectivity"][first_id:n_id],
            }
        ends = {
            **dict.fromkeys(_SIZES, n_part),
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


def is_ours(file: Any) -> bool:
    """Whether an open file was written by this class; an older one may lack some arrays."""
    needed = ["VTKHDF/Steps", "VTKHDF/CellData/part", *(f"{BESIDE}/{name}" for name in _BESIDE)]
    return all(name in file for name in needed)


# --- digests -------------------------------------------------------------------------------------


def digest_of_arrays(arrays: Mapping[str, Any]) -> int:
    """Return the digest of named arrays, in any order; their types are included."""
    crc = 0
    for name in sorted(arrays):
        rows = np.ascontiguousarray(arrays[name])
        crc = zlib.crc32(f"{name}{rows.dtype.str}{rows.shape}".encode(), crc)
        crc = zlib.crc32(rows.reshape(-1).view(np.uint8).data, crc)
    return crc


def _digest_of_row(description: str, numbers: Iterable[float], places: Iterable[int]) -> int:
    """Return the digest of a frame's row, of its :func:`_described` names and units.

    The numbers are time, the series in the order of their names, pose; the places are the counts,
    then the values of :data:`_PLACES` and :data:`_SIZES`.
    """
    crc = zlib.crc32(description.encode())
    crc = zlib.crc32(np.array([*numbers], "<f8").tobytes(), crc)
    return zlib.crc32(np.array([*places], "<i8").tobytes(), crc)


def _described(attributes: Mapping[str, Any], series_names: Iterable[str]) -> str:
    """Return version, names and units of a result file as one text, from its attributes."""
    texts = [str(attributes["version"])]
    for name in ("coordinate", "scalar_names", "scalar_units"):
        texts += [name, *map(str, attributes[name])]
    return "\n".join([*texts, *sorted(series_names)])


def damaged_row(root: Any, beside: Any, n_frame: int) -> int | None:
    """Return the first of the frames whose row has changed since it was written, None if none.

    ``root`` and ``beside`` are VTK's group of the file and the library's own.
    """
    if not n_frame:
        return None
    steps, series = root["Steps"], root["FieldData"]
    description = _described(beside.attrs, series)

    def rows(column: Any) -> Any:
        return column[:n_frame].reshape(n_frame, -1)

    part = rows(steps["PartOffsets"])[:, 0]
    sizes = [root[name][()][part][:, None] for name in _SIZES]
    places = [rows(beside["counts"]), *(rows(steps[name]) for name in _PLACES), *sizes]
    numbers = [rows(steps["Values"]), *(rows(series[name]) for name in sorted(series))]
    table = np.concatenate([*numbers, rows(beside["pose"])], axis=1)
    where = np.concatenate(places, axis=1)
    rows_of_both = zip(table.tolist(), where.tolist(), strict=True)
    now = np.array([_digest_of_row(description, *row) for row in rows_of_both], np.uint32)
    wrong = np.flatnonzero(beside[DIGESTS][:n_frame, 0] != now)
    return int(wrong[0]) if wrong.size else None
