"""The constants of the code are those of the table of docs/theory/scales.md."""

import numpy as np
import pytest

from page_tables import numbers_of, row
from shellcut import CohesiveLaw
from shellcut.cables import cohesive_law
from shellcut.contact import penalty_contact
from shellcut.mesh.structured import opening_disc
from shellcut.models.guillotine import _CLEARANCE, _LEFT
from shellcut.results import steady_window
from shellcut.simulation import instability
from shellcut.tool import closest_triangles, cutting_edge, shapes

LAW, FILM, TOOL = CohesiveLaw(), opening_disc("M1"), shapes.tooth_ring()
HALF_THICKNESS = 0.35
"""Of a tooth [mm]."""
REACH = closest_triangles.REACH / closest_triangles.REACH_HALF_THICKNESS
"""Over V/A of the tool."""
UNDER_THE_PATH = 2.0 * np.pi * 9.4 / 152
"""Sides of the quads there [mm]."""
FARTHEST = np.abs(TOOL.vertices).max()
SIDES = np.linalg.norm(np.diff(FILM.nodes[FILM.quads[:, [0, 1, 2, 3, 0]]], axis=1), axis=2)


@pytest.mark.parametrize(
    ("begins", "follows", "with_the_paper"),
    [
        (
            "depth behind the cutting edge",
            [cutting_edge.CUT_DEPTH],
            [cutting_edge.CUT_DEPTH * UNDER_THE_PATH],
        ),
        (
            "margin of the list",
            [penalty_contact._MARGIN],
            [penalty_contact._MARGIN * np.median(SIDES)],
        ),
        (
            "shortest branch of a cable",
            [1 / cohesive_law._SHORT_BRANCH, 1 / cohesive_law._SHORT_BRANCH_WITHOUT_ONSET],
            [cohesive_law._SHORT_BRANCH * LAW.onset],
        ),
        (
            "opening over which the force of the equilibrium start fades",
            [1 / cohesive_law._START_OPENING],
            [cohesive_law._START_OPENING * LAW.opening_u],
        ),
        ("reach of the grid", [REACH], [REACH * TOOL.half_thickness()]),
        (
            "round-off of distances",
            [penalty_contact._ROUND_OFF],
            [penalty_contact._ROUND_OFF * FARTHEST],
        ),
        (
            "facets of a made tooth",
            [1 / shapes.DEFAULT_DEVIATION, 1 / shapes.EDGE_DEVIATION, shapes.LONGEST_TRIANGLE],
            [
                HALF_THICKNESS * constant
                for constant in (
                    shapes.DEFAULT_DEVIATION,
                    shapes.EDGE_DEVIATION,
                    shapes.LONGEST_TRIANGLE,
                )
            ],
        ),
        (
            "guillotine: gap",
            [1 / _CLEARANCE, _LEFT],
            [_CLEARANCE * LAW.opening_u, _LEFT * LAW.opening_u],
        ),
        ("steady window", [steady_window._ROUND_OFF], [1e-9]),
        ("least energy of the balance", [100.0 * instability._NOTICED_STRAIN], []),
        ("snapshots", [0.0], [LAW.strength]),
    ],
)
def test_constants_are_those_of_the_page(begins, follows, with_the_paper):
    _, rule, shown = row("docs/theory/scales.md", begins)
    # Of a quotient of 1 the page shows the divisor.
    told = [float(text) for text in numbers_of(rule.replace("1/", "").replace("8/7", f"{8 / 7}"))]
    assert told == pytest.approx(follows, rel=0.01)
    told = [float(text) for text in numbers_of(shown)]
    if begins.startswith("depth"):
        assert told[0] <= with_the_paper[0] <= told[1]
    else:
        assert told == pytest.approx(with_the_paper, rel=0.1)
