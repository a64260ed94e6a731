"""Directors left to the mesh, which lean out of symmetry planes: from files and from meshers.

The benchmarks of the cases A03 to A05, quarters and eighths whose rims lie in symmetry planes, with
the mean normals of their quads in place of the normals of the surface. From arrays they are rows of
the cases themselves.
"""

import numpy as np
import pytest

from cases import a03_scordelis_lo, a04_pinched_cylinder, a05_hemisphere
from cases.patches import cylinder_place
from shellcut import Mesh, read_film
from shellcut.mesh.outline import mesh_from_outline
from shellcut.mesh.structured import rectangle

CASES = {
    "roof": (a03_scordelis_lo, cylinder_place(25.0, 25.0, 40.0)),
    "cylinder": (a04_pinched_cylinder, cylinder_place(300.0, 300.0, 90.0)),
    "hemisphere": (a05_hemisphere, a05_hemisphere.sphere),
}
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


def write_abaqus(path, mesh):
    """Write a film as other programs do, coordinates with seven digits."""
    lines = ["*NODE"]
    lines += [f"{k}, {x:.7g}, {y:.7g}, {z:.7g}" for k, (x, y, z) in enumerate(mesh.nodes, 1)]
    lines += ["*ELEMENT, TYPE=S4"]
    lines += [f"{k}, {a}, {b}, {c}, {d}" for k, (a, b, c, d) in enumerate(mesh.quads + 1, 1)]
    for name, ids in mesh.node_sets.items():
        lines += [f"*NSET, NSET={name}", *map(str, ids + 1)]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("name", CASES)
def test_film_files(name, tmp_path):
    case, _ = CASES[name]
    write_abaqus(tmp_path / "film.inp", case.patch(16))
    film = read_film(tmp_path / "film.inp", unit="mm")
    # Measured: 2e-4 and less. Same element; leaning directors are of second order.
    assert case.deflection(film) == pytest.approx(case.CROSS_CHECK[16], rel=2e-3)


def bend(flat, place, *, exact):
    """Return a mesh of the unit square bent to a surface, its sides as node sets."""
    u, v = flat.nodes[:, 0], flat.nodes[:, 1]
    nodes, normals = place(u, v)
    sides = {"u0": u, "u1": 1.0 - u, "v0": v, "v1": 1.0 - v}
    return Mesh.from_arrays(
        nodes,
        flat.quads,
        directors=normals if exact else None,
        node_sets={name: np.flatnonzero(abs(off) < 1e-9) for name, off in sides.items()},
    )


@pytest.mark.parametrize("name", CASES)
def test_meshers(name):
    pytest.importorskip("gmsh", exc_type=ImportError)
    case, place = CASES[name]
    flat = rectangle(1.0, 1.0, n_x=16, n_y=16)
    flat = Mesh.from_arrays(flat.nodes + np.array([0.0, 0.5, 0.0]), flat.quads)
    meshes = {"structured": flat, "Gmsh": mesh_from_outline(SQUARE, size=1.0 / 16.0)}
    for kind, mesh in meshes.items():
        exact, ours = (case.deflection(bend(mesh, place, exact=e)) for e in (True, False))
        # Measured: 2e-4 and less.
        assert ours == pytest.approx(exact, rel=1e-3), kind
