"""The force on a tip against closed forms, and the directions that follow from it."""

import numpy as np
import pytest
from scipy.integrate import quad

import shellcut as sc
from films import free_film, from_zero, shaken
from free_strip import notched_sheet, path_in, segment_ahead
from naive import cases
from naive.shell import shape
from page_tables import numbers_of, row, shown_as, table
from shellcut.fracture.free_direction import FreeDirection
from shellcut.fracture.sheet_stress import sheet_stress
from shellcut.fracture.tip_domain import TipDomain
from shellcut.fracture.tip_force import TipForce
from shellcut.material import Elastic, Layer, Linear, Orthotropic, Plastic
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.mitc4.element import N_STRAIN
from shellcut.mitc4.section import axes_in_frame, frame_components, full_stiffness, gauss_geometry
from shellcut.mitc4.sliding_points import SlidingPoints
from shellcut.mitc4.tangent import quad_products
from shellcut.state import JOINTED
from shellcut.tool_shapes import straight_blade
from tip_domains import BASE, at_tip, domain_in, force_on

YOUNG, POISSON, THICKNESS = 1678.0, 0.3, 0.1
FILM = sc.ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, density=1e-9, thickness=THICKNESS)


def layered(material, **options):
    return sc.ShellMaterial([Layer(material, THICKNESS)], **options)


ALONG = Orthotropic(900.0, 2400.0, 0.2, 500.0, 1e-9)
STIFFER = Orthotropic(900.0, 2400.0, 0.2, 500.0, 1e-9, angle_deg=25.0)


def energies(film, X, T, x, t):
    """½ sᵀ H s of quads."""
    H, (i, j) = np.zeros((len(X), N_STRAIN, N_STRAIN)), np.triu_indices(N_STRAIN)
    H[:, i, j] = H[:, j, i] = full_stiffness(X, T, film)
    s = quad_products(x, t) - quad_products(X, T)
    return 0.5 * np.einsum("ei,eij,ej->e", s, H, s)


@pytest.mark.parametrize(
    "film",
    [
        FILM,
        layered(Elastic(YOUNG, POISSON, 1e-9), points_per_layer=3),
        layered(STIFFER, direction=(1.0, 1.0, 0.2)),
    ],
)
def test_the_change_of_energy_with_a_slide_is_that_of_the_energy(film):
    rng = np.random.default_rng(3)
    mesh = cylinder(5.0, 4.0, n_around=24, n_along=4)
    X, T = mesh.nodes[mesh.quads], mesh.directors[mesh.quads]
    x, t = X + 0.05 * rng.normal(size=X.shape), T + 0.05 * rng.normal(size=T.shape)
    move, turn = rng.normal(size=(2, *X.shape))
    # Along a quad's own side: its corner 1 by 0.3 of the way to corner 2, with the director.
    slide, turned = np.zeros((2, *X.shape))
    slide[:, 1], turned[:, 1] = 0.3 * (X[:, 2] - X[:, 1]), 0.3 * (T[:, 2] - T[:, 1])
    found = SlidingPoints(X, T, slide[None], film).changes(x, t, move[None], turn[None])[0]
    step = 1e-5
    ends = [
        energies(film, X + s * slide, T + s * turned, x + s * move, t + s * turn)
        for s in (step, -step)
    ]
    # Discretisation: two central differences, exact to the square of their steps.
    most = np.abs(found).max()
    assert found == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-5, abs=1e-6 * most)


@pytest.mark.parametrize(
    "load",
    [
        sc.Pressure(0.3),
        sc.Pressure(0.3, following=True),
        sc.Gravity((0.0, 3e9, 2e9)),
        sc.EdgeTraction("right", (30.0, 0.0, 20.0)),
    ],
)
def test_an_even_state_has_no_tip(load):
    """Even strain, turned, moving at an even speed and loaded: nothing is released anywhere."""
    sim = sc.Simulation(uneven_mesh(), FILM, damping_alpha=0.0, loads=[load])
    stretch = np.array([[1.01, 0.003, 0.0], [0.0, 0.995, 0.0], [0.004, 0.0, 1.0]])
    drawn(sim.state, stretch)
    sim.state.node.x += [40.0, -30.0, 20.0]
    force = force_on(sim, np.array([3.0, 0.2, 0.0]), 2.0)
    energy = YOUNG * THICKNESS * 0.01**2  # per area, of that order
    # Round-off, over the energy in the domain.
    assert np.abs(force.of(sim.state)).max() < 1e-8 * energy


def uneven_mesh():
    """A sheet of quads whose inner nodes are moved at random."""
    return shaken(rectangle(6.0, 6.0, size=0.5), 1.0, size=0.1)


def drawn(state, stretch):
    """Deform the whole film evenly."""
    n = state.node
    n.x[: n.count] = n.X[: n.count] @ stretch.T
    n.t[: n.count] = np.cross(*(BASE @ stretch.T))
    n.t[: n.count] /= np.linalg.norm(n.t[0])


def flowed(state, shell, at):
    """Give the film the plastic strains (11, 22, twice 12) = at[:, 0] + at[:, 1:] (x, y)."""
    film = shell.reference
    slot, width = shell.blocks.slot, shell.blocks.width
    n_height, n_number = shell.points.rule.place.size, shell.points.rule.n_history
    material, corners = shell.material, (film.x[film.quads], film.t[film.quads])
    for q, (n, A1, A2, T0, _, _) in enumerate(gauss_geometry(*corners)):
        place = np.einsum("a,eac->ec", n, corners[0])
        _, frame = frame_components(A1, A2, T0)
        c, s = np.ones(len(place)), np.zeros(len(place))
        if material.has_axes:
            c, s = axes_in_frame(A1, A2, T0, material.direction_at(place))
        first = c[:, None] * frame[:, 0] + s[:, None] * frame[:, 1]
        strain = at[:, 0] + place[:, :2] @ at[:, 1:].T
        tensor = np.zeros((len(place), 2, 2))
        tensor[:, 0, 0], tensor[:, 1, 1] = strain[:, 0], strain[:, 1]
        tensor[:, 0, 1] = tensor[:, 1, 0] = 0.5 * strain[:, 2]
        axes = np.stack([first[:, :2], np.cross([0.0, 0.0, 1.0], first)[:, :2]], axis=1)
        own = axes @ tensor @ axes.transpose(0, 2, 1)
        for j in range(n_height):
            for k, numbers in enumerate((own[:, 0, 0], own[:, 1, 1], 2.0 * own[:, 0, 1])):
                at_number = (q * n_height + j) * n_number + 2 + k
                state.history[slot // width, at_number, slot % width] = numbers


PLASTIC = Plastic(Elastic(YOUNG, POISSON, 1e-9), Linear(15.0, 60.0))
UNEVEN = np.array([[0.05, 0.01, -0.02], [-0.03, 0.015, 0.01], [0.02, -0.02, 0.03]])


@pytest.mark.parametrize(
    ("material", "flow"),
    [
        (STIFFER, None),
        (PLASTIC, UNEVEN),
        (Plastic(PLASTIC.elastic, Linear(15.0, 60.0), r_values=(0.6, 1.0, 1.8)), UNEVEN),
    ],
)
def test_uneven_flow_makes_no_tip(material, flow):
    """Any law, evenly drawn: what the slides find below belongs to the film, not to a crack."""
    direction = (1.0, 0.4, 0.0)
    shell, state = cases.set_up(uneven_mesh(), layered(material, direction=direction))
    stretch = np.array([[1.15, 0.1, 0.0], [-0.05, 0.9, 0.0], [0.3, 0.0, 1.0]])
    drawn(state, stretch)
    if flow is not None:
        flowed(state, shell, flow)
    for place in ([3.0, 0.2, 0.0], [0.1, 0.2, 0.0]):  # within the film, and at its rim
        force = TipForce(state, shell, domain_in(state, shell, place, 2.0), BASE)
        energy = YOUNG * THICKNESS * 0.15**2  # per area, of that order
        found = force.of(state)
        assert np.abs(found).max() < 1e-7 * energy  # round-off of differences


def test_film_that_has_not_flowed_slides_to_film_that_has():
    """The law reads no plastic strain where the equivalent one is zero; a slide must."""
    shell, state = cases.set_up(uneven_mesh(), layered(PLASTIC))
    drawn(state, np.diag([1.1, 0.95, 1.0]))
    # The film slides out of itself at its rim.
    rows = np.arange(shell.reference.quads.shape[0])
    out = TipDomain(rows, np.ones((len(rows), 4)), 0.0)
    rim = TipForce(state, shell, out, BASE)
    never = rim.of(state)
    flowed(state, shell, UNEVEN)
    at_zero = rim.of(state)
    n_number = shell.points.rule.n_history
    state.history[:, ::n_number] = 0.1
    np.testing.assert_array_equal(at_zero, rim.of(state))
    assert np.abs(at_zero - never).max() > 0.1 * np.abs(never).max()


def notched(length, notch, beside=0.0, film=FILM, loads=()):
    """A strip 4 mm high with clamped long sides, notched ``beside`` its middle line."""
    sim = free_film(
        from_zero(rectangle(length, 4.0, size=0.25)),
        material=film,
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        loads=loads,
        law=sc.CohesiveLaw(strength=1e3),
    )
    sim.notch((-1.0, beside, 0.0), (notch, beside, 0.0))
    return sim


def strip_at_rest(pull, film=FILM, slit=None):
    """A long notched strip whose upper and lower sides are moved apart by ``pull`` [mm]."""
    sim = notched(16.0, 8.0, film=film)
    if slit is not None:
        sim.notch(*((*end, 0.0) for end in slit))
    y = sim.state.node.X[: sim.state.node.count, 1]
    sim.relax(np.clip(y / 4.0, -0.5, 0.5)[:, None] * np.asarray(pull), tolerance=1e-4)
    return sim


@pytest.mark.parametrize(
    ("material", "reaches"), [(FILM, (1.0, 1.8, 3.0)), (layered(ALONG), (1.0,))]
)
def test_a_long_strip_releases_the_energy_ahead_of_its_tip(material, reaches):
    """Far behind the tip nothing is stored, far ahead C_22 e²/2 per volume over the height."""
    stretch = 0.004
    sim = strip_at_rest([0.0, 4.0 * stretch, 0.0], film=material)
    strain = stretch + 0.5 * stretch**2
    stiffness = material.layers[0].material.plane_stress()[1, 1]
    released = 0.5 * stiffness * strain**2 * THICKNESS * 4.0
    for reach in reaches:
        J = force_on(sim, np.array([8.0, 0.0, 0.0]), reach).of(sim.state)
        # Discretisation (quads of a sixteenth of the height at a singular tip).
        assert J[0] == pytest.approx(released, rel=0.03)
        assert abs(J[1]) < 1e-3 * released  # round-off and rest: it is symmetric


def test_film_beyond_another_crack_is_no_part_of_the_force_on_a_tip():
    """A domain of 3 mm around a tip 0.9 mm beside a slit, 2 mm from clamped sides."""
    sim = strip_at_rest([0.0, 0.016, 0.0], slit=((7.1, 0.9), (20.0, 0.9)))
    place = np.array([8.0, 0.0, 0.0])
    J, wide = (force_on(sim, place, reach).of(sim.state) for reach in (0.8, 3.0))
    # Discretisation, and for the part across the energies of its own flanks; measured 8 and 30 %
    # (of which nothing is left in all film within 3 mm).
    assert wide[0] == pytest.approx(J[0], rel=0.12)
    assert wide[1] == pytest.approx(J[1], abs=0.35 * J[0])
    assert J[1] > 0.5 * J[0]  # towards the slit


@pytest.mark.parametrize(("fibres", "rise"), [(0, 0.3), (1, 0.0), (6, 0.3)])
def test_cables_slide_as_the_film_does_where_they_are(rise, fibres):
    """F · q dx/de at both ends, q and dx/de those of the place where the end lies in its quad."""
    sim = notched_sheet(rise, FILM, fibres=fibres)
    state = sim.state
    for _ in range(2):
        sim.cracks.growth.along(state, *segment_ahead(sim), "criterion", 1.0)
    stretch = np.array([[1.1, 0.2, 0.0], [-0.1, 0.95, 0.0], [0.3, 0.1, 1.0]])
    drawn(state, stretch)
    film, c = sim.shell.reference, state.cable
    assert c.count == 2 * (fibres or 2)

    def q(X):  # even slopes, so that it is the same in all quads at a place
        return 0.4 + X @ [0.11, -0.17, 0.0]

    rows = np.arange(len(film.quads))
    domain = TipDomain(rows, q(film.x[film.quads]), 1.0)
    c.force[: c.count] = np.random.default_rng(6).normal(size=(c.count, 2, 3))
    wanted = np.zeros(2)
    for k in range(c.count):
        for side in (0, 1):
            start, stop = (shape(*place)[0] for place in c.chord[k, side])
            weights = (1.0 - c.share[k]) * start + c.share[k] * stop
            X = weights @ film.x[film.quads[c.row[k, side]]]
            wanted += q(X) * (BASE @ stretch.T @ c.force[k, side])
    pulled = TipForce(state, sim.shell, domain, BASE).of(state)
    c.force[: c.count] = 0.0
    found = pulled - TipForce(state, sim.shell, domain, BASE).of(state)
    np.testing.assert_allclose(found, wanted, rtol=1e-9)  # round-off


def on_the_page(first):
    """Return J as docs/theory/tears.md shows it, by the reaches of the domains [mm]."""
    _, rows = table("docs/theory/tears.md", "[`test_tip_force.py`]")
    (row,) = [row for row in rows if row[0].startswith(first)]
    return dict(zip(map(float, numbers_of(row[1])), row[2].split(", "), strict=True))


def pressed_strip(load, beside=0.0):
    """A strip notched to its middle, at rest under a load."""
    sim = notched(12.0, 6.0, beside, loads=[load])
    sim.relax(tolerance=1e-3)
    return sim


def test_a_crack_takes_its_own_flanks_along_round_a_bend_and_no_other():
    sim = free_film(uneven_mesh(), material=FILM, law=sc.CohesiveLaw(strength=1e3))
    low, left = sim.mesh.nodes[:, 1].min(), sim.mesh.nodes[:, 0].min()
    way = [(left - 1.0, low + 2.9), (left + 2.6, low + 2.9), (left + 3.4, low + 3.9)]
    sim.notch(*((*point, 0.0) for point in way))
    (place,) = sim.cracks.at_tips(sim.state.node.X)
    topology = sim.cracks.cuts.topology
    bent = domain_in(sim.state, sim.shell, place, 1.6, topology)
    assert bent.room == pytest.approx(1.6)  # nothing is nearer than the reach
    X = sim.shell.reference.x[sim.shell.reference.quads[bent.rows]]
    wanted = np.clip(2.0 - 2.0 * np.linalg.norm(X - place, axis=2) / 1.6, 0.0, 1.0)
    np.testing.assert_allclose(bent.q, wanted, atol=1e-9)
    sim.notch((left + 7.0, place[1] + 0.7, 0.0), (place[0] - 0.3, place[1] + 0.7, 0.0))
    beside = domain_in(sim.state, sim.shell, place, 1.6, topology)
    assert beside.room == pytest.approx(0.7, abs=0.08)  # places on sides of the mesh
    assert beside.q.min() < -0.1  # of corners beyond the flank


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
    place = at_tip(sim)
    ahead = height**5 / 720.0
    behind = sum((0.5 * height + s * beside) ** 5 / 20.0 for s in (1.0, -1.0))
    D = YOUNG * THICKNESS**3 / (12.0 * (1.0 - POISSON**2))
    released = 0.5 * PRESSURE**2 * (behind - ahead) / D
    for reach in (1.0, 1.8):
        force = force_on(sim, place, reach)
        # Discretisation: 1.01, weight, which is lumped with the mass, 1.03; on quads half as long
        # 1.00 for both.
        found = force.of(sim.state)[0]
        assert found == pytest.approx(released, rel=0.04)
        if load == sc.Pressure(PRESSURE):
            assert shown_as(on_the_page("strip")[reach], found / released)
        told = row("docs/verification.md", "strip under pressure; under its weight")[2]
        assert shown_as(told.split("; ")[isinstance(load, sc.Gravity)], found / released)


def test_a_crack_in_the_middle_of_a_pressed_strip_goes_straight_on():
    sim = pressed_strip(sc.Pressure(PRESSURE))
    (tip,) = sim.cracks.tips
    direction = FreeDirection(sim.shell, path_in(sim).film, sim.law)
    way = next(direction.directions(sim.state, tip))
    assert abs(way[1] / way[0]) < np.tan(np.radians(0.1))  # rest, to 1e-3 of the load


# --- what acts on the film: what is released does not depend on how much of it the domain holds


def plane_strip(slit=10.0, **more):
    """A strip in its plane, held on the right, slit from the left 4 mm above its lower rim."""
    mesh = from_zero(rectangle(24.0, 14.0, size=1.0), 0.0, -4.0)
    flat = sc.Support(np.arange(mesh.n_node), translation="z", rotation="xyz")
    sim = sc.Simulation(
        mesh,
        FILM,
        supports=[sc.Support.clamped("right"), flat],
        law=sc.CohesiveLaw(strength=1e5),
        fracture=sc.Fracture(path="free", fibres=0),
        damping_beta=5e-8,
        **more,
    )
    sim.notch((-1.0, 0.0, 0.0), (slit, 0.0, 0.0))
    return sim


def released_in(sim, reaches):
    """The force on the tip by domains of some reaches."""
    return np.array([force_on(sim, at_tip(sim), reach).of(sim.state) for reach in reaches])


def released_as_on_the_page(sim, first):
    """The same by the domains of the page, which has the digits."""
    told = on_the_page(first)
    J = released_in(sim, told)
    assert [shown_as(*pair) for pair in zip(told.values(), J[:, 0], strict=True)] == [True] * 4
    return J


def parted(slit):
    """Two forces of 0.1 N part the flanks 5 mm from the rim, 1 mm from the slit."""
    X = from_zero(rectangle(24.0, 14.0, size=1.0), 0.0, -4.0).nodes
    ids = [int(np.linalg.norm(X - [5.0, y, 0.0], axis=1).argmin()) for y in (1.0, -1.0)]
    pull = [sc.NodalForce(ids[:1], (0.0, 0.1, 0.0)), sc.NodalForce(ids[1:], (0.0, -0.1, 0.0))]
    sim = plane_strip(slit, loads=pull)
    sim.relax()
    x = sim.state.node.x
    return sim, x[ids[0], 1] - x[ids[1], 1]


def test_forces_on_nodes_in_the_domain_do_not_change_what_is_released():
    (_, short), (sim, _), (_, long) = parted(9.0), parted(10.0), parted(11.0)
    J = released_as_on_the_page(sim, "slit")  # the forces are 5 mm behind the tip
    # Discretisation, 0.8 to 1.8 %.
    assert J[:, 0] == pytest.approx(0.5 * 0.1 * (long - short) / 2.0, rel=0.03)
    assert np.ptp(J[1:, 1]) < 0.05 * abs(J[0, 1])


def test_a_wedge_within_the_domain_does_not_change_what_is_released():
    blade = straight_blade(half_thickness=0.1, wedge_half_angle_deg=20.0, length=12.0)
    wedge = sc.Tool.from_triangles(blade.vertices, blade.triangles, edges=np.zeros((0, 2), int))
    way = [[x, 0.0, 0.0] for x in (0.0, 3.0, 6.0, 6.0)]
    sim = plane_strip(
        tool=wedge.translated((-0.01, 0.0, 0.0)),
        motion=sc.TableMotion([0.0, 5e-4, 1e-3, 1.5e-3], way),
        damping_alpha=8000.0,
    )
    while sim.state.time < 2.5e-3:  # until it rests
        sim.step()
    J = released_as_on_the_page(sim, "blunt wedge")  # the wedge ends 4 mm behind the tip
    # Discretisation: 2.5 and 7 %.
    assert J[:, 0] == pytest.approx(J[0, 0], rel=0.04)
    assert J[:, 1] == pytest.approx(J[0, 1], rel=0.12)


def test_a_blade_and_the_cables_that_it_bends_do_not_change_what_is_released():
    case = sc.guillotine(0.8, length=12.0, width=8.0, travel=6.5, fracture=sc.Fracture(path="free"))
    sim = case.simulation
    sim.run(0.8 * case.duration)
    assert (sim.state.cable.status == JOINTED).sum() > 10
    told = on_the_page("blade that cuts")
    J = released_in(sim, told)[:, 0]
    # The zone ahead of the edge is 3 mm long. By chance in the run.
    assert [float(text) for text in told.values()] == pytest.approx(J, abs=2e-3)
    assert np.ptp(J) < 0.2 * J.min()


# --- the stress of a sheet, found again from the field of a crack with zones of its strength


def ahead_of_a_crack(p, x, a=1.0):
    """Return the stress at x ahead of a zone over the strength, and c / x.

    A crack of length 2b under p, less what pairs of forces do that hold its zones together.
    """
    b = a / np.cos(0.5 * np.pi * p)
    at = b + x

    def pair(angle):  # at b sin(angle) on either side
        return 2.0 * b * np.cos(angle) * b * np.cos(angle) / (at**2 - (b * np.sin(angle)) ** 2)

    zones = quad(pair, np.arcsin(a / b), 0.5 * np.pi)[0]
    stress = (p - zones / np.pi) * at / np.sqrt(at**2 - b**2)
    return stress, -np.log(np.cos(0.5 * np.pi * p)) * a / x


@pytest.mark.parametrize("p", [0.05, 0.6, 0.99])
@pytest.mark.parametrize("x", [0.01, 3.0, 100.0])
def test_the_stress_of_the_sheet_is_found_again(p, x):
    stress, length = ahead_of_a_crack(p, x)
    assert p < stress < 1.0
    assert sheet_stress(stress, length) == pytest.approx(p, abs=1e-6)
