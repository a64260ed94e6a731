"""Write what a user brings: a cap as STL, inside out, and a disc as .msh.

The disc knows nothing of the blade's path; its rim is the group ``clamped``.
"""

import sys
from pathlib import Path

import numpy as np

from films import unstructured_disc
from shellcut.mesh.mesh import Mesh
from shellcut.tool.shapes import tooth_ring

SPACING = 1.3  # mm, of the triangles that the quads are made of


def write_inside_out(path: Path) -> None:
    """Write the ring of four teeth with every normal turned inwards."""
    tool = tooth_ring(n_teeth=4)
    lines = ["solid cap"]
    for a, b, c in tool.vertices[tool.triangles[:, ::-1]].tolist():
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in (a, b, c)]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid cap", ""]))


def write_gmsh(path: Path, film: Mesh, rim: np.ndarray) -> None:
    """Write Gmsh's format 2.2, the rim as a physical group of lines."""
    sides = [
        (a, b)
        for quad in film.quads.tolist()
        for a, b in zip(quad, quad[1:] + quad[:1], strict=True)
        if a in set(rim.tolist()) and b in set(rim.tolist())
    ]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2"]
    lines += ['1 1 "clamped"', '2 2 "membrane"', "$EndPhysicalNames", "$Nodes", str(film.n_node)]
    lines += [f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(film.nodes.tolist(), 1)]
    lines += ["$EndNodes", "$Elements", str(len(sides) + film.n_quad)]
    lines += [f"{k} 1 2 1 1 {a + 1} {b + 1}" for k, (a, b) in enumerate(sides, 1)]
    for k, quad in enumerate(film.quads.tolist(), 1 + len(sides)):
        lines.append(f"{k} 3 2 2 1 " + " ".join(str(n + 1) for n in quad))
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def main(folder: Path) -> None:
    """Write all of them."""
    write_inside_out(folder / "cap.stl")
    film = unstructured_disc(spacing=SPACING)
    write_gmsh(folder / "disc.msh", film, film.node_set("rim"))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    print("{}")
