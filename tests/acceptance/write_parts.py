"""Write what a user brings: a cap as STL, inside out, and a disc as .msh.

The disc knows nothing of the blade's path; its rim is the group ``clamped``.
"""

import sys
from pathlib import Path

from films import unstructured_disc, write_gmsh
from shellcut.tool.shapes import tooth_ring

SPACING = 1.3  # mm, of the triangles that the quads are made of


def write_inside_out(path):
    """Write the ring of four teeth with every normal turned inwards."""
    tool = tooth_ring(n_teeth=4)
    lines = ["solid cap"]
    for a, b, c in tool.vertices[tool.triangles[:, ::-1]].tolist():
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in (a, b, c)]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid cap", ""]))


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    write_inside_out(folder / "cap.stl")
    disc = unstructured_disc(spacing=SPACING)
    write_gmsh(folder / "disc.msh", disc, rim="clamped", quads="membrane")
