"""A crack that runs by itself is as fast whatever ``check_every`` is, and after a restart."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle
from shellcut.simulation.hooks import StopWhen
from shellcut.tool.shapes import straight_blade

LENGTH, HEIGHT, GROWN = 20.0, 10.0, 5.0
LAW = sc.CohesiveLaw(
    strength=25.0, plateau=18.0, opening_a=0.006, opening_p=0.018, opening_u=0.03, onset=0.0005
)


def strip(check_every, path="free", *, beside_a_blade=False):
    """A brittle film that is stretched between its long sides, with a notch, at rest."""
    film = sc.ShellMaterial.homogeneous(young=2000.0, poisson=0.3, density=1e-9, thickness=0.1)
    tool = {}
    if beside_a_blade:  # far above the film
        blade = straight_blade(half_thickness=0.1, length=2.0, height=2.0)
        tool = {
            "tool": blade.translated((0.0, 0.0, 50.0)),
            "motion": sc.StraightMotion((1, 0, 0), 1e3, ramp=1e-6),
        }
    mesh = rectangle(LENGTH, HEIGHT, n_x=40, n_y=20)
    if path == "edges":
        mesh = mesh.cut(mesh.nodes_where(lambda x, y, z: (abs(y) < 1e-6) & (x < 7.1)))
    sim = sc.Simulation(
        mesh,
        film,
        supports=[sc.Support.clamped("top"), sc.Support.clamped("bottom")],
        law=LAW,
        fracture=sc.Fracture(path=path, check_every=check_every),
        imperfection=0,
        damping_alpha=0.0,
        **tool,
    )
    if path == "free":
        sim.notch((-0.1, 0.2, 0.0), (7.0, 0.2, 0.0))
    n, long_crack = sim.state.node, np.sqrt(2.0 * LAW.fracture_energy * 0.91 / 2000.0 / HEIGHT)
    displacement = np.zeros((n.count, 3))
    displacement[:, 1] = 1.45 * long_crack * n.X[: n.count, 1]
    sim.relax(displacement, tolerance=1e-3)
    return sim


def tears(sim):
    return [one for one in sim.state.split_log if one.kind == "tear"]


def times(sim):
    """The times of all tears until the crack has grown by so much, after the first [s]."""
    sim.run(1e-4, hooks=[StopWhen(lambda: sim.state.crack_length > GROWN)])
    found = np.array([one.time for one in tears(sim)])
    assert len(found) > 5
    return found - found[0]


@pytest.mark.parametrize("path", ["free", "edges"])
@pytest.mark.parametrize("beside_a_blade", [False, True])
def test_a_running_crack_does_not_wait_for_the_next_check(path, beside_a_blade):
    often, seldom = (times(strip(n, path, beside_a_blade=beside_a_blade)) for n in (1, 50))
    # It waits for a tenth of its time for a quad at most.
    assert seldom[-1] == pytest.approx(often[-1], rel=0.1)


def test_it_goes_on_bit_for_bit_between_two_checks(tmp_path):
    whole, first, second = strip(1000), strip(1000), strip(1000)
    for sim in (whole, first):
        while len(tears(sim)) < 3:
            sim.step()
    assert first.state.step % 1000
    sc.save_checkpoint(first, tmp_path / "checkpoint.h5")
    sc.load_checkpoint(second, tmp_path / "checkpoint.h5")
    for sim in (whole, second):
        for _ in range(200):
            sim.step()
    assert len(tears(whole)) > 4
    assert whole.state.split_log == second.state.split_log
    assert np.array_equal(whole.state.node.x, second.state.node.x)
