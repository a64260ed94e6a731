"""The force on a tip against closed forms, and the directions that follow from it."""

import numpy as np
import pytest

import shellcut as sc
from naive import cases
from shellcut.fracture.tip_force import TipForce
from shellcut.material import Elastic, Hencky, Layer, Linear, Plastic
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.mitc4.element import N_STRAIN
from shellcut.mitc4.section import full_stiffness
from shellcut.mitc4.sliding_energy import SlidingEnergy
from shellcut.mitc4.tangent import reference_products

YOUNG, POISSON, THICKNESS = 1678.0, 0.3, 0.1
FILM = sc.ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, density=1e-9, thickness=THICKNESS)
BASE = np.eye(3)[:2]


def energies(X, T, x, t):
    """½ sᵀ H s of quads."""
    H, (i, j) = np.zeros((len(X), N_STRAIN, N_STRAIN)), np.triu_indices(N_STRAIN)
    H[:, i, j] = H[:, j, i] = full_stiffness(X, T, FILM)
    s = reference_products(x, t) - reference_products(X, T)
    return 0.5 * np.einsum("ei,eij,ej->e", s, H, s)


def test_the_change_of_energy_with_a_slide_is_that_of_the_energy():
    rng = np.random.default_rng(3)
    mesh = cylinder(5.0, 4.0, n_around=24, n_along=4)
    X, T = mesh.nodes[mesh.quads], mesh.directors[mesh.quads]
    x, t = X + 0.05 * rng.normal(size=X.shape), T + 0.05 * rng.normal(size=T.shape)
    move = rng.normal(size=X.shape)
    # Along a quad's own side: its corner 1 by 0.3 of the way to corner 2, with the director.
    slide, turned = np.zeros((2, *X.shape))
    slide[:, 1], turned[:, 1] = 0.3 * (X[:, 2] - X[:, 1]), 0.3 * (T[:, 2] - T[:, 1])
    found = SlidingEnergy.of(X, T, slide[None], FILM).changes(x, t, move[None])[0]
    step = 1e-5
    ends = [energies(X + s * slide, T + s * turned, x + s * move, t) for s in (step, -step)]
    # Discretisation: two central differences, exact to the square of their steps.
    assert found == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-5)


@pytest.mark.parametrize(
    "load",
    [
        None,
        sc.Pressure(0.3),
        sc.Pressure(0.3, following=True),
        sc.Gravity((0.0, 3e9, 2e9)),
        sc.EdgeTraction("right", (30.0, 0.0, 20.0)),
    ],
)
def test_an_even_state_has_no_tip(load):
    """Even strain, turned, moving at an even speed or loaded: nothing is released anywhere."""
    mesh = rectangle(6.0, 6.0, size=0.5)
    rng = np.random.default_rng(1)
    X = mesh.nodes.copy()
    inside = np.setdiff1d(np.arange(mesh.n_node), mesh.boundary_nodes())
    X[inside, :2] += 0.1 * rng.uniform(-1.0, 1.0, (inside.size, 2))
    mesh = sc.Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)
    loads = [] if load is None else [load]
    sim = sc.Simulation(mesh, FILM, damping_alpha=0.0, loads=loads)
    stretch = np.array([[1.01, 0.003, 0.0], [0.0, 0.995, 0.0], [0.004, 0.0, 1.0]])
    n = sim.state.node
    n.x[: n.count] = n.X[: n.count] @ stretch.T + [40.0, -30.0, 20.0]
    n.t[: n.count] = np.cross(*(BASE @ stretch.T))
    n.t[: n.count] /= np.linalg.norm(n.t[0])
    force = TipForce(sim.state, sim.shell, np.array([3.0, 0.2, 0.0]), BASE, 2.0, sim.loads)
    energy = YOUNG * THICKNESS * 0.01**2  # per area, of that order
    # Round-off, over the energy in the domain and what the loads would do over 1 mm.
    assert np.abs(force.of(sim.state, BASE @ stretch.T)).max() < 1e-8 * energy


@pytest.mark.parametrize("law", ["Hencky", "von Mises"])
def test_a_law_that_is_not_linear_is_refused(law):
    film = Elastic(YOUNG, POISSON, 1e-9)
    given = Hencky(film) if law == "Hencky" else Plastic(film, Linear(15.0, 60.0))
    mesh = rectangle(2.0, 2.0, size=1.0)
    shell, state = cases.set_up(mesh, sc.ShellMaterial([Layer(given, THICKNESS)]))
    with pytest.raises(ValueError, match=f"known for linear films without axes only, got {law}"):
        TipForce(state, shell, np.array([1.0, 0.0, 0.0]), BASE, 2.0)


def strip_at_rest(pull, notch=8.0, height=4.0):
    """A long notched strip whose upper and lower sides are moved apart by ``pull`` [mm]."""
    mesh = rectangle(16.0, height, size=0.25)
    X = mesh.nodes - [mesh.nodes[:, 0].min(), 0.0, 0.0]
    mesh = sc.Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)
    supports = [sc.Support.clamped("bottom"), sc.Support.clamped("top")]
    sim = sc.Simulation(
        mesh,
        FILM,
        supports=supports,
        law=sc.CohesiveLaw(strength=1e3),
        fracture=sc.Fracture(path="free"),
    )
    sim.notch((-1.0, 0.0, 0.0), (notch, 0.0, 0.0))
    y = sim.state.node.X[: sim.state.node.count, 1]
    share = np.clip(y / height, -0.5, 0.5)
    sim.relax(share[:, None] * np.asarray(pull), tolerance=1e-4)
    return sim


@pytest.mark.parametrize("reach", [1.0, 1.8])
def test_a_long_strip_releases_the_energy_ahead_of_its_tip(reach):
    """Far behind the tip nothing is stored, far ahead E' e²/2 per volume over the height."""
    stretch = 0.004
    sim = strip_at_rest([0.0, 4.0 * stretch, 0.0])
    force = TipForce(sim.state, sim.shell, np.array([8.0, 0.0, 0.0]), BASE, reach)
    strain = stretch + 0.5 * stretch**2
    released = 0.5 * YOUNG / (1.0 - POISSON**2) * strain**2 * THICKNESS * 4.0
    J = force.of(sim.state, BASE)
    # Discretisation (quads of a sixteenth of the height at a singular tip).
    assert J[0] == pytest.approx(released, rel=0.03)
    assert abs(J[1]) < 1e-3 * released  # round-off and rest: it is symmetric


def pressed_strip(load, beside=0.0, pull=0.0, length=12.0, height=4.0):
    """A strip with clamped long sides, notched to its middle, at rest under a load."""
    mesh = rectangle(length, height, size=0.25)
    X = mesh.nodes - [mesh.nodes[:, 0].min(), 0.0, 0.0]
    mesh = sc.Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)
    sim = sc.Simulation(
        mesh,
        FILM,
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        loads=[load],
        law=sc.CohesiveLaw(strength=1e3),
        fracture=sc.Fracture(path="free"),
    )
    sim.notch((-1.0, beside, 0.0), (0.5 * length, beside, 0.0))
    sim.relax(tolerance=1e-3)
    return sim


def in_space(sim):
    """Row ahead of the only tip, and what the base has become there."""
    path, (tip,) = sim.cracks.free._path, sim.cracks.free.tips
    row, entry = path.rows_ahead(tip)[0]
    x = sim.state.node.x[sim.state.quads[row]]
    return tip, np.array([path.carried_on(row, entry, way) @ x for way in BASE])


PRESSURE = 1e-5  # MPa: it deflects the flanks by 1e-3 of their thickness


@pytest.mark.parametrize(
    "load",
    [
        sc.Pressure(PRESSURE),
        sc.Pressure(PRESSURE, following=True),
        sc.Gravity((0.0, 0.0, PRESSURE / (1e-9 * THICKNESS))),
    ],
)
def test_a_pressed_strip_releases_what_its_load_does_less_what_it_stores(load):
    """Ahead a beam with clamped ends, behind two cantilevers: -E + W = ½ p ∫ w dy in each."""
    height, beside = 4.0, 0.1
    sim = pressed_strip(load, beside=beside)
    tip, moved = in_space(sim)
    place = sim.cracks.free._path.reference_of(sim.state, tip)
    ahead = height**5 / 720.0
    behind = sum((0.5 * height + s * beside) ** 5 / 20.0 for s in (1.0, -1.0))
    D = YOUNG * THICKNESS**3 / (12.0 * (1.0 - POISSON**2))
    released = 0.5 * PRESSURE**2 * (behind - ahead) / D
    for reach in (1.0, 1.8):
        force = TipForce(sim.state, sim.shell, place, BASE, reach, sim.loads)
        # Discretisation: 1.00 and 0.99; weight 1.02, lumped with the mass. 1.15 and 2 without load.
        assert force.of(sim.state, moved)[0] == pytest.approx(released, rel=0.03)


def test_a_crack_in_the_middle_of_a_pressed_strip_goes_straight_on():
    # What the load does in the sliding is larger than what is released: without it, 16° aside.
    sim = pressed_strip(sc.Pressure(PRESSURE))
    tip, _ = in_space(sim)
    way = next(sim.cracks.free._direction.ways(sim.state, tip))
    assert abs(way[1] / way[0]) < np.tan(np.radians(0.1))  # rest, to 1e-3 of the load
