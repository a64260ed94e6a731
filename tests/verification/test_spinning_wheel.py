"""A round cutting wheel without friction: how fast it turns about its axis changes nothing."""

import numpy as np
import pytest

import shellcut as sc
from round_tools import wheel
from shellcut.models import free_cut
from shellcut.recording.cut_front import CutFront

RADIUS, CENTRE = 5.0, 3.0
TRAVEL, SPEED = 4.5, 6000.0
SPINS = [(0.0, (3.0, -6.0)), (12.0, (1.0, -1.0, 8.0, -6.0))]
LAW = sc.CohesiveLaw(
    strength=18.0,
    plateau=12.0,
    opening_a=0.1,
    opening_p=0.8,
    opening_u=1.2,
    onset=0.005,
    joint="free",
)


def motion(spin, degrees, start=0.0):
    """Straight on, with the speed of the rim over that of the centre; and the rotation of it."""
    time = np.linspace(0.0, (TRAVEL + 0.6) / SPEED, 121)
    way = SPEED * (time - 1e-4 * (1.0 - np.exp(-time / 1e-4)))
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    R, at = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), way - 4.3
    places = np.stack([at * c, start + at * s, np.full_like(at, CENTRE)], axis=1)
    return sc.TableMotion(time, places, np.outer(spin * way / RADIUS, R[:, 1])), R


def cut(spin, degrees):
    """A strip that a wheel has cut in a lane of this angle, and the uncut film ahead of it."""
    moves, R = motion(spin, degrees, start=-0.45 if degrees else 0.0)
    points, triangles = wheel(radius=RADIUS)
    case = free_cut(
        sc.meshing.rectangle(8.0, 4.0, size=0.5),
        tool=sc.Tool.from_triangles(points @ R.T, triangles),
        motion=moves,
        duration=TRAVEL / SPEED,
        notch=1.0,
        clamp=("bottom", "top"),
        law=LAW,
    )
    case.simulation.run(case.duration)
    return case.simulation, CutFront(case.simulation, case.duration).rows(case.simulation)[0, 2]


@pytest.mark.parametrize(("degrees", "spins"), SPINS)
def test_its_spin_changes_no_cut(degrees, spins):
    rests, uncut = cut(0.0, degrees)
    ends = np.array([split.end for split in rests.state.split_log])
    assert len(ends) > 4
    for spin in spins:
        turns, ahead = cut(spin, degrees)
        splits = turns.state.split_log
        assert "tear" not in {split.kind for split in splits}
        np.testing.assert_allclose([split.end for split in splits], ends, atol=0.02)
        assert turns.state.crack_length == pytest.approx(rests.state.crack_length, abs=0.01)
        # The rim is a polygon, whose corners rub along the film in steps.
        assert turns.work_in_film == pytest.approx(rests.work_in_film, rel=0.02)
        assert ahead == pytest.approx(uncut, abs=0.02)
