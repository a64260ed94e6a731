"""Read every frame by VTK's own reader and compare it with what shellcut reads back."""

import json
import sys
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkIOHDF import vtkHDFReader

import shellcut

MEMBRANE, CABLE, TOOL, FLANK, EDGE = range(5)

results = shellcut.read(sys.argv[1])
reader = vtkHDFReader()
reader.SetFileName(str(Path(sys.argv[1]) / f"{results.name}.vtkhdf"))
reader.UpdateInformation()
assert reader.GetNumberOfSteps() == results.n_frame, "as many frames as shellcut reads"


def checked(k: int) -> tuple[float, float, int]:
    """Compare frame k; return the distance of the points, the slit's width and the arrays read."""
    reader.SetStep(k)
    reader.Update()
    grid, frame = reader.GetOutput(), results.frame(k)
    assert reader.GetTimeValue() == results.times[k]
    arrays = {}
    for data in (grid.GetPointData(), grid.GetCellData(), grid.GetFieldData()):
        for i in range(data.GetNumberOfArrays()):
            arrays[data.GetArrayName(i)] = vtk_to_numpy(data.GetArray(i))
    for name, values in arrays.items():
        assert np.isfinite(values).all(), f"{name} of frame {k} is not finite"
    points = vtk_to_numpy(grid.GetPoints().GetData())
    assert np.isfinite(points).all()
    part = arrays["part"]
    assert set(part.tolist()) <= {MEMBRANE, CABLE, TOOL, FLANK, EDGE}
    assert (part == MEMBRANE).sum() == len(frame.quads)
    assert (part == TOOL).sum() > 0
    # Deformed positions, the nodes first: no Warp By Vector is needed.
    distance = np.abs(points[: len(frame.points)] - frame.points).max()
    assert distance < 1e-5, f"points of frame {k} are off by {distance} mm"
    moved = arrays["displacement [mm]"][: len(frame.points)]
    cells = grid.GetCells()
    begin = vtk_to_numpy(cells.GetOffsetsArray())
    corners = vtk_to_numpy(cells.GetConnectivityArray())
    quads = corners[begin[:-1][part == MEMBRANE][:, None] + np.arange(4)]
    assert np.array_equal(quads, frame.quads), f"quads of frame {k}"
    flanks = np.flatnonzero(part == FLANK)
    middle = points[corners[begin[:-1][flanks][:, None] + [0, 1]]].mean(axis=1)
    width = np.linalg.norm(middle[0::2] - middle[1::2], axis=1)
    assert np.isfinite(moved).all()
    return float(distance), float(width.max(initial=0.0)), len(arrays)


back = [results.n_frame // 2, 3, 0]
found = [checked(k) for k in [*range(results.n_frame), *back]]
distances, widths, arrays = zip(*found, strict=True)
print(
    json.dumps(
        {
            "vtk": vtkVersion().GetVTKVersion(),
            "n_frame": results.n_frame,
            "n_back": len(back),
            "n_array": max(arrays),
            "points": max(distances),
            "opened": max(widths),
        }
    )
)
