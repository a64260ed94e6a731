"""A film and a tool in every format that is read, small, with nothing symmetrical about them."""

import functools
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
    centre = mesh.nodes[mesh.quads].mean(axis=1)
    quad_sets = {"upper": np.flatnonzero(centre[:, 1] > 0.3)}
    node_sets = {"rim": mesh.node_set("rim"), "ring": mesh.node_set("ring_4")}
    return np.round(nodes, 5), mesh.quads, node_sets, quad_sets


def abaqus():
    """A part and its instance, as Abaqus/CAE writes them."""
    nodes, quads, node_sets, quad_sets = film()
    lines = ["*Heading", "** PARTS", "*Part, name=Sheet", "*Node"]
    lines += [f"{i}, {x:.5f}, {y:.5f}, {z:.5f}" for i, (x, y, z) in enumerate(nodes, start=1)]
    lines.append("*Element, type=S4R")
    lines += [f"{e}, {', '.join(map(str, q + 1))}" for e, q in enumerate(quads, start=1)]
    lines += ["*Elset, elset=upper", *_rows(quad_sets["upper"] + 1, ", ".join)]
    lines += ["*Elset, elset=_all, internal, generate", f"1, {len(quads)}, 1"]
    lines += ["*Shell Section, elset=_all, material=PE", "0.1, 5", "*End Part"]
    lines += ["*Assembly, name=Assembly", "*Instance, name=Sheet-1, part=Sheet", "1., 2., 0."]
    lines.append("*End Instance")
    for name, members in node_sets.items():
        lines += [f"*Nset, nset={name}, instance=Sheet-1", *_rows(members + 1, ", ".join)]
    lines += ["*Nset, nset=first, instance=Sheet-1, generate", "1, 9, 2", "*End Assembly"]
    return "\n".join([*lines, "*Material, name=PE", "*Elastic", "1678., 0.3"]) + "\n"


def lsdyna(*, commas=False):
    """In fixed columns or with commas."""
    nodes, quads, node_sets, quad_sets = film()

    def card(values, width=10):
        return ", ".join(map(str, values)) if commas else "".join(f"{v:>{width}}" for v in values)

    lines = ["*KEYWORD", "$ made by hand", "*NODE"]
    for i, place in enumerate(nodes.tolist(), start=1):
        lines.append(card([i, *place]) if commas else card([i], 8) + card(place, 16))
    lines += ["*PART", "the film", card([1, 1, 1]), "*ELEMENT_SHELL"]
    lines += [card([e, 1, *(q + 1).tolist()], 8) for e, q in enumerate(quads, start=1)]
    for kind, sets in (("NODE", node_sets), ("SHELL", quad_sets)):
        for sid, (name, members) in enumerate(sets.items(), start=1):
            lines += [f"*SET_{kind}_LIST_TITLE", name, card([sid]), *_rows(members + 1, card)]
    return "\n".join([*lines, "*MAT_ELASTIC", card([1, 1e-9, 1678.0]), "*END"]) + "\n"


def _rows(ids, joined):
    return [joined([str(n) for n in ids[k : k + 8]]) for k in range(0, len(ids), 8)]


def _by_meshio(ending, **options):
    tool = tooth_ring(n_teeth=1, n_arc=9, length=0.8, height=3.0)
    mesh = meshio.Mesh(np.round(tool.vertices, 6), [("triangle", tool.triangles)])
    if ending in (".vtu", ".vtk"):
        nodes, quads, node_sets, quad_sets = film()
        marks = {name: np.isin(np.arange(len(nodes)), m) for name, m in node_sets.items()}
        mesh = meshio.Mesh(nodes, [("quad", quads)], {k: m * 1 for k, m in marks.items()})
        for name, members in quad_sets.items():
            mesh.cell_data[name] = [np.isin(np.arange(len(quads)), members) * 1]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh{ending}"
        meshio.write(path, mesh, **options)
        return path.read_bytes()


FILMS = {
    "Abaqus": ("film.inp", lambda: abaqus().encode(), True),
    "LS-DYNA columns": ("film.k", lambda: lsdyna().encode(), True),
    "LS-DYNA commas": ("film.k", lambda: lsdyna(commas=True).encode(), True),
    "Gmsh 2.2 text": ("film.msh", (DATA / "gmsh_2.2.msh").read_bytes, True),
    "Gmsh 2.2 binary": ("film.msh", (DATA / "gmsh_2.2_binary.msh").read_bytes, False),
    "Gmsh 4.1 text": ("film.msh", (DATA / "gmsh_4.1.msh").read_bytes, True),
    "Gmsh 4.1 binary": ("film.msh", (DATA / "gmsh_4.1_binary.msh").read_bytes, False),
}
TOOLS = {"OBJ text": ("tooth.obj", lambda: _by_meshio(".obj"), True)}
for _ending, _into in ((".vtu", FILMS), (".vtk", FILMS), (".ply", TOOLS), (".stl", TOOLS)):
    for _binary in (False, True):
        _name = f"{_ending[1:].upper()} {'binary' if _binary else 'text'}"
        _into[_name] = (
            f"mesh{_ending}",
            functools.partial(_by_meshio, _ending, binary=_binary),
            not _binary,
        )
"""By format: name of the file, what gives its bytes, whether it is text."""
