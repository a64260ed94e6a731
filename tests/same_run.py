"""Two folders of runs hold the same run."""

import numpy as np

import shellcut


def assert_same_run(out, other):
    """Compare all files; those whose bytes hold a time of day or a wall time, by what they tell."""
    mine, theirs = ({p.name for p in one.iterdir()} for one in (out, other))
    assert mine == theirs
    pictures = [name for name in mine if name.endswith(".png")]
    for name in ("history.csv", "splits.csv", "run.files", *pictures):
        assert (out / name).read_bytes() == (other / name).read_bytes(), name
    a, b = shellcut.read(out), shellcut.read(other)
    assert a.times.tolist() == b.times.tolist()
    for one, two in zip(a.frames(), b.frames(), strict=True):
        np.testing.assert_array_equal(one.points, two.points)
        np.testing.assert_array_equal(one.quads, two.quads)
    wall = ("wall_s", "ns_per_quad_step")
    figures = [{k: v for k, v in one.summary.items() if k not in wall} for one in (a, b)]
    assert figures[0] == figures[1]
