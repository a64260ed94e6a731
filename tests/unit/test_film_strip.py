"""The film strip: rows and columns of frames by one camera."""

import itertools

import numpy as np
import pytest

from opening_frame import opening_frame
from shellcut.view import draw_film_strip

FRAMES = [opening_frame(angle, n_side=8) for angle in (0.0, 20.0, 40.0, 60.0)]


def pixels(path):
    image = pytest.importorskip("matplotlib.image", reason="needs shellcut[plot]")
    return image.imread(path)[..., :3]


def test_frames_stand_in_rows_and_differ(tmp_path):
    pytest.importorskip("matplotlib", reason="needs shellcut[plot]")
    draw_film_strip(tmp_path / "strip.png", FRAMES, columns=2, width=8.0, dpi=50)
    image = pixels(tmp_path / "strip.png")
    assert image.shape[1] == 400
    used = image.shape[0] - int(0.95 * 50)  # without the foot
    panels = [
        half[:, part]
        for half in np.array_split(image[:used], 2)
        for part in (slice(0, 200), slice(200, 400))
    ]
    for panel in panels:
        assert (panel < 0.97).any(axis=2).mean() > 0.2
    size = min(panel.shape[0] for panel in panels)
    for one, other in itertools.pairwise(panels):
        assert np.abs(one[:size] - other[:size]).mean() > 0.005  # the cut goes on


def test_one_frame_is_a_strip_too(tmp_path):
    pytest.importorskip("matplotlib", reason="needs shellcut[plot]")
    draw_film_strip(tmp_path / "strip.png", FRAMES[:1], width=6.0, dpi=50)
    assert pixels(tmp_path / "strip.png").shape[1] == 300


@pytest.mark.parametrize(("frames", "columns"), [([], 3), (FRAMES, 0)])
def test_nothing_to_draw_is_refused(tmp_path, frames, columns):
    with pytest.raises(ValueError, match="at least one frame and one column"):
        draw_film_strip(tmp_path / "strip.png", frames, columns=columns)
