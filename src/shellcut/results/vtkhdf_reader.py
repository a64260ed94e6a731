"""Read the frames of a result file, comparing every number with the stored digests.

A file that differs in a single bit is refused, with the number of the damaged frame.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np

from shellcut.arrays import Floats
from shellcut.files.hdf_target import HdfTarget
from shellcut.files.regular_file import require_regular
from shellcut.frame import Frame
from shellcut.tool.pose import Pose

from .frame_grid import CELL_ARRAYS, POINT_ARRAYS, Counts, array_name, frame_of, is_history
from .vtkhdf import BESIDE, DIGESTS, ENDED, NOT_ENDED, damaged_row, digest_of_arrays, is_ours

# A file may be read while its run writes: what is read then may be half old and half new, as its
# digests tell. It is read again, so often at most, until it has not been written to for a while.
_TICK_S, _HELD_UP_S = 0.02, 1.0
_MOST_TRIES = 250

_Value = TypeVar("_Value")


class ResultFileError(ValueError):
    """The file is no result of shellcut, or is damaged; the message says which."""


class VtkHdfReader:
    """Read the frames of a file, also of a killed run or one still writing it.

    It reads the file as it is now; later frames are not seen. Raises ResultFileError if it was not
    written by :class:`VtkHdfWriter`, or its times, values or poses have changed since.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).absolute()
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
        """Return frame ``k``, counted from 0, or backwards from -1 at the end.

        The values are those written: points in single precision, other floating-point arrays of 12
        bits, ``reference`` (points minus displacement) accordingly, scalars exact. Raises
        ResultFileError if they have changed since.
        """
        k = self._index(k)
        return self._settled(lambda file: self._read_frame(file, k))

    def pose(self, k: int) -> Pose | None:
        """Return the exact pose of the tool at frame ``k``, None if the frame has no tool."""
        k = self._index(k)
        counts, row = self._settled(
            lambda file: (Counts(*file[BESIDE]["counts"][k].tolist()), file[BESIDE]["pose"][k])
        )
        return Pose(row[:9].reshape(3, 3), row[9:]) if counts.vertex else None

    def _index(self, k: int) -> int:
        if not -self.n_frame <= k < self.n_frame:
            there = f"0 to {self.n_frame - 1}" if self.n_frame else "none yet"
            raise IndexError(f"frame must be one of those in {self.path}, {there}, got {k}")
        return k % self.n_frame

    def _settled(self, read: Callable[[Any], _Value]) -> _Value:
        """Return the result of ``read`` on the open file, never of a partly written one."""
        require_regular(self.path)
        for _ in range(_MOST_TRIES):
            try:
                # Not by HDF5's own file, which locks it and may have it open here.
                with closing(HdfTarget(self.path, "r")) as raw, h5py.File(raw, "r") as file:
                    return read(file)
            except Exception as error:  # whatever HDF5 makes of damage: sizes, types, names
                failed = error
            if time.time() - self.path.stat().st_mtime >= _HELD_UP_S:
                break
            time.sleep(_TICK_S)
        else:
            raise ResultFileError(f"{self.path} is being written continuously; read it again later")
        if isinstance(failed, ResultFileError):
            raise failed
        raise ResultFileError(
            f"{self.path} must be a complete result file of shellcut; HDF5 says: {failed}"
        ) from failed

    def _read_steps(self, file: Any) -> None:
        if not is_ours(file):
            raise ResultFileError(
                f"{self.path} was not written by shellcut, or by an older version"
            )
        steps, beside = file["VTKHDF/Steps"], file[BESIDE].attrs
        n_frame, n_row = int(steps.attrs["NSteps"]), len(steps["Values"])
        # A killed run may have begun one frame more than it has counted.
        ended = int(beside[ENDED])
        if ended not in (n_frame, NOT_ENDED) or not n_frame <= n_row <= n_frame + 1:
            raise ResultFileError(
                f"{self.path} is damaged: it counts {n_frame} frames and has {n_row}"
            )
        if (k := damaged_row(file["VTKHDF"], file[BESIDE], n_frame)) is not None:
            raise ResultFileError(
                f"{self.path} is damaged: time, values or pose of frame {k} are not what was "
                "written"
            )
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
        counts = Counts(*file[BESIDE]["counts"][k].tolist())
        part = int(steps["PartOffsets"][k])

        def rows(column: Any, begin: Any, count: int) -> Any:
            return column[int(begin) : int(begin) + count]

        first_id, n_id = steps["ConnectivityIdOffsets"][k, 0], root["NumberOfConnectivityIds"][part]
        point, n_point = steps["PointOffsets"][k], counts.points[-1]
        cell, n_cell = steps["CellOffsets"][k, 0], counts.cells[-1]
        data = steps["CellDataOffsets/part"][k]
        on_points, on_cells = root["PointData"], root["CellData"]
        of_material = filter(is_history, on_cells)
        # Older files lack the fields added later.
        arrays = {n: rows(on_points[n], point, n_point) for n in POINT_ARRAYS if n in on_points}
        arrays |= {
            n: rows(on_cells[n], data, n_cell)
            for n in (*CELL_ARRAYS, *of_material)
            if n in on_cells
        }
        grid = {
            "Points": rows(root["Points"], point, n_point),
            "Connectivity": rows(root["Connectivity"], first_id, int(n_id)),
            "Types": rows(root["Types"], cell, n_cell),
            "Offsets": rows(root["Offsets"], int(cell) + part, n_cell + 1),
        }
        if digest_of_arrays(grid | arrays) != int(file[BESIDE][DIGESTS][k, 1]):
            raise ResultFileError(
                f"{self.path} is damaged: the arrays of frame {k} are not what was written"
            )
        pose = file[BESIDE]["pose"][k]
        scalars = {
            name: float(root[f"FieldData/{array_name(name, unit)}"][k])
            for name, unit in self._scalar_units.items()
        }
        return frame_of(
            counts,
            grid,
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
