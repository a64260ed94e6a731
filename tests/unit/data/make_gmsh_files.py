"""Write the .msh and .inp files beside this one by Gmsh itself: `python make_gmsh_files.py`.

Two rectangles, 3 x 2 and 2 x 2 quads, side by side: 0 <= x <= 5, 0 <= y <= 2. The groups overlap:
"film" is both, "right part" the second; "left" the line x = 0, "corner" the point (0, 0).
"""

from pathlib import Path

import gmsh


def build():
    geo = gmsh.model.geo
    p = [geo.addPoint(x, y, 0.0) for x, y in ((0, 0), (3, 0), (5, 0), (5, 2), (3, 2), (0, 2))]
    geo.addPoint(9.0, 9.0, 0.0)  # belongs to nothing
    bottom, bottom_2 = geo.addLine(p[0], p[1]), geo.addLine(p[1], p[2])
    right, top_2 = geo.addLine(p[2], p[3]), geo.addLine(p[3], p[4])
    top, left, middle = geo.addLine(p[4], p[5]), geo.addLine(p[5], p[0]), geo.addLine(p[1], p[4])
    one = geo.addPlaneSurface([geo.addCurveLoop([bottom, middle, top, left])])
    # clockwise: this part is turned over
    two = geo.addPlaneSurface([-geo.addCurveLoop([bottom_2, right, top_2, -middle])])
    for line, n in ((bottom, 3), (top, 3), (bottom_2, 2), (top_2, 2), (left, 2), (middle, 2)):
        geo.mesh.setTransfiniteCurve(line, n + 1)
    geo.mesh.setTransfiniteCurve(right, 3)
    for surface in (one, two):
        geo.mesh.setTransfiniteSurface(surface)
        geo.mesh.setRecombine(2, surface)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [one, two], name="film")
    gmsh.model.addPhysicalGroup(2, [two], name="right part")
    gmsh.model.addPhysicalGroup(1, [left], name="left")
    gmsh.model.addPhysicalGroup(1, [right])  # has no name
    gmsh.model.addPhysicalGroup(0, [p[0]], name="corner")
    gmsh.model.mesh.generate(2)


def write(folder):
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        build()
        for version in (2.2, 4.1):
            for binary in (0, 1):
                gmsh.option.setNumber("Mesh.MshFileVersion", version)
                gmsh.option.setNumber("Mesh.Binary", binary)
                gmsh.write(str(folder / f"gmsh_{version}{'_binary' if binary else ''}.msh"))
        gmsh.option.setNumber("Mesh.Binary", 0)
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
        gmsh.write(str(folder / "gmsh.inp"))
    finally:
        gmsh.finalize()


if __name__ == "__main__":
    write(Path(__file__).parent)
