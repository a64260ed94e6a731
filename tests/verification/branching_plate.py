"""A plate of glass in which a fast crack branches: python tests/verification/branching_plate.py.

The plate of [Song2008] and [Borden2012]: 100 by 40 mm, a crack from the middle of its left side to
its middle, and 1 MPa on its long sides from the first moment on. E = 32 GPa, nu = 0.2, 2.45 g/cm³,
G = 3 J/m². Prints where and when the crack branches first, how fast it was, and when a branch comes
to the far side; with ``--picture FILE`` draws the paths.
"""

import argparse
from pathlib import Path

import numpy as np

import shellcut as sc
from shellcut.mesh.structured import rectangle

YOUNG, POISSON, DENSITY = 32e3, 0.2, 2.45e-9
ENERGY = 0.003
"""G [N/mm]."""


def plate(
    length=100.0,
    width=40.0,
    size=40.0 / 81,
    *,
    pull=1.0,
    strength=5.0,
    moved=0.0,
    threads=None,
    **options,
):
    """Return the plate before it is pulled, its crack along the middle.

    strength : [MPa]; the process zone is E G / strength², 3.8 mm.  moved : random shifts of nodes,
    in edges.  options : of :class:`shellcut.Fracture`.
    """
    mesh = rectangle(length, width, size=size)
    X = mesh.nodes - [mesh.nodes[:, 0].min(), 0.0, 0.0]
    inside = np.ones(mesh.n_node, bool)
    inside[mesh.boundary_nodes()] = False
    X[inside, :2] += np.random.default_rng(1).uniform(-moved, moved, (inside.sum(), 2)) * size
    sides = {
        name: np.flatnonzero(np.abs(X[:, 1] - y) < 1e-9)
        for name, y in (("bottom", -0.5 * width), ("top", 0.5 * width))
    }
    far = ENERGY / (
        0.375 * strength
    )  # half the strength from a quarter of it on: 0.375 strength far
    sim = sc.Simulation(
        sc.Mesh.from_arrays(X, mesh.quads, node_sets=sides),
        sc.ShellMaterial.homogeneous(young=YOUNG, poisson=POISSON, density=DENSITY, thickness=1.0),
        loads=[
            sc.EdgeTraction("top", (0.0, pull, 0.0)),
            sc.EdgeTraction("bottom", (0.0, -pull, 0.0)),
        ],
        law=sc.CohesiveLaw(
            strength=strength,
            plateau=0.5 * strength,
            opening_a=0.25 * far,
            opening_p=0.25 * far,
            opening_u=far,
            onset=0.02 * far,
        ),
        fracture=sc.Fracture(path="free", check_every=2, fibres=6, **options),
        damping_beta=1e-9,
        threads=threads,
    )
    sim.notch((-1.0, 0.0, 0.0), (0.5 * length, 0.0, 0.0))
    return sim


def cuts(sim):
    """Return where and when the film was cut after the notch, shapes (n, 2) [mm] and (n,) [s]."""
    log = [cut for cut in sim.state.split_log if cut.kind != "notch"]
    places = np.array([cut.reference[:2] for cut in log]).reshape(-1, 2)
    return places, np.array([cut.time for cut in log])


def branchings(sim):
    """Return where and when cracks have become two, shapes (n, 2) [mm] and (n,) [s].

    Two cuts of one moment that begin at one place.
    """
    places, times = cuts(sim)
    twice = (np.diff(times) == 0.0) & (np.abs(np.diff(places, axis=0)).max(axis=1) < 1e-9)
    return places[:-1][twice], times[:-1][twice]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", type=float, default=40.0 / 81, help="of the quads [mm]")
    parser.add_argument("--moved", type=float, default=0.0, help="shifts of nodes, in edges")
    parser.add_argument("--strength", type=float, default=5.0, help="sigma_F [MPa]")
    parser.add_argument("--pull", type=float, default=1.0, help="on the long sides [MPa]")
    parser.add_argument("--picture", type=Path, help="draw the paths into this file")
    chosen = parser.parse_args()
    sim = plate(
        size=chosen.size,
        moved=chosen.moved,
        strength=chosen.strength,
        pull=chosen.pull,
        branching=True,
    )
    while sim.state.time < 100e-6 and sim.cracks.tips:
        sim.step()
    places, times = cuts(sim)
    where, when = branchings(sim)
    print(f"first cut at {1e6 * times[0]:.1f} us")
    for (x, y), time in zip(where, when, strict=True):
        before = (times < time) & (places[:, 0] > x - 5.0) & (np.abs(places[:, 1] - y) < 3.0)
        speed = (x - places[before][0, 0]) / (time - times[before][0]) if before.any() else np.nan
        print(f"branches at ({x:.1f}, {y:+.1f}) mm, {1e6 * time:.1f} us, {1e-3 * speed:.0f} m/s")
    at_end = times[places[:, 0] > 100.0 - 2.0 * chosen.size]
    print(f"at the far side at {1e6 * at_end[0]:.1f} us" if len(at_end) else "not at the far side")
    book = sim.ledger
    print(f"crack {sim.state.crack_length:.1f} mm, {len(sim.cracks.tips)} tips left")
    print(f"cables {book.cohesive_work / (ENERGY * sim.state.crack_length):.3f} G h")
    print(f"imbalance {book.relative(book.imbalance):.1e} of the work of the loads")
    if chosen.picture is not None:
        draw(sim, chosen.picture)


def draw(sim, target):
    """Draw where the film was cut, coloured by time."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot

    places, times = cuts(sim)
    figure, axes = pyplot.subplots(figsize=(8.0, 3.4), layout="constrained")
    axes.plot([0.0, 50.0], [0.0, 0.0], color="0.4")
    dots = axes.scatter(*places.T, c=1e6 * times, s=5.0, cmap="viridis")
    axes.set(xlim=(0, 100), ylim=(-20, 20), aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    figure.colorbar(dots, label="time [µs]", shrink=0.8)
    figure.savefig(target, dpi=100)


if __name__ == "__main__":
    main()
