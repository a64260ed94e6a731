"""The constants of the code are those of the table of docs/theory/scales.md."""

import numpy as np
import pytest

from page_tables import numbers_of, row
from shellcut import CohesiveLaw
from shellcut.cables.cohesive_law import _SHORT_BRANCH, _SHORT_BRANCH_WITHOUT_ONSET, _START_OPENING
from shellcut.contact.penalty_contact import _MARGIN, _ROUND_OFF
from shellcut.mesh.structured import opening_disc
from shellcut.models.guillotine import _CLEARANCE, _LEFT
from shellcut.results import steady_window
from shellcut.simulation.instability import _NOTICED_STRAIN
from shellcut.tool import closest_triangles, shapes
from shellcut.tool.cutting_edge import CUT_DEPTH

LAW, FILM, TOOL = CohesiveLaw(), opening_disc("M1"), shapes.tooth_ring()
HALF_THICKNESS = 0.35
"""Of a tooth [mm]."""
REACH = closest_triangles.REACH / closest_triangles.REACH_HALF_THICKNESS
"""Over V/A of the tool."""
UNDER_THE_PATH = 2.0 * np.pi * 9.4 / 152
"""Sides of the quads there [mm]."""
SIDES = np.linalg.norm(np.diff(FILM.nodes[FILM.quads[:, [0, 1, 2, 3, 0]]], axis=1), axis=2)
FACETS = np.array([shapes.DEFAULT_DEVIATION, shapes.EDGE_DEVIATION, shapes.LONGEST_TRIANGLE])
FACETS_SHOWN = [*(1.0 / FACETS[:2]), shapes.LONGEST_TRIANGLE]
BRANCHES = 1.0 / np.array([_SHORT_BRANCH, _SHORT_BRANCH_WITHOUT_ONSET])
START = "opening over which the force of the equilibrium start fades"


@pytest.mark.parametrize(
    ("begins", "follows", "with_the_paper"),
    [
        ("depth behind the cutting edge", [CUT_DEPTH], [CUT_DEPTH * UNDER_THE_PATH]),
        ("margin of the list", [_MARGIN], [_MARGIN * np.median(SIDES)]),
        ("shortest branch of a cable", BRANCHES, [_SHORT_BRANCH * LAW.onset]),
        (START, [1 / _START_OPENING], [_START_OPENING * LAW.opening_u]),
        ("reach of the grid", [REACH], [REACH * TOOL.half_thickness()]),
        ("round-off of distances", [_ROUND_OFF], [_ROUND_OFF * np.abs(TOOL.vertices).max()]),
        ("facets of a made tooth", FACETS_SHOWN, HALF_THICKNESS * FACETS),
        (
            "guillotine: gap",
            [1 / _CLEARANCE, _LEFT],
            [_CLEARANCE * LAW.opening_u, _LEFT * LAW.opening_u],
        ),
        ("steady window", [steady_window._ROUND_OFF], [1e-9]),
        ("least energy of the balance", [100.0 * _NOTICED_STRAIN], []),
        ("snapshots", [0.0], [LAW.strength]),
    ],
)
def test_constants_are_those_of_the_page(begins, follows, with_the_paper):
    _, rule, shown = row("docs/theory/scales.md", begins)
    # Of a quotient of 1 the page shows the divisor.
    told = [float(text) for text in numbers_of(rule.replace("1/", "").replace("8/7", f"{8 / 7}"))]
    assert told == pytest.approx(list(follows), rel=0.01)
    told = [float(text) for text in numbers_of(shown)]
    if begins.startswith("depth"):
        assert told[0] <= with_the_paper[0] <= told[1]
    else:
        assert told == pytest.approx(list(with_the_paper), rel=0.1)
