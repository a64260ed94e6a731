"""Frames of a run as PVD + VTU, for ParaView before 5.12 and other readers of VTK's XML files.

``NAME.pvd`` lists the frames with their times, ``NAME_frames/frame_0000.vtu`` and so on hold them,
points, cells and arrays as :mod:`shellcut.results.frame_grid` lays them out; a frame's scalars are
not in them. Each file is written aside and renamed, the list after the frame, so that a killed run
leaves a list of whole frames.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

from shellcut.files.appendable_file import GrowingFile
from shellcut.files.whole_file import written_whole
from shellcut.frame import Frame

from .frame_grid import FrameGrid, grid_of

_ROOT = {"type": "Collection", "version": "0.1", "byte_order": "LittleEndian"}


class PvdWriter(GrowingFile):
    """Append frames to a PVD file and the folder beside it.

    Parameters
    ----------
    path : str or Path
        The list, ``NAME.pvd``; frames go to ``NAME_frames``.
    mode, until
        As :class:`GrowingFile`, ``until`` in s. Of the frames there those are removed that the old
        list names and the new one does not.
    announce : callable, optional
        Given the path of each frame before it is written.

    Raises
    ------
    ValueError
        If the file of mode ``"a"`` is no list of this class.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        mode: Literal["w", "a"] = "w",
        until: float | None = None,
        announce: Callable[[Path], None] = lambda _: None,
    ) -> None:
        super().__init__(path, mode=mode, until=until)
        self._folder = self.path.with_name(f"{self.path.stem}_frames")
        self._announce = announce
        listed = self._listed_times()
        self._times = [time for time in listed if self.goes_on and (until is None or time <= until)]
        self._folder.mkdir(parents=True, exist_ok=True)
        for k in range(len(self._times), len(listed)):
            (self._folder / _file_name(k)).unlink(missing_ok=True)
        self._write_list()

    @property
    def n_frame(self) -> int:
        """Number of frames in the list."""
        return len(self._times)

    def append(self, frame: Frame) -> None:
        """Write one frame, then the list.

        Raises
        ------
        ValueError
            If its time is not later than that of the last.
        """
        if self._times and frame.time <= self._times[-1]:
            raise ValueError(
                f"frames must be appended in order of time, got {frame.time} s after "
                f"{self._times[-1]} s"
            )
        path = self._folder / _file_name(self.n_frame)
        self._announce(path)
        with written_whole(path) as aside:
            _mesh_of(grid_of(frame)).write(aside, file_format="vtu")
        self._times.append(frame.time)
        self._write_list()

    def sync(self) -> None:
        """Do nothing: what a power cut takes of these can be made again from the result file."""

    def close(self) -> None:
        """Do nothing: between two frames no file is open."""

    def _write_list(self) -> None:
        root = ElementTree.Element("VTKFile", _ROOT)
        collection = ElementTree.SubElement(root, "Collection")
        for k, time in enumerate(self._times):
            file = f"{self._folder.name}/{_file_name(k)}"
            row = {"timestep": repr(float(time)), "part": "0", "file": file}
            ElementTree.SubElement(collection, "DataSet", row)
        ElementTree.indent(root)
        with written_whole(self.path) as aside:
            ElementTree.ElementTree(root).write(aside, encoding="utf-8", xml_declaration=True)

    def _listed_times(self) -> list[float]:
        """Return the times that the old list gives; none without one that is to be replaced."""
        try:
            rows = ElementTree.parse(self.path).getroot().findall("Collection/DataSet")
            files = [row.attrib["file"] for row in rows]
            if files != [f"{self._folder.name}/{_file_name(k)}" for k in range(len(files))]:
                raise ValueError("other files are listed")
            return [float(row.attrib["timestep"]) for row in rows]
        except FileNotFoundError:
            return []
        except (ElementTree.ParseError, KeyError, ValueError) as error:
            if not self.goes_on:
                return []
            raise ValueError(
                f"{self.path} was not written by shellcut; move it away or begin anew with mode 'w'"
            ) from error


def _file_name(k: int) -> str:
    return f"frame_{k:04d}.vtu"


def _mesh_of(grid: FrameGrid) -> Any:
    import meshio

    # One block of cells a part, the names as meshio calls the types.
    kinds = (("quad", 4), ("line", 2), ("triangle", 3), ("line", 2), ("line", 2))
    blocks, rows, first, first_id = [], [], 0, 0
    for (kind, size), end in zip(kinds, grid.counts.cells, strict=True):
        if end > first:
            ids = grid.connectivity[first_id : first_id + size * (end - first)]
            blocks.append((kind, ids.reshape(-1, size)))
            rows.append(slice(first, end))
            first_id += ids.size
        first = end
    return meshio.Mesh(
        grid.points,
        blocks,
        point_data=dict(grid.point_arrays),
        cell_data={name: [a[some] for some in rows] for name, a in grid.cell_arrays.items()},
    )
