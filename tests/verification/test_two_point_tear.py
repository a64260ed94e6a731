"""Two-point tearing: a free sheet is torn by pulling two points of its notched edge apart.

A, the tip T and B come to lie on a line. With the unit vectors u_A and u_B from the points to the
tip, in the flat sheet, the force on the tip is J = F (u_A + u_B). In an isotropic film the crack
runs along u_A + u_B, on a hyperbola with the foci A and B, at F = G h / |u_A + u_B|; with G(theta)
where G(theta) / cos(theta - theta_T) is least. Corrections are of the order of sqrt(D / (G h)) /
|TA|, 2 per cent here. The quick tests, on large quads at high speed, compare the path alone.
"""

from typing import NamedTuple

import numpy as np
import pytest

import shellcut as sc
from courses import recorded
from films import from_zero, shaken
from shellcut.mesh.structured import rectangle

LAW = sc.CohesiveLaw(
    strength=7.0, plateau=5.6, opening_a=0.4, opening_p=1.6, opening_u=2.4, onset=0.02
)
TEARING = LAW.fracture_energy
NOTCH, RISE = 12.0, 5e-4
TRIED = np.radians(np.linspace(-85.0, 85.0, 3401))


class Sheet(NamedTuple):
    """A sheet with a notch along y = 0, pulled at (0, a) and (0, b)."""

    a: float
    b: float
    length: float
    low: float
    high: float
    size: float
    speed: float
    thickness: float = 0.1
    moved: float = 0.0
    film: sc.Anisotropy | None = None


def pulled(sheet):
    """Return a simulation and its two nodes that move up and down."""
    mesh = from_zero(
        rectangle(sheet.length, sheet.high - sheet.low, size=sheet.size), 0.0, sheet.low
    )
    mesh = shaken(mesh, 1.0, size=sheet.moved * sheet.size)
    X = mesh.nodes
    ends = [int(np.argmin(np.hypot(X[:, 0], X[:, 1] - y))) for y in (sheet.a, sheet.b)]

    def rate(speed):
        return {"z": lambda time: speed * min(1.0, time / RISE)}

    rates = rate(sheet.speed), rate(-sheet.speed)
    supports = [
        sc.Support([end], rotation="", velocity=v) for end, v in zip(ends, rates, strict=True)
    ]
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(thickness=sheet.thickness),
        supports=supports,
        law=LAW,
        fracture=sc.Fracture(path="free", anisotropy=sheet.film),
        damping_alpha=20.0,
    )
    sim.notch((-1.0, 0.0, 0.0), (NOTCH, 0.0, 0.0))
    return sim, ends


def torn(sim, ends, far):
    """Tear; return crack, distance of the points and work of the supports in time."""

    def read(sim):
        a, b = sim.state.node.x[ends]
        return sim.state.crack_length, np.linalg.norm(a - b), sim.ledger.support_work

    def ended(sim):
        return sim.state.time >= 0.1 or sim.state.crack_length >= far

    return recorded(sim, ended, read, every=50)


def best(sheet, T):
    """Return the direction [rad] of a crack and its force over G h, by theory."""
    S = sum((T - end) / np.linalg.norm(T - end) for end in ((0.0, sheet.a), (0.0, sheet.b)))
    away = TRIED - np.arctan2(S[1], S[0])
    f = np.ones(len(TRIED))
    if sheet.film is not None:
        ways = np.stack([np.cos(TRIED), np.sin(TRIED), 0.0 * TRIED], axis=1)
        f = sheet.film.factors(ways, np.array([0.0, 0.0, 1.0]))
    needed = np.where(np.cos(away) > 0.05, f / np.maximum(np.cos(away), 0.05), np.inf)
    k = int(np.argmin(needed))
    return TRIED[k], needed[k] / np.linalg.norm(S)


def path(sim):
    """Return where the crack has been, shape (n, 2)."""
    return np.array([cut.reference[:2] for cut in sim.state.split_log if cut.kind != "notch"])


def expected_path(sheet, far, n=400):
    """Return the path by theory from the end of the notch, shape (n + 1, 2)."""
    places = [np.array([NOTCH, 0.0])]
    for _ in range(n):
        angle, _ = best(sheet, places[-1])
        places.append(places[-1] + far / n * np.array([np.cos(angle), np.sin(angle)]))
    return np.array(places)


def largest_miss(found, expected):
    """Return how far the farthest of some places lies from a path [mm]."""
    gaps = np.linalg.norm(found[:, None] - expected[None], axis=2)
    return gaps.min(axis=1).max()


def chord(places, until):
    """Return the direction from the start of a path to where it passes x [degrees]."""
    rise = np.interp(until, *places.T) - places[0, 1]
    return np.degrees(np.arctan2(rise, until - places[0, 0]))


MD_AT_45 = sc.Anisotropy(direction=(1.0, 1.0, 0.0), along=0.85, across=1.15)
EVEN = Sheet(9.0, -9.0, length=25.0, low=-12.0, high=12.0, size=1.0, speed=3000.0)
UNEVEN = Sheet(6.0, -18.0, length=25.0, low=-20.0, high=8.0, size=1.0, speed=3000.0)


@pytest.mark.parametrize(
    "sheet",
    [
        pytest.param(UNEVEN, id="hyperbola"),
        pytest.param(EVEN._replace(film=MD_AT_45), id="anisotropic", marks=pytest.mark.slow),
        pytest.param(EVEN._replace(film=MD_AT_45, moved=0.2), id="anisotropic, moved"),
    ],
)
def test_the_crack_takes_the_way_of_least_force(sheet):
    sim, ends = pulled(sheet)
    torn(sim, ends, 9.0)
    found, expected = path(sim), expected_path(sheet, 11.0)
    # Discretisation: half an edge; measured 0.23 to 0.29.
    assert largest_miss(found, expected) < 0.5 * sheet.size
    # Theory without bending; measured within 1.7.
    until = found[-1, 0]
    assert chord(found, until) == pytest.approx(chord(expected, until), abs=2.0)
    assert abs(sim.ledger.relative(sim.ledger.imbalance)) < 1e-4


LARGE = Sheet(6.0, -18.0, 33.0, -19.8, 7.8, size=0.6, speed=700.0, thickness=0.07)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "moved", "slower", "stage_off"),
    [(0.6, 0.0, 1.0, 0.03), (0.6, 0.2, 1.0, 0.05), (0.4, 0.2, 1.0, 0.03), (0.6, 0.2, 2.0, 0.15)],
)
def test_force_and_way_of_a_long_tear(size, moved, slower, stage_off):
    sheet = LARGE._replace(size=size, moved=moved, speed=LARGE.speed / slower)
    sim, ends = pulled(sheet)
    crack, apart, work = torn(sim, ends, 16.0)
    found, expected = path(sim), expected_path(sheet, 18.0)
    ways = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(found, axis=0), axis=1)))
    ratios = []
    for start in (4.0, 7.0, 10.0, 13.0):
        stage = (crack > start) & (crack < start + 3.0)
        tip = np.array([np.interp(start + 1.5, ways, column) for column in found.T])
        unit = TEARING * sheet.thickness * best(sheet, tip)[1]
        ratios.append(np.polyfit(apart[stage], work[stage], 1)[0] / unit)
    # Theory without bending (2 per cent), quads that snap and damping (1): measured 1.7, 2.6 and
    # 1.1. A stage holds five edges of 0.6 mm, after each of which the force falls and rises:
    # measured up to 3.8 on moved quads, on those of 0.4 mm 2.7. At half the speed one tip is
    # pressed, and torn late: 12 in that stage (32, where it has to wait until nothing presses).
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.03 if slower == 1.0 else 0.05)
    assert ratios == pytest.approx(np.ones(4), abs=stage_off)
    # Discretisation: half an edge in 12 mm; measured 0.38, 0.18 and 0.18.
    assert largest_miss(found[ways < 12.0], expected) < 0.5 * sheet.size
    until = found[-1, 0]
    assert chord(found, until) == pytest.approx(chord(expected, until), abs=2.0)
    assert abs(sim.ledger.relative(sim.ledger.imbalance)) < 1e-4
