"""The force at which the teeth of the opening test go through the film, whatever the mesh and path.

Axial, of each tooth in the step in which one of them pierces; F_p is that of a sharp tip.
"""

import numpy as np
import pytest

import shellcut
from films import unstructured_disc
from page_tables import numbers_of, shown, table
from shellcut import CohesiveLaw, Fracture, MeasuredCurve, Recorder, ShellMaterial, opening_test
from shellcut.contact.tool_points import tool_points
from shellcut.fracture.puncture import puncture_force
from shellcut.results.verdict import verdict
from shellcut.tool.shapes import tooth_ring

DURATION = 6e-3
"""Of 95 degrees [s]."""

F_P = puncture_force(ShellMaterial.homogeneous(), CohesiveLaw())


def first_split(duration, film="quick", clearance=0.02, **options):
    """Return the axial forces of the teeth in the step before a tip pierces [N], and the record.

    duration : of 95 degrees [s].
    """
    tool = tooth_ring(tip_clearance=clearance)
    sim = opening_test(film, tool=tool, duration=duration, **options).simulation
    while not sim.state.split_log:
        force = np.abs(sim.terms.wrench[:, 2])
        sim.step()
        assert sim.state.time < 0.15 * duration
    return force, sim.state.split_log[0]


def pierced(thickness, duration):
    """Return the record of the first piercing of a film."""
    return first_split(duration, material=ShellMaterial.homogeneous(thickness=thickness))[1]


def judged(record):
    """Return what the verdict says of it: whether it is good, and how much slower to go."""
    (line,) = [one for one in verdict({"piercing_delay_rel": record.delay}) if "tip" in str(one)]
    slower = line.text.partition("motion that is ")[2].partition(" times slower")[0]
    return line.kind, float(slower or 1.0)


@pytest.mark.parametrize(
    ("film", "path", "clearance", "slower"),
    [
        ("quick", "free", 0.0, 1.0),
        ("quick", "free", 0.04, 1.0),
        ("quick", "edges", 0.02, 1.0),
        ("quick", "free", 0.02, 0.5),
        ("quick", "free", 0.02, 3.0),
        ("raw", "free", 0.02, 1.0),
    ],
)
def test_a_tip_pierces_at_its_force(film, path, clearance, slower):
    film = unstructured_disc() if film == "raw" else film
    fracture = Fracture(path=path)
    force, record = first_split(slower * DURATION, film, clearance, fracture=fracture)
    assert record.kind == "puncture"
    # Forces are looked at every ten steps.
    assert 1.0 <= record.measure < 1.06
    assert record.force == pytest.approx(F_P, rel=0.06)
    # With impacts of nodes, which do not pierce: 0.387 to 0.426 N, this at twice the speed.
    assert force.max() == pytest.approx(F_P, rel=0.06 if slower >= 1.0 else 0.12)
    # All are felt, over skewed quads too; on an irregular mesh not all at the same depth.
    assert force.min() > 0.7 * F_P


def on_the_page():
    """Return share [%], depth [mm] and work [N·mm] as shown by film [mm] and duration [s]."""
    told = {}
    for film, *cells in table("docs/howto/pierce.md", "film | time for 95°")[1]:
        columns = zip(*map(numbers_of, cells), strict=True)
        for duration, *figures in columns:
            told[float(numbers_of(film)[0]), 1e-3 * float(duration)] = figures
    return told


TOLD = on_the_page()


@pytest.mark.parametrize(
    ("thickness", "duration"),
    [
        one if one in ((0.02, 6e-3), (0.2, 6e-3)) else pytest.param(*one, marks=pytest.mark.slow)
        for one in TOLD
    ],
)
def test_impacts_of_nodes_do_not_pierce(thickness, duration):
    # Quads of 0.8 mm: the contact force itself reaches F_p of 0.02 mm at 0.065 mm in 6 ms, and at
    # 0.003 mm in 3 ms, as the tip meets the first node.
    record = pierced(thickness, duration)
    figures = 100.0 * record.delay, record.depth, record.work
    told = TOLD[thickness, duration]
    assert [shown(*pair) for pair in zip(figures, told, strict=True)] == told
    assert 1.0 <= record.measure < 1.06
    if record.delay <= 0.05:
        _, depth, work = map(float, TOLD[thickness, 24e-3])
        assert record.depth == pytest.approx(depth, rel=0.15)
        assert record.work == pytest.approx(work, rel=0.10)
    assert judged(record)[0] == ("good" if record.delay <= 0.05 else "doubt")


def test_a_tip_too_fast_is_told_how_slow_to_go():
    record = pierced(0.02, 1.5e-3)
    _, depth, work = map(float, TOLD[0.02, 24e-3])
    kind, slower = judged(record)
    assert kind == "doubt"
    # Its depth is nearly right, while the work is more than twice that of a slow tip.
    assert record.depth == pytest.approx(depth, rel=0.15)
    assert record.work > 2.0 * work
    assert 3.0 < slower < 5.0
    again = pierced(0.02, slower * 1.5e-3)
    assert judged(again)[0] == "good"
    assert again.work == pytest.approx(work, rel=0.20)


@pytest.mark.parametrize("radius", [0.0, 0.02, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("size", [0.1, 0.4, 0.8])
def test_every_end_of_a_cutting_edge_has_its_point(radius, size):
    tool = tooth_ring(edge_radius=radius)
    points = tool_points(tool, size)
    ends = np.flatnonzero(np.bincount(tool.edges.ravel(), minlength=tool.n_vertex) == 1)
    assert len(ends) >= 4
    tips = points.place[points.radius == 0.0]
    gap = np.linalg.norm(tool.vertices[ends][:, None] - tips[None], axis=2).min(axis=1)
    assert gap.max() == 0.0


def test_force_depth_and_work_at_the_first_piercing_are_told(tmp_path):
    case = opening_test("quick", duration=DURATION, tool=tooth_ring(tip_clearance=0.02))
    sim, until = case.simulation, 0.06 * DURATION
    sim.run(until, [Recorder(sim, tmp_path / "out", until=until, name="quick", n_row=200)])
    results = shellcut.read(tmp_path / "out")
    history, splits, told = results.history, results.splits, results.summary
    for edge in (1, 2, 3, 4):
        k = np.flatnonzero(splits["edge"] == edge)[0]
        then = splits["time"][k]
        assert splits["kind"][k] == "puncture"
        for what, unit in (("force", "N"), ("depth", "mm"), ("work", "Nmm")):
            assert told[f"piercing_{what}_{edge}_{unit}"] == splits[what][k]
        assert splits["force"][k] == pytest.approx(F_P, rel=0.06)
        # The tip is as deep as the tool has come down, but for what the contact yields.
        down = -sim.motion.pose(then)[1][2] - 0.02
        assert 0.9 * down < splits["depth"][k] < down
        work = np.interp(then, history["time"], history["tool_work"])
        assert splits["work"][k] == pytest.approx(work, rel=0.02)
    delays = [record.delay for record in sim.state.split_log if record.kind == "puncture"]
    assert 0.0 < told["piercing_delay_rel"] <= max(delays) < 0.05
    angle = history["angle"]
    measured = MeasuredCurve(angle, 0.5 * history["axial_force"], "deg", "N")
    found = shellcut.compare(results, measured, y="axial_force")
    assert found.pierced_at == pytest.approx(np.interp(then, history["time"], angle))
    assert found.pierced_simulated == pytest.approx(4.0 * F_P, rel=0.06)
    assert found.pierced_measured == pytest.approx(0.5 * found.pierced_simulated)
    assert "at first piercing" in str(found)
