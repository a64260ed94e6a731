"""The oscillating cut: its bar, its film, and a short and coarse run of it."""

import numpy as np
import pytest

from shellcut import Fracture, oscillating
from shellcut.contact import settings
from shellcut.models.oscillating import film_before
from shellcut.tool_shapes import round_bar


def test_the_bar_touches_the_origin_and_leans_forward():
    bar = round_bar(diameter=4.0, height=20.0, tilt_deg=10.0)
    # Its section in the sheet is an ellipse, 4 mm broad, drawn out by the tilt: facets of 5°.
    assert bar.volume()[0] == pytest.approx(np.pi * 4.0 * 20.0, rel=2e-3)
    x, _, z = bar.vertices.T
    assert x[z > 5.0].mean() > x[z < -5.0].mean()
    assert x[np.abs(z) < 1.0].max() == pytest.approx(0.0, abs=0.2)


def test_the_film_is_fine_in_its_band():
    film = film_before(6.0, size=0.5, length=20.0, width=30.0, band=4.0)
    area, y = film.quad_areas(), film.nodes[film.quads].mean(axis=1)[:, 1]
    within = np.abs(y) < 4.0
    assert np.abs(area[within].mean() / 0.25 - 1.0) < 0.01  # nodes moved at random
    assert area[~within].max() > 3.0 * 0.25
    assert area.sum() == pytest.approx(600.0)  # round-off
    x, y, _ = film.nodes[film.boundary_nodes()].T
    assert (np.isclose(np.abs(x - 10.0), 10.0) | np.isclose(np.abs(y), 15.0)).all()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"length": 10.0}, "lengthen the strip"),
        ({"width": 10.0}, "size, band and half the width must increase"),
        ({"fracture": Fracture(path="edges")}, "nothing steers it"),
    ],
)
def test_what_cannot_be_is_refused(wrong, said):
    with pytest.raises(ValueError, match=said):
        oscillating(1.5, **wrong)


def bar_in_coarse_film(way=None):
    """Four quads a diameter, too few for the wave, which takes minutes to grow."""
    case = oscillating(1.5, length=36.0)
    sim = case.simulation
    sim.run(case.duration if way is None else way / 3000.0 + 0.5e-3)
    path = np.array([cut.reference[:2] for cut in sim.state.split_log if cut.kind != "notch"])
    return sim, path


@pytest.fixture(scope="module")
def coarse():
    return bar_in_coarse_film()


def test_the_crack_runs_ahead_of_the_bar(coarse):
    # The crack comes towards the bar's line and stays near it. From x = 12 mm on its path is one of
    # run-to-run scatter (docs/theory/oscillating.md): in 2 of 37 runs it comes to the line later.
    # The bounds are those of all runs; their bars were wider or narrower by 0.1 to 10 µm or had 36
    # to 144 facets, or nodes were moved by 1e-9 to 1e-3 mm.
    sim, path = coarse
    x, y = path.T
    assert x[-1] > sim.pose.translation[0] + 1.0  # it tears ahead of the bar, by 2.9 to 6.3 mm
    assert y[0] == pytest.approx(2.1)  # round-off: the end of the notch
    # Regression; other diameters, by 0.1 to 10 µm, move it by up to 0.005.
    assert np.interp([11.0, 12.0], x, y) == pytest.approx([1.737, 1.141], abs=0.02)
    assert np.abs(y[x < 14.0]).min() < 1.3  # 0.4 to 1.1
    assert np.abs(y[x > 14.0]).max() < 3.5  # 0.4 to 2.8; half the bar is 3
    assert (np.diff(x) > -0.75).all()  # half a side; 0.5 at most
    assert len(sim.cracks.tips) == 1
    assert abs(sim.ledger.relative(sim.ledger.imbalance)) < 0.01


def test_rounded_edges_of_the_bar_do_not_move_the_crack(coarse, monkeypatch):
    # Its facets turn by 5°: they lose 0.05 µm to the rounding.
    _, rounded = coarse
    monkeypatch.setattr(settings, "ROUNDING", 1e-6)
    _, sharp = bar_in_coarse_film(way=11.5)
    # Three cuts, on quads of 1.5 mm; measured 1.8e-3. It grows with every cut.
    assert min(len(rounded), len(sharp)) >= 3
    assert np.abs(rounded[:3] - sharp[:3]).max() < 2e-3
