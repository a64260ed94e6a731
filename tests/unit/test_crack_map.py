"""Crack map: when edges opened, where teeth went, and that it is drawn."""

import dataclasses

import numpy as np
import pytest

from opening_frame import RADIUS, opening_frame
from shellcut.view import draw_crack_map
from shellcut.view._teeth import teeth_of, tooth_paths
from shellcut.view.crack_map import crack_history

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


def test_teeth_are_counted_in_the_order_of_their_segments(frames):
    edges = frames[0].edge_points
    np.testing.assert_array_equal(teeth_of(edges), np.repeat(np.arange(4), 12))
    np.testing.assert_array_equal(teeth_of(edges[12:]), np.repeat(np.arange(3), 12))


def test_teeth_go_through_the_film_along_the_circle(frames):
    paths = tooth_paths(frames)
    assert len(paths) == 4
    for path in paths:
        np.testing.assert_allclose(np.hypot(path[:, 0], path[:, 1]), RADIUS, rtol=1e-3)
        np.testing.assert_allclose(path[:, 2], 0.0, atol=1e-12)
    lifted = [
        dataclasses.replace(f, edge_points=f.edge_points + np.array([0, 0, 9.0])) for f in frames
    ]
    assert np.isnan(tooth_paths(lifted)).all()


def test_a_curved_film_has_no_plane_to_go_through(frames):
    bent = frames[0].reference * [1, 1, 0] + np.array([[0, 0, 1]]) * frames[0].reference[:, :1] ** 2
    assert tooth_paths([dataclasses.replace(f, reference=bent) for f in frames[:1]]) == []


def test_the_picture_has_the_colours_of_early_and_late(tmp_path, frames):
    image = pytest.importorskip("matplotlib.image", reason="needs shellcut[plot]")
    colormaps = pytest.importorskip("matplotlib").colormaps
    splits = {"blade": frames[-1].reference[frames[-1].crack_edges[::3, 0, 0]]}

    def colours(shown, **options):
        draw_crack_map(tmp_path / "map.png", shown, width=6.0, dpi=60, **options)
        pixels = image.imread(tmp_path / "map.png")[..., :3]
        assert pixels.shape[1] == 360
        plan = pixels[:, : int(0.86 * 360)]  # without the colour bar
        when = np.searchsorted(ANGLES, 30.0) * 15.0 / 45.0
        return [
            int((np.abs(plan - colormaps["viridis"](u)[:3]).max(axis=2) < 0.06).sum())
            for u in (15.0 / 45.0, when, 1.0)
        ]

    # measured: about 100 pixels each
    assert min(colours(frames)) > 20
    assert min(colours(frames, splits=splits)) > 20
    assert colours(frames[:1]) == [0, 0, 0]


def test_no_frames_are_refused(tmp_path):
    with pytest.raises(ValueError, match="at least one frame"):
        draw_crack_map(tmp_path / "map.png", [])
