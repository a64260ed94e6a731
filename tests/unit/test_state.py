"""Tables that grow, and the state of a mesh at rest."""

import numpy as np
import pytest

from naive import cases
from shellcut import ShellMaterial, Simulation, StraightMotion, Support
from shellcut.frame import Frame
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.models import free_cut
from shellcut.tool.shapes import straight_blade


def test_initial_state_is_the_mesh_at_rest():
    mesh = rectangle(3.0, 2.0, n_x=3, n_y=2)
    mesh = mesh.cut([4, 5])  # a notch at the left: node 4 has a twin, node 12
    state = initial_state(mesh)
    n = state.n_node
    assert n == mesh.n_node == 13
    np.testing.assert_array_equal(state.node.x[:n], mesh.nodes)
    np.testing.assert_array_equal(state.node.t[:n], mesh.directors)
    assert np.flatnonzero(state.node.halved).tolist() == [4, 12]
    assert state.node.origin[12] == 4
    assert not state.node.velocity_half.any()
    state.node.x[0] = 99.0  # no view of the frozen mesh, nor of the reference
    state.quads[0, 0] = 7
    assert mesh.nodes[0, 0] == 0.0
    assert state.node.X[0, 0] == 0.0
    assert mesh.quads[0, 0] == 0
    assert (state.time, state.step, state.revision, state.crack_length) == (0.0, 0, 0, 0.0)
    assert state.n_cable == 0


@pytest.mark.parametrize("name", ["flat", "curved"])
def test_a_film_that_turns_takes_its_directors_along(name):
    """Wherever it lies: the spin of a director is that of the body without the part along it."""
    mesh, spin = cases.ALL[name](4, 3), np.array([30.0, -20.0, 50.0])
    mesh = cases.moved_mesh(mesh, mesh.nodes + np.array([70.0, -40.0, 25.0]))
    velocity = np.cross(spin, mesh.nodes) + np.array([1.0, 2.0, 3.0])
    sim = Simulation(mesh, ShellMaterial.homogeneous(), velocity=velocity, damping_alpha=0.0)
    t = mesh.directors
    wanted = spin - (t @ spin)[:, None] * t
    np.testing.assert_allclose(sim.state.node.spin_half[: mesh.n_node], wanted, rtol=0, atol=1e-6)


def test_a_film_of_one_quad_is_cut():
    """A table of one row, which NumPy takes for one stored by column, grows as any."""
    case = free_cut(
        rectangle(1.0, 1.0, size=1.0),
        tool=straight_blade(),
        motion=StraightMotion((1.0, 0.0, 0.0), speed=6000.0),
        duration=2.5e-4,
        supports=[Support.clamped("bottom"), Support.clamped("top")],
    )
    case.simulation.run(case.duration)
    assert case.simulation.state.n_quad > 1
    assert case.simulation.state.crack_length > 0.0


# --- frame refuses what does not fit together, and stays as it was when its sources change


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


def test_what_is_left_out_is_as_the_membrane_or_nothing():
    frame = square(quad_stress=[[1.0, 2.0, 3.0]], quad_principal=[[4.0, 5.0]])
    for side in ("top", "bottom"):
        assert getattr(frame, f"quad_stress_{side}").tolist() == [[1.0, 2.0, 3.0]]
        assert getattr(frame, f"quad_principal_{side}").tolist() == [[4.0, 5.0]]
    assert frame.quad_thickness.tolist() == [0.0]
    assert frame.held.tolist() == [False] * 4
    assert frame.cable_segments.shape == (0, 2, 3)
    assert frame.tool_triangles.dtype == np.int64
    assert frame.tool_tooth.shape == frame.edge_tooth.shape == frame.cable_opening.shape == (0,)
    np.testing.assert_array_equal(frame.displacement, np.tile([0, 0, 0.5], (4, 1)))


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
        (
            {
                "cable_segments": np.zeros((1, 2, 3)),
                "cable_state": np.array([2], np.int8),
                "cable_traction": [0.0],
            },
            r"must be 0 \(straight\) or 1 \(jointed\)",
        ),
        ({"scalars": {"torque": 1.0}}, r"same names, not \['torque'\]"),
        ({"scalars": {"a": np.inf}, "scalar_units": {"a": "-"}}, "scalar 'a' must be finite"),
        ({"time": np.nan}, "time must be finite"),
        ({"held": [0, 1, 0, 0]}, "held must hold bools, got int64"),
        ({"tool_rotation": np.eye(2)}, r"tool_rotation must have shape \(3, 3\), got \(2, 2\)"),
        ({"quad_history": {"damage": [0.0, 1.0]}}, "quad_history 'damage' must have shape"),
    ],
)
def test_misfits_are_named(changes, message):
    with pytest.raises(ValueError, match=message):
        square(**changes)
