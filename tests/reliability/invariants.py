"""A cut that is turned, moved, mirrored, numbered otherwise or in other units is the same cut.

Round-off is all that may differ. A step adds an error of eps (S + L) to a position, S the distance
from the origin and L the size of the film. As a share of the smallest length on which forces
depend, the depth d of contact, that is eps (S + L) / d of the force. The bound over n steps is n
times that, of the film for positions and of the largest for energies. Factors that are powers of
two change no bit.
"""

import functools
from itertools import count

import numpy as np

import notched_strip
import shellcut as sc
import test_scales
from scaled import Factors

from .trial import Trial, of_the_suite

SHARE = 1
SIZE, N_STEP = 3.2, 600
DEEPEST = 1e-4  # mm: contact is deeper than this when forces count
SAME = "positions and energies are the same to round-off"
ROWS = {
    "turned": (f"film, tool and motion turned about any axis: {SAME}", "`invariants.py`"),
    "shifted": (f"all moved by up to 100 mm: {SAME}", "`invariants.py`"),
    "mirrored": (f"the film mirrored in the plane of the blade: {SAME}", "`invariants.py`"),
    "renumbered": (
        f"nodes and quads in another order, quads begun at another corner: {SAME}",
        "`invariants.py`",
    ),
    "other units": (
        "lengths, times, stresses times powers of two: bit for bit",
        "`tests/scaled.py`",
    ),
    "halves": (
        "half a model with a symmetry plane is the whole",
        "`tests/unit/test_symmetry_plane.py`",
    ),
}
CHANGED = [row for row in ROWS if row != "halves"]
HALVES = "unit/test_symmetry_plane.py::test_a_quarter_is_the_whole_to_round_off"


def trials():
    yield Trial("halves", "static", functools.partial(of_the_suite, HALVES))
    for number in count(1):
        row, rng = CHANGED[number % len(CHANGED)], np.random.default_rng([61, number])
        same = same_in_other_units if row == "other units" else functools.partial(same_but, row)
        yield Trial(row, f"{row} by seed {number}", functools.partial(same, rng))


@functools.cache
def inputs():
    """Return those of a cut, and its film's nodes without symmetry, quads and held sides."""
    sim = notched_strip.cutting(
        contact=sc.Contact(penalty=1e4),
        damping_alpha=0.1,
        damping_beta=5e-8,
        imperfection=0,  # its phases depend on the place
    )
    mesh = sim.mesh
    nodes = mesh.nodes.copy()
    middle = np.abs(nodes[:, 1]) < 1e-9
    nodes[middle, 1] += 0.012  # in the plane of the blade, round-off decides on the side
    inside = np.setdiff1d(np.flatnonzero(~middle), mesh.boundary_nodes())
    nodes[inside, :2] += np.random.default_rng(7).uniform(-0.06, 0.06, (len(inside), 2))
    return sim.inputs, (nodes, mesh.quads, mesh.node_set("sides"))


def simulation(nodes, quads, sides, turn, shift):
    """Return the cut of a film, turned, then moved."""
    given, _ = inputs()
    start = [-0.05, 0.0, 0.0]  # on a node, round-off decides whether the tool is outside
    blade = given["tool"]
    place = (blade.vertices + start) @ turn.T + shift
    mesh = sc.Mesh.from_arrays(nodes @ turn.T + shift, quads)
    changed = {
        "mesh": mesh,
        "stepping": sc.Stepping(fixed=7e-8),  # round-off may move a change of the step
        "threads": 1,
        "supports": [sc.Support.clamped(sides)],
        "loads": [sc.Pressure(1e-3)],
        "tool": sc.Tool.from_triangles(place, blade.triangles, edges=blade.edges),
        "motion": sc.StraightMotion(turn[:, 0], 2e4, ramp=5e-6),
    }
    return sc.Simulation(**given | changed)


def result(sim):
    """Return centres of the quads and energies after some steps; the film is cut.

    Which of two nodes keeps its number after a split depends on the numbers, so nodes are not
    compared.
    """
    for _ in range(N_STEP):
        sim.step()
    assert sim.state.split_log, "nothing was cut"
    energies = np.array(list(sim.close_ledger().entries().values()))
    centres = sim.state.node.x[sim.state.quads[: sim.mesh.n_quad]].mean(axis=1)
    return centres, energies


@functools.cache
def reference():
    return result(simulation(*inputs()[1], np.eye(3), np.zeros(3)))


def turned(rng):
    """Return a rotation at random."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def same_but(row, rng, folder):
    """Fail unless positions and energies of a changed cut are the same to round-off."""
    nodes, quads, sides = inputs()[1]
    turn, shift, order = np.eye(3), np.zeros(3), np.arange(len(quads))
    if row == "turned":
        turn = turned(rng)
    elif row == "shifted":
        shift = rng.uniform(-100.0, 100.0, 3)
    elif row == "mirrored":
        nodes, quads = nodes * (1, -1, 1), quads[:, ::-1]
    else:
        numbers, order = rng.permutation(len(nodes)), rng.permutation(len(quads))
        new = np.argsort(numbers)
        nodes, quads, sides = nodes[numbers], new[quads[order]], new[sides]
        begun = zip(rng.integers(4, size=len(quads)), quads, strict=True)
        quads = np.array([np.roll(quad, k) for k, quad in begun])
    found, energies = result(simulation(nodes, quads, sides, turn, shift))
    found = ((found - shift) @ turn)[np.argsort(order)]
    if row == "mirrored":
        found = found * (1, -1, 1)
    wanted, of_reference = reference()
    most = N_STEP * np.finfo(float).eps * (np.abs(shift).max() + SIZE) / DEEPEST
    off = np.abs(found - wanted).max() / SIZE
    of_energy = np.abs(energies - of_reference).max() / np.abs(of_reference).max()
    assert off <= most, f"positions differ by {off:.2g} of the film, {most:.2g} is round-off"
    assert of_energy <= most, f"energies differ by {of_energy:.2g}, {most:.2g} is round-off"


def same_in_other_units(rng, folder):
    length, shorter, stress = rng.integers((-6, 0, -3), (12, 4, 2)).tolist()
    # No film is heavier than any matter, which a check refuses.
    f = Factors(2.0**length, 2.0 ** (length - shorter), 4.0**stress)
    np.testing.assert_array_equal(test_scales.guillotine(f), in_mm_and_s())


@functools.cache
def in_mm_and_s():
    return test_scales.guillotine(Factors())
