"""The curves are drawn with names and units, parts and comparisons, and refuse ragged columns."""

import dataclasses

import numpy as np
import pytest

from opening_frame import RADIUS, opening_frame
from shellcut.results.run_curves import energy_diagram, imbalance_diagram, resistance_diagram
from shellcut.view import Curve, Diagram, curves, draw_crack_map, draw_curves
from shellcut.view.crack_map import crack_history, tooth_paths

pytest.importorskip("matplotlib", reason="needs shellcut-fem[plot]")

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


@pytest.mark.parametrize(
    ("second", "teeth"),
    [(0.499, ["each of 2 teeth, all alike"]), (0.45, ["tooth 1", "tooth 2"])],
)
def test_torque_with_its_parts_and_others(tmp_path, figures, second, teeth):
    path = tmp_path / "torque.png"
    mean_of = {"torque_plateau_Nmm": 143.6, "torque_plateau_half_width_Nmm": 0.5}
    mean_of |= {"window_from_deg": 27.44, "window_to_deg": 63.09}
    history = PARTS | {"torque_tooth_2": second * TORQUE}
    diagram = resistance_diagram(history, UNITS, mean_of)
    draw_curves(path, [dataclasses.replace(diagram, title="opening")], dpi=50)
    assert path.stat().st_size > 1000
    (axes,) = figures[0].axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("angle [°]", "torque [N·mm]")
    mean = "mean over 27.4-63.1°: 143.6 ± 0.5 N·mm"
    assert labels(axes) == [*teeth, "from contact", "from cables at the edge", "total", mean]
    assert axes.get_legend().get_title().get_text() == "opening"
    lines = {line.get_label(): line for line in axes.lines}
    assert lines[mean].get_xydata().tolist() == [[27.44, 143.6], [63.09, 143.6]]
    np.testing.assert_array_equal(lines["total"].get_ydata(), TORQUE)
    assert len({line.get_color() for line in axes.lines}) == len(axes.lines)
    np.testing.assert_allclose(lines["from contact"].get_ydata(), 0.05 * TORQUE, atol=1e-9)


def test_energy_is_stacked_and_the_imbalance_below(tmp_path, figures):
    history = PARTS | {"cohesive_work": 0.95 * WORK, "damping_mass": 0.05 * WORK}
    history["imbalance"] = 1e-4 * WORK
    diagrams = [of(history, UNITS) for of in (energy_diagram, imbalance_diagram)]
    draw_curves(tmp_path / "energy.svg", diagrams)
    upper, lower = figures[0].axes
    assert len(upper.collections) == 2
    assert labels(upper) == ["cables", "damping", "work put in"]
    rim = upper.collections[1].get_paths()[0].vertices[:, 1].max()
    assert rim == pytest.approx(WORK[-1])
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("energy [N·mm]", "imbalance [%]")
    shown, early = lower.lines[0].get_ydata(), 0.1 * WORK[-1] > WORK
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
    with pytest.raises(ValueError, match="same first dimension"):
        draw_curves(tmp_path / "never.png", [ragged])


# --- crack map: when edges opened, where teeth went, and that it is drawn


ANGLES = (0.0, 15.0, 30.0, 45.0)


@pytest.fixture(scope="module")
def frames():
    return [opening_frame(angle, n_side=16) for angle in ANGLES]


def blurred(frame, size, seed):
    noise = np.random.default_rng(seed).normal(scale=size, size=frame.reference.shape)
    return dataclasses.replace(frame, reference=frame.reference + noise)


def test_edges_are_dated_by_their_first_frame(frames):
    segments, opened = crack_history(frames)
    assert len(segments) == len(frames[-1].crack_edges)
    for k, frame in enumerate(frames):
        assert (opened <= ANGLES[k]).sum() == len(frame.crack_edges)
    np.testing.assert_allclose(np.hypot(*segments.reshape(-1, 3)[:, :2].T), RADIUS, atol=1e-9)
    segments, opened = crack_history(frames[:1])
    assert segments.shape == (0, 2, 3)
    assert opened.shape == (0,)
    # 1e-4 mm is the rounding of a displacement of half a millimetre; edges are 0.9 mm long
    rounded = [blurred(frame, 1e-4, k) for k, frame in enumerate(frames)]
    np.testing.assert_array_equal(crack_history(rounded)[1], crack_history(frames)[1])


def test_teeth_go_through_the_film_along_the_circle(frames):
    paths = tooth_paths(frames)
    assert len(paths) == 4
    for path in paths:
        np.testing.assert_allclose(np.hypot(path[:, 0], path[:, 1]), RADIUS, rtol=1e-3)
        np.testing.assert_allclose(path[:, 2], 0.0, atol=1e-12)
    above = np.array([0.0, 0.0, 9.0])
    lifted = [dataclasses.replace(f, edge_points=f.edge_points + above) for f in frames]
    assert np.isnan(tooth_paths(lifted)).all()
    # A curved film has no plane to go through.
    x, y, _ = frames[0].reference.T
    bent = np.stack((x, y, x**2), axis=1)
    assert tooth_paths([dataclasses.replace(frames[0], reference=bent)]) == []


def test_the_picture_has_the_colours_of_early_and_late(tmp_path, frames):
    from matplotlib import colormaps, image

    splits = {"blade": frames[-1].reference[frames[-1].crack_edges[::3, 0, 0]]}

    def colours(shown, **options):
        draw_crack_map(tmp_path / "map.png", shown, width=6.0, dpi=60, **options)
        pixels = image.imread(tmp_path / "map.png")[..., :3]
        assert pixels.shape[1] == 360
        plan = pixels[:, : int(0.86 * 360)]  # without the colour bar
        return [
            int((np.abs(plan - colormaps["viridis"](u)[:3]).max(axis=2) < 0.06).sum())
            for u in (15.0 / 45.0, 30.0 / 45.0, 1.0)
        ]

    # measured: about 100 pixels each
    assert min(colours(frames)) > 20
    assert min(colours(frames, splits=splits)) > 20
    assert colours(frames[:1]) == [0, 0, 0]
    with pytest.raises(ValueError, match="at least one frame"):
        draw_crack_map(tmp_path / "map.png", [])
