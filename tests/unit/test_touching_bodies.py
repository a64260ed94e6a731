"""Bodies of a tool that touch or overlap are refused, those that are apart are not."""

import re

import numpy as np
import pytest
import scipy
from scipy.spatial.transform import Rotation

from blunt_tools import BOX_FACES, ball, blunt, box_corners, prism
from shellcut import read_tool
from shellcut.formats.stl import write_stl
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.surface import Surface, merge_vertices
from shellcut.tool.tool import ToolError
from shellcut.tool.touching_bodies import touching_bodies
from test_tool import joined

TURN = Rotation.from_rotvec([0.3, -0.5, 0.9]).as_matrix()
LEAN = Rotation.from_rotvec([0.0, np.pi / 4, 0.0]).as_matrix()
TWIST = Rotation.from_rotvec([0.0, 0.0, np.pi / 4]).as_matrix()
ACROSS = TWIST @ LEAN
GAP = 2e-3


def box(low, high):
    return box_corners(low, high), BOX_FACES


def moved(body, at, turn=None):
    return (body[0] if turn is None else body[0] @ turn.T) + at, body[1]


ONE = box((0, 0, 0), (1, 2, 3))
CUBE = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
WEDGE = prism([(0.0, 0.0), (-1.0, 0.2), (-1.0, -0.2)], 0.0, 2.0)
BAR = box((-5, -0.5, -0.5), (5, 0.5, 0.5))
ROOT = np.sqrt(0.5)  # from the middle of a cube to an edge of it
TOUCHING = {
    "a face on a face": (ONE, box((1, 0.5, 0.5), (2, 1.5, 2.5))),
    "faces that share a corner": (ONE, box((1, 0, 0), (2, 1.5, 2.5))),
    "faces that cross": (ONE, box((1, -1, 1), (2, 3, 2))),
    "an edge on an edge": (ONE, box((1, 2, 1), (2, 3, 2))),
    "an edge across an edge": (ONE, moved(CUBE, (1.5, 2.5, 1.5), ACROSS)),
    "an edge on a face": (ONE, moved(CUBE, (1 + ROOT, 1, 1), LEAN)),
    "a corner on a face": (ONE, moved(WEDGE, (0.5, 1, 3), LEAN)),
    "a corner in a face": (ONE, box((0.9, 1.9, 2.9), (2, 3, 4))),
    "slabs that are flush": (ONE, box((0.5, 0, 0.1), (1.5, 2, 3.1))),
    "slabs that are flush and within": (ONE, box((0, 0, 1), (1, 2, 2))),
    "bars that cross": (BAR, box((-0.4, -0.4, -5), (0.4, 0.4, 5))),
    "a bar through a face": (ONE, moved(BAR, (0.5, 1, 1), TURN)),
    "within": (ONE, box((0.3, 0.5, 0.5), (0.6, 1, 1))),
    "around": (CUBE, box((-1, -2, -3), (1, 2, 3))),
    "a shifted copy": (WEDGE, moved(WEDGE, (0.01, 0.003, 0.002))),
    "a wedge in a wedge": (WEDGE, moved(WEDGE, (-0.5, 0, 0.7), TURN)),
}
APART = {
    "a face before a face": (ONE, box((1 + GAP, 0.5, 0.5), (2, 1.5, 2.5))),
    "an edge beside an edge": (ONE, box((1 + GAP, 2 + GAP, 1), (2, 3, 2))),
    "an edge across an edge": (ONE, moved(CUBE, (1.5 + GAP, 2.5 + GAP, 1.5), ACROSS)),
    "an edge before a face": (ONE, moved(CUBE, (1 + GAP + ROOT, 1, 1), LEAN)),
    "a corner before a corner": (ONE, box((1 + GAP, 2 + GAP, 3 + GAP), (2, 3, 4))),
    "bars that pass": (BAR, box((-0.4, 0.5 + GAP, -5), (0.4, 1.3, 5))),
    "blades side by side": (WEDGE, moved(WEDGE, (0, 0.4 + GAP, 0))),
    "wedges with their edges together": (WEDGE, moved(WEDGE, (GAP, 0, 0.3), TURN @ TURN)),
}
PLACES = {
    "as it is": (np.eye(3), 1.0, 0.0),
    "small, turned": (TURN, 1e-3, 0.0),
    "large, turned, far away": (TURN @ TURN, 50.0, (1e8, -3e8, 2e8)),
}


def found(*bodies, place="as it is"):
    """Return what is refused of bodies behind a third one, turned, scaled and moved."""
    turn, scale, at = PLACES[place]
    vertices, triangles = joined(box((-12, -12, -12), (-9, -9, -9)), *bodies)
    merged, ids, _ = merge_vertices(scale * vertices @ turn.T + at, triangles, None)
    return Surface(merged, ids).problems()


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("bodies", TOUCHING.values(), ids=TOUCHING)
def test_bodies_that_touch_or_overlap_are_refused_by_their_numbers(bodies, place):
    for pair in (bodies, bodies[::-1]):
        assert "touch or overlap: 2 and 3 near (" in found(*pair, place=place)[-1]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("bodies", APART.values(), ids=APART)
def test_bodies_that_are_apart_are_accepted(bodies, place):
    for pair in (bodies, bodies[::-1]):
        assert found(*pair, place=place) == []


def test_every_pair_has_its_place():
    row = [moved(CUBE, (0.9 * k, 0.02 * k, 0.0)) for k in range(3)]
    (said,) = found(*row, box((9, 9, 9), (10, 10, 10)))
    *places, rest = re.split(r" near \((.*?)\)", said)
    assert places[::2] == ["bodies touch or overlap: 2 and 3", ", 3 and 4"]
    assert rest.startswith("; unite them in the program that made them")
    for k, place in enumerate(places[1::2]):
        away = np.array(place.split(", "), float) - (0.9 * k + 0.45, 0.02 * k + 0.01, 0.0)
        assert (np.abs(away) <= (0.05 + 1e-6, 0.5, 0.5)).all()  # in both


def test_bodies_with_corners_in_common_are_refused():
    (said,) = found(ONE, box((1, 0, 0), (2, 2, 3)))
    assert "non-manifold edges" in said
    assert said.endswith("unite bodies that touch there")


def test_open_bodies_have_their_holes_refused_alone():
    vertices, triangles = CUBE
    (said,) = found((vertices, triangles[2:]), moved(CUBE, (0.5, 0.2, 0.1)))
    assert "hole" in said


@pytest.mark.parametrize(("gap", "n"), [(1e-3, 0), (-1e-3, 1), (-0.5, 1)])
def test_balls_of_many_triangles(gap, n):
    one = ball(1.0, 4)
    other = moved((one.vertices, one.triangles), (0, 0, 2 + gap), TWIST)
    assert len(found((one.vertices, one.triangles), other, place="small, turned")) == n
    inner = moved((0.99 * one.vertices, one.triangles), (0, 0, 2 + gap))
    assert "2 and 3" in found(inner, other)[0]


def test_a_file_of_parts_is_refused_and_rings_are_tools(tmp_path):
    path, blade = tmp_path / "parts.stl", straight_blade()
    parts = [(blade.vertices, blade.triangles), box((-20, -0.2, -1), (-3, 0.2, 1))]
    write_stl(path, *joined(*parts), header="parts")
    with pytest.raises(ToolError, match=r"parts\.stl cannot be a tool:\n- .* overlap: 1 and 2"):
        read_tool(path, unit="mm")
    assert tooth_ring(n_teeth=12).n_body == 12
    blunt(*joined(ONE, moved(ONE, (1.0 + 1e-5, 0.0, 0.0))))


def distance(a, b):
    """Return the distance of two triangles by a programme of another kind."""
    sums = 1e5 * np.array([[1.0, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]])
    shares, _ = scipy.optimize.nnls(
        np.vstack([np.hstack([a.T, -b.T]), sums]), [0.0, 0, 0, 1e5, 1e5]
    )
    return np.linalg.norm(shares[:3] @ a / shares[:3].sum() - shares[3:] @ b / shares[3:].sum())


def test_the_distance_of_triangles_decides():
    rng = np.random.default_rng(1)
    n_apart = 0
    for k in range(300):
        a, b = rng.normal(size=(2, 3, 3))
        b += (k % 3) * rng.normal(size=3)
        if k % 4 == 0:
            a[:, 2] = b[:, 2] = 0.0
        if k % 5 == 0:
            a, b = np.round(a), np.round(b)
        far, body = distance(a, b), np.array([4, 7])
        n_apart += far > 1e-5
        ((i, j, place),) = touching_bodies(np.array([a, b]), body, 1.00001 * far + 1e-7)
        assert (i, j, place.shape) == (4, 7, (3,))
        if far > 1e-5:
            assert not [*touching_bodies(np.array([a, b]), body, 0.99999 * far - 1e-7)]
    assert 100 < n_apart < 250
