"""What holds a film: rigid motions left free, by hand."""

import numpy as np
import pytest

from shellcut.checks.hold import check_hold, pieces_of
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import rectangle

MESH = rectangle(4.0, 2.0, size=1.0)
ALL = np.arange(MESH.n_node)
SIDE = {name: MESH.node_set(name) for name in ("left", "right", "bottom", "top")}
POSITION, CLAMPED = [0, 1, 2], [0, 1, 2, 3, 4, 5]


def held(*parts, n_node=MESH.n_node):
    support = np.zeros((n_node, 6), bool)
    for nodes, components in parts:
        support[np.ix_(np.atleast_1d(nodes), components)] = True
    return support


@pytest.mark.parametrize(
    ("parts", "free"),
    [
        ([], ["along x", "along y", "along z", "about x", "about y", "about z"]),
        ([(SIDE["left"], CLAMPED)], []),
        ([(SIDE["bottom"], POSITION), (SIDE["top"], POSITION)], []),
        ([(ALL, [2])], ["along x", "along y", "about z"]),
        # a hinge along the left side, which is parallel to y
        ([(SIDE["left"], POSITION)], ["about an axis along (0, 1, 0)"]),
        # one clamped node: a director has no drilling
        ([(SIDE["left"][:1], CLAMPED)], ["about an axis along (0, 0, 1)"]),
        # x at the left, y at the bottom and z at the right leave a hinge at the right side
        (
            [(SIDE["left"], [0]), (SIDE["bottom"], [1]), (SIDE["right"], [2])],
            ["about an axis along (0, 1, 0)"],
        ),
        # two nodes on a diagonal, and z where neither of them lies
        ([([0, -1], POSITION)], ["about an axis along (1, 0.5, 0)"]),
    ],
)
def test_what_supports_leave_free(parts, free):
    [(_, found)] = pieces_of(MESH.quads, MESH.nodes, MESH.directors, held(*parts), 1e-10)
    assert found == free


def test_every_piece_must_be_held():
    n = MESH.n_node
    both = Mesh.from_arrays(
        np.concatenate([MESH.nodes, MESH.nodes + np.array([0.0, 5.0, 0.0])]),
        np.concatenate([MESH.quads, MESH.quads + n]),
    )
    (finding,) = check_hold(both, held((SIDE["left"], CLAMPED), n_node=2 * n))
    assert finding.severity == "doubt"
    assert "the piece of 8 quads about (2, 5, 0) mm, which nothing holds" in str(finding)
    whole = held((SIDE["left"], CLAMPED), (SIDE["left"] + n, CLAMPED), n_node=2 * n)
    assert list(check_hold(both, whole)) == []


def test_a_film_that_is_held_here_and_there_is_told_what_it_can_do():
    (finding,) = check_hold(MESH, held((ALL, [2])))
    assert "whose 15 held nodes leave it free to move along x, along y, about z" in str(finding)
    (finding,) = check_hold(MESH, held())
    assert "the film about (2, 0, 0) mm, which nothing holds" in str(finding)
