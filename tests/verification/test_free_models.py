"""The ready models on meshes that ignore the path: by default they cut, and notch, through quads.

Limits and window as in :mod:`test_free_cut`.
"""

import numpy as np
import pytest

import shellcut as sc
import test_free_cut
from shellcut.models.free_cut import free_cut
from shellcut.models.guillotine import blade_before, guillotine
from test_free_cut import NOTCH, TRAVEL, forces, strip


def check(case):
    """Run a model to its end: the force is the tearing energy, on the mesh as it is."""
    sim = case.simulation
    assert sim.fracture.path == "free"
    assert {cut.kind for cut in sim.state.split_log} == {"notch"}
    (tip,) = sim.cracks.at_tips(sim.mesh.nodes)
    size = np.sqrt(sim.shell.area.max())
    assert NOTCH - 1e-9 <= tip[0] - sim.mesh.nodes[:, 0].min() < NOTCH + size
    assert abs(tip[1]) < 0.05 * size
    assert case.check.findings == ()
    by_tool, by_cables, imbalance = forces(sim, case.duration)
    assert by_tool == pytest.approx(1.0, abs=0.025)
    assert by_cables == pytest.approx(1.0, abs=0.015)
    assert imbalance < 1e-3


def free(mesh):
    """The guillotine, put together as a free cut."""
    blade, motion, duration = blade_before(
        mesh, None, travel=TRAVEL, speed=6000.0, law=sc.CohesiveLaw()
    )
    return free_cut(
        mesh,
        tool=blade,
        motion=motion,
        duration=duration,
        notch=NOTCH,
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
    )


def test_guillotine_on_offset_rows():
    check(guillotine(mesh=strip("offset", 0.3), notch=NOTCH, travel=TRAVEL))


def test_guillotine_between_two_rows():
    check(guillotine(0.8, length=24.0, width=7.2, notch=NOTCH, travel=TRAVEL))


def test_guillotine_through_quads_along_its_own_line():
    through = sc.Fracture(path="free")
    check(guillotine(0.8, length=24.0, notch=NOTCH, travel=TRAVEL, fracture=through))


def test_free_cut_on_offset_rows():
    check(free(strip("offset", 0.3)))


def test_free_cut_on_quads_by_gmsh(monkeypatch):
    pytest.importorskip("gmsh")
    monkeypatch.setattr(test_free_cut, "SIZE", 0.6)
    mesh = sc.mesh_from_outline([(0, -4), (24, -4), (24, 4), (0, 4)], size=0.6)
    y = mesh.nodes[:, 1]
    sides = {"bottom": np.flatnonzero(y < -4 + 1e-9), "top": np.flatnonzero(y > 4 - 1e-9)}
    check(free(mesh.with_sets(node_sets=sides)))
