"""Layers of film that lie close together are pierced one by one, each at its own force."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.fracture.puncture import puncture_force
from shellcut.mesh.structured import rectangle
from teeth import tool_of, tooth, vee

FILM, LAW, SPEED, SIDE = sc.ShellMaterial.homogeneous(), sc.CohesiveLaw(), 1000.0, 6.4
SHEET = rectangle(SIDE, SIDE, n_x=8, n_y=8)
RIM = SHEET.boundary_nodes()


def layers(*heights):
    """Return sheets one above the other, and the nodes of their rims."""
    n = len(SHEET.nodes)
    nodes = np.concatenate([SHEET.nodes + np.array([0.0, 0.0, z]) for z in heights])
    quads = np.concatenate([SHEET.quads + k * n for k in range(len(heights))])
    held = np.concatenate([RIM + k * n for k in range(len(heights))])
    return sc.Mesh.from_arrays(nodes, quads), held


def folded(gap):
    """Return a film that is folded back below itself, and the nodes of its rim and its bend."""
    straight, turn = np.linspace(0.0, SIDE, 9), np.linspace(0.0, np.pi, 7)[1:-1]
    x = np.concatenate([straight, SIDE + 0.5 * gap * np.sin(turn), straight[::-1]])
    z = np.concatenate([0.0 * straight, 0.5 * gap * (np.cos(turn) - 1.0), 0.0 * straight - gap])
    y, m = SHEET.nodes[::9, 1], len(x)
    nodes = np.array([(a, b, c) for b in y for a, c in zip(x, z, strict=True)])
    first = np.array([k * m + i for k in range(8) for i in range(m - 1)])
    mesh = sc.Mesh.from_arrays(nodes, first[:, None] + [0, 1, m + 1, m])
    bent = np.flatnonzero(nodes[:, 0] > SIDE - 1e-6)
    return mesh, np.union1d(mesh.boundary_nodes(), bent)


def pierced(film, depth):
    """Return time, height, depth and the force on the edge where a spear pierces layers."""
    mesh, held = film
    middle = 0.5 * SHEET.nodes[0] + 0.5 * SHEET.nodes[-1]
    sim = sc.Simulation(
        mesh,
        FILM,
        supports=[sc.Support.clamped(held)],
        tool=tool_of(tooth(vee(70.0, 0.8))).translated(middle + np.array([0.013, 0.03, 0.005])),
        motion=sc.StraightMotion((0.0, 0.0, -1.0), speed=SPEED, ramp=5e-5),
        law=LAW,
    )
    sim.run(depth / SPEED)
    return [
        (one.time, one.reference[2], one.depth, one.force)
        for one in sim.state.split_log
        if one.kind == "puncture"
    ]


@pytest.mark.parametrize(
    "film",
    [
        layers(0.0, -0.07),
        layers(0.0, -0.3),
        layers(0.0, -0.15, -0.3),
        folded(0.12),
        folded(0.35),
    ],
    ids=["close", "apart", "three", "close fold", "fold"],
)
def test_each_layer_is_pierced_as_if_it_were_alone(film):
    heights = np.unique(film[0].nodes[film[0].quads].mean(axis=1)[:, 2].round(9))[::-1]
    heights = heights[[np.isclose(film[0].nodes[:, 2], z).sum() > 70 for z in heights]]
    ((time, _, alone, force),) = pierced(layers(0.0), 0.5)
    assert force == pytest.approx(puncture_force(FILM, LAW), rel=0.02)
    found = pierced(film, 0.5 - heights[-1])
    assert [height for _, height, _, _ in found] == pytest.approx(heights.tolist())
    for when, height, depth, _ in found:
        # A check is 0.004 ms after the other; what the layers above carry makes no difference.
        assert when == pytest.approx(time - height / SPEED, abs=1e-5)
        assert depth == pytest.approx(alone, abs=0.012)
