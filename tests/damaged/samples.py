"""A film and a tool in every format that is read, small, with nothing symmetrical about them."""

import functools
import io
import tempfile
from pathlib import Path

import meshio
import numpy as np

from shellcut.mesh.structured import disc
from shellcut.tool.shapes import tooth_ring

DATA = Path(__file__).parents[1] / "unit" / "data"


@functools.cache
def film():
    """Nodes, quads, node sets and quad sets: a disc of 60 quads, its inner nodes moved a little."""
    mesh = disc(5.0, n_side=4, n_layer=3, ring_radii=(5.0, 4.0))
    rng = np.random.default_rng(3)
    nodes = mesh.nodes + 0.05 * rng.uniform(-1, 1, mesh.nodes.shape) * (1, 1, 0)
    nodes = np.round(nodes, 5)
    centre = mesh.nodes[mesh.quads].mean(axis=1)
    quad_sets = {"upper": np.flatnonzero(centre[:, 1] > 0.3)}
    node_sets = {"rim": mesh.node_set("rim"), "ring": mesh.node_set("ring_4")}
    return nodes, mesh.quads, node_sets, quad_sets


def _rows(numbers, a_line=8):
    numbers = [str(n) for n in numbers]
    return [", ".join(numbers[k : k + a_line]) for k in range(0, len(numbers), a_line)]


def abaqus():
    nodes, quads, node_sets, quad_sets = film()
    lines = ["*HEADING", "a film", "*NODE"]
    lines += [f"{i}, {x:.5f}, {y:.5f}, {z:.5f}" for i, (x, y, z) in enumerate(nodes, start=1)]
    lines.append("*ELEMENT, TYPE=S4R, ELSET=film")
    lines += [f"{e}, {', '.join(map(str, q + 1))}" for e, q in enumerate(quads, start=1)]
    for name, members in node_sets.items():
        lines += [f"*NSET, NSET={name}", *_rows(members + 1)]
    for name, members in quad_sets.items():
        lines += [f"*ELSET, ELSET={name}", *_rows(members + 1)]
    lines += ["*NSET, NSET=first, GENERATE", "1, 9, 2"]
    lines += ["*MATERIAL, NAME=PE", "*ELASTIC", "1678., 0.3", "*STEP", "*END STEP"]
    return "\n".join(lines) + "\n"


def abaqus_parts():
    """As Abaqus/CAE writes it."""
    nodes, quads, node_sets, quad_sets = film()
    lines = ["*Heading", "** Job name: film Model name: film", "** PARTS", "**"]
    lines += ["*Part, name=Sheet", "*Node"]
    lines += [
        f"{i:7d}, {x:12.5f}, {y:12.5f}, {z:12.5f}" for i, (x, y, z) in enumerate(nodes, start=1)
    ]
    lines.append("*Element, type=S4R")
    lines += [f"{e}, {', '.join(map(str, q + 1))}" for e, q in enumerate(quads, start=1)]
    lines += ["*Elset, elset=upper", *_rows(quad_sets["upper"] + 1, 16)]
    lines += ["*Elset, elset=_all, internal, generate", f"1, {len(quads)}, 1"]
    lines += ["** Section: s", "*Shell Section, elset=_all, material=PE", "0.1, 5"]
    lines += ["*End Part", "** ASSEMBLY", "*Assembly, name=Assembly", "**"]
    lines += ["*Instance, name=Sheet-1, part=Sheet", "1., 2., 0.", "*End Instance", "**"]
    for name, members in node_sets.items():
        lines += [f"*Nset, nset={name}, instance=Sheet-1", *_rows(members + 1, 16)]
    lines += ["*End Assembly", "** MATERIALS", "*Material, name=PE", "*Elastic", "1678., 0.3"]
    return "\n".join(lines) + "\n"


def lsdyna(*, commas=False):
    nodes, quads, node_sets, quad_sets = film()

    def card(values, width):
        return ", ".join(map(str, values)) if commas else "".join(f"{v:>{width}}" for v in values)

    def cards(ids):
        return [card(ids[k : k + 8].tolist(), 10) for k in range(0, len(ids), 8)]

    lines = ["*KEYWORD", "$ made by hand", "*TITLE", "a film", "*NODE"]
    lines.append("$#   nid               x               y               z      tc      rc")
    for i, xyz in enumerate(nodes, start=1):
        row = [f"{c:.5f}" for c in xyz]
        lines.append(card([i, *row], 0) if commas else card([i], 8) + card(row, 16))
    lines += ["*PART", "the film", card([1, 1, 1], 10)]
    lines.append("*ELEMENT_SHELL")
    lines += [card([e, 1, *(q + 1).tolist()], 8) for e, q in enumerate(quads, start=1)]
    for sid, (name, members) in enumerate(node_sets.items(), start=1):
        lines += ["*SET_NODE_LIST_TITLE", name, card([sid], 10), *cards(members + 1)]
    for sid, (name, members) in enumerate(quad_sets.items(), start=1):
        lines += ["*SET_SHELL_LIST_TITLE", name, card([sid], 10), *cards(members + 1)]
    lines += ["*MAT_ELASTIC", card([1, 1e-9, 1678.0], 10), "*END"]
    return "\n".join(lines) + "\n"


def _by_meshio(ending, **options):
    nodes, quads, node_sets, quad_sets = film()
    marks = {name: np.isin(np.arange(len(nodes)), m) for name, m in node_sets.items()}
    cells = {name: [np.isin(np.arange(len(quads)), m)] for name, m in quad_sets.items()}
    mesh = meshio.Mesh(
        nodes,
        [("quad", quads)],
        point_data={name: m.astype(np.int32) for name, m in marks.items()},
        cell_data={name: [m[0].astype(np.int32)] for name, m in cells.items()},
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"film{ending}"
        meshio.write(path, mesh, **options)
        return path.read_bytes()


def gmsh_2():
    nodes, quads, node_sets, quad_sets = film()
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3"]
    lines += ['1 1 "rim"', '2 2 "upper"', '2 3 "lower"', "$EndPhysicalNames", "$Nodes"]
    lines.append(str(len(nodes)))
    lines += [f"{i} {x:.5f} {y:.5f} {z:.5f}" for i, (x, y, z) in enumerate(nodes, start=1)]
    rim = node_sets["rim"]
    sides = np.stack([rim, np.roll(rim, -1)], axis=1)
    lines += ["$EndNodes", "$Elements", str(len(sides) + len(quads))]
    lines += [f"{k} 1 2 1 1 {a} {b}" for k, (a, b) in enumerate((sides + 1).tolist(), start=1)]
    upper = set(quad_sets["upper"].tolist())
    for e, q in enumerate((quads + 1).tolist()):
        group = 2 if e in upper else 3
        lines.append(f"{len(sides) + e + 1} 3 2 {group} {group} {' '.join(map(str, q))}")
    return "\n".join([*lines, "$EndElements"]) + "\n"


def _surface():
    tool = tooth_ring(n_teeth=1, n_arc=9, length=0.8, height=3.0)
    return np.round(tool.vertices, 6), tool.triangles


def obj():
    vertices, triangles = _surface()
    lines = ["# a tooth", "o tooth"]
    lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()]
    return "\n".join(lines) + "\n"


def ply(*, binary=False):
    vertices, triangles = _surface()
    out = io.BytesIO()
    kind = "binary_little_endian" if binary else "ascii"
    header = ["ply", f"format {kind} 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {axis}" for axis in "xyz"]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices"]
    out.write(("\n".join([*header, "end_header"]) + "\n").encode())
    if binary:
        out.write(vertices.astype("<f4").tobytes())
        rows = np.zeros(len(triangles), [("n", "u1"), ("v", "<i4", 3)])
        rows["n"], rows["v"] = 3, triangles
        out.write(rows.tobytes())
    else:
        out.write("".join(f"{x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in vertices).encode())
        out.write("".join(f"3 {a} {b} {c}\n" for a, b, c in triangles.tolist()).encode())
    return out.getvalue()


def stl(*, binary=False):
    vertices, triangles = _surface()
    mesh = meshio.Mesh(vertices, [("triangle", triangles)])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tooth.stl"
        meshio.stl.write(path, mesh, binary=binary)
        return path.read_bytes()


FILMS = {
    "Abaqus deck": ("film.inp", lambda: abaqus().encode(), True),
    "Abaqus parts": ("film.inp", lambda: abaqus_parts().encode(), True),
    "LS-DYNA columns": ("film.k", lambda: lsdyna().encode(), True),
    "LS-DYNA commas": ("film.k", lambda: lsdyna(commas=True).encode(), True),
    "Gmsh 2.2 text": ("film.msh", lambda: gmsh_2().encode(), True),
    "Gmsh 2.2 binary": ("film.msh", (DATA / "gmsh_2.2_binary.msh").read_bytes, False),
    "Gmsh 4.1 text": ("film.msh", (DATA / "gmsh_4.1.msh").read_bytes, True),
    "Gmsh 4.1 binary": ("film.msh", (DATA / "gmsh_4.1_binary.msh").read_bytes, False),
    "VTU text": ("film.vtu", lambda: _by_meshio(".vtu", binary=False), True),
    "VTU binary": ("film.vtu", lambda: _by_meshio(".vtu", binary=True), False),
    "VTK text": ("film.vtk", lambda: _by_meshio(".vtk", binary=False), True),
    "VTK binary": ("film.vtk", lambda: _by_meshio(".vtk", binary=True), False),
}
"""By format: name of the file, its bytes, whether it is text."""

TOOLS = {
    "OBJ": ("tooth.obj", lambda: obj().encode(), True),
    "PLY text": ("tooth.ply", ply, True),
    "PLY binary": ("tooth.ply", lambda: ply(binary=True), False),
    "STL text": ("tooth.stl", stl, True),
    "STL binary": ("tooth.stl", lambda: stl(binary=True), False),
}
