"""What the verdict compares energies with, by who does the work: histories by hand, and runs."""

import re

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle
from shellcut.models import free_cut
from shellcut.results.energy_account import cut_work, relative_figures
from shellcut.results.verdict import verdict
from shellcut.tool.shapes import straight_blade

TOUCHED = {"deepest_penetration": [0.0, 0.1, 0.1, 0.1]}


@pytest.mark.parametrize(
    ("columns", "work", "begin"),
    [
        ({"tool_work": [0, 0, 1, 8], "cohesive_work": [0, 0, 0, 7]}, [0, 0, 1, 8], 1),
        # What supports put in before the tool, and what yields then, is no work of the cut.
        ({"tool_work": [0, 0, 1, 4], "support_work": [0, 9, 9, 9], "friction_work": [0, 2, 2, 8]},
         [0, 0, 1, 6], 1),
        # As seen from the film, which its supports move.
        ({"tool_work": [0, 1, 5, 9], "tool_work_in_film": [0, 1, 3, 4]}, [0, 1, 3, 4], 0),
        ({"tool_work": [0, 1e-12, 0, 0], "support_work": [0, 1, 5, 6]}, [0, 1, 5, 6], 0),
        # A tool that gets back what it has put in, or is driven by the film.
        ({"tool_work": [0, 6, 2, 0]}, [0, 6, 6, 6], 0),
        ({"tool_work": [0, -2, -4, -3]}, [0, 2, 4, 4], 0),
        # Loads press the film on a tool at rest; without a tool nobody's force is in question.
        ({"load_work": [0, 0, 2, 5]} | TOUCHED, [0, 0, 2, 5], 1),
        ({"load_work": [0, 0, 2, 5], "cohesive_work": [0, 0, 1, 4]}, [0, 0, 0, 0], 0),
        ({"load_work": [0, 8, 8, 8], "tool_work": [0, 0, 0.1, 0.2], "cohesive_work": [0, 0, 3, 5]},
         [0, 0, 3, 5], 1),
    ],
)  # fmt: skip
def test_the_work_of_the_cut_is_that_of_the_tool_or_what_the_laws_dissipate(columns, work, begin):
    history = {"tool_work": np.zeros(4)} | {k: np.array(v, float) for k, v in columns.items()}
    found, row = cut_work(history)
    assert (found.tolist(), row) == (work, begin)


def test_each_share_is_of_what_it_may_falsify():
    # A load is put on and taken off while the tool waits. Then a tenth of the cut has no balance.
    columns = {
        "load_work": [0.0, 50.0, 0.0, 0.0, 0.0],
        "tool_work": [0.0, 0.0, 0.0, 5.0, 10.0],
        "kinetic_translation": [0.0, 30.0, 20.0, 1.0, 0.5],
        "damping_mass": [0.0, 10.0, 20.0, 20.2, 20.4],
        "imbalance": [0.0, 0.1, 0.2, 0.5, 1.0],
    }
    history = {name: np.array(column) for name, column in columns.items()}
    figures = relative_figures(history | {"kinetic_rotation": np.zeros(5)})
    assert figures == pytest.approx(
        {
            "imbalance_rel": 1.0 / 50.0,
            "kinetic_rel": 1.0 / 5.0,
            "cut_work_Nmm": 10.0,
            "damping_before_Nmm": 20.0,
        }
    )
    end = {"damping_Nmm": 20.4, "cables_Nmm": 9.0, "n_cable_broken": 1, "tool_work_Nmm": 10.0}
    lines = [line.text for line in verdict(figures | end)]
    for said in (
        "at most 2 % of the energy put in",
        "reaches 20 % of the work of the cut",
        "Damping is small: 4 % of the work of the cut",
        "cables took 95.7 % of the dissipated work",
    ):
        assert any(said in line for line in lines), said


# --- runs of one cut, 1.6 mm into a strip, with another source of the energy each

SPEED, WAIT, WIDTH, STRETCH = 6000.0, 4e-4, 14.4, 0.008


def pulse(time):
    """Return the speed at which a border moves out while the blade is on its way [mm/s]."""
    return STRETCH * WIDTH / WAIT * np.sin(np.pi * time / WAIT) ** 2 if time < WAIT else 0.0


SOURCES = {
    "tool": {},
    "moved": {side: {"x": lambda t: -SPEED * min(t / 1e-4, 1.0)} for side in ("bottom", "top")},
    "stretched": {"bottom": {"y": lambda t: -pulse(t)}, "top": {"y": pulse}},
    "relaxed": {},
    "pressed": {},
}


def strip(source):
    """Return the case of a blade and a strip, which that source moves, stretches or presses."""
    mesh, sides = rectangle(8.0, WIDTH, size=0.8), SOURCES[source]
    speed = 1e-6 if source == "moved" else SPEED
    tool = straight_blade(length=8.0, height=3.0, half_thickness=0.3)
    load = sc.Pressure(0.08, factor=lambda t: min(t / WAIT, 1.0))
    case = free_cut(
        mesh,
        tool=tool.translated((0.25 - SPEED * WAIT, 0.0, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed, ramp=1e-4),
        duration=WAIT + 1.6 / SPEED,
        supports=[
            sc.Support(side, velocity=sides[side]) if sides else sc.Support.clamped(side)
            for side in ("bottom", "top")
        ],
        loads=[load] if source == "pressed" else [],
    )
    if source == "relaxed":
        case.simulation.relax(case.simulation.mesh.nodes * [0.0, STRETCH, 0.0])
    return case


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    found = {}
    for source in SOURCES:
        folder = tmp_path_factory.mktemp(source)
        strip(source).run(folder, progress=False, curves=False, n_frame=2, n_snapshot=0, n_row=200)
        found[source] = sc.read(folder).summary
    return found


@pytest.mark.parametrize("source", SOURCES)
def test_every_run_is_judged_by_the_work_of_its_cut(figures, source):
    found = figures[source]
    texts = [line["text"] for line in found["verdict"]]
    (said,) = (text for text in texts if text.startswith("The energies balance"))
    assert "of the energy put in (limit 1 %)" in said
    (share,) = (
        re.search(r": (\S+) % of the work of the cut", t)[1] for t in texts if "amping is" in t
    )
    damping = found["damping_Nmm"] - found.get("damping_before_Nmm", 0.0)
    # Two digits are said.
    assert float(share) == pytest.approx(100.0 * damping / found["cut_work_Nmm"], rel=0.05)


def test_the_work_of_a_cut_does_not_depend_on_who_moves_or_stretches_the_film(figures):
    work = {source: found["cut_work_Nmm"] for source, found in figures.items()}
    alone, moved, stretched, relaxed, pressed = (figures[source] for source in SOURCES)
    assert work["tool"] == alone["tool_work_Nmm"]
    assert abs(moved["tool_work_Nmm"]) < 1e-6 * moved["support_work_Nmm"]
    # The start differs: a film that its supports move vibrates.
    assert work["moved"] == pytest.approx(work["tool"], rel=0.02)
    # Both films store the same before the cut, a quarter of its work.
    assert stretched["support_work_Nmm"] == pytest.approx(relaxed["initial_Nmm"], rel=0.01)
    assert stretched["support_work_Nmm"] > 0.25 * work["stretched"]
    assert work["stretched"] == pytest.approx(work["relaxed"], rel=0.02)
    assert stretched["kinetic_rel"] == pytest.approx(relaxed["kinetic_rel"], rel=0.1)
    # The pressure opens the cut that the blade begins. Cables still store some of their work.
    assert pressed["load_work_Nmm"] > 2.0 * pressed["tool_work_Nmm"]
    assert work["pressed"] >= pressed["cables_Nmm"] > 2.0 * pressed["tool_work_Nmm"]
    assert pressed["imbalance_rel"] < 1e-3
