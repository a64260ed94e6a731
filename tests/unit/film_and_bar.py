"""A film of 1 mm quads and a square bar that comes at its rim with an edge, between two nodes."""

import numpy as np

from blunt_tools import blunt, prism
from shellcut import Contact, ShellMaterial, Simulation, StraightMotion, Support
from shellcut.mesh.structured import rectangle

ON = Contact(film_edges=True, tool_points=False)
GAP = 0.01


def bar(side=0.6, length=3.0):
    """A square bar along z; one of its edges is at the origin, the bar lies in x < 0."""
    w = side / np.sqrt(2.0)
    return along_z([(0.0, 0.0), (-w, w), (-2.0 * w, 0.0), (-w, -w)], length)


def flat_bar(width=0.3, deep=0.6, length=3.0):
    """A bar along z that ends in x = 0 with a flat face between two of its edges."""
    w = 0.5 * width
    return along_z([(0.0, w), (-deep, w), (-deep, -w), (0.0, -w)], length)


def round_bar(radius=1.0, length=3.0, n=60):
    """A bar of n facets along z, one edge of which is at the origin; it lies in x < 0."""
    angle = 2.0 * np.pi * np.arange(n) / n
    return along_z(radius * np.column_stack([np.cos(angle) - 1.0, np.sin(angle)]), length)


def along_z(section, length):
    return blunt(*prism(section, -0.5 * length, 0.5 * length))


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
