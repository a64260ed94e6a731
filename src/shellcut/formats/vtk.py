"""VTK files: cells, and integer arrays as groups.

An integer or boolean array on points or cells becomes groups: one with the array's name if it
contains only 0 and 1, otherwise ``name_7`` and the like for each value.
"""

from __future__ import annotations

from pathlib import Path

from .file_mesh import FileMesh
from .vtk_grid import mesh_of
from .vtk_legacy import read_vtk_legacy
from .vtk_xml import read_vtk_xml


def read_vtk(path: str | Path) -> FileMesh:
    """Read an unstructured grid or polygons: .vtu, .vtp or legacy .vtk.

    Raises
    ------
    FileError
        If it is none of these, or holds other counts than declared.
    """
    path = Path(path)
    read = read_vtk_legacy if path.suffix.lower() == ".vtk" else read_vtk_xml
    return mesh_of(path, read(path))
