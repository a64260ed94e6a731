"""Write two_teeth_inch.step and .iges, in inches, with CadQuery 2.8 (OpenCASCADE 7.9).

``pip install cadquery`` (not in the extra ``test``: 500 MB), then run this file in its folder.
"""

import cadquery
from OCP.IGESControl import IGESControl_Writer
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer


def tooth(x):
    """Return a wedge 3 mm long with a round back, 1.6 mm thick and 4 mm high, edge at x."""
    section = cadquery.Workplane("XY").moveTo(x, 0.0).lineTo(x + 3.0, 0.8)
    back = section.threePointArc((x + 3.8, 0.0), (x + 3.0, -0.8))
    return back.close().extrude(4.0).val()


both = cadquery.Compound.makeCompound([tooth(0.0), tooth(8.0)])
print(both.Volume(), both.Area())  # 27.24247719318988 83.40479060760168

step = STEPControl_Writer()  # makes the parameter known
Interface_Static.SetCVal_s("write.step.unit", "INCH")
step = STEPControl_Writer()
step.Transfer(both.wrapped, STEPControl_AsIs)
step.Write("two_teeth_inch.step")

iges = IGESControl_Writer("IN", 1)
iges.AddShape(both.wrapped)
iges.ComputeModel()
iges.Write("two_teeth_inch.iges")
