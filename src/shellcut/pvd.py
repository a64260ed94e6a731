"""Frames of a run as PVD + VTU, for ParaView before 5.12 and other readers of VTK's XML files.

``NAME.pvd`` lists the frames with their times, ``NAME_frames/frame_0000.vtu`` and so on hold them,
points, cells and arrays as :mod:`shellcut.frame_grid` lays them out; a frame's scalars are not in
them. Each file is written aside and renamed, the list after the frame, so that a killed run leaves
a list of whole frames.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

from .frame import Frame
from .frame_grid import FrameGrid, grid_of
from .growing_file import GrowingFile

_ROOT = {"type": "Collection", "version": "0.1", "byte_order": "LittleEndian"}


class PvdWriter(GrowingFile):
    """Append frames to a PVD file and the folder beside it.

    Parameters
    ----------
    path : str or Path
        The list, ``NAME.pvd``; frames go to ``NAME_frames``.
    mode, until
        As :class:`GrowingFile`, ``until`` in s.

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
    ) -> None:
        super().__init__(path, mode=mode, until=until)
        self._folder = self.path.with_name(f"{self.path.stem}_frames")
        self._folder.mkdir(parents=True, exist_ok=True)
        self._times = self._old_times(until) if self.goes_on else []
        for file in self._folder.glob("frame_*.vtu*"):
            if file.name not in map(_file_name, range(len(self._times))):
                file.unlink()
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
        aside = path.with_name(f"{path.name}.part")
        _mesh_of(grid_of(frame)).write(aside, file_format="vtu")
        aside.replace(path)
        self._times.append(frame.time)
        self._write_list()

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
        aside = self.path.with_name(f"{self.path.name}.part")
        ElementTree.ElementTree(root).write(aside, encoding="utf-8", xml_declaration=True)
        aside.replace(self.path)

    def _old_times(self, until: float | None) -> list[float]:
        try:
            rows = ElementTree.parse(self.path).getroot().findall("Collection/DataSet")
            listed = [(float(row.attrib["timestep"]), Path(row.attrib["file"])) for row in rows]
        except (ElementTree.ParseError, KeyError, ValueError) as error:
            raise ValueError(self._foreign()) from error
        if [file.as_posix() for _, file in listed] != [
            f"{self._folder.name}/{_file_name(k)}" for k in range(len(listed))
        ]:
            raise ValueError(self._foreign())
        return [time for time, _ in listed if until is None or time <= until]

    def _foreign(self) -> str:
        return f"{self.path} was not written by shellcut; move it away or begin anew with mode 'w'"


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
