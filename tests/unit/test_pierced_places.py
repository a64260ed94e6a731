"""Whole film is pierced at the same force wherever a tip comes down and however its edge lies."""

import numpy as np
import pytest

from shellcut import CohesiveLaw, Fracture, ShellMaterial, Simulation, StraightMotion, Support
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import rectangle
from teeth import tool_of, tooth, vee

CELL, N_CELL = 5, 4
"""Quads of 1 mm a side of one film, and films a side: each is clamped by itself."""

PLACES = [
    # The rim, and the corner of it.
    (0.02, 0.02), (2.0, 0.05), (2.4, 0.05), (4.5, 0.5),
    # Nodes, and beside them.
    (0.1, 2.5), (2.0, 2.0), (3.0, 2.0), (1.0, 1.0),
    (0.5, 2.0), (2.02, 2.02), (2.02, 2.0), (2.0 + 1e-7, 2.0),
    # Sides, and beside them; within a quad.
    (2.5, 2.0), (2.0, 2.3), (2.5, 2.0 + 1e-7), (2.31, 2.77),
]  # fmt: skip
"""Where the tips come down, film by film, row by row: in the first row and column at the rim."""


def skewed(mesh, amount=0.12):
    """Return a mesh whose inner nodes are moved by up to a part of a quad."""
    nodes, rng = mesh.nodes.copy(), np.random.default_rng(3)
    inner = np.setdiff1d(np.arange(len(nodes)), mesh.boundary_nodes())
    nodes[inner, :2] += rng.uniform(-amount, amount, (len(inner), 2))
    return Mesh.from_arrays(nodes, mesh.quads)


def pierced(angle, path, line, *, skew=False, puncture=None):
    """Press sixteen teeth into as many films; return the record of each, and of what is cut."""
    size = CELL * N_CELL
    mesh = rectangle(float(size), float(size), size=1.0)
    low = mesh.nodes.min(axis=0)
    held = np.flatnonzero((np.round(mesh.nodes - low, 6)[:, :2] % CELL == 0.0).any(axis=1))
    mesh = skewed(mesh) if skew else mesh
    firsts = [(CELL * (k % N_CELL), CELL * (k // N_CELL)) for k in range(len(PLACES))]
    teeth = [
        tooth(line, height=1.0, turn_deg=angle + 7.0 * skew, at=low[:2] + first + np.array(place))
        for first, place in zip(firsts, PLACES, strict=True)
    ]
    run = Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        supports=[Support.clamped(held)],
        tool=tool_of(*teeth).translated((0.0, 0.0, low[2] + 0.002)),
        motion=StraightMotion((0.0, 0.0, -1.0), speed=600.0, ramp=5e-5),
        law=CohesiveLaw(),
        fracture=Fracture(path=path, check_every=1, puncture_force=puncture),
    )
    first = {}
    while len(first) < len(PLACES) and run.state.time < 9e-4:
        seen = len(run.state.split_log)
        run.step()
        for record in run.state.split_log[seen:]:
            place = np.array(record.reference) - low
            k = int(place[0] // CELL) + N_CELL * int(place[1] // CELL)
            first.setdefault(min(record.edge if record.edge >= 0 else k, len(PLACES) - 1), record)
    return first


@pytest.mark.parametrize(
    ("path", "angle"),
    [("free", 0.0), ("free", 30.0), ("free", 45.0), ("free", 105.0), ("edges", 30.0)],
)
def test_a_tip_pierces_at_its_force_at_any_place_in_any_direction(path, angle):
    # Sixteen places in each direction; the force is looked at in every step.
    first = pierced(angle, path, vee(30.0, 0.8))
    assert sorted(first) == list(range(len(PLACES)))
    assert {record.kind for record in first.values()} == {"puncture"}
    assert max(record.measure for record in first.values()) < 1.06
    assert min(record.measure for record in first.values()) >= 1.0
