"""Discs meshed by Gmsh as a user would, in quads by several algorithms."""

from contextlib import contextmanager

import numpy as np

from shellcut import Mesh

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


def gmsh_disc(algorithm, recombination, size, *, seed=0):
    """Return a disc with the set "rim", its whole boundary circle."""
    with gmsh_with(
        Algorithm=algorithm,
        RandomSeed=seed + 1,
        RandomFactor=1e-9 if seed == 0 else 1e-4 * seed,
        MeshSizeMin=size,
        MeshSizeMax=size,
        RecombinationAlgorithm=recombination,
    ) as gmsh:
        shape = gmsh.model.occ
        shape.addDisk(0.0, 0.0, 0.0, RADIUS, RADIUS)
        shape.rotate(shape.getEntities(2), 0, 0, 0, 0, 0, 1, 0.37 * seed)
        shape.synchronize()
        # an odd number of nodes on a rim leaves triangles
        for _, curve in gmsh.model.getEntities(1):
            n_pair = round(shape.getMass(1, curve) / size / 2)
            gmsh.model.mesh.setTransfiniteCurve(curve, 2 * n_pair + 1)
        for _, surface in gmsh.model.getEntities(2):
            gmsh.model.mesh.setRecombine(2, surface)
        gmsh.model.mesh.generate(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        types, _, corners = gmsh.model.mesh.getElements(2)
    (kind,) = types
    assert kind == 3, "triangles were left"
    row = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    row[tags.astype(np.int64)] = np.arange(len(tags))
    quads = row[corners[0].astype(np.int64).reshape(-1, 4)]
    used, quads = np.unique(quads, return_inverse=True)
    return _with_rim(places.reshape(-1, 3)[used, :2], quads.reshape(-1, 4))


def _with_rim(nodes, quads):
    p, q = nodes[quads[:, 2]] - nodes[quads[:, 0]], nodes[quads[:, 3]] - nodes[quads[:, 1]]
    clockwise = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] < 0.0
    quads[clockwise] = quads[clockwise][:, ::-1]
    boundary = Mesh.from_arrays(nodes, quads).boundary_nodes()
    rim = boundary[np.hypot(*nodes[boundary].T) > 0.97 * RADIUS]
    nodes[rim] *= (RADIUS / np.hypot(*nodes[rim].T))[:, None]  # middles of sides stood inside
    return Mesh.from_arrays(nodes, quads, node_sets={"rim": rim})
