"""A notch tears from about the same stress on, wherever in the quads it ends."""

import numpy as np
import pytest

import shellcut as sc
from films import shaken
from shellcut.mesh.structured import rectangle

LAW = sc.CohesiveLaw(
    strength=18.0, plateau=12.0, opening_a=0.25, opening_p=1.5, opening_u=2.0, onset=0.005
)
SIDE = 8.0


def sheared():
    mesh = rectangle(SIDE, SIDE, n_x=16, n_y=16)
    X = mesh.nodes.copy()
    X[:, 0] += 0.3 * X[:, 1] * np.sin(np.pi * X[:, 0] / SIDE)
    return sc.Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)


MESHES = {
    "square": rectangle(SIDE, SIDE, n_x=16, n_y=16),
    "wide": rectangle(SIDE, SIDE, n_x=12, n_y=24),
    "sheared": sheared(),
    "shaken": shaken(rectangle(SIDE, SIDE, n_x=16, n_y=16), 0.08, 3),
}


def tears(mesh, start, stop, stress, sides=("bottom", "top")):
    """Whether a notch tears in a film at rest under a mean stress [MPa]."""
    material = sc.ShellMaterial.homogeneous()
    held = [sc.Support.clamped(name) for name in sides]
    path = sc.Fracture(path="free", check_every=1)
    sim = sc.Simulation(mesh, material, supports=held, law=LAW, fracture=path, imperfection=0)
    sim.notch((*start, 0.0), (*stop, 0.0))
    n, axis = sim.state.node, 1 if "top" in sides else 0
    pulled = mesh.node_set(sides[1])

    def rest_at(strain):
        displacement = np.zeros((n.count, 3))
        displacement[:, axis] = strain * (n.X[: n.count, axis] - n.X[: n.count, axis].min())
        sim.relax(displacement, tolerance=2e-3)
        return n.reaction[pulled, axis].sum() / material.thickness / SIDE

    # The film is linear: what is missing after a guess of the strain is made up for.
    guess = 0.5 * stress / 1678.0
    rest_at(guess * (stress / rest_at(guess) - 1.0))
    sim.step()
    return sim.state.crack_length > 0.0


def notch(slope_deg, length, shift, low):
    """A notch from the left border upwards."""
    slope = np.radians(slope_deg)
    start = np.array([-0.3, low + shift])
    return start, start + length * np.array([np.cos(slope), np.sin(slope)])


@pytest.mark.parametrize(
    ("mesh", "slope_deg", "length", "shift"),
    [
        ("square", 0, 3.02, 0.1),
        ("square", 55, 3.0, 0.02),
        ("square", 55, 3.0, 0.25),
        ("square", 55, 3.0, 0.48),
        ("wide", 10, 3.02, 0.1),
        ("wide", 30, 3.0, 0.02),
        ("wide", 55, 3.1, 0.48),
        ("sheared", 30, 3.07, 0.33),
        ("sheared", 55, 3.05, 0.25),
        ("sheared", 75, 3.07, 0.33),
        ("shaken", 10, 3.08, 0.4),
        ("shaken", 30, 3.0, 0.02),
    ],
)
def test_the_place_in_the_quad_does_not_decide_when_a_notch_tears(mesh, slope_deg, length, shift):
    """Most of these notches would first cut a corner of a quad off."""
    at = notch(slope_deg, length, shift, -2.0 if slope_deg > 40 else -1.0)
    assert not tears(MESHES[mesh], *at, 2.5)
    assert tears(MESHES[mesh], *at, 8.0)


@pytest.mark.parametrize("y", [0.1, 0.25, 0.4])
def test_a_slit_along_the_pull_does_not_tear(y):
    """It barely disturbs the stress, which is half the strength."""
    assert not tears(MESHES["square"], (-1.0, y), (3.2, y), 9.0, ("left", "right"))


def steps_to_tear(path, slope_deg, shift, shear, *, beside_a_blade):
    """Steps until a notch in the middle of a film tears, pulled across by its long sides."""
    mesh, middle, tool = rectangle(9.6, SIDE, n_x=12, n_y=10), 4.8, {}
    options = {"fibres": 0}
    if path == "edges":  # along the pull
        mesh = mesh.cut(mesh.nodes_where(lambda x, y, z: (abs(x - middle) < 0.1) & (abs(y) < 1.7)))
        options["turn_limit_deg"] = 100.0
    if beside_a_blade:  # 9 mm before the film
        blade = sc.tool_shapes.straight_blade(length=3.0, height=4.0).translated((-9.0, 0.0, 0.0))
        tool = {"tool": blade, "motion": sc.StraightMotion((1.0, 0.0, 0.0), 1.0, ramp=1e-5)}

    def rates(sign):
        return {"x": lambda t: sign * 150.0 * shear, "y": lambda t: sign * 150.0}

    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(young=2000.0, poisson=0.3),
        supports=[
            sc.Support("top", velocity=rates(1.0)),
            sc.Support("bottom", velocity=rates(-1.0)),
        ],
        law=sc.CohesiveTable(openings=[0.0, 0.3, 1.6, 2.0], tractions=[18.0, 12.0, 12.0, 0.0]),
        fracture=sc.Fracture(path=path, **options),
        imperfection=0,
        **tool,
    )
    if path == "free":
        slope = np.radians(slope_deg)
        half = 1.6 * np.array([np.cos(slope), np.sin(slope), 0.0])
        sim.notch(*(np.array([middle + shift, -0.07, 0.0]) + side * half for side in (-1.0, 1.0)))
    while sim.state.crack_length == 0.0 and sim.state.step < 1500:
        sim.step()
    return sim.state.step


@pytest.mark.parametrize(
    ("path", "slope_deg", "shift", "shear"),
    [
        ("free", 80, 0.33, 0.0),
        ("free", 82, 0.0, 0.0),
        ("free", 90, 0.37, 0.0),
        ("free", 95, 0.13, 0.0),
        ("free", 30, 0.2, 0.8),
        ("free", 120, 0.2, 0.8),
        ("edges", 90, 0.0, 0.0),
        ("edges", 90, 0.0, 0.4),
    ],
)
def test_a_blade_that_touches_nothing_does_not_make_a_tear_wait(path, slope_deg, shift, shear):
    """Straight ahead hardly any force pulls on most of these notches; they tear to the side."""
    alone, beside = (
        steps_to_tear(path, slope_deg, shift, shear, beside_a_blade=blade)
        for blade in (False, True)
    )
    # With a blade directions are searched in every fifth check, of ten steps each.
    assert alone <= beside <= alone + 50
