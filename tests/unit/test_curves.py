"""The curves are drawn with names and units, parts and comparisons, and refuse ragged columns."""

import numpy as np
import pytest

from shellcut.view import curves, draw_energy, draw_torque

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


def test_torque_with_everything(tmp_path, figures):
    path = tmp_path / "torque.png"
    draw_torque(
        path,
        ANGLE,
        TORQUE,
        contact=0.05 * TORQUE,
        joints=0.95 * TORQUE,
        teeth=np.outer(TORQUE, [0.25, 0.25, 0.25, 0.25]),
        second=(ANGLE[:30], 0.24 * TORQUE[:30]),
        levels={"theory": 135.2},
        plateau=(27.44, 63.09, 143.6),
        dpi=50,
    )
    assert path.stat().st_size > 1000
    (axes,) = figures[0].axes
    assert axes.get_xlabel() == "angle [°]"
    assert axes.get_ylabel() == "torque [N·mm]"
    assert labels(axes) == [
        "total",
        "each of 4 teeth",
        "classical cables",
        "from contact",
        "from cables at the edge",
        "theory: 135.2 N·mm",
        "mean over 27.4-63.1°: 143.6 N·mm",
    ]
    mean = next(line for line in axes.lines if line.get_label().startswith("mean"))
    assert mean.get_xydata().tolist() == [[27.44, 143.6], [63.09, 143.6]]
    total = next(line for line in axes.lines if line.get_label() == "total")
    np.testing.assert_array_equal(total.get_ydata(), TORQUE)


def test_force_over_way(tmp_path, figures):
    draw_torque(
        tmp_path / "force.svg",
        ANGLE,
        TORQUE,
        coordinate_name="travel",
        coordinate_unit="mm",
        name="force",
        unit="N",
    )
    (axes,) = figures[0].axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("travel [mm]", "force [N]")


def test_energy_is_stacked_and_the_imbalance_below(tmp_path, figures):
    shares = {"cables": 0.95 * WORK, "damping": 0.05 * WORK}
    draw_energy(tmp_path / "energy.png", ANGLE, WORK, shares, 0.04 * np.sin(ANGLE), dpi=50)
    upper, lower = figures[0].axes
    assert len(upper.collections) == 2
    assert labels(upper) == ["work put in", "damping", "cables"]
    rim = upper.collections[1].get_paths()[0].vertices[:, 1].max()
    assert rim == pytest.approx(WORK[-1])
    assert lower.get_ylabel() == "imbalance [%]"
    assert upper.get_ylabel() == "energy [N·mm]"


def test_a_negative_share_is_drawn_as_a_line(tmp_path, figures):
    shares = {"cables": 1.2 * WORK, "supports": -0.2 * WORK}
    draw_energy(tmp_path / "energy.png", ANGLE, WORK, shares, 0.0 * WORK, dpi=50)
    upper, _ = figures[0].axes
    assert not upper.collections
    assert len(upper.lines) == 3


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p: draw_torque(p, ANGLE, TORQUE[1:]), "total must have as many rows .*, 60, got"),
        (lambda p: draw_torque(p, ANGLE, TORQUE, teeth=TORQUE), r"teeth must have shape \(n, n_t"),
        (
            lambda p: draw_energy(p, ANGLE, WORK, {"strain": [1.0]}, WORK),
            "strain must have as many rows",
        ),
    ],
)
def test_ragged_columns_are_refused_by_name(tmp_path, call, message):
    with pytest.raises(ValueError, match=message):
        call(tmp_path / "x.png")
