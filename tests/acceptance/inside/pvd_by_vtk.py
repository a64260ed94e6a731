"""Read the PVD and its VTU files by VTK and compare the points with those of the .vtkhdf."""

import json
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

import shellcut

out = Path(sys.argv[1])
results = shellcut.read(out)
sets = ElementTree.parse(out / f"{results.name}.pvd").getroot().findall(".//DataSet")
assert len(sets) == results.n_frame
worst = 0.0
for k, entry in enumerate(sets):
    assert float(entry.attrib["timestep"]) == results.times[k]
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(out / entry.attrib["file"]))
    reader.Update()
    points = vtk_to_numpy(reader.GetOutput().GetPoints().GetData())
    known = results.frame(k).points
    worst = max(worst, float(np.abs(points[: len(known)] - known).max()))
assert worst < 1e-5, f"points are off by {worst} mm"
print(json.dumps({"n_file": len(sets), "points": worst}))
