"""Glue to a rigid base against closed forms: pull-off, peel, stretch, cuts, restart.

The peel strips are one quad wide. Their front advances along +x, the free end is pulled by a
prescribed motion. With the force F on the end and its angle theta to -x,

    F²/(2 E b² h) + (F/b) (1 - cos theta) = tau                            (Kendall 1975)

in a steady peel, b the width: the first term is the stretch of the free film, and below 1 % from
45° on.
"""

import math

import numpy as np
import pytest

import shellcut as sc
from free_model import FREE as A_CUT
from gone_on import check_goes_on
from naive.glue_law import traction
from page_tables import row, shown_as
from shellcut.meshing import rectangle
from shellcut.model_file.reader import model_of_text
from shellcut.models import Case, guillotine
from shellcut.results.answers import answers
from shellcut.results.verdict import verdict

FILM = sc.ShellMaterial.homogeneous()
YOUNG, THICKNESS = 1678.0, 0.074
FREE = 4.0
"""Length of the strip that is not glued [mm]."""


def glue_of(sim):
    return next(term for term in sim.terms if term.name == "adhesion")


def pressed(pressure):
    """Return a glued sheet at rest under a pressure [MPa]."""
    mesh = rectangle(2.0, 2.0, size=0.5)
    load = sc.Pressure(pressure, factor=lambda time: min(time / 2e-4, 1.0))
    glue = sc.Adhesion(quads=np.arange(mesh.n_quad), energy=0.05, strength=0.5)
    sim = sc.Simulation(mesh, FILM, loads=[load], terms=[glue], damping_alpha=2e4)
    sim.run(until=6e-4)
    return sim


@pytest.mark.parametrize("pressure", [0.45, -0.3])
def test_glue_and_base_carry_a_pressure(pressure):
    points = glue_of(pressed(pressure)).points
    np.testing.assert_allclose(points.traction[:, 2], -pressure, rtol=1e-4)
    assert np.abs(points.traction[:, :2]).max() < 1e-4 * abs(pressure)
    assert points.largest.max() < 0.05


def test_the_step_counts_the_steepest_glue_under_each_node():
    """Of all quads at a node, also where they differ in size, and of sliding if it is steeper."""
    mesh = rectangle(2.0, 1.0, n_x=4, n_y=2)
    uneven = mesh.nodes.copy()
    uneven[:, 0] **= 2
    mesh = sc.Mesh.from_arrays(uneven, mesh.quads)
    glue = sc.Adhesion(quads=np.arange(mesh.n_quad), strength=0.5, stiffness=30.0, shear=1.5)
    sim = sc.Simulation(mesh, FILM, terms=[glue])
    nodes, stiffness = glue_of(sim).stiffness(sim.state, {})
    area = np.bincount(mesh.quads.ravel(), np.repeat(0.25 * mesh.quad_areas(), 4), mesh.n_node)
    np.testing.assert_array_equal(nodes, np.arange(mesh.n_node))
    np.testing.assert_allclose(stiffness, 30.0 * 1.5**2 * area, rtol=1e-12)


def test_a_pressure_above_the_strength_pulls_the_sheet_off():
    off = pressed(0.55)
    assert not glue_of(off).points.traction.any()
    ledger = off.close_ledger()
    assert ledger.adhesion_dissipated == pytest.approx(0.05 * 4.0, rel=1e-9)
    # It snaps within a few dozen steps, over each of which the work takes the mean force.
    assert ledger.adhesion_work == pytest.approx(ledger.adhesion_dissipated, rel=1e-3)


class Peel:
    """A strip whose free end moves with a speed [mm/s] along a path of a parameter."""

    def __init__(
        self, path, *, energy=0.05, strength=None, size=0.5, speed=1e3, length=12.0, **options
    ):
        mesh = rectangle(length, size, size=size)
        end = np.flatnonzero(mesh.nodes[:, 0] < 1e-9)
        glued = np.flatnonzero(mesh.nodes[mesh.quads].mean(axis=1)[:, 0] > FREE)
        options = {"damping_alpha": 0.0, **options}

        def rate(axis):
            return lambda time: speed * min(time / 1e-4, 1.0) * path(speed * time)[axis]

        pulled = sc.Support(end, rotation="", velocity={"x": rate(0), "z": rate(1)})
        glue = sc.Adhesion(quads=glued, energy=energy, strength=strength)
        self.energy, self.width, self.end, self.speed = energy, size, end, speed
        self.sim = sc.Simulation(mesh, FILM, supports=[pulled], terms=[glue], **options)

    def energy_of_force(self, begin, stop):
        """Return the mean of the closed form's left side over tau, of a range of the path [mm]."""
        found, sim = [], self.sim
        sim.run(until=begin / self.speed)
        while sim.state.time < stop / self.speed:
            sim.run(until=sim.state.time + 0.01 / self.speed)
            force = sim.state.node.reaction[self.end, :3].sum(axis=0)
            found.append(self._left_side(force))
        return float(np.mean(found)) / self.energy

    def _left_side(self, force):
        size = math.hypot(force[0], force[2])
        stretch = size**2 / (2.0 * YOUNG * self.width**2 * THICKNESS)
        return stretch + (size + force[0]) / self.width  # cos theta = - force_x / size


def at_angle(degrees):
    """Return the path of an end that keeps the peeled film at an angle, once it is taut."""
    half = math.radians(0.5 * degrees)
    return lambda _: (math.sin(half), math.cos(half))


@pytest.mark.parametrize("energy", [0.02, 0.05, 0.1])
def test_peel_at_a_right_angle(energy):
    peel = Peel(at_angle(90.0), energy=energy)
    assert peel.energy_of_force(8.0, 14.0) == pytest.approx(1.0, abs=0.03)
    ledger = peel.sim.close_ledger()
    assert abs(ledger.relative(ledger.imbalance)) < 1e-4
    # The work takes the mean force of a step, over a few of which a node lets go.
    assert ledger.adhesion_dissipated + ledger.adhesion_stored == pytest.approx(
        ledger.adhesion_work, rel=1e-5
    )


# What each row of the table on the theory page changes.
PEELS = {
    "quads of 0.25 mm": {"size": 0.25},
    "quads of 0.5 mm": {},
    "quads of 1 mm": {"size": 1.0},
    "3 m/s": {"speed": 3e3},
    "10 m/s": {"speed": 1e4},
    "strength 0.3 MPa": {"strength": 0.3},
    "strength 0.6 MPa": {"strength": 0.6},
    "strength 1.2 MPa": {"strength": 1.2},
    "strength 1.2 MPa, quads of 0.25 mm": {"strength": 1.2, "size": 0.25},
}
ANGLES = {"45°": 45.0, "22.6°": 22.6, "15.4°": 15.4}


@pytest.mark.slow
@pytest.mark.parametrize("name", PEELS)
def test_refinement_and_speed_are_those_of_the_page(name):
    peel = Peel(at_angle(90.0), **PEELS[name])
    glue = glue_of(peel.sim)
    found = peel.energy_of_force(8.0, 14.0)
    _, strength, zone, over_sides, energy = row("docs/theory/adhesion.md", f"{name} |")
    assert shown_as(strength, glue.law.strength)
    assert shown_as(zone, glue.zone)
    assert shown_as(over_sides, glue.zone / glue.side)
    assert shown_as(energy, found), found


@pytest.mark.slow
@pytest.mark.parametrize("name", ANGLES)
def test_small_angles_are_those_of_the_page(name):
    found = stretched_peel(ANGLES[name])
    assert shown_as(row("docs/theory/adhesion.md", f"{name} |")[1], found), found


def folded_back(path):
    """A half circle about the front, then along +x: the film is pulled back over itself."""
    turn = path / FREE
    if turn < math.radians(165.0):
        return math.sin(turn), math.cos(turn)
    return 1.0, 0.0


def test_peel_folded_back():
    peel = Peel(folded_back, length=16.0)
    assert peel.energy_of_force(17.0, 25.0) == pytest.approx(1.0, abs=0.02)


def stretched_peel(degrees):
    """Return the left side of the closed form over tau, once the film is taut."""
    peel = Peel(at_angle(degrees), length=14.0)
    slack = FREE * math.sin(math.radians(degrees)) / math.cos(math.radians(0.5 * degrees))
    return peel.energy_of_force(slack + 0.6, slack + 1.6)


@pytest.mark.parametrize("degrees", [22.6, 15.4])
def test_peel_at_a_small_angle_stretches_the_film(degrees):
    assert stretched_peel(degrees) == pytest.approx(1.0, abs=0.02)


def test_peel_from_a_cylinder():
    """The normals of the base are the film's directors: glue and strain take the work.

    Kinetic energy and the damping of the bent film take the rest, below 6 %.
    """
    radius, angle = 20.0, math.radians(35.0)
    flat = rectangle(radius * angle, 0.5, size=0.5)
    turn = flat.nodes[:, 0] / radius
    nodes = np.stack([radius * np.sin(turn), flat.nodes[:, 1], radius * np.cos(turn)], axis=1)
    mesh = sc.Mesh.from_arrays(nodes, flat.quads)
    glue = sc.Adhesion(quads=np.arange(8, mesh.n_quad), energy=0.05)
    end = np.flatnonzero(turn < 1e-9)
    rate = {"z": lambda time: 1e3 * min(time / 1e-4, 1)}
    pulled = sc.Support(end, rotation="", velocity=rate)
    sim = sc.Simulation(mesh, FILM, supports=[pulled], terms=[glue], damping_alpha=0.0)
    sim.run(until=6e-3)
    peeled = sim.close_ledger()
    assert peeled.adhesion_dissipated > 0.05 * 0.5 * 2.0
    assert abs(peeled.relative(peeled.imbalance)) < 2e-4
    share = (peeled.adhesion_dissipated + peeled.strain) / peeled.support_work
    assert share == pytest.approx(1.0, abs=0.06)


def glued_cut(path="free", **options):
    """A guillotine through a strip that is glued all over, weakly."""
    n_across = 7 if path == "free" else 8
    quads = np.arange(12 * n_across)
    glue = sc.Adhesion(quads=quads, energy=0.02, strength=0.2)
    size = {"length": 6.0, "width": 0.5 * n_across, "notch": 1.0, "travel": 2.0}
    cracks = sc.Fracture(path=path)
    case = guillotine(0.5, **size, terms=[glue], fracture=cracks, **options)
    assert case.simulation.mesh.n_quad == quads.size
    return case


@pytest.mark.parametrize("path", ["free", "edges"])
def test_a_cut_divides_the_glue_among_the_duplicates(path, monkeypatch):
    case = glued_cut(path)
    sim = case.simulation
    glue, asked = glue_of(sim), []
    area = glue.points.area.sum()
    assert area == pytest.approx(sim.mesh.quad_areas().sum(), rel=1e-12)
    of_rows = glue.add_corner_forces
    monkeypatch.setattr(glue, "add_corner_forces", lambda *given: asked.append(of_rows(*given)))
    sim.run(case.duration)
    assert asked or path == "edges"  # by trial cuts, for the forces of single rows
    assert len(sim.state.split_log) > 2
    ledger = sim.close_ledger()
    assert abs(ledger.relative(ledger.imbalance)) < 2e-4
    points = glue.points
    assert points.area.sum() == pytest.approx(area, rel=1e-12)
    # Each duplicate has a share of the area of the mesh's node, and its place on the base.
    node, n = sim.state.node, sim.mesh.n_node
    assert node.real[points.node].all()
    origin = node.origin[points.node]
    share = np.bincount(origin, points.area, n)
    whole = np.bincount(node.origin[:n], nodal_areas(sim.mesh), n)
    np.testing.assert_allclose(share, whole, rtol=1e-12)
    # A crack through quads passes beside the nodes.
    assert np.sum(np.bincount(origin) > 1) == (0 if path == "free" else 5)
    np.testing.assert_allclose(points.base, node.X[points.node], atol=1e-3)


def nodal_areas(mesh):
    """Return the area of the quarters of squares that meet at each node."""
    return np.bincount(mesh.quads.ravel(), np.repeat(mesh.quad_areas() / 4.0, 4), mesh.n_node)


def test_a_run_goes_on_bit_for_bit(tmp_path):
    def reached(sim):
        return sim.ledger.adhesion_dissipated > 1e-3

    check_goes_on(
        lambda **options: glued_cut(**options).simulation, reached, tmp_path / "glue.h5", 100
    )


def test_a_glued_film_can_be_relaxed():
    mesh = rectangle(2.0, 1.0, size=0.5)
    load = sc.Pressure(0.01)
    glue = sc.Adhesion(quads=np.arange(mesh.n_quad), energy=0.05, strength=0.5)
    sim = sc.Simulation(mesh, FILM, loads=[load], terms=[glue])
    sim.relax(tolerance=1e-6)
    carried = (glue_of(sim).points.traction[:, 2] * glue_of(sim).points.area).sum()
    assert carried == pytest.approx(-0.01 * 2.0, rel=1e-4)


LAW = {"energy": 0.05, "strength": 0.5, "stiffness": 40.0, "shear": 0.7}


def stretched(displacement):
    """Return a glued strip that is pinned at both ends and relaxed after a displacement."""
    mesh = rectangle(6.0, 2.0, size=0.5)
    ends = [sc.Support(np.flatnonzero(np.isclose(mesh.nodes[:, 0], x))) for x in (0.0, 6.0)]
    glue = sc.Adhesion(quads=np.arange(mesh.n_quad), energy=0.05, strength=0.5)
    sim = sc.Simulation(mesh, FILM, supports=ends, terms=[glue])
    if displacement:
        sim.relax(displacement * mesh.nodes * np.array([1.0, 0.0, 0.0]))
    return sim


def test_a_film_that_is_stretched_before_the_run_is_glued_as_it_lies_then(tmp_path):
    sim = stretched(0.005)
    points = glue_of(sim).points
    assert np.ptp(points.base[:, 0]) == pytest.approx(6.03, rel=1e-9)
    assert not glue_of(sim).damage.any()
    assert np.abs(points.traction).max() < 0.5
    for _ in range(20):
        sim.step()
    sc.save_checkpoint(sim, tmp_path / "c.h5")
    again = stretched(0.0)
    sc.load_checkpoint(again, tmp_path / "c.h5")
    for one in (sim, again):
        for _ in range(20):
            one.step()
    np.testing.assert_array_equal(again.state.node.x, sim.state.node.x)


def test_a_cut_through_glued_film_has_a_summary(tmp_path):
    glued_cut().run(tmp_path, n_snapshot=0, progress=False)
    assert sc.read(tmp_path).summary["adhesion_damaged_rel"] > 0.0


def test_traction_on_any_path_is_that_of_the_plain_law():
    mesh = rectangle(1.0, 1.0, size=1.0)
    normal = np.array([0.2, -0.3, 0.9]) / np.linalg.norm([0.2, -0.3, 0.9])
    glue = sc.Adhesion(quads=[0], normal=normal.tolist(), **LAW)
    sim = sc.Simulation(mesh, FILM, terms=[glue])
    points, state, generator = glue_of(sim).points, sim.state, np.random.default_rng(3)
    largest, start = np.zeros(4), state.node.x[:4].copy()
    for reach in np.linspace(0.002, 0.7, 90):
        state.node.x[:4] = start + reach * generator.uniform(-1.0, 1.0, (4, 3))
        state.node.force_rows[:] = 0.0
        glue_of(sim).add_forces(state, sim.pose)
        expected = np.zeros((4, 3))
        for k in range(4):
            apart = state.node.x[k] - start[k]
            expected[k], largest[k] = traction(apart, normal, largest[k], **LAW)
        np.testing.assert_allclose(points.traction, expected, atol=1e-12)
        np.testing.assert_allclose(state.node.force[:4], 0.25 * expected, atol=1e-12)
    assert (largest >= 0.2).all()


def test_stored_and_dissipated_make_up_the_work_of_a_slow_path():
    sim = sc.Simulation(rectangle(1.0, 1.0, size=1.0), FILM, terms=[sc.Adhesion(quads=[0], **LAW)])
    glue, state = glue_of(sim), sim.state
    start, work, spent = state.node.x[:4].copy(), 0.0, 0.0
    for t in np.linspace(0.0, 1.0, 20_001):
        apart = 0.13 * math.sin(5.0 * t) * np.array([0.5, -0.2, 1.0])
        state.node.x[:4] = start + apart
        glue.add_forces(state, sim.pose)
        work, spent = work - glue.touch.sums[0], spent + glue.touch.sums[2]
    assert spent > 0.02
    assert work == pytest.approx(spent + glue.touch.sums[1], rel=1e-7)


def test_forces_of_single_rows_add_up_and_leave_the_points_as_they_are():
    sim = glued_cut().simulation
    for _ in range(300):
        sim.step()
    glue, state = glue_of(sim), sim.state
    quads = state.quads[: state.n_quad]
    rows, nodes = np.repeat(np.arange(len(quads)), 4), quads.ravel().astype(np.int64)
    before = [column.copy() for column in glue.points]
    single = np.zeros((rows.size, 3))
    glue.add_corner_forces(state, rows, nodes, single)
    for was, now in zip(before, glue.points, strict=True):
        np.testing.assert_array_equal(was, now)
    total = np.zeros((state.n_node, 3))
    np.add.at(total, nodes, single)
    state.node.force_rows[:] = 0.0
    glue.add_forces(state, sim.pose)
    assert np.abs(total).max() > 1e-6
    np.testing.assert_allclose(total, state.node.force[: state.n_node], atol=1e-15)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "needs nodes or quads"),
        ({"nodes": "left", "quads": [0]}, "needs nodes or quads"),
        ({"nodes": "left"}, "no quad has all its nodes"),
        ({"quads": [99]}, "must lie in 0..7"),
        ({"quads": [0], "normal": [0.0, 0.0, 0.0]}, "must have a direction"),
        ({"quads": [0], "name": "in/out"}, "must have letters, digits"),
        ({"quads": [0], "strength": 1.0, "stiffness": 2.0}, "stiffness of adhesion must be above"),
    ],
)
def test_wrong_input_is_refused(given, words):
    mesh = rectangle(2.0, 1.0, size=0.5)
    with pytest.raises(ValueError, match=words):
        sc.Simulation(mesh, FILM, terms=[sc.Adhesion(**{"energy": 0.05, **given})])


def test_what_the_quads_resolve_of_a_glue_is_said():
    mesh = rectangle(4.0, 2.0, size=0.5)

    def found(**options):
        glue = sc.Adhesion(quads=np.arange(mesh.n_quad), energy=0.05, **options)
        sim = sc.Simulation(mesh, FILM, terms=[glue])
        return sc.check_model(sim, 1e-3).findings

    (told,) = found()
    assert told.severity == "note"
    assert "strength 0.344 MPa" in told.came
    (stiff,) = found(strength=3.0)
    assert "make its quads 0.17 mm small" in stiff.remedy
    damaged = {"adhesion_damaged_rel": 0.1, "adhesion_lift_mm": 0.02}
    summary = {**glued_cut().simulation.terms.summary(), **damaged}
    said = "it holds, but 10 % of its area is damaged and lifted by up to 0.02 mm"
    assert answers(summary) == [("adhesion", said)]
    coarse = {**summary, "adhesion_resolved_rel": 0.6}
    (_, unsure), *_ = answers(coarse)
    assert unsure == f"{said} (doubtful: the quads do not resolve how it peels)"
    gone = {**coarse, "adhesion_let_go_rel": 0.05}
    (snaps,) = [one for one in verdict(gone) if "snaps off adhesion" in one.text]
    assert snaps.kind == "doubt"
    assert "0.9 sides of the quads" in snaps.text
    assert not [one for one in verdict(coarse) if "snaps" in one.text]


@pytest.mark.parametrize("sides", [(1.0, 1.0), (1.0, 0.25), (0.125, 1.0)])
def test_the_strength_by_default_is_resolved_along_the_longer_sides(sides):
    mesh = rectangle(4.0, 2.0, n_x=round(4.0 / sides[0]), n_y=round(2.0 / sides[1]))
    glue = sc.Adhesion(quads=np.arange(mesh.n_quad), energy=0.05)
    points = glue_of(sc.Simulation(mesh, FILM, terms=[glue]))
    assert points.zone == pytest.approx(1.5, rel=1e-12)  # sides of 1 mm


def test_a_fold_too_small_for_tears_is_doubted_where_the_film_may_crack():
    mesh = rectangle(4.0, 2.0, size=0.5)

    def doubts(energy, **options):
        glue = sc.Adhesion(quads=np.arange(mesh.n_quad), energy=energy)
        sim = sc.Simulation(mesh, FILM, terms=[glue], **options)
        return [one for one in sc.check_model(sim, 1e-3).doubts if "flap" in one.holds]

    (small,) = doubts(0.1, law=sc.CohesiveLaw())
    assert small.came == "1.1 sides"
    assert small.remedy == "make the quads 0.37 mm small"
    assert doubts(0.05, law=sc.CohesiveLaw()) == []  # 1.6 sides
    assert doubts(0.1) == []
    tool = sc.tool_shapes.straight_blade()
    led = {"tool": tool, "motion": sc.StraightMotion((1.0, 0.0, 0.0), 1e3)}
    assert doubts(0.1, law=sc.CohesiveLaw(), **led) == []


def test_glue_supports_a_film():
    """Without a support, glue alone keeps the piece: no doubt of a film that nothing supports."""
    mesh = rectangle(4.0, 2.0, size=0.5)
    glue = sc.Adhesion(quads=np.arange(8), energy=0.05)
    tool = sc.tool_shapes.straight_blade().translated((-20.0, 0.0, 0.0))
    motion = sc.StraightMotion((1.0, 0.0, 0.0), 1e3)
    for terms, n_doubt in (([glue], 0), ([], 1)):
        sim = sc.Simulation(mesh, FILM, tool=tool, motion=motion, terms=terms)
        doubts = [one for one in sc.check_model(sim, 1e-4).doubts if "piece" in one.holds]
        assert len(doubts) == n_doubt


def two_films(**options):
    """Return a film in two pieces, one clamped and one, of quads 8 to 15, free or glued."""
    one = rectangle(2.0, 1.0, size=0.5)
    nodes = np.vstack([one.nodes, one.nodes + np.array([3.0, 0.0, 0.0])])
    quads = np.concatenate([one.quads, one.quads + one.n_node])
    mesh = sc.Mesh.from_arrays(nodes, quads)
    moved = {"velocity": {"z": lambda time: 1.0}}
    clamp = sc.Support(np.flatnonzero(nodes[:, 0] < 0.1), **moved)
    return sc.Simulation(mesh, FILM, supports=[clamp], law=sc.CohesiveLaw(), **options)


@pytest.mark.parametrize(("terms", "n_loose"), [([], 1), ([sc.Adhesion(quads=range(8, 16))], 0)])
def test_a_glued_piece_is_not_loose_and_frames_show_the_glue(tmp_path, terms, n_loose):
    case = Case("two", two_films(terms=terms), 2e-6)
    case.run(tmp_path, n_snapshot=0, progress=False)
    results = sc.read(tmp_path)
    frame = results.frame(-1)
    assert results.summary["n_loose"] == n_loose
    assert frame.held[frame.quads[8:]].all() == bool(terms)
    assert ("adhesion" in frame.quad_history) == bool(terms)


def test_a_model_file_glues():
    text = A_CUT + '[[adhesion]]\nquads = [0, 1]\nenergy = "50 N/m"\n'
    (glue,) = model_of_text(text, "glued.toml").build().simulation.inputs["terms"]
    assert glue.energy == pytest.approx(0.05)
    assert tuple(glue.quads) == (0, 1)
