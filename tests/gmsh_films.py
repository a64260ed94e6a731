"""Films meshed by Gmsh as a user would, in quads by several algorithms."""

from contextlib import contextmanager

import numpy as np

from shellcut import mesh_from_outline, read_film

RADIUS = 10.2

# Algorithm, recombination and size [mm] for about 2,600 quads; seeds disturb and turn the disc.
DISCS = {"frontal, blossom": (6, 1, 0.37), "packing": (11, 3, 1.2)}


@contextmanager
def gmsh_with(**options):
    """Gmsh with some of its options of meshes, silent."""
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for name, value in options.items():
            gmsh.option.setNumber(f"Mesh.{name}", value)
        yield gmsh
    finally:
        gmsh.finalize()


def gmsh_disc(path, algorithm, recombination, size, *, seed):
    """Return a disc that Gmsh writes to a path; its boundary is the set "rim"."""
    with gmsh_with(
        Algorithm=algorithm,
        RandomSeed=seed + 1,
        RandomFactor=1e-4 * seed,
        MeshSizeMin=size,
        MeshSizeMax=size,
        RecombineAll=1,
        RecombinationAlgorithm=recombination,
    ) as gmsh:
        shape = gmsh.model.occ
        surface = shape.addDisk(0.0, 0.0, 0.0, RADIUS, RADIUS)
        shape.rotate([(2, surface)], 0, 0, 0, 0, 0, 1, 0.37 * seed)
        shape.synchronize()
        curves = [tag for _, tag in gmsh.model.getEntities(1)]
        # an odd number of nodes on a rim leaves triangles
        for curve in curves:
            n_pair = round(shape.getMass(1, curve) / size / 2)
            gmsh.model.mesh.setTransfiniteCurve(curve, 2 * n_pair + 1)
        gmsh.model.addPhysicalGroup(1, curves, name="rim")
        gmsh.model.addPhysicalGroup(2, [surface], name="film")
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    return read_film(path, unit="mm")


def gmsh_strip(length, width, size):
    """Return a strip from x = 0 whose long sides are the sets "bottom" and "top"."""
    high = 0.5 * width
    corners = [(0.0, -high), (length, -high), (length, high), (0.0, high)]
    mesh = mesh_from_outline(corners, size=size)
    y = mesh.nodes[:, 1]
    sides = {"bottom": y < 1e-6 - high, "top": y > high - 1e-6}
    return mesh.with_sets(node_sets={name: np.flatnonzero(on) for name, on in sides.items()})
