"""A film pulled by its supports, without a tool: way, force, work, verdict, report, pictures."""

import json

import numpy as np
import pytest

from shellcut import (
    Adhesion,
    Fracture,
    ShellMaterial,
    Simulation,
    Support,
    read,
    report_run,
    trouser,
)
from shellcut.loads.supports import Ramped
from shellcut.mesh.structured import rectangle
from shellcut.recording.resistance import SupportPull


@pytest.fixture(scope="module")
def torn(tmp_path_factory):
    """A small trouser test that is torn to its end."""
    folder = tmp_path_factory.mktemp("torn")
    case = trouser(1.0, length=20.0, notch=4.0, speed=6000.0, ramp=1e-4)
    case.run(folder, n_row=200, n_frame=4, n_snapshot=2)
    return case, folder


def test_the_work_of_the_supports_is_that_of_the_force_over_the_way(torn):
    _, folder = torn
    h = read(folder).history
    assert list(h)[1:3] == ["way", "force"]
    after_the_ramp = 2.0 * 6000.0 * (h["time"][-1] - 0.5e-4)  # by which the two legs part
    assert h["way"][-1] == pytest.approx(after_the_ramp, rel=1e-6)  # round-off of the way's table
    # Discretisation: a row in 30 steps; the force rises and falls with the quads.
    work = np.trapezoid(h["force"], h["way"])
    assert work == pytest.approx(h["support_work"][-1], rel=0.05)
    assert not h["tool_work"].any()
    assert not any("tooth" in name or "penetration" in name for name in h)


def test_its_summary_judges_the_work_of_the_supports(torn):
    case, folder = torn
    said = json.loads((folder / "summary.json").read_text())
    assert said["support_work_Nmm"] == case.simulation.ledger.support_work
    assert not {"tool_work_Nmm", "contact_Nmm", "deepest_penetration_mm"} & set(said)
    assert said["imbalance_rel"] < 1e-3
    # Quads of two fifths of opening_u, four a leg, and a quick pull: within a tenth of G h / 2.
    G_h = case.simulation.law.fracture_energy * case.simulation.material.thickness
    assert said["force_plateau_N"] == pytest.approx(0.5 * G_h, rel=0.1)
    assert said["window_from_mm"] > 4.0
    lines = [line["text"] for line in said["verdict"]]
    assert said["cut_work_Nmm"] == said["support_work_Nmm"]
    assert any("of the work of the cut" in line for line in lines)
    assert not any("tool" in line for line in lines)


def test_its_report_and_its_pictures_are_there(torn):
    _, folder = torn
    assert "work of the supports" in report_run(folder).read_text()
    assert {"force.png", "energy.png", "snapshot_00.png"} <= {p.name for p in folder.iterdir()}
    assert read(folder).frame(-1).tool_points.size == 0


def strip(supports, *, velocity=(0.0, 0.0, 0.0), **options):
    mesh = rectangle(4.0, 2.0, size=1.0)
    film = ShellMaterial.homogeneous(young=1000.0, poisson=0.3, thickness=0.1)
    velocity = np.tile(velocity, (mesh.n_node, 1))
    return Simulation(mesh, film, supports=supports, velocity=velocity, **options)


def moved(nodes, velocity, over=1e-4, common=(0.0, 0.0, 0.0)):
    """A grip without turns whose velocity rises over a time, and a velocity common to all."""
    rates = {
        axis: lambda time, v=v, u=u: u + v * min(time / over, 1.0)
        for axis, v, u in zip("xyz", velocity, common, strict=True)
    }
    return Support(nodes, rotation="", velocity=rates)


PULLS = {
    "stretch": {"left": (0.0, 0.0, 0.0), "right": (900.0, 0.0, 0.0)},
    "shear": {"bottom": (0.0, 0.0, 0.0), "top": (700.0, 0.0, 0.0)},
    "three grips": {(0,): (0.0, 300.0, 400.0), (4,): (0.0, 0.0, -400.0), (10, 14): (0.0,) * 3},
}


@pytest.mark.parametrize("common", [(-450.0, 0.0, 0.0), (3000.0, -800.0, 0.0), (9.0, 1.0, 5e3)])
@pytest.mark.parametrize("name", PULLS)
def test_a_velocity_common_to_all_changes_no_figure(name, common):
    figures = []
    for u in ((0.0, 0.0, 0.0), common):
        grips = [
            moved(nodes if isinstance(nodes, str) else list(nodes), v, common=u)
            for nodes, v in PULLS[name].items()
        ]
        sim = strip(grips, velocity=u)
        pull = SupportPull(sim, 2e-4)
        sim.run(2e-4)
        row = {figure: value for figure, _, value in pull.row(sim)}
        figures.append([pull.coordinate(2e-4), row["force"], row["kinetic_in_film"]])
    speeds = np.array(list(PULLS[name].values()))
    apart = max(np.linalg.norm(one - other) for one in speeds for other in speeds)
    # Round-off of the way's table.
    assert figures[0][0] == pytest.approx(apart * 1.5e-4, rel=1e-6)
    assert abs(figures[0][1]) > 0.01
    (way, force, kinetic), carried = figures
    assert carried[0] == pytest.approx(way, rel=1e-6)
    # A difference of 1e-10 mm in the first step grows where the film bends, measured 8e-4.
    assert carried[1] == pytest.approx(force, rel=2e-3)
    # The momentum is half a step later than the energy. Measured 0.04 at most.
    assert carried[2] == pytest.approx(kinetic, rel=0.05)


TEST_MACHINES = [(0.0, 60.0), (-60.0, 0.0), (-30.0, 30.0), (-15.0, 45.0)]


@pytest.mark.parametrize(("left", "right"), TEST_MACHINES)
def test_the_force_is_that_of_a_load_cell_whichever_grip_moves(left, right):
    grips = [
        Support(name, translation="x", rotation="", velocity={"x": Ramped(v, 1e-3)})
        for name, v in (("left", left), ("right", right))
    ]
    fixed = Support([5], translation="yz", rotation="")
    sim = strip([*grips, fixed], damping_alpha=1e4)
    pull = SupportPull(sim, 2e-3)
    sim.run(2e-3)
    way = 60.0 * 1.5e-3
    e = way / 4.0
    assert pull.coordinate(2e-3) == pytest.approx(way, rel=1e-6)  # round-off of the way's table
    # E h b with the Green strain, so per length of the reference; inertia and drag, 1 %.
    assert pull.felt(sim) == pytest.approx([200.0 * (1.0 + e) * (e + 0.5 * e * e)], rel=0.01)


@pytest.mark.parametrize("held", ["nothing", "another axis", "glue"])
def test_without_a_second_grip_along_the_motion_it_is_seen_in_space(held):
    alone = moved("right", (300.0, 0.0, 400.0))
    rest = [Support([5], translation="y", rotation="")] if held == "another axis" else []
    glue = [Adhesion(quads=[0], energy=1.0, strength=5.0)] if held == "glue" else []
    sim = strip([alone, *rest], terms=glue)
    pull = SupportPull(sim, 1e-4)
    sim.run(1e-4)
    assert pull.coordinate(1e-4) == pytest.approx(500.0 * 0.5e-4, rel=1e-6)
    n = sim.state.node
    power = np.sum(n.reaction[:, :3] * n.support_rate[:, :3])
    assert pull.felt(sim) == pytest.approx([power / np.hypot(*n.support_rate[4, [0, 2]])], rel=1e-9)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"notch": 20.0}, "notch must lie within the length"),
        ({"length": 3.0, "notch": 1.0}, "lengthen the strip"),
        ({"size": 1.0, "fracture": Fracture(path="edges")}, "nothing steers its crack"),
    ],
)
def test_what_cannot_be_is_refused(wrong, said):
    with pytest.raises(ValueError, match=said):
        trouser(**wrong)
