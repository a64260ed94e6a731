"""A cut that is turned, moved, mirrored, numbered otherwise or in other units is the same cut.

Round-off is all that may differ. A step adds an error of eps (S + L) to a position, S the distance
from the origin and L the size of the film. As a share of the smallest length on which forces
depend, the depth d of contact, that is eps (S + L) / d of the force. The bound over n steps is n
times that, of the film for positions and of the largest for energies. Factors that are powers of
two change no bit.
"""

import functools

import numpy as np

import shellcut as sc
from scaled import Factors
from shellcut.mesh.structured import rectangle
from shellcut.tool.shapes import straight_blade

from .trial import Trial

SHARE = 1
SIZE, N_STEP = 3.2, 600
DEEPEST = 1e-4  # mm: contact is deeper than this when forces count
ROWS = {
    name: (f"{what}: positions and energies are the same to round-off", "`invariants.py`")
    for name, what in {
        "turned": "film, tool and motion turned about any axis",
        "shifted": "all moved by up to 100 mm",
        "mirrored": "the film mirrored in the plane of the blade",
        "renumbered": "nodes and quads in another order, quads begun at another corner",
    }.items()
} | {
    "other units": (
        "lengths, times, stresses times powers of two: bit for bit",
        "`tests/scaled.py`",
    ),
    "halves": (
        "half a model with a symmetry plane is the whole",
        "`tests/unit/test_symmetry_plane.py`",
    ),
}
RANDOM = [row for row in ROWS if row != "halves"]
COUNT = None


def trial(number):
    """Return a trial: a change at random."""
    if number == 0:
        return Trial("halves", "static", _halves)
    row = RANDOM[number % len(RANDOM)]
    rng = np.random.default_rng([61, number])
    return Trial(row, f"{row} by seed {number}", functools.partial(_same, row, rng))


def film():
    """Return a notched film without symmetry."""
    mesh = rectangle(SIZE, 1.6, n_x=8, n_y=4).cut([18, 19])
    nodes = mesh.nodes.copy()
    inside = np.setdiff1d(np.arange(len(nodes)), mesh.boundary_nodes())
    middle = np.abs(nodes[:, 1]) < 1e-9
    nodes[middle, 1] += 0.012  # in the plane of the blade, round-off decides on the side
    inside = inside[~middle[inside]]
    nodes[inside, :2] += np.random.default_rng(7).uniform(-0.06, 0.06, (len(inside), 2))
    sides = [*mesh.node_set("bottom"), *mesh.node_set("top")]
    return nodes, mesh.quads, np.array(sides)


def simulation(nodes, quads, sides, f=Factors(), turn=np.eye(3), shift=np.zeros(3)):  # noqa: B008
    """Return a cut of the film, turned, then moved, in the units of the factors."""
    blade = straight_blade(half_thickness=0.1, length=2.0, height=2.0)
    start = [-0.05, 0.0, 0.0]  # on a node, round-off decides whether the tool is outside
    place = (blade.vertices + start) @ turn.T + shift
    tool = f.tool(sc.Tool.from_triangles(place, blade.triangles, edges=blade.edges))
    mesh = sc.Mesh.from_arrays(nodes @ turn.T + shift, quads, node_sets={"sides": sides})
    law = sc.CohesiveLaw(strength=18.0, opening_a=0.05, opening_p=0.2, opening_u=0.3)
    return sc.Simulation(
        f.mesh(mesh),
        f.material(sc.ShellMaterial.homogeneous()),
        supports=[sc.Support.clamped("sides")],
        loads=[sc.Pressure(1e-3 * f.stress)],
        tool=tool,
        motion=sc.StraightMotion(turn[:, 0], 2e4 * f.length / f.time, ramp=5e-6 * f.time),
        law=f.law(law),
        contact=sc.Contact(penalty=1e4 * f.stress / f.length),
        fracture=sc.Fracture(path="edges", check_every=5),
        damping_alpha=0.1 / f.time,
        damping_beta=5e-8 * f.time,
        stepping=sc.Stepping(fixed=7e-8 * f.time),  # round-off may move a change of the step
        imperfection=0,  # its phases depend on the place
        threads=1,
    )


def result(sim):
    """Return centres of the quads, energies and time after some steps; the film is cut.

    Which of two nodes keeps its number after a split depends on the numbers, so nodes are not
    compared.
    """
    for _ in range(N_STEP):
        sim.step()
    assert sim.state.split_log, "nothing was cut"
    energies = np.array(list(sim.close_ledger().entries().values()))
    centres = sim.state.node.x[sim.state.quads[: sim.mesh.n_quad]].mean(axis=1)
    return centres, energies, sim.state.time


@functools.cache
def reference():
    return result(simulation(*film()))


def turned(rng):
    """Return a rotation at random."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def _same(row, rng, folder):
    nodes, quads, sides = film()
    x, energies, time = reference()
    options, back, shift, f = {}, np.eye(3), np.zeros(3), Factors()
    order = np.arange(len(quads))
    if row == "turned":
        back = options["turn"] = turned(rng)
    elif row == "shifted":
        shift = options["shift"] = rng.uniform(-100.0, 100.0, 3)
    elif row == "mirrored":
        nodes, quads = nodes * (1, -1, 1), quads[:, ::-1]
        back = np.diag([1.0, -1.0, 1.0])
    elif row == "renumbered":
        numbers, order = rng.permutation(len(nodes)), rng.permutation(len(quads))
        new = np.argsort(numbers)
        nodes, quads, sides = nodes[numbers], new[quads[order]], new[sides]
        quads = np.array(
            [np.roll(quad, k) for k, quad in zip(rng.integers(4, size=32), quads, strict=True)]
        )
    else:
        length, shorter, stress = rng.integers((-6, 0, -3), (12, 4, 2)).tolist()
        # No film is heavier than any matter, which a check refuses.
        f = options["f"] = Factors(2.0**length, 2.0 ** (length - shorter), 4.0**stress)
    found, other, end = result(simulation(nodes, quads, sides, **options))
    found = (found / f.length - shift) @ back
    found, other, end = found[np.argsort(order)], other / f.energy, end / f.time
    if row == "other units":
        assert (found == x).all()
        assert (other == energies).all()
        assert end == time
        return
    most = N_STEP * np.finfo(float).eps * (np.abs(shift).max() + SIZE) / DEEPEST
    off = np.abs(found - x).max() / SIZE
    of_energy = np.abs(other - energies).max() / np.abs(energies).max()
    assert off <= most, f"positions differ by {off:.2g} of the film, {most:.2g} is round-off"
    assert of_energy <= most, f"energies differ by {of_energy:.2g}, {most:.2g} is round-off"


def _halves(folder):
    from test_symmetry_plane import test_a_quarter_is_the_whole_to_round_off as quarter

    quarter()
