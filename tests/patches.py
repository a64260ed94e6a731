"""Quads of the unit square mapped onto surfaces, and films made of them."""

import numpy as np

from shellcut import Mesh, NodalForce, ShellMaterial, Statics, Support


def mapped_patch(n_u, n_v, place, *, exact=True):
    """Return n_u x n_v quads of the unit square mapped onto a surface.

    ``place(u, v)`` returns positions and unit directors, shape (..., 3). Node sets ``u0``, ``u1``,
    ``v0``, ``v1`` are the sides, in order of the running parameter; node (i, j) of the grid has the
    id i (n_v + 1) + j. With ``exact`` the directors are those of the surface, else left to the
    mesh.
    """
    u, v = np.meshgrid(np.linspace(0, 1, n_u + 1), np.linspace(0, 1, n_v + 1), indexing="ij")
    nodes, directors = place(u, v)
    ids = np.arange(u.size).reshape(u.shape)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    return Mesh.from_arrays(
        nodes.reshape(-1, 3),
        quads.reshape(-1, 4),
        directors=directors.reshape(-1, 3) if exact else None,
        node_sets={"u0": ids[0], "u1": ids[-1], "v0": ids[:, 0], "v1": ids[:, -1]},
    )


def cylinder_patch(radius, length, arc_deg, n_arc, n_along, *, exact=True):
    """Return a patch of a cylinder about y; u runs over the arc from the top, v along y."""

    def place(u, v):
        angle = np.radians(arc_deg) * u
        director = np.stack([np.sin(angle), 0.0 * v, np.cos(angle)], axis=-1)
        nodes = radius * director
        nodes[..., 1] = length * v
        return nodes, director

    return mapped_patch(n_arc, n_along, place, exact=exact)


DIAPHRAGM = Support("v1", translation="xz", rotation="y")
"""Of a cylinder's end: it supports the displacements in its plane."""


def pinched_cylinder(radius, length, n, material, force, *, exact=True):
    """Return an eighth of a cylinder with end diaphragms, under a force, and the node of that."""
    mesh = cylinder_patch(radius, length, 90.0, n, n, exact=exact)
    load = int(mesh.node_set("u0")[0])
    planes = (("u0", "x"), ("u1", "z"), ("v0", "y"))
    model = Statics(
        mesh,
        material,
        supports=[*(Support.symmetry(*plane) for plane in planes), DIAPHRAGM],
        loads=[NodalForce([load], (0.0, 0.0, -force))],
    )
    return model, load


def spacing(mesh):
    """Return the mean side of the quads [mm]."""
    return float(np.sqrt(mesh.quad_areas().mean()))


def sphere(u, v):
    """Map u to the azimuth from x to y, v to the height from the equator to a hole of 18°."""
    azimuth, height = 0.5 * np.pi * u, np.radians(72.0) * v
    out = [np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)]
    director = np.stack(out, axis=-1)
    return 10.0 * director, director


def pinched_hemisphere(mesh, thickness, force, **options):
    """Return a quarter of a hemisphere under two forces, and the nodes on x and y they act on."""
    on_x, on_y = (int(mesh.node_set(side)[0]) for side in ("u0", "u1"))
    model = Statics(
        mesh,
        ShellMaterial.homogeneous(young=6.825e7, poisson=0.3, thickness=thickness, **options),
        supports=[
            Support.symmetry("u0", "y"),
            Support.symmetry("u1", "x"),
            Support([on_x], translation="z", rotation=""),
        ],
        loads=[NodalForce([on_x], (force, 0, 0)), NodalForce([on_y], (0, -force, 0))],
    )
    return model, on_x, on_y


def hinged_roof(n, thickness, *, exact=True):
    """Return a quarter of a shallow roof, a force of 750 N down on its centre, and that node."""
    mesh = cylinder_patch(2540.0, 254.0, np.degrees(0.1), n, n, exact=exact)
    centre = int(mesh.node_set("u0")[0])
    roof = Statics(
        mesh,
        ShellMaterial.homogeneous(young=3102.75, poisson=0.3, density=1e-9, thickness=thickness),
        supports=[
            Support.symmetry("u0", "x"),
            Support.symmetry("v0", "y"),
            Support("u1", translation="xyz", rotation="xz"),
        ],
        loads=[NodalForce([centre], (0.0, 0.0, -750.0))],
    )
    return roof, centre
