"""Frame refuses what does not fit together, and stays as it was when its sources change."""

import dataclasses

import numpy as np
import pytest

from opening_frame import opening_frame
from shellcut.frame import Frame


def square(**changes):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    fields = {
        "time": 0.0,
        "coordinate": 0.0,
        "coordinate_name": "angle",
        "coordinate_unit": "deg",
        "points": points + np.array([0, 0, 0.5]),
        "reference": points,
        "director": np.tile([0.0, 0, 1], (4, 1)),
        "velocity": np.zeros((4, 3)),
        "quads": [[0, 1, 2, 3]],
        "quad_stress": np.ones((1, 3)),
        "quad_principal": np.ones((1, 2)),
    }
    return Frame(**(fields | changes))


def test_a_membrane_alone_is_a_frame():
    frame = square()
    assert frame.cable_segments.shape == (0, 2, 3)
    assert frame.tool_triangles.dtype == np.int64
    np.testing.assert_array_equal(frame.displacement, np.tile([0, 0, 0.5], (4, 1)))


def test_what_is_left_out_is_as_the_membrane_or_nothing():
    frame = square(quad_stress=[[1.0, 2.0, 3.0]], quad_principal=[[4.0, 5.0]])
    for side in ("top", "bottom"):
        assert getattr(frame, f"quad_stress_{side}").tolist() == [[1.0, 2.0, 3.0]]
        assert getattr(frame, f"quad_principal_{side}").tolist() == [[4.0, 5.0]]
    assert frame.quad_thickness.tolist() == [0.0]
    assert frame.held.tolist() == [False] * 4
    assert frame.tool_tooth.shape == frame.edge_tooth.shape == frame.cable_opening.shape == (0,)


def test_arrays_are_copied_and_read_only():
    points = np.zeros((4, 3))
    frame = square(points=points)
    points += 1.0
    assert frame.points.sum() == 0.0
    with pytest.raises(ValueError, match="read-only"):
        frame.points[0, 0] = 1.0
    scalars = {"torque": 1.0}
    frame = square(scalars=scalars, scalar_units={"torque": "N*mm"})
    scalars["torque"] = 2.0
    assert frame.scalars["torque"] == 1.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"director": np.zeros((3, 3))}, r"director must have shape \(4, 3\), got \(3, 3\)"),
        ({"quads": [[0, 1, 2, 4]]}, r"quads must lie in 0\.\.3, got 0\.\.4"),
        ({"quads": [[0.0, 1, 2, 3]]}, "quads must hold integers, got float64"),
        ({"quad_principal": [[np.nan, 0]]}, r"quad_principal must be finite, row 0"),
        ({"tool_triangles": [[0, 1, 2]]}, "tool_triangles must lie in"),
        ({"cable_segments": np.zeros((1, 2, 3))}, r"cable_state must have shape \(1,\)"),
        ({"scalars": {"torque": 1.0}}, r"same names, not \['torque'\]"),
        (
            {"scalars": {"torque": np.inf}, "scalar_units": {"torque": "N*mm"}},
            "scalar 'torque' must be finite",
        ),
        ({"time": np.nan}, "time must be finite"),
        ({"quad_stress_top": np.ones((2, 3))}, r"quad_stress_top must have shape \(1, 3\), got"),
        ({"quad_thickness": [np.inf]}, "quad_thickness must be finite, row 0"),
        ({"held": [0, 1, 0, 0]}, "held must hold bools, got int64"),
        ({"tool_tooth": [1]}, r"tool_tooth must have shape \(0,\), got \(1,\)"),
        ({"tool_rotation": np.eye(2)}, r"tool_rotation must have shape \(3, 3\), got \(2, 2\)"),
    ],
)
def test_misfits_are_named(changes, message):
    with pytest.raises(ValueError, match=message):
        square(**changes)


def test_unknown_cable_state_is_refused():
    frame = opening_frame()
    with pytest.raises(ValueError, match=r"must be 0 \(straight\) or 1 \(jointed\)"):
        dataclasses.replace(frame, cable_state=frame.cable_state + 1)


def test_made_up_opening_is_sound():
    frame = opening_frame()
    assert len(frame.quads) == 2204
    minus, plus = frame.crack_edges[:, 0], frame.crack_edges[:, 1]
    np.testing.assert_array_equal(frame.reference[minus], frame.reference[plus])
    assert (minus != plus).any(axis=1).all()
