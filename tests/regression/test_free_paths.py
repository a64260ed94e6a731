"""Blades through random meshes on any path: nothing blows up, and the ledger closes.

A few of the cuts of :mod:`random_cuts`, which runs any number of them as a command.
"""

import numpy as np
import pytest

from random_cuts import KINDS, LENGTH, carried_out


@pytest.mark.parametrize(("kind", "seed"), [("bend", 3), ("arc", 2), ("crossing", 0)])
def test_any_path_through_any_mesh(kind, seed):
    cut = KINDS[kind](np.random.default_rng(seed))
    found, sim = carried_out(cut), cut.simulation
    assert found.crack > 3.0
    assert sim.cables.n_broken > 0
    assert found.imbalance < 5e-3
    # The film yields to the blade by being cut; a flap that the blade catches takes far more work.
    assert found.work < 1.5
    # The edge meets the cables on its way. They are laid at once where it has passed.
    assert found.late < 0.25
    # The cuts begin on the path, also where the blade turns: they aim where its edge will be. They
    # move onto corners within 0.05 edges; an eighth of the edge squared over the least radius is as
    # much. The neck before a slit tears beside the path: measured 0.19 with three imperfections,
    # 0.36 and 0.61 of the crossings of seeds 1 and 2.
    assert found.off < (0.25 if kind == "crossing" else 0.1)
    # All mass is still there, and only real nodes or flank points are touched.
    nodes = sim.state.node
    assert nodes.mass[: nodes.count].sum() == pytest.approx(
        sim.mesh.quad_areas().sum() * 0.074e-9, rel=1e-12
    )
    assert not nodes.contact_force[: nodes.count][~nodes.real[: nodes.count]].any()


@pytest.mark.parametrize("seed", [3, 8])
def test_tight_turns_in_a_film_that_gives(seed):
    # The flap moves aside, so the cuts leave the way of the blade and its edge is late; the film is
    # torn, no more. Of twenty seeds the largest imbalance is 0.53 % (3) and the most work 3.9 (8).
    cut = KINDS["tight"](np.random.default_rng(seed))
    found, sim = carried_out(cut), cut.simulation
    assert found.crack > 4.0
    assert found.imbalance < 1e-2
    assert found.late < 1.0
    nodes = sim.state.node
    assert np.abs(nodes.x[: nodes.count]).max() < 0.5 * LENGTH + 3.0  # nothing has flown off
