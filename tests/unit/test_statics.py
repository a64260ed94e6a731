"""Statics against closed forms: load steps, arc length, modes; refusals.

That linear solutions, their stresses and buckled shapes are right: tests/verification, A and B.
"""

import itertools

import numpy as np
import pytest

from dense_statics import dense
from patches import hinged_roof, mapped_patch
from shellcut import EdgeTraction, Gravity, Mesh, NodalForce, Pressure, ShellMaterial, Support
from shellcut.material import Elastic, Layer, Linear, Plastic
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.statics import load_path
from shellcut.statics.statics import Statics
from shellcut.statics.tangent_solver import NoConvergence

LENGTH, WIDTH, THICKNESS, YOUNG, DENSITY = 10.0, 1.0, 0.1, 1.2e6, 1e-9
LEFT = (Support.clamped("left"),)
BENDING = YOUNG * WIDTH * THICKNESS**3 / 12.0


def cantilever(n, *loads, n_y=1, poisson=0.0, supports=LEFT):
    material = ShellMaterial.homogeneous(
        young=YOUNG, poisson=poisson, density=DENSITY, thickness=THICKNESS
    )
    mesh = rectangle(LENGTH, WIDTH, n_x=n, n_y=n_y)
    return Statics(mesh, material, supports=supports, loads=loads)


def tip(strip):
    return strip.mesh.node_set("right")[0]


SHEAR = EdgeTraction("right", (0.0, 0.0, 4.0))


# --- linear


def test_linear_end_shear_what_bears_it_and_what_it_stores():
    # n linear elements with a constant shear each give L³ / 3 EI less by its 1 / 4n².
    strip = cantilever(8, SHEAR)
    answer = strip.linear()
    displacement, rotation = answer  # as a sequence
    assert displacement is answer.displacement
    assert rotation is answer.rotation
    shear_flexibility = LENGTH / (5.0 / 6.0 * 0.5 * YOUNG * WIDTH * THICKNESS)
    expected = 4.0 * (LENGTH**3 / (3.0 * BENDING) * (1.0 - 1.0 / 256.0) + shear_flexibility)
    assert displacement[tip(strip), 2] == pytest.approx(expected, rel=1e-9)
    assert answer.energy == pytest.approx(0.5 * 4.0 * expected, rel=1e-9)
    left = strip.mesh.node_set("left")
    # The supports bear the load, 4 N, and its moment about the root, to round-off.
    np.testing.assert_allclose(answer.reaction.sum(axis=0), [0, 0, -4.0], atol=1e-7)
    np.testing.assert_allclose(moment(strip, answer), [0, 4.0 * LENGTH, 0], atol=1e-6)
    assert not np.delete(answer.reaction, left, axis=0).any()
    assert not np.delete(answer.reaction_moment, left, axis=0).any()
    assert max(answer.residual, answer.error) < 1e-9
    assert 1e4 < answer.condition < 1e12
    assert (strip.state.node.x == strip.state.node.X).all()
    assert strip.factor == 0.0
    # The stresses stay when the film moves on.
    before = answer.stress(place="top")
    strip.load_steps([1.0])
    assert (answer.stress(place="top") == before).all()


def moment(strip, answer, displacement=0.0):
    """Return the moment of the reactions at the left side about the origin."""
    left = strip.mesh.node_set("left")
    places = (strip.mesh.nodes + displacement)[left]
    return (answer.reaction_moment[left] + np.cross(places, answer.reaction[left])).sum(axis=0)


def test_stresses_about_a_stretched_state_are_the_difference_quotient():
    strip = cantilever(4, EdgeTraction("right", (2e3, 0.0, 0.0)), poisson=0.3, n_y=2)
    strip.load_steps([1.0])
    before, answer, node = strip.stress(place="top"), strip.linear(), strip.state.node
    change = answer.stress(place="top") - before
    start, moved = (node.x.copy(), node.t.copy()), []
    for step in (1e-4, -1e-4):
        strip.move(step * answer.displacement, step * answer.rotation)
        moved.append(strip.stress(place="top"))
        node.x[:], node.t[:] = start
    quotient = (moved[0] - moved[1]) / 2e-4
    # Error of a central difference, and round-off over the step.
    np.testing.assert_allclose(change, quotient, atol=1e-6 * abs(quotient).max())
    assert abs(answer.displacement).max() > 1e-3
    with pytest.raises(ValueError, match="place must be one of"):
        answer.stress(place="nominal")


def test_an_equilibrium_knows_its_reactions_energy_and_residual_on_any_path():
    strip, factors = cantilever(8, SHEAR), np.linspace(0.05, 1.0, 20)
    path = strip.load_steps(factors)
    assert [e.factor for e in path] == pytest.approx(factors)
    end, right = path[-1], strip.mesh.node_set("right")
    np.testing.assert_allclose(end.reaction.sum(axis=0), [0, 0, -4.0], atol=1e-6)
    here = strip.mesh.nodes + end.displacement
    load = np.cross(here[right], [0, 0, 2.0]).sum(axis=0)
    np.testing.assert_allclose(moment(strip, end, end.displacement), -load, atol=1e-5)
    assert end.residual <= 1e-8
    # Work of the dead load along the path, by the trapezoidal rule.
    w = np.array([0.0, *(e.displacement[tip(strip), 2] for e in path)])
    work = np.trapezoid(4.0 * np.append(0.0, factors), w)
    assert end.energy == pytest.approx(work, rel=2e-3)
    # In one step, and back. All are at equilibrium to 1e-8 of the largest force.
    strip = cantilever(8, SHEAR)
    there, back = strip.load_steps([1.0, 0.0])
    np.testing.assert_allclose(there.displacement, end.displacement, atol=1e-6)
    assert there.n_iteration < 12
    assert abs(back.displacement).max() < 1e-6
    assert strip.factor == 0.0


@pytest.mark.parametrize(
    ("quads", "message"),
    [
        ([8], "quad ids from 0 to 7, got 8"),
        ([True] * 8, r"got an array of shape \(8,\) and type bool; of a mask take np.flatnonzero"),
        ([0.5], r"got an array of shape \(1,\) and type float64"),
        (0, r"got an array of shape \(\)"),
    ],
)
def test_stresses_of_no_quads_are_refused(quads, message):
    strip = cantilever(4, SHEAR, n_y=2)
    for stress in (strip.stress, strip.linear().stress):
        with pytest.raises(ValueError, match=message):
            stress(quads)
        assert stress([]).shape == (0, 3, 3)


# --- load steps


@pytest.mark.parametrize("factors", [[float("nan")], ["all"], 1.0])
def test_load_factors_must_be_numbers(factors):
    with pytest.raises(ValueError, match="factors must be a list of finite numbers, got"):
        cantilever(2, SHEAR).load_steps(factors)


def test_no_convergence_names_the_last_equilibrium_and_puts_it_back(monkeypatch):
    strip = cantilever(8, SHEAR)
    (before,) = strip.load_steps([0.25])
    monkeypatch.setattr(load_path, "_MOST_ITERATIONS", 1)
    said = (
        r"no equilibrium at load factor 0\.25.* after 1 iterations, residual .* N; the last "
        r"equilibrium is at load factor 0\.25: follow the path by arc length"
    )
    with pytest.raises(NoConvergence, match=said):
        strip.load_steps([1.0])
    n, node = strip.mesh.n_node, strip.state.node
    assert (node.x[:n] - node.X[:n] == before.displacement).all()
    with pytest.raises(NoConvergence, match=r"could not be followed past load factor 0\.25"):
        strip.arc_length(0.5, until=lambda e: e.factor > 1.0)


def two_of(mesh, *shift):
    """Return a mesh and a copy of it beside it as one film of two parts."""
    nodes = np.concatenate([mesh.nodes, mesh.nodes + np.array(shift)])
    return Mesh.from_arrays(nodes, np.concatenate([mesh.quads, mesh.quads + mesh.n_node]))


def test_a_rigid_motion_is_refused():
    material = ShellMaterial.homogeneous(young=YOUNG, density=DENSITY, thickness=THICKNESS)
    mesh = rectangle(LENGTH, WIDTH, n_x=4, n_y=1)
    free = Statics(mesh, material, supports=[Support("left", "xy", "")], loads=[SHEAR])
    named = r"a rigid motion is not supported \(along z, about x, about y\)"
    with pytest.raises(NoConvergence, match=named):
        free.linear()
    # Two parts, one of which is clamped: the message says what the other can do.
    parts = two_of(mesh, 0.0, 2.0, 0.0)
    left = np.flatnonzero(parts.nodes[:, 0] == 0.0)
    supports = [Support.clamped(left[:2]), Support(left[2:], "xyz", "")]
    with pytest.raises(NoConvergence, match=r"\(about an axis along \(0, 1, 0\) of part 2 of 2\)"):
        Statics(parts, material, supports=supports, loads=[Gravity((0, 0, -9810.0))]).linear()


def test_shares_of_a_step_end_at_its_factor(monkeypatch):
    # 0.37 in eighths, summed, is one unit of the last digit below it.
    (whole,) = cantilever(8, SHEAR).load_steps([0.37])
    monkeypatch.setattr(load_path, "_MOST_ITERATIONS", 3)
    strip = cantilever(8, SHEAR)
    (end,) = strip.load_steps([0.37])
    assert end.factor == 0.37
    np.testing.assert_allclose(end.displacement, whole.displacement, atol=1e-6)
    assert end.n_iteration > whole.n_iteration
    # What is at rest under a load needs no step to it.
    assert strip.load_steps([0.37, np.nextafter(0.37, 1.0)])[-1].n_iteration == 0


# --- stability


def pressed_plate(imperfection=0.0, n=8):
    """A square with a half-wave, its rim held along z only, pressed along x by 4 pi² D / a²."""
    a, h, young, poisson = 10.0, 0.1, 7e4, 0.3
    flat = rectangle(a, a, n_x=n, n_y=n)
    wave = np.sin(np.pi / a * (flat.nodes[:, :2] - flat.nodes[:, :2].min(axis=0))).prod(axis=1)
    nodes = flat.nodes + np.outer(imperfection * h * wave, [0, 0, 1])
    sets = {side: flat.node_set(side) for side in ("left", "right", "bottom", "top")}
    N = 4.0 * np.pi**2 * young * h**3 / (12.0 * (1.0 - poisson**2) * a**2)
    plate = Statics(
        Mesh.from_arrays(nodes, flat.quads, node_sets=sets),
        ShellMaterial.homogeneous(young=young, poisson=poisson, density=1e-9, thickness=h),
        supports=[
            Support("left", "xz", ""),
            Support([int(sets["left"][0])], "y", ""),
            *(Support(side, "z", "") for side in ("right", "bottom", "top")),
        ],
        loads=[EdgeTraction("right", (-N, 0.0, 0.0))],
    )
    return plate, np.argmax(wave), h


def check_modes(film, n, **options):
    """Compare the lowest frequencies with those of the dense matrices, and return all of these."""
    K, mass = dense(film, **options)
    q2 = np.linalg.eigvalsh(K / np.sqrt(np.outer(mass, mass)))
    expected = np.sign(q2) * np.sqrt(abs(q2)) / (2.0 * np.pi)
    modes = film.modes(n, **options)
    np.testing.assert_allclose(modes.frequency, expected[:n], rtol=1e-6)
    return modes, expected


def test_modes_of_an_unstable_state_are_the_lowest():
    plate, _, _ = pressed_plate()
    (rest,) = plate.load_steps([8.0])
    assert rest.n_negative > 4
    for n in (1, rest.n_negative - 1, rest.n_negative, rest.n_negative + 4):
        _, expected = check_modes(plate, n)
    assert (expected < 0.0).sum() == rest.n_negative


def test_a_flat_plate_says_where_it_buckles_and_finds_its_stable_branch(caplog):
    plate, centre, h = pressed_plate()
    before, after = plate.load_steps([0.9, 1.31])
    assert (before.n_negative, after.n_negative) == (0, 1)
    assert abs(after.displacement[:, 2]).max() < 1e-9 * h
    (said,) = (record.args for record in caplog.records)
    # Within the bracket of half a per cent, and the error of the mesh.
    assert said[3] < said[0] < said[3] * 1.005
    assert said[0] == pytest.approx(1.0, abs=0.03)
    assert "move the film by about its thickness along Statics.modes(1).shape[0]" in caplog.text
    # The motion that grows comes first, with its sign.
    modes, _ = check_modes(plate, 3)
    assert modes.frequency[0] < 0.0 < modes.frequency[1]
    with pytest.raises(ValueError, match=r"displacement must have shape \(81, 3\)"):
        plate.move(np.zeros((3, 3)))
    plate.move(h * modes.shape[0])
    (rest,) = plate.load_steps([1.31])
    assert rest.n_negative == 0
    # An uneven plate in one large step ends on this branch, as in small ones.
    caplog.clear()
    ends = []
    for factors in ([1.31], np.linspace(0.131, 1.31, 10)):
        waved, _, _ = pressed_plate(0.01)
        ends.append(waved.load_steps(factors)[-1])
        assert ends[-1].n_negative == 0
    np.testing.assert_allclose(ends[0].displacement, ends[1].displacement, atol=1e-6 * h)
    assert not caplog.records
    (waved,) = pressed_plate(1e-3)[0].load_steps([1.31])
    deflection = waved.displacement[centre, 2]
    assert abs(rest.displacement[centre, 2]) == pytest.approx(deflection, rel=1e-3)
    assert deflection > 1.1 * h


@pytest.mark.parametrize(("following", "critical"), [(True, 3.0), (False, 4.0)])
def test_a_ring_under_pressure(following, critical, caplog):
    # Half of it, its ends on the plane z = 0. Oval at 3 D/R³ if the pressure stays normal to it,
    # at 4 D/R³ if it keeps its direction.
    arc = cylinder(10.0, 0.5, n_around=24, n_along=1, arc_deg=180.0)
    x, every = arc.nodes, np.arange(arc.n_node)
    ends = np.flatnonzero(x[:, 2] < x[:, 2].min() + 1e-9)
    ring = Statics(
        arc,
        ShellMaterial.homogeneous(young=1e4, poisson=0.0, density=DENSITY, thickness=0.2),
        supports=[
            Support(np.setdiff1d(every, ends), "y", "xz"),
            Support(ends, "yz", "xyz"),
            Support(np.flatnonzero(abs(x[:, 0]) < 1e-9), "x", ""),
        ],
        loads=[Pressure(-1e4 * 0.2**3 / 12.0 / 10.0**3, following=following)],
    )
    rest = ring.load_steps([2.5, 4.5])
    assert [e.n_negative for e in rest] == [0, 1]
    # 24 quads: the critical load is 1 % too high.
    assert caplog.records[0].args[0] == pytest.approx(critical, rel=0.015)


def test_a_limit_load_by_yielding_is_one():
    # The stiffness is that of the step that led there: from its end on the film would be elastic.
    flat = rectangle(20.0, 1.0, n_x=10, n_y=1)
    u = flat.nodes[:, 0] / 20.0
    nodes = flat.nodes + np.outer(8.0 * u * (1.0 - u), [0, 0, 1])
    yielding = Plastic(Elastic(1e4, 0.3, DENSITY), Linear(20.0, 100.0))
    arch = Statics(
        Mesh.from_arrays(nodes, flat.quads),
        ShellMaterial([Layer(yielding, 0.5)], points_per_layer=5),
        supports=[
            Support.clamped(np.flatnonzero((u < 1e-9) | (u > 1.0 - 1e-9))),
            Support(np.arange(flat.n_node), "y", "x"),
        ],
        loads=[NodalForce(np.flatnonzero(abs(u - 0.5) < 1e-9), (0.0, 0.0, -1.0))],
    )
    nth = itertools.count(1)
    path = arch.arc_length(0.2, until=lambda e: next(nth) == 9)
    factor = np.array([e.factor for e in path])
    top = int(factor.argmax())
    assert 2 <= top <= 6
    unstable = [e.n_negative > 0 for e in path]
    assert not any(unstable[:top])
    assert all(unstable[top + 1 :])
    stiffness, _ = dense(arch)
    assert abs(stiffness - stiffness.T).max() < 1e-14 * abs(stiffness).max()


# --- arc length


def strut(base, rise, n):
    """Half a shallow truss: a thick strip, pinned below, its top guided along z and loaded."""
    mesh = mapped_patch(n, 1, lambda u, v: (np.stack([base * u, v, rise * u], -1), u), exact=False)
    material = ShellMaterial.homogeneous(young=100.0, poisson=0.0, density=1e-9, thickness=1.0)
    supports = [Support.pinned("u0"), Support("u1", "xy", "")]
    return Statics(mesh, material, supports=supports, loads=[EdgeTraction("u1", (0.0, 0.0, -1.0))])


def test_arc_length_passes_both_limit_points_of_a_truss(caplog):
    caplog.set_level("INFO", "shellcut")
    # Green strain and linear stress: P = E A (h² - z²) z / (2 L³), z the height. Thick enough not
    # to buckle, the strip stays straight, and the element holds that exactly.
    base, rise = 10.0, 1.0
    truss = strut(base, rise, 2)
    limit = 100.0 * rise**3 / (3.0 * np.sqrt(3.0) * np.hypot(base, rise) ** 3)
    path = truss.arc_length(0.3 * limit, until=lambda e: e.factor > 2.0 * limit)
    factor = np.array([e.factor for e in path])
    top = truss.mesh.node_set("u1")[0]
    z = rise + np.array([e.displacement[top, 2] for e in path])
    exact = 100.0 * (rise**2 - z**2) * z / (2.0 * np.hypot(base, rise) ** 3)
    np.testing.assert_allclose(factor, exact, atol=1e-6 * limit)
    assert (np.diff(z) < 0.0).all()  # the way goes on and on
    between = factor[(z < 0.7 * rise) & (z > -0.4 * rise)]
    assert (np.diff(between) < 0.0).all()  # down from one limit point to the other
    assert factor.min() < 0.0
    assert factor[-1] > 2.0 * limit
    # The one motion that is free under a dead load, along the path, is unstable between them.
    falls = abs(z) < rise / np.sqrt(3.0)
    assert [e.n_negative for e in path] == falls.astype(int).tolist()
    assert [r.levelname for r in caplog.records] == ["WARNING", "INFO"]
    assert "unstable in 1 motion(s), in 0 at the equilibrium before" in caplog.text
    assert "one is expected from a limit point" in caplog.text


def test_arc_length_goes_on_from_load_steps():
    strip = cantilever(8, SHEAR)
    strip.load_steps([0.5])
    path = strip.arc_length(0.1, until=lambda e: e.factor > 0.9)
    assert 0.5 < path[0].factor < 0.65
    whole = cantilever(8, SHEAR).load_steps([path[-1].factor])
    np.testing.assert_allclose(path[-1].displacement, whole[0].displacement, atol=1e-6)
    assert len(strip.arc_length(1e-4, until=lambda _: False, longest=1.0)) == 200


@pytest.mark.parametrize("first", [0.05, 1.0, 5.0])
def test_a_snap_is_not_passed_in_one_leap(first):
    # The roof of case B09, half as thick. The load falls to -0.1245 of the full one while the
    # centre goes back by 2 mm.
    roof, top = hinged_roof(4, 6.35)
    path = roof.arc_length(first, until=lambda e: e.factor > 0.6)
    factor = np.array([e.factor for e in path])
    down = -np.array([e.displacement[top, 2] for e in path])
    assert factor.min() == pytest.approx(-0.1245, abs=2e-3)
    assert (np.diff(down) < 0.0).sum() >= 2
    steps = np.diff([e.displacement.ravel() for e in path], axis=0)
    steps /= np.linalg.norm(steps, axis=1, keepdims=True)
    turn = (steps[1:] * steps[:-1]).sum(axis=1)
    assert turn.min() > np.cos(np.radians(30.0))
    # Nor in the first: before it the load has its maximum.
    assert factor[: factor.argmin()].max() == pytest.approx(0.206, abs=0.01)


def test_arc_length_is_bounded():
    n_step = []
    for longest in (1.0, 8.0):
        strip = cantilever(8, SHEAR)
        path = strip.arc_length(0.01, until=lambda e: e.factor > 0.2, longest=longest)
        points = np.array([0.0 * path[0].displacement, *(e.displacement for e in path)])
        size = np.linalg.norm(np.diff(points, axis=0).reshape(len(path), -1), axis=1)
        # Along the path; across it a step may be a little longer.
        assert size.max() < 1.1 * longest * size[0]
        n_step.append(len(path))
    assert n_step[0] > 2 * n_step[1]


def test_an_arc_that_cannot_be_begun_is_refused():
    strip = cantilever(8, SHEAR)
    said = r"n_wanted must be 1 or more, got 0; longest must be 1 or more, got 0\.5"
    with pytest.raises(ValueError, match=said):
        strip.arc_length(0.1, until=lambda e: True, longest=0.5, n_wanted=0)
    for first in (0, np.nan, "some"):
        with pytest.raises(ValueError, match=f"first must be .*, got .*{first}"):
            strip.arc_length(first, until=lambda e: True)
    for idle in (cantilever(8), cantilever(8, EdgeTraction("left", (0.0, 0.0, 4.0)))):
        with pytest.raises(ValueError, match="a load that acts where the film is free to move"):
            idle.arc_length(0.1, until=lambda e: True)


def test_an_arc_begins_at_an_equilibrium():
    # A moved film is at rest nowhere: the first increment does not lead back to rest.
    paths = []
    for lifted in (1e-3, 0.0):
        strip = cantilever(8, SHEAR)
        strip.move(np.outer(lifted * strip.mesh.nodes[:, 0] ** 2, [0.0, 0.0, 1.0]))
        paths.append(strip.arc_length(0.05, until=lambda e: e.factor > 0.1))
    for one, two in zip(*paths, strict=True):
        np.testing.assert_allclose(one.displacement, two.displacement, atol=1e-6)


# --- vibrations


def test_largest_frequency_is_that_of_the_dense_matrices():
    one_freedom = cantilever(2, supports=[Support.clamped(range(1, 6)), Support([0], "xy", "xyz")])
    for strip, n in ((cantilever(6, n_y=2, poisson=0.3), 3), (one_freedom, 1)):
        _, expected = check_modes(strip, n, true_inertia=False)
        assert strip.largest_frequency() == pytest.approx(2.0 * np.pi * expected[-1], rel=1e-9)


def test_all_modes_there_are_and_no_more():
    strip, n = cantilever(2), 20
    np.testing.assert_allclose(
        strip.modes(n - 3).frequency, strip.modes(n).frequency[:-3], rtol=1e-8
    )
    for wrong in (n + 1, 0, 2.0):
        with pytest.raises(ValueError, match=f"n must be a whole number from 1 to 20.*got {wrong}"):
            strip.modes(wrong)
    free = Statics(strip.mesh, strip.shell.material).modes(5 * strip.mesh.n_node).frequency
    assert np.flatnonzero(free == 0.0).tolist() == list(range(6))


def test_no_mode_is_omitted_where_many_are_alike():
    # Two free films: every frequency twice and twelve rigid motions.
    one = rectangle(4.0, 3.0, n_x=6, n_y=6)
    film = ShellMaterial.homogeneous(young=1e6, density=DENSITY, thickness=0.05)
    frequency = Statics(two_of(one, 5.0, 0.0, 0.0), film).modes(20).frequency
    assert (frequency[:12] == 0.0).all()
    np.testing.assert_allclose(frequency[12::2], frequency[13::2], rtol=1e-8)
    np.testing.assert_allclose(frequency[12::2], Statics(one, film).modes(10).frequency[6:])
    # A film whose factors would be exactly singular.
    square = Statics(rectangle(4.0, 4.0, n_x=1, n_y=1), ShellMaterial.homogeneous(thickness=1.0))
    assert (square.modes(7).frequency > 0.0).tolist() == [False] * 6 + [True]


def test_what_statics_cannot_do_is_refused():
    moving = Support("right", velocity={"x": lambda time: 1.0}, spin={"y": lambda time: 1.0})
    with pytest.raises(ValueError, match=r"velocity of the support of 'right' .*; spin of .*move"):
        cantilever(2, supports=[Support.clamped("left"), moving])
    full = cantilever(2, supports=[Support.clamped(range(6))])
    for ask in (
        full.linear,
        full.largest_frequency,
        lambda: full.modes(1),
        lambda: full.load_steps([1.0]),
        lambda: full.arc_length(0.1, until=lambda e: True),
    ):
        with pytest.raises(ValueError, match="no freedom is left"):
            ask()
