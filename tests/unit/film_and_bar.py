"""A film of 1 mm quads and a square bar that comes at its rim with an edge, between two nodes."""

import numpy as np

from shellcut import Contact, ShellMaterial, Simulation, StraightMotion, Support, Tool
from shellcut.mesh.structured import rectangle

ON = Contact(film_edges=True, tool_points=False)
GAP = 0.01


def bar(side=0.6, length=3.0):
    """A square bar along z; one of its edges is at the origin, the bar lies in x < 0."""
    w = side / np.sqrt(2.0)
    section = np.array([[-w, -w], [-2.0 * w, 0.0], [-w, w], [0.0, 0.0]])
    return prism(section, length)


def flat_bar(width=0.3, deep=0.6, length=3.0):
    """A bar along z that ends in x = 0 with a flat face between two of its edges."""
    w = 0.5 * width
    return prism(np.array([[0.0, -w], [-deep, -w], [-deep, w], [0.0, w]]), length)


def prism(section, length):
    """A bar along z of a section of four corners, (4, 2)."""
    ends = [np.column_stack([section, np.full(4, z)]) for z in (-0.5 * length, 0.5 * length)]
    sides = [t for i in range(4) for j in [(i + 1) % 4] for t in ((i, i + 4, j), (j, i + 4, j + 4))]
    caps = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6)]
    return Tool.from_triangles(np.vstack(ends), sides + caps, edges=np.zeros((0, 2), int))


def round_bar(radius=1.0, length=3.0, n=60):
    """A bar of n facets along z, one edge of which is at the origin; it lies in x < 0."""
    angle = 2.0 * np.pi * np.arange(n) / n
    section = radius * np.column_stack([np.cos(angle) - 1.0, np.sin(angle)])
    ends = [np.column_stack([section, np.full(n, z)]) for z in (-0.5 * length, 0.5 * length)]
    sides = [t for i in range(n) for j in [(i + 1) % n] for t in ((i, j, i + n), (j, j + n, i + n))]
    caps = [(0, i + 1, i) for i in range(1, n - 1)]
    caps += [(n, n + i, n + i + 1) for i in range(1, n - 1)]
    return Tool.from_triangles(np.vstack(ends), sides + caps, edges=np.zeros((0, 2), int))


def pushed(contact=ON, at=0.3, direction=(1.0, 0.0, 0.0), tool=None, **options):
    """A film of 1 mm quads, clamped on the right, and a bar that comes at its left rim."""
    mesh = rectangle(4.0, 4.0, n_x=4, n_y=4)
    left, right = mesh.nodes[:, 0].min(), mesh.nodes[:, 0].max()
    return Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        supports=[Support.clamped(np.flatnonzero(np.isclose(mesh.nodes[:, 0], right)))],
        tool=(tool or bar()).translated((left - GAP, at, 0.0)),
        motion=StraightMotion(direction, speed=2000.0, ramp=2e-5),
        contact=contact,
        **options,
    )
