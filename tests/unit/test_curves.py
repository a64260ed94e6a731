"""The curves are drawn with names and units, parts and comparisons, and refuse ragged columns."""

import dataclasses

import numpy as np
import pytest

from shellcut.results.run_curves import energy_diagram, imbalance_diagram, resistance_diagram
from shellcut.view import Curve, Diagram, curves, draw_curves

pytest.importorskip("matplotlib", reason="needs shellcut[plot]")

ANGLE = np.linspace(0.0, 95.0, 60)
TORQUE = 143.6 * np.clip(ANGLE / 15.0, 0.0, 1.0)
WORK = np.cumsum(TORQUE) * np.radians(ANGLE[1])


@pytest.fixture
def figures(monkeypatch):
    """Return the list of figures that were saved."""
    saved = []
    really_save = curves.save

    def save(figure, path):
        saved.append(figure)
        really_save(figure, path)

    monkeypatch.setattr(curves, "save", save)
    return saved


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


UNITS = {"time": "s", "angle": "deg", "torque": "N*mm"}
PARTS = {
    "time": ANGLE,
    "angle": ANGLE,
    "torque": TORQUE,
    "torque_contact": 0.03 * TORQUE,
    "torque_edges": 0.02 * TORQUE,
    "torque_joints": 0.95 * TORQUE,
    "torque_tooth_1": 0.5 * TORQUE,
    "torque_tooth_2": 0.5 * TORQUE,
    "tool_work": WORK,
}


def test_torque_with_its_parts_and_others(tmp_path, figures):
    path = tmp_path / "torque.png"
    diagram = resistance_diagram(PARTS, UNITS)
    mean = Curve("mean", [143.6, 143.6], "mean", x=[27.44, 63.09])
    diagram = dataclasses.replace(diagram, curves=[*diagram.curves, mean], title="opening")
    draw_curves(path, [diagram], dpi=50)
    assert path.stat().st_size > 1000
    (axes,) = figures[0].axes
    assert axes.get_xlabel() == "angle [°]"
    assert axes.get_ylabel() == "torque [N·mm]"
    parts = ["each of 2 teeth", "from contact", "from cables at the edge", "total"]
    assert labels(axes) == [*parts, "mean"]
    assert axes.get_legend().get_title().get_text() == "opening"
    lines = {line.get_label(): line for line in axes.lines}
    assert lines["mean"].get_xydata().tolist() == [[27.44, 143.6], [63.09, 143.6]]
    np.testing.assert_array_equal(lines["total"].get_ydata(), TORQUE)
    np.testing.assert_allclose(lines["from contact"].get_ydata(), 0.05 * TORQUE, atol=1e-9)


def test_energy_is_stacked_and_the_imbalance_below(tmp_path, figures):
    missed = {"imbalance": 1e-4 * WORK, "imbalance_rel": 1e-4 + 0.0 * WORK}
    history = PARTS | missed | {"cohesive_work": 0.95 * WORK, "damping_mass": 0.05 * WORK}
    diagrams = [of(history, UNITS) for of in (energy_diagram, imbalance_diagram)]
    draw_curves(tmp_path / "energy.svg", diagrams)
    upper, lower = figures[0].axes
    assert len(upper.collections) == 2
    assert labels(upper) == ["cables", "damping", "work put in"]
    rim = upper.collections[1].get_paths()[0].vertices[:, 1].max()
    assert rim == pytest.approx(WORK[-1])
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("energy [N·mm]", "imbalance [%]")
    shown = lower.lines[0].get_ydata()
    early = 0.1 * WORK[-1] > WORK
    assert early[0]
    assert np.isnan(shown[early]).all()
    assert shown[~early] == pytest.approx(0.01)


def test_negative_shares_are_lines_and_ragged_columns_refused(tmp_path, figures):
    history = PARTS | {"cohesive_work": 1.2 * WORK, "damping_mass": -0.2 * WORK}
    draw_curves(tmp_path / "energy.png", [energy_diagram(history, UNITS)], dpi=50)
    (upper,) = figures[0].axes
    assert not upper.collections
    assert {"cables", "damping", "work put in"} <= {line.get_label() for line in upper.lines}
    ragged = Diagram(ANGLE, [Curve("total", TORQUE[1:])], "angle", "deg", "torque", "N*mm")
    with pytest.raises(ValueError, match=r"total must have as many rows .*, 60, got"):
        draw_curves(tmp_path / "never.png", [ragged])
