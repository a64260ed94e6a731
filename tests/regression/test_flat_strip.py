"""A flat film hangs on where it lies, one with a shape at the start does not.

The table of docs/theory/time.md. At z = 10 mm round-off decides whether the film leaves its plane;
where it does not, the upright blade presses it by its whole thickness.
"""

import numpy as np
import pytest

import shellcut as sc
from courses import course, growth
from films import cut_by
from page_tables import shown_as, table
from shellcut.mesh.structured import rectangle
from shellcut.models.case import PAPER_DAMPING
from shellcut.models.guillotine import blade_before

SIZE, LENGTH, WIDTH, NOTCH, TRAVEL, SPEED = 0.8, 24.0, 8.0, 2.4, 16.0, 6000.0
LAW, FILM = sc.CohesiveLaw(), sc.ShellMaterial.homogeneous()


def force_at(z, number):
    """Return the steady force on a strip at a height, with a shape at the start, over G h."""
    mesh = rectangle(LENGTH, WIDTH, size=SIZE)
    start = mesh.nodes[:, 0].min()
    notch = mesh.nodes_where(lambda x, y, z: (np.abs(y) < 1e-9) & (x < start + NOTCH + 0.1))
    blade, motion, duration = blade_before(mesh, None, travel=TRAVEL, speed=SPEED, law=LAW)
    lift = np.array([0.0, 0.0, z])
    lifted = sc.Mesh.from_arrays(mesh.nodes + lift, mesh.quads, node_sets=mesh.node_sets)
    along = {"motion": motion, "fracture": sc.Fracture(path="edges"), "imperfection": number}
    along["damping_beta"] = PAPER_DAMPING  # as the guillotine
    sim = cut_by(blade.translated(tuple(lift)), lifted.cut(notch), SPEED, **along)
    way, work = course(sim, duration, "tool_work")
    # Whole spacings of the nodes.
    ends = way[-1] - SIZE * int((way[-1] - 8.8) / SIZE), way[-1]
    return growth(way, work, *ends) / (LAW.fracture_energy * FILM.thickness)


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 1])
def test_the_force_is_that_of_the_page(number):
    _, rows = table("docs/theory/time.md", "| $z$ = 0")
    for z, told in zip((0.0, 10.0), rows[number][1:], strict=True):
        found, ends = force_at(z, number), [float(end) for end in told.split(" to ")]
        if len(ends) == 2:  # the least and the largest that was found: it is round-off's choice
            assert ends[0] - 0.01 < found < ends[1] + 0.01, (z, found)
        else:
            assert shown_as(told, found), (z, found)
