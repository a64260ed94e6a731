"""Frames of a run as PVD + VTU, for ParaView before 5.12 and other readers of VTK's XML files.

``NAME.pvd`` lists the frames with their times; ``NAME_frames/frame_0000.vtu`` and so on contain
points, cells and arrays as laid out by :mod:`shellcut.results.frame_grid`, without the frame's
scalars. Each file is written under a temporary name and renamed, the list after the frame, so that
a killed run leaves a list of complete frames.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

import numpy as np

from shellcut.files.appendable_file import AppendableFile
from shellcut.files.whole_file import atomic_write, unfinished
from shellcut.frame import Frame

from .frame_grid import LINE, POLYGON, QUAD, TRIANGLE, FrameGrid, grid_of

_ROOT = {"type": "Collection", "version": "0.1", "byte_order": "LittleEndian"}


class PvdWriter(AppendableFile):
    """Append frames to a PVD file and the folder beside it.

    Parameters
    ----------
    path : str or Path
        The list, ``NAME.pvd``; frames go to ``NAME_frames``.
    mode, until
        As in :class:`AppendableFile`, ``until`` in s. Frames named in the old list but not in the
        new one are removed.
    announce : callable, optional
        Receives the path of each frame before it is written.

    Raises
    ------
    ValueError
        If the file of mode ``"a"`` is not a list of this class.
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
        self._times = [
            time for time in listed if self.appending and (until is None or time <= until)
        ]
        self._folder.mkdir(parents=True, exist_ok=True)
        later = [self._folder / _file_name(k) for k in range(len(self._times), len(listed))]
        of_killed = unfinished(self._folder / _file_name(len(listed)))
        for path in (*later, *of_killed):
            path.unlink(missing_ok=True)
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
            If its time is not later than that of the last frame.
        """
        if self._times and frame.time <= self._times[-1]:
            raise ValueError(
                f"frames must be appended in order of time, got {frame.time} s after "
                f"{self._times[-1]} s"
            )
        path = self._folder / _file_name(self.n_frame)
        self._announce(path)
        with atomic_write(path) as temporary:
            _mesh_of(grid_of(frame)).write(temporary, file_format="vtu")
        self._times.append(frame.time)
        self._write_list()

    def sync(self) -> None:
        """Do nothing: the result file can restore whatever a power cut destroys here."""

    def close(self) -> None:
        """Do nothing: no file is open between two frames."""

    def _write_list(self) -> None:
        root = ElementTree.Element("VTKFile", _ROOT)
        collection = ElementTree.SubElement(root, "Collection")
        for k, time in enumerate(self._times):
            file = f"{self._folder.name}/{_file_name(k)}"
            row = {"timestep": repr(float(time)), "part": "0", "file": file}
            ElementTree.SubElement(collection, "DataSet", row)
        ElementTree.indent(root)
        with atomic_write(self.path) as temporary:
            ElementTree.ElementTree(root).write(temporary, encoding="utf-8", xml_declaration=True)

    def _listed_times(self) -> list[float]:
        """Return the times in the old list; empty if it is to be replaced."""
        try:
            rows = ElementTree.parse(self.path).getroot().findall("Collection/DataSet")
            files = [row.attrib["file"] for row in rows]
            if files != [f"{self._folder.name}/{_file_name(k)}" for k in range(len(files))]:
                raise ValueError("other files are listed")
            return [float(row.attrib["timestep"]) for row in rows]
        except FileNotFoundError:
            return []
        except (ElementTree.ParseError, KeyError, ValueError) as error:
            if not self.appending:
                return []
            raise ValueError(
                f"{self.path} was not written by shellcut; move it away or start anew with mode 'w'"
            ) from error


def _file_name(k: int) -> str:
    return f"frame_{k:04d}.vtu"


def _mesh_of(grid: FrameGrid) -> Any:
    import meshio

    # One block per run of cells of one part and one size, under meshio's names of the types.
    names = {LINE: "line", TRIANGLE: "triangle", POLYGON: "polygon", QUAD: "quad"}
    kinds = np.stack([grid.cell_arrays["part"], grid.types, grid.sizes])
    begins = np.flatnonzero((np.diff(kinds, axis=1, prepend=-1) != 0).any(axis=0))
    ends = np.append(begins[1:], len(grid.sizes))
    first_id = np.cumsum(grid.sizes) - grid.sizes
    blocks, rows = [], []
    for first, end in zip(begins.tolist(), ends.tolist(), strict=True):
        size = int(grid.sizes[first])
        ids = grid.connectivity[first_id[first] :][: size * (end - first)]
        blocks.append((names[int(grid.types[first])], ids.reshape(-1, size)))
        rows.append(slice(first, end))
    return meshio.Mesh(
        grid.points,
        blocks,
        point_data=dict(grid.point_arrays),
        cell_data={name: [a[some] for some in rows] for name, a in grid.cell_arrays.items()},
    )
