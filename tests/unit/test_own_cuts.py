"""Beside which flanks a blade begins no cut."""

import numpy as np

import shellcut as sc
from shellcut.fracture.own_cuts import OwnCuts, blades
from shellcut.mesh.structured import rectangle
from teeth import tool_of, tooth, vee

LENGTH = 0.2


def two_teeth(gap, height=0.0):
    """Return two blades along x side by side, the second one higher."""
    line, thin = np.array(vee(56.0, 0.4)), 0.04
    higher = line + np.array([0.0, height])
    return tool_of(
        tooth(line, height=2.0, half_thickness=thin, at=(6.0, 0.25)),
        tooth(higher, height=2.0 + height, half_thickness=thin, at=(6.0, 0.25 + gap)),
    ).translated((0.013, 0.0, 0.02))


def test_edges_whose_ends_are_close_are_one_blade():
    assert blades(two_teeth(1.1 * LENGTH), LENGTH).tolist() == [0, 1]
    assert blades(two_teeth(0.9 * LENGTH), LENGTH).tolist() == [0, 0]


def test_a_blade_minds_its_own_flanks_and_those_of_notches():
    mesh = rectangle(12.0, 8.0, n_x=15, n_y=10)
    slit = [np.linalg.norm(mesh.nodes - (x, 2.4, 0.0), axis=1).argmin() for x in (1.6, 2.4, 3.2)]
    sim = sc.Simulation(
        mesh.cut(slit),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(name) for name in ("left", "right", "bottom", "top")],
        tool=two_teeth(0.9, height=1.5),
        motion=sc.StraightMotion((0.0, 0.0, -1.0), speed=1500.0, ramp=2e-4),
        law=sc.CohesiveLaw(),
    )
    s = sim.state
    own = OwnCuts(s, sim.tool, LENGTH, sim.cracks.growth.path.film, sim.shell.mesh_quads)
    at_notch = s.node.halved[s.quads].any(axis=1)
    assert at_notch.any()
    first, second = (int(np.flatnonzero(sim.tool.edge_chain == k)[0]) for k in (0, 1))

    def minded(segment):
        return np.array([own.at_own_flank(s, row, segment) for row in range(s.n_quad)])

    assert (minded(first) == at_notch).all()
    by_tooth = np.zeros(s.n_quad, bool)
    while not by_tooth.any():
        sim.step()
        halved = s.node.halved[s.quads].any(axis=1)
        by_tooth = halved & ~np.append(at_notch, np.zeros(s.n_quad - len(at_notch), bool))
    assert {record.edge for record in s.split_log} == {0}
    assert (minded(first) == halved).all()
    assert not (minded(second) & by_tooth).any()
