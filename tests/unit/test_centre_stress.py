"""Stress at the centres: the kernel against its definition in NumPy."""

import numpy as np
import pytest

from naive import cases
from shellcut.centre_stress import CentreStress
from shellcut.material import Elastic, Layer, ShellMaterial

LAMINATE = ShellMaterial(
    [Layer(Elastic(5000.0, 0.35, 2e-9), 0.01), Layer(Elastic(800.0, 0.4, 1e-9), 0.06)]
)


def base_vectors(x, t, z):
    """g_1, g_2 at the centre and the height z, and the director there."""
    d1 = 0.25 * np.array([-1, 1, 1, -1])
    d2 = 0.25 * np.array([-1, -1, 1, 1])
    return d1 @ x + z * (d1 @ t), d2 @ x + z * (d2 @ t), t.mean(axis=0)


def stress(X, T, x, t, material, place):
    h = material.thickness
    z = {"top": 0.5 * h, "bottom": -0.5 * h}.get(place, 0.0)
    layer = {"top": -1, "bottom": 0}.get(place, 1 if len(material.layers) > 1 else 0)
    law = material.layers[layer].material.plane_stress()
    G1, G2, T0 = base_vectors(X, T, z)
    g1, g2, _ = base_vectors(x, t, z)
    # The deformation gradient of the surface, taken from and to the plane of the frame.
    e3 = T0 / np.linalg.norm(T0)
    e1 = np.cross(G2, e3) / np.linalg.norm(np.cross(G2, e3))
    e2 = np.cross(e3, e1)
    up = np.linalg.inv(np.stack([G1, G2, T0], axis=1))[:2]
    F = np.outer(g1, up[0]) + np.outer(g2, up[1])
    frame = np.stack([e1, e2])
    reference = np.outer(G1, up[0]) + np.outer(G2, up[1])
    E = 0.5 * frame @ (F.T @ F - reference.T @ reference) @ frame.T
    s = law @ [E[0, 0], E[1, 1], 2 * E[0, 1]]
    S = np.array([[s[0], s[2]], [s[2], s[1]]])
    carried = F @ frame.T
    if place == "nominal":
        f1 = carried[:, 0] / np.linalg.norm(carried[:, 0])
        normal = np.cross(carried[:, 0], carried[:, 1])
        f2 = np.cross(normal / np.linalg.norm(normal), f1)
        return np.stack([f1, f2], axis=1) @ S @ np.stack([f1, f2])
    J = np.linalg.norm(np.cross(g1, g2)) / np.linalg.norm(np.cross(G1, G2))
    return carried @ S @ carried.T / J


@pytest.mark.parametrize("place", ["mid", "top", "bottom", "nominal"])
@pytest.mark.parametrize("material", [cases.FILM, LAMINATE], ids=["film", "laminate"])
@pytest.mark.parametrize("case", cases.ALL)
def test_stress_is_its_definition(case, material, place):
    mesh = cases.ALL[case]()
    _, state = cases.set_up(mesh)
    cases.deform(state)
    which = np.array([4, 0, 3])
    got = CentreStress(mesh, material).cauchy(state.node.x, state.node.t, state.quads, which, place)
    for tensor, e in zip(got, which, strict=True):
        q = mesh.quads[e]
        x, t = state.node.x[q], state.node.t[q]
        wanted = stress(mesh.nodes[q], mesh.directors[q], x, t, material, place)
        # Round-off of a metric of order one.
        np.testing.assert_allclose(tensor, wanted, atol=1e-12 * np.abs(wanted).max() * 10)


def test_a_wrong_place_is_refused():
    mesh = cases.warped()
    _, state = cases.set_up(mesh)
    with pytest.raises(ValueError, match=r"place must be one of .*, got 'side'"):
        CentreStress(mesh, cases.FILM).cauchy(
            state.node.x, state.node.t, state.quads, np.arange(2), "side"
        )
