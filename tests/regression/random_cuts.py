"""Random cuts through random meshes: arcs, bends, crossings, tight turns.

The tests run a few, ``python tests/regression/random_cuts.py --seeds 40`` so many of each kind.
"""

import argparse
import sys
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

import shellcut as sc
from shellcut.mesh.structured import rectangle
from shellcut.tool_shapes import straight_blade, tooth_ring

LENGTH, WIDTH, SIZE = 12.0, 10.0, 0.8
SPEED = 6000.0
"""Of a blade [mm/s]."""


class RandomCut(NamedTuple):
    """A simulation, until when it cuts [s], and what gives distances of places from its path [mm].

    least : work of the tool from which on its imbalance counts [N·mm].
    """

    simulation: object
    until: float
    off: object
    least: float = 2.0


def film(rng, size=SIZE):
    """Return nodes of a film moved at random, its middle at the origin, and its mesh."""
    mesh = rectangle(LENGTH, WIDTH, size=size)
    X = mesh.nodes - [*mesh.nodes.mean(axis=0)[:2], 0.0]
    inside = np.ones(mesh.n_node, bool)
    inside[mesh.boundary_nodes()] = False
    X[inside, :2] += rng.uniform(-0.22, 0.22, (inside.sum(), 2)) * size
    return X, mesh


def held(X, mesh, *, material=None, law=None, **arguments):
    """Return a simulation of a film held at its rim but for the left one."""
    left = (np.abs(X[:, 0] + LENGTH / 2) < 1e-9) & (np.abs(X[:, 1]) < WIDTH / 2 - 1e-6)
    rim = np.setdiff1d(mesh.boundary_nodes(), np.flatnonzero(left))
    return sc.Simulation(
        sc.Mesh.from_arrays(X, mesh.quads, node_sets={"held": rim}),
        material or sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("held")],
        law=law or sc.CohesiveLaw(),
        fracture=sc.Fracture(path="free"),
        **arguments,
    )


def led(path, heading, slow=0.25):
    """Return the motion of a blade along a path, shape (n, 2), its end [s] and the way ahead.

    It begins 1.2 mm before the path. heading : at each place [rad].  slow : way that a blade would
    move as it turns by one radian [mm].
    """
    # Rounded, because NumPy's functions differ in the last place between processors.
    path, heading = np.round(path, 9), np.round(heading, 9)
    steps = np.hypot(*np.diff(path, axis=0).T) + slow * np.abs(np.diff(heading))
    time = np.round((np.append(0.0, np.cumsum(steps)) + 1.2) / SPEED, 12)
    ahead = np.round([np.cos(heading[0]), np.sin(heading[0]), 0.0], 9)
    places = np.column_stack([path, np.zeros(len(path))])
    turns = np.column_stack([np.zeros((len(path), 2)), heading])
    motion = sc.TableMotion(
        np.append(0.0, time),
        np.vstack([places[0] - 1.2 * ahead, places]),
        np.vstack([turns[:1], turns]),
    )
    return motion, float(time[-1]), ahead


def notch(sim, start, ahead):
    """Notch a film from outside to where a blade begins its path."""
    start = np.array([*np.round(start, 9), 0.0])
    sim.notch(start - 1.5 * ahead, start + 1.2 * ahead)


def bend(rng, *, curvature=(-0.12, 0.12), slits=0):
    """A short blade enters at the left rim and follows an arc, or a line of curvature 0."""
    X, mesh = film(rng)
    k, angle, y = rng.uniform(*curvature), rng.uniform(-0.3, 0.3), rng.uniform(-1.0, 1.0)
    way = np.linspace(0.0, 9.0, 40)
    # Straight as far as the notch reaches: a blade does not cut into the flank of a crack.
    heading = angle + k * np.maximum(way - 2.4, 0.0)
    middle = 0.5 * (heading[1:] + heading[:-1])
    steps = np.diff(way)[:, None] * np.column_stack([np.cos(middle), np.sin(middle)])
    path = np.array([-LENGTH / 2, y]) + np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    motion, _, ahead = led(path, heading, slow=0.0)
    sim = held(X, mesh, tool=straight_blade(length=1.5, height=6.0), motion=motion)
    notch(sim, path[0], ahead)
    for _ in range(slits):
        across = rng.uniform(-0.8, 0.8)
        at, side = path[rng.integers(14, 30)], rng.choice([-1.0, 1.0])
        slit = side * np.array([np.sin(across), np.cos(across)])
        rim = at - slit * (WIDTH / 2 + side * at[1] + 0.5) / slit[1] / side
        end = at + rng.uniform(0.3, 2.0) * slit
        sim.notch([*np.round(rim, 9), 0.0], [*np.round(end, 9), 0.0])
    until = 0.9 * (1e-4 + way[-1] / SPEED)
    return RandomCut(sim, until, lambda places: _from_line(places, path))


def arc(rng):
    """Teeth screw down into a film that is held all around.

    Its quads must resolve the fold over a tooth: in sides of 0.8 mm a tip ahead of the edge may
    tear aside, and the tooth then comes down a second time.
    """
    X, mesh = film(rng, 0.5)
    radius = rng.uniform(2.5, 3.5)
    sim = sc.Simulation(
        sc.Mesh.from_arrays(X, mesh.quads, node_sets={"rim": mesh.boundary_nodes()}),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("rim")],
        tool=tooth_ring(n_teeth=2, radius=radius),
        motion=sc.ScrewMotion.over(angle_deg=120.0, duration=4e-3, pitch=rng.uniform(8.0, 14.0)),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path="free"),
    )
    return RandomCut(
        sim, 2.5e-3, lambda places: np.abs(np.hypot(places[:, 0], places[:, 1]) - radius)
    )


def crossing(rng):
    """A blade crosses up to three slits."""
    return bend(rng, curvature=(-0.03, 0.03), slits=int(rng.integers(1, 4)))


def tight(rng):
    """A short blade turns by 40° to 130°, every one to two edges, in a film that gives.

    Modulus, strength and the law's length are drawn, so that film strains by 2 to 15 % before it
    parts.
    """
    X, mesh = film(rng)
    angle = rng.uniform(-0.4, 0.4)
    corners, headings = [np.array([-LENGTH / 2, rng.uniform(-1.0, 1.0)])], [angle]
    corners.append(corners[0] + 2.4 * np.array([np.cos(angle), np.sin(angle)]))
    for _ in range(7):
        angle += rng.choice([-1.0, 1.0]) * np.radians(rng.uniform(40.0, 130.0))
        way = rng.uniform(1.0, 2.0) * SIZE * np.array([np.cos(angle), np.sin(angle)])
        if np.abs(corners[-1] + way).max() > 0.35 * WIDTH:  # back into the film
            angle = 2.0 * headings[-1] - angle
            way = rng.uniform(1.0, 2.0) * SIZE * np.array([np.cos(angle), np.sin(angle)])
        corners.append(corners[-1] + way)
        headings.append(angle)
    share = np.linspace(0.02, 0.98, 8)[:, None]
    path = np.concatenate([a + share * (b - a) for a, b in pairwise(corners)])
    heading = np.repeat(headings, len(share))
    # It turns on the spot at a corner, by way of half of the turn.
    at = len(share) * np.arange(1, len(headings))
    path = np.insert(path, at, corners[1:-1], axis=0)
    heading = np.insert(heading, at, 0.5 * (np.array(headings[1:]) + headings[:-1]))
    motion, until, ahead = led(path, heading)
    young, strain = rng.uniform(50.0, 500.0), rng.uniform(0.02, 0.15)
    opening = rng.uniform(0.4, 2.0)
    law = sc.CohesiveLaw(
        strength=strain * young,
        plateau=0.6 * strain * young,
        opening_a=0.2 * opening,
        opening_p=0.5 * opening,
        opening_u=opening,
    )
    soft, blade = sc.ShellMaterial.homogeneous(young=young), straight_blade(length=0.6, height=6.0)
    sim = held(X, mesh, material=soft, law=law, tool=blade, motion=motion)
    notch(sim, path[0], ahead)
    least = 2.0 * law.fracture_energy * sim.material.thickness  # of 2 mm of crack
    return RandomCut(sim, until, lambda places: _from_line(places, path), least)


KINDS = {"bend": bend, "arc": arc, "crossing": crossing, "tight": tight}


def _from_line(places, path):
    """Return the distances of places from a broken line that goes straight on at its end."""
    a, b = path[:-1], path[1:]
    p = places[:, None, :2]
    s = ((p - a) * (b - a)).sum(axis=-1) / ((b - a) ** 2).sum(axis=-1)
    last = np.append(np.ones(len(a) - 1), np.inf)
    foot = a + np.clip(s, 0.0, last)[..., None] * (b - a)
    return np.linalg.norm(p - foot, axis=-1).min(axis=1)


class Outcome(NamedTuple):
    """What a cut came to.

    crack : length [mm].  imbalance : largest, over the largest work of the tool so far.  late :
    largest overshoot of a cable, in edges.  off : farthest cut of a blade from the path, in edges;
    without those where a tooth comes down.  work : of the tool over that of the cables.
    """

    crack: float
    imbalance: float
    late: float
    off: float
    work: float


def carried_out(cut):
    """Run a cut."""
    sim = cut.simulation
    largest = worst = 0.0
    while sim.state.time < cut.until:
        sim.step()
        if sim.state.step % 100 == 0:
            book = sim.close_ledger()
            largest = max(largest, book.tool_work)
            if book.tool_work > cut.least:
                worst = max(worst, abs(book.imbalance) / largest)
    cables, book = sim.state.cable, sim.close_ledger()
    log = [c for c in sim.state.split_log if c.kind not in ("notch", "tear") and c.measure != 0.0]
    off = cut.off(np.array([c.reference for c in log])) if log else np.zeros(1)
    return Outcome(
        sim.state.crack_length,
        worst,
        float(cables.overshoot[: cables.count].max(initial=0.0)) / SIZE,
        float(off.max()) / SIZE,
        book.tool_work / max(book.cohesive_work, 1e-9),
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    given, done, failed = parser.parse_args(), {}, 0
    for kind, seed in product(given.kinds, range(given.first, given.first + given.seeds)):
        try:
            done[kind, seed] = outcome = carried_out(KINDS[kind](np.random.default_rng(seed)))
            told = ", ".join(f"{name} {value:.4f}" for name, value in outcome._asdict().items())
        except Exception as error:  # a blow-up is what is looked for
            told, failed = f"{type(error).__name__}: {error}"[:300], failed + 1
        print(f"{kind} {seed}: {told}", flush=True)
    print(f"{len(done)} cuts, {failed} failed")
    for name in Outcome._fields[1:]:
        (kind, seed), worst = max(done.items(), key=lambda item: getattr(item[1], name))
        print(f"largest {name}: {getattr(worst, name):.4f} ({kind} {seed})")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
