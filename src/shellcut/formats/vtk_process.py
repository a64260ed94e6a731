"""Rewrite a VTK file by VTK as a .vtu that meshio reads: ``vtk_process.py FILE OUT``.

VTK crashes or hangs on some damaged files; here it takes nobody with it.
:mod:`shellcut.formats.vtk` starts the process. Standard output names what is passed over, one a
line. Any error that VTK reports is a refusal. This file imports nothing of shellcut, so that it
starts at once.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

# of arrays in a legacy file, of each of which VTK reads one unless told otherwise
_KINDS = ("Scalars", "Vectors", "Normals", "Tensors", "TCoords", "ColorScalars", "Fields")


def main(path: str, out: str) -> None:
    """Read the file and write its grid."""
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
    from vtkmodules.vtkFiltersCore import vtkAppendFilter
    from vtkmodules.vtkIOLegacy import vtkDataSetReader
    from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader, vtkXMLUnstructuredGridWriter

    errors: list[str] = []

    def keep(_window: Any, _event: str, text: str) -> None:
        errors.append(re.sub(r".*?\(0x[0-9a-f]+\): ", "", " ".join(text.split()), count=1))

    keep.CallDataType = "string0"  # type: ignore[attr-defined]
    window: Any = vtkStringOutputWindow()
    window.AddObserver("ErrorEvent", keep)
    vtkOutputWindow.SetInstance(window)
    legacy = Path(path).suffix.lower() == ".vtk"
    reader: Any = vtkDataSetReader() if legacy else vtkXMLGenericDataObjectReader()
    for kind in _KINDS if legacy else ():
        getattr(reader, f"ReadAll{kind}On")()
    reader.SetFileName(path)
    reader.Update()
    read = reader.GetOutputDataObject(0)
    if errors:
        sys.exit(errors[0])
    if read is None or not read.IsA("vtkDataSet"):
        sys.exit("it must hold one grid or surface")
    cells = vtkAppendFilter()  # whatever its kind becomes an unstructured grid
    cells.AddInputData(read)
    cells.Update()
    grid = cells.GetOutput()
    _take_out(grid, set() if legacy else _of_some_pieces(Path(path).read_bytes()))
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(out)
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()
    writer.SetCompressorTypeToNone()
    if not writer.Write() or errors:
        sys.exit("; ".join(errors[:1]) or "the grid cannot be written")


def _of_some_pieces(content: bytes) -> set[tuple[str, str | None]]:
    # arrays that some pieces lack, for which VTK leaves memory unset: (section, name)
    if content.count(b"<Piece") < 2:
        return set()
    head = re.sub(rb"<AppendedData.*</AppendedData>", b"", content, flags=re.DOTALL)
    pieces = ElementTree.fromstring(head).findall("*/Piece")
    held = Counter((part.tag, array.get("Name")) for p in pieces for part in p for array in part)
    return {which for which, n in held.items() if n < len(pieces)}


def _take_out(grid: Any, unset: set[tuple[str, str | None]]) -> None:
    # all arrays that are no numbers, have no name, or are unset
    for part, data in (("PointData", grid.GetPointData()), ("CellData", grid.GetCellData())):
        for k in reversed(range(data.GetNumberOfArrays())):
            array, name = data.GetAbstractArray(k), data.GetArrayName(k)
            numbers = array.IsA("vtkDataArray") and not array.IsA("vtkBitArray")
            if not (name and numbers) or (part, name) in unset:
                print(f"array {name!r}")
                data.RemoveArray(k)
    for k in range(grid.GetFieldData().GetNumberOfArrays()):
        print(f"array {grid.GetFieldData().GetArrayName(k)!r} of the field data")
    grid.GetFieldData().Initialize()


if __name__ == "__main__":
    main(*sys.argv[1:])
