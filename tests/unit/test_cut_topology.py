"""Copies of quads: what a cut of a cut quad makes, and its undoing.

Which copies share nodes: tests of cracks that meet, of segments and of frames.
"""

from shellcut.fracture.cut_topology import CutTopology
from shellcut.fracture.quad_polygon import WHOLE
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import quads_of_nodes


def test_a_cut_of_a_copy_and_its_undoing():
    mesh, quad = rectangle(3.0, 3.0, size=1.0), 4
    cuts, node = CutTopology(mesh.quads, *quads_of_nodes(mesh.quads, mesh.n_node)), mesh.quads[4, 0]
    new = cuts.cut(quad, (-1.0, 0.0), (1.0, 0.0))
    before = cuts.polygon(new), cuts.classes(node), cuts.n_row
    end = next(p for p in cuts.polygon(new).points if p[1] != 0.0)
    newer = cuts.cut(new, (0.0, 0.0), end)
    assert cuts.rows_of(quad) == [quad, new, newer]
    cuts.mend(new, newer, before[0])
    assert before == (cuts.polygon(new), cuts.classes(node), cuts.n_row)
    cuts.mend(quad, new, WHOLE)
    assert cuts.rows_of(quad) == [quad]
    assert cuts.polygon(quad) == WHOLE
