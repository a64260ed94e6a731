"""What looks like a loss is said, and no mesh that the package makes raises a doubt."""

import numpy as np
import pytest

from shellcut import Mesh, guillotine, preview
from shellcut.mesh.film_doubts import film_doubts
from shellcut.mesh.structured import annulus, cylinder, disc, opening_disc, rectangle

SHEET = rectangle(6.0, 6.0, size=1.0)  # 49 nodes, 36 quads, row by row from (0, -3)
DISC = disc(5.0, n_side=6, n_layer=3)
RIM = DISC.node_set("rim")


def without(mesh, quads):
    """Return the mesh without some quads and the nodes that only they had."""
    left = np.delete(mesh.quads, quads, axis=0)
    used, new = np.unique(left, return_inverse=True)
    return Mesh.from_arrays(mesh.nodes[used], new.reshape(-1, 4))


# Made where they are asked for: every process that collects the tests would compile the kernels of
# the strip before it runs the first test.
SOUND = {
    "sheet": lambda: SHEET,
    "one quad": lambda: rectangle(1.0, 1.0, n_x=1, n_y=1),
    "one row": lambda: rectangle(12.0, 1.0, n_x=12, n_y=1),
    "opening": lambda: opening_disc("quick"),
    "ring": lambda: annulus(1.0, 2.0, n_around=12, n_radial=3),
    "ring with a small hole": lambda: annulus(0.1, 2.0, n_around=6, n_radial=3),
    "cylinder": lambda: cylinder(5.0, 10.0, n_around=20, n_along=10),
    "roof": lambda: cylinder(5.0, 10.0, n_around=20, n_along=10, arc_deg=90.0),
    "cut from the side": lambda: SHEET.cut([21, 22, 23]),
    "cut inside": lambda: SHEET.cut([23, 24, 25]),
    "notched strip": lambda: guillotine(1.0, length=6.0, width=4.0, notch=1.0).simulation.mesh,
    "staircase": lambda: without(SHEET, [0, 1, 2, 6, 7, 12]),
    "corner off": lambda: without(SHEET, [35]),
    "two rows off": lambda: without(SHEET, [2, 3, 8, 9]),
    "three sides": lambda: SHEET.with_sets(
        node_sets={"held": np.unique([*range(7), *range(0, 49, 7), *range(6, 49, 7)])}
    ),
    "part of the rim": lambda: DISC.with_sets(node_sets={"held": RIM[:12]}),
}


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_film_raises_no_doubt(name):
    assert film_doubts(SOUND[name]()) == []


def test_a_hole_that_a_set_names_is_meant():
    holed = without(SHEET, [14, 15, 20, 21])
    around = holed.nodes_where(lambda x, y, z: (np.abs(x - 3.0) <= 1.0) & (np.abs(y) <= 1.0))
    assert len(around) == 8
    assert "a hole of 8 edges around (3, 0, 0) mm has the size of 4 quads" in film_doubts(holed)[0]
    assert film_doubts(holed.with_sets(node_sets={"hole": around})) == []


@pytest.mark.parametrize(
    ("quads", "told"),
    [
        ([14], "a hole of 4 edges around (2.5, -0.5, 0) mm has the size of 1 quad: is one missing"),
        ([14, 15], "a hole of 6 edges around (3, -0.5, 0) mm has the size of 2 quads: are some"),
        ([3], "1 notch in the rim of the size of one quad, at (3.5, -2.5, 0) mm: is a quad"),
        ([3, 32], "2 notches in the rim of the size of one quad, at (3.5, -2.5, 0) mm, (2.5, 2.5"),
        (
            [1, 7, 6],
            "the film is in 2 parts that share no node, of so many quads: 1 at (0.5, -2.5, 0), 32",
        ),
    ],
)
def test_quads_that_are_gone(quads, told):
    assert told in "; ".join(film_doubts(without(SHEET, quads)))


# 24 was meant; 25 is the next one in its row.
WRONG_CORNER = np.where(np.arange(36)[:, None] == 14, [16, 17, 25, 23], SHEET.quads)


def moved(node, x, y, z):
    nodes = SHEET.nodes.copy()
    nodes[node] += (x, y, z)
    return nodes


@pytest.mark.parametrize(
    ("nodes", "quads", "told"),
    [
        (
            SHEET.nodes,
            WRONG_CORNER,
            "quads overlap within a loop of 4 edges around (3, -0.25, 0) mm: is a corner of one "
            "wrong there?",
        ),
        (
            moved(24, 0.8, 0.1, 0.0),
            SHEET.quads,
            "2 quads have far less shape than all others, 0.46 or more: quad 15 at (3.7, -0.475, "
            "0) mm, 0.16, quad 21 at (3.7, 0.525, 0) mm, 0.19: is a node out of its place?",
        ),
        # Of the rim: the quads beside it stay convex.
        (moved(3, 0.0, -3e5, 0.0), SHEET.quads, "2 quads have far less shape than all others"),
        (
            moved(24, 0.0, 0.0, 0.2),
            SHEET.quads,
            "all but 1 node lie in one plane: node 24 at (3, 0, 0.2) mm",
        ),
        (
            moved(24, 0.0, 0.0, 0.2)[:, [2, 0, 1]],
            SHEET.quads,
            "all but 1 node lie in one plane: node 24 at (0.2, 3, 0) mm",
        ),
    ],
)
def test_a_node_that_slipped(nodes, quads, told):
    (doubt,) = film_doubts(Mesh.from_arrays(nodes, quads))
    assert doubt.startswith(told)


@pytest.mark.parametrize(
    ("members", "told"),
    [
        (np.delete(RIM, 3), "node set 'held' leaves out 1 of the 24 nodes of a boundary: node"),
        (RIM[:20], "node set 'held' leaves out 4 of the 24 nodes of a boundary: node"),
        (np.append(RIM, 0), "of the 25 nodes of set 'held' 1 has no neighbour in it: node 0 at"),
        (np.delete(RIM[:14], 6), "node set 'held' of 13 nodes ends on both sides of node"),
    ],
)
def test_node_sets_with_a_slip(members, told):
    (doubt, *_) = film_doubts(DISC.with_sets(node_sets={"held": members}))
    assert told in doubt


def test_quad_sets_with_a_slip():
    doubts = film_doubts(
        SHEET.with_sets(quad_sets={"most": np.delete(np.arange(36), 14), "low": [*range(12), 33]})
    )
    assert doubts == [
        "quad set 'most' of 35: quad 14 at (2.5, -0.5, 0) mm, beside its members, has none but "
        "members beside it",
        "quad set 'low' of 13: quad 33 at (3.5, 2.5, 0) mm, its members, has only others beside it",
    ]


def test_the_preview_counts_sets_and_says_doubts(tmp_path):
    pytest.importorskip("matplotlib")
    case = guillotine(1.0, length=6.0, width=4.0, notch=1.0)
    report = preview(case.simulation, tmp_path / "model.png")
    assert "sets   of nodes: left 6 in 2 pieces, right 5, bottom 7, top 7" in report
    assert "doubt" not in report
