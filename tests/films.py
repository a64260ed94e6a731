"""Quad meshes that know nothing of the blade's path, made without a mesher."""

import meshio
import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

import shellcut as sc


def shaken(mesh, most, seed=1, size=1.0, held=None):
    """Return a mesh whose nodes, but those of its rim and some others, are moved at random.

    By up to ``most`` times ``size`` [mm] along x and y.
    """
    X, rng = mesh.nodes.copy(), np.random.default_rng(seed)
    inside = np.setdiff1d(np.arange(mesh.n_node), mesh.boundary_nodes())
    inside = inside if held is None else np.setdiff1d(inside, held)
    X[inside, :2] += rng.uniform(-most, most, (inside.size, 2)) * size
    return sc.Mesh.from_arrays(X, mesh.quads, node_sets=dict(mesh.node_sets))


def from_zero(mesh, *corner):
    """Return a mesh moved to begin at x = 0, or with its lowest coordinates at a corner."""
    start = mesh.nodes.min(axis=0)
    shift = np.append(start[: len(corner)] - corner, 0.0) if corner else [start[0], 0.0, 0.0]
    return sc.Mesh.from_arrays(mesh.nodes - shift, mesh.quads, node_sets=dict(mesh.node_sets))


def pieces(quads):
    """Return the piece to which each quad belongs: quads with a common node hang together."""
    table = csr_array((np.ones(quads.size), (np.arange(len(quads)).repeat(4), quads.ravel())))
    return connected_components(table @ table.T)[1]


def free_film(mesh, **options):
    """Return a run of a film: the default film and law, and cracks through the quads."""
    usual = {
        "material": sc.ShellMaterial.homogeneous(),
        "law": sc.CohesiveLaw(),
        "fracture": sc.Fracture(path="free"),
    }
    return sc.Simulation(mesh, **usual | options)


def cut_by(tool, mesh, speed, *, ramp=0.0, **options):
    """Return a run of a tool that goes along x through a film whose long sides are held."""
    usual = {
        "supports": [sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        "motion": sc.StraightMotion((1.0, 0.0, 0.0), speed=speed, ramp=ramp),
    }
    return free_film(mesh, tool=tool, **usual | options)


def unstructured_disc(radius=10.2, spacing=0.93, seed=0):
    """Return a disc of some 2,600 quads: jittered triangles, each cut into three quads."""
    n_rim = round(2.0 * np.pi * radius / spacing)
    angle = 2.0 * np.pi * np.arange(n_rim) / n_rim
    rim = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    n = int(np.ceil(1.25 * radius / spacing))
    i, j = np.meshgrid(np.arange(-n, n + 1), np.arange(-n, n + 1))
    lattice = spacing * np.stack([i + 0.5 * j, np.sqrt(0.75) * j], axis=-1).reshape(-1, 2)
    lattice += np.random.default_rng(seed).uniform(-0.12, 0.12, lattice.shape) * spacing
    inner = lattice[np.hypot(*lattice.T) < radius - 0.6 * spacing]
    points = np.concatenate([rim, inner])
    nodes, quads, middles = three_quads_a_triangle(points, Delaunay(points).simplices)
    on_rim = (middles < n_rim).all(axis=1) & (
        np.abs(middles[:, 0] - middles[:, 1]) % (n_rim - 2) == 1
    )
    middle = np.flatnonzero(on_rim) + len(points)
    nodes[middle] *= radius / np.hypot(*nodes[middle].T)[:, None]
    rim_nodes = np.flatnonzero(np.hypot(*nodes.T) > radius - 1e-6)
    return sc.Mesh.from_arrays(nodes, quads, node_sets={"rim": rim_nodes})


def write_gmsh(path, film, *, rim, quads):
    """Write Gmsh's format 2.2, rim and quads as physical groups of these names."""
    sides = np.stack([film.quads, np.roll(film.quads, -1, axis=1)], axis=2).reshape(-1, 2)
    sides = sides[np.isin(sides, film.node_set("rim")).all(axis=1)]
    groups = [np.full(len(sides), 1), np.full(film.n_quad, 2)]
    mesh = meshio.Mesh(
        film.nodes,
        [("line", sides), ("quad", film.quads)],
        cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
        field_data={rim: np.array([1, 1]), quads: np.array([2, 2])},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)


def three_quads_a_triangle(points, triangles):
    """Return nodes, quads and the ends of the sides at whose middles the new nodes stand."""
    triangles = triangles.copy()
    a, b, c = (points[triangles[:, k]] for k in range(3))
    ccw = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) > (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[~ccw] = triangles[~ccw][:, ::-1]
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, side_of = np.unique(sides, axis=0, return_inverse=True)
    side_of = side_of.reshape(-1, 3) + len(points)
    centre = np.arange(len(triangles)) + len(points) + len(unique)
    nodes = np.concatenate([points, points[unique].mean(axis=1), points[triangles].mean(axis=1)])
    quads = np.concatenate(
        [
            np.stack([triangles[:, k], side_of[:, k], centre, side_of[:, k - 1]], axis=1)
            for k in range(3)
        ]
    )
    return nodes, quads, unique
