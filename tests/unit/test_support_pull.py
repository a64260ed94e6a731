"""A film pulled by its supports, without a tool: way, force, work, verdict, report, pictures."""

import json

import numpy as np
import pytest

from shellcut import Fracture, ShellMaterial, Simulation, Support, read, report_run, trouser
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
    after_the_ramp = 6000.0 * (h["time"][-1] - 0.5e-4)
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
    # Quads of two fifths of opening_u, four a leg, and a quick pull: within a tenth of G h.
    G_h = case.simulation.law.fracture_energy * case.simulation.material.thickness
    assert said["force_plateau_N"] == pytest.approx(G_h, rel=0.1)
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


def test_the_way_is_that_of_the_fastest_support():
    fast = {"x": lambda time: 300.0, "y": lambda time: 400.0 * time / 1e-3}
    pulled = [  # node 5 begins the middle row
        Support("right", velocity=fast),
        Support([5], translation="z", rotation="", velocity={"z": lambda time: -100.0}),
    ]
    sim = Simulation(rectangle(4.0, 2.0, size=1.0), ShellMaterial.homogeneous(), supports=pulled)
    pull = SupportPull(sim, 1e-3)
    t = np.linspace(0.0, 1e-3, 2001)
    way = np.trapezoid(np.hypot(300.0, 400.0 * t / 1e-3), t)
    assert pull.coordinate(1e-3) == pytest.approx(way, rel=1e-6)  # discretisation of the integral
    assert pull.coordinate(0.0) == 0.0


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
