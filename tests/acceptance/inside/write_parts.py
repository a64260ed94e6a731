"""Write what a user brings: a cap as STL, inside out, and a disc as .msh, .inp and .k.

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


def write_abaqus(path: Path, film: Mesh, rim: np.ndarray) -> None:
    """Write an Abaqus deck, the rim as a node set."""
    lines = ["*NODE"]
    lines += [f"{k}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(film.nodes.tolist(), 1)]
    lines += ["*ELEMENT, TYPE=S4R, ELSET=membrane"]
    for k, quad in enumerate(film.quads.tolist(), 1):
        lines.append(", ".join(str(n) for n in (k, *(n + 1 for n in quad))))
    lines += ["*NSET, NSET=clamped", *(f"{n + 1}," for n in rim.tolist())]
    path.write_text("\n".join([*lines, ""]))


def write_lsdyna(path: Path, film: Mesh, rim: np.ndarray) -> None:
    """Write an LS-DYNA deck with commas, the rim as a titled set."""
    lines = ["*KEYWORD", "*NODE"]
    lines += [f"{k},{x!r},{y!r},{z!r}" for k, (x, y, z) in enumerate(film.nodes.tolist(), 1)]
    lines += ["*ELEMENT_SHELL"]
    for k, quad in enumerate(film.quads.tolist(), 1):
        lines.append(",".join(str(n) for n in (k, 1, *(n + 1 for n in quad))))
    lines += ["*SET_NODE_LIST_TITLE", "clamped", "1"]
    lines += [",".join(str(n + 1) for n in rim[k : k + 8].tolist()) for k in range(0, len(rim), 8)]
    path.write_text("\n".join([*lines, "*END", ""]))


def main(folder: Path) -> None:
    """Write all of them."""
    write_inside_out(folder / "cap.stl")
    film = unstructured_disc(spacing=SPACING)
    rim = film.node_set("rim")
    write_gmsh(folder / "disc.msh", film, rim)
    write_abaqus(folder / "disc.inp", film, rim)
    write_lsdyna(folder / "disc.k", film, rim)
    small = Mesh.from_arrays(0.01 * film.nodes, film.quads)
    write_abaqus(folder / "decimetres.inp", small, rim)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    print("{}")
