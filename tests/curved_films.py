"""Curved films for cuts through quads: strips rolled onto a cylinder, surfaces of revolution."""

import numpy as np

import shellcut as sc
from films import free_film, from_zero, shaken
from gmsh_films import gmsh_with
from shellcut.mesh.film_file import read_film
from shellcut.mesh.structured import rectangle


def moved(mesh, kind, amount, size, seed=5):
    """Return a strip from x = 0 whose rows of quads do not follow y = 0, its rims straight."""
    X = from_zero(mesh).nodes.copy()
    x, y = X[:, 0], X[:, 1]
    length, width = np.ptp(x), np.ptp(y)
    if kind == "offset":
        X[:, 1] += amount * size * (1.0 - (2.0 * y / width) ** 2)
    elif kind == "turned":
        ends = np.clip(np.minimum(x, length - x) / 6.0, 0.0, 1.0)
        X[:, 0] += np.tan(np.radians(amount)) * y * ends
    elif kind == "wavy":
        X[:, 1] += amount * np.sin(2.0 * np.pi * x / 9.0) * (1.0 - (2.0 * y / width) ** 2)
    elif kind == "random":
        return from_zero(shaken(mesh, amount, seed, size))
    return sc.Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)


class Roll:
    """A cylinder under a strip, its axis at an angle to the strip's middle line y = 0.

    The line of the cylinder over which (0, 0) lies is the crown; there the film is z = 0 and the
    middle line runs along +x.
    """

    def __init__(self, angle_deg, radius):
        angle = np.radians(angle_deg)
        self.radius, self.sine, self.cosine = radius, np.sin(angle), np.cos(angle)
        self.axis = np.array([self.cosine, self.sine, 0.0])
        self.hoop = np.array([-self.sine, self.cosine, 0.0])

    def onto(self, u, v):
        """Return places and normals in space of the strip's points u, v, shape (n, 3) each."""
        u, v = np.broadcast_arrays(np.atleast_1d(u), v)
        turn = (v * self.cosine - u * self.sine) / self.radius
        up = np.array([0.0, 0.0, 1.0])
        normal = np.outer(np.sin(turn), self.hoop) + np.outer(np.cos(turn), up)
        along = np.outer(u * self.cosine + v * self.sine, self.axis)
        return along + self.radius * (normal - up), normal

    def mesh(self, strip):
        """Return a flat strip rolled onto the cylinder."""
        X, normals = self.onto(strip.nodes[:, 0], strip.nodes[:, 1])
        return sc.Mesh.from_arrays(X, strip.quads, node_sets=strip.node_sets, directors=normals)

    def unrolled(self, X):
        """Return u, v of places in space."""
        turn = np.arctan2(X @ self.hoop, X[:, 2] + self.radius) * self.radius
        along = X @ self.axis
        return (
            along * self.cosine - turn * self.sine,
            along * self.sine + turn * self.cosine,
        )

    def motion(self, speed, ramp):
        """Return the motion along the middle line, which maps the cylinder onto itself.

        With it the way in mm per unit of its coordinate.
        """
        if self.sine == 0.0:
            return sc.StraightMotion((1.0, 0.0, 0.0), speed=speed, ramp=ramp), 1.0
        screw = sc.ScrewMotion(
            angular_speed=speed * self.sine / self.radius,
            pitch=2.0 * np.pi * self.radius * self.cosine / self.sine,
            ramp=ramp,
            axis=tuple(self.axis),
            axis_point=(0.0, 0.0, -self.radius),
            advance=tuple(self.axis),
        )
        return screw, self.radius / self.sine


TORN = sc.CohesiveLaw(opening_a=0.02, opening_p=0.05, opening_u=0.1)
"""A law of a short process zone, for films without a blade."""


def torn_across(mesh, notch, **options):
    """Pull a strip along x, its node set "left" held, until a crack from a notch is through."""
    held = {"translation": "xyz", "rotation": "xyz"}
    pull = {"x": lambda time: 400.0 * min(1.0, time / 2e-4)}
    supports = [sc.Support("left", **held), sc.Support("right", **held, velocity=pull)]
    options = {"law": TORN, "damping_alpha": 2000.0, **options}
    sim = free_film(mesh, supports=supports, **options)
    sim.notch(*notch)
    while sim.state.time < 6e-4 and sim.cracks.tips:
        sim.step()
    book = sim.close_ledger()
    assert abs(book.relative(book.imbalance)) < 1e-3
    return sim


def strip_with_hole(length, width, size, hole):
    """Return a strip from x = 0 without the quads whose centres lie in x from, x to, |y| up to."""
    mesh = from_zero(rectangle(length, width, size=size))
    X = mesh.nodes
    x, y, _ = X[mesh.quads].mean(axis=1).T
    stays = ~((hole[0] < x) & (x < hole[1]) & (np.abs(y) < hole[2]))
    used, quads = np.unique(mesh.quads[stays], return_inverse=True)
    X = X[used]
    sides = {"bottom": X[:, 1] < 1e-9 - width / 2, "top": X[:, 1] > width / 2 - 1e-9}
    sets = {name: np.flatnonzero(at) for name, at in sides.items()}
    return sc.Mesh.from_arrays(X, quads.reshape(-1, 4), node_sets=sets)


def revolved(path, kind, size, *, tilt_deg=0.0):
    """Return a cap of a sphere, or a sector of a cone or a bottle's shoulder, as Gmsh meshes it.

    Written to a file and read by the library. The axis is z, leaning by ``tilt_deg`` about x; the
    sectors lie around -x. The set "rim" is the whole boundary.
    """
    # all quads: each is cut in four
    quads = {"RecombineAll": 1, "RecombinationAlgorithm": 1, "SubdivisionAlgorithm": 1}
    with gmsh_with(Algorithm=6, MeshSizeMin=2 * size, MeshSizeMax=2 * size, **quads) as gmsh:
        surfaces = _cap(gmsh, 12.0, 8.0) if kind == "cap" else _sector(gmsh, kind)
        rim = gmsh.model.getBoundary([(2, s) for s in surfaces], oriented=False)
        gmsh.model.addPhysicalGroup(2, surfaces, name="film")
        gmsh.model.addPhysicalGroup(1, [c for d, c in rim if d == 1], name="rim")
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    mesh = read_film(path, unit="mm")
    c, s = np.cos(np.radians(tilt_deg)), np.sin(np.radians(tilt_deg))
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    return sc.Mesh.from_arrays(mesh.nodes @ turn.T, mesh.quads, node_sets=mesh.node_sets)


def _cap(gmsh, radius, rim):
    shape, latitude = gmsh.model.occ, np.arccos(rim / radius)
    shape.addSphere(0.0, 0.0, -radius * np.sin(latitude), radius, angle1=latitude)
    shape.synchronize()
    return [s for _, s in gmsh.model.getEntities(2) if gmsh.model.getType(2, s) == "Sphere"]


def _sector(gmsh, kind):
    sector = np.radians(150.0)
    if kind == "cone":
        profile = [(9.0, 0.0), (4.5, 6.0)]
    else:
        z = np.linspace(0.0, 8.0, 17)
        neck = np.stack([7.0 + 3.0 * np.cos(np.pi * z / 8.0), z], axis=1).tolist()
        profile = [(10.0, -2.5), *neck, (4.0, 9.5)]
    shape = gmsh.model.occ
    points = [shape.addPoint(r, 0.0, z) for r, z in profile]
    curve = shape.addLine(*points) if kind == "cone" else shape.addSpline(points)
    made = [m for m in shape.revolve([(1, curve)], 0, 0, 0, 0, 0, 1, sector) if m[0] == 2]
    shape.rotate(made, 0, 0, 0, 0, 0, 1, np.pi - 0.5 * sector)
    shape.synchronize()
    return [s for _, s in made]
