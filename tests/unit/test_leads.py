"""What a path is led on by at its ends: as far as there is film, and room in it."""

import numpy as np
import pytest

from shellcut import PathCurve, imprint
from shellcut.imprinting.film_plane import FilmPlane
from shellcut.imprinting.leads import with_room
from shellcut.mesh.structured import annulus, rectangle

SHEET = rectangle(20.0, 10.0, n_x=40, n_y=21)  # no line of edges on y = 0


def fitted(mesh, *curves):
    film = FilmPlane(mesh)
    return with_room(film, curves)


def led(start, end, before=3.0, after=3.0):
    """A line that a blade cuts from ``start`` to ``end``, with its leads."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    way = (b - a) / np.linalg.norm(b - a)
    return PathCurve.line(a - before * way, b + after * way).with_leads(before, after)


def ends(curve):
    return curve.point([0.0, curve.leads[0], curve.length - curve.leads[1], curve.length])


def test_where_there_is_room_a_path_keeps_its_leads():
    path = led((6.0, 0.0), (14.0, 1.0))
    (curve,), notes = fitted(SHEET, path)
    assert curve.leads == (3.0, 3.0)
    assert curve.length == path.length
    assert notes == []
    (plain,), _ = fitted(SHEET, PathCurve.line((6.0, 0.0), (14.0, 1.0)))
    assert plain.leads == (0.0, 0.0)


def test_a_lead_ends_where_the_film_does():
    # A hole lies behind the first place, the end of the film beyond the last one.
    ring = annulus(3.0, 10.0, n_around=80, n_radial=18)
    (curve,), notes = fitted(ring, led((4.5, 0.2), (9.0, 0.4), before=9.0))
    at = ends(curve)
    # The hole's rim, and 0.05 mm over it: an eighth of an edge.
    assert np.hypot(*at[0]) == pytest.approx(3.0, abs=0.06)
    assert np.hypot(*at[3]) == pytest.approx(10.0, abs=0.06)
    np.testing.assert_allclose(at[1:3], [[4.5, 0.2], [9.0, 0.4]], atol=1e-9)
    assert notes == []
    result = imprint(ring, led((4.5, 0.2), (9.0, 0.4), before=9.0))
    assert len(result.chains) == 1  # none beyond the hole


def test_a_blade_that_comes_in_over_the_rim_has_nothing_behind():
    (curve,), notes = fitted(SHEET, led((-0.3, 0.0), (14.0, 0.0)))
    assert curve.leads == (0.0, 3.0)
    assert notes == []


def test_a_lead_without_room_is_shortened_and_it_is_said():
    # On it comes within 0.9 edges of the upper rim, y = 5, at an angle too flat to cross it.
    (curve,), notes = fitted(SHEET, led((4.0, 1.0), (15.5, 4.0)))
    assert curve.leads[0] == 3.0
    assert 0.0 < curve.leads[1] < 2.0
    assert len(notes) == 1
    assert "beyond the end at (15.5, 4, 0), where the mesh has no room" in notes[0]
    result = imprint(SHEET, led((4.0, 1.0), (15.5, 4.0)))
    assert notes[0] in result.notes


def test_a_lead_keeps_clear_of_another_path_and_of_a_pre_crack():
    across = PathCurve.line((4.2, -6.0), (4.2, 6.0))
    (_, curve), notes = fitted(SHEET, across, led((6.5, 0.1), (14.0, 0.1)))
    # 2.5 edges of 0.5 mm from the other path
    assert 4.2 + 1.25 - 0.01 < ends(curve)[0, 0] < 6.5
    assert len(notes) == 1
    column = SHEET.nodes_where(lambda x, y, z: (abs(x - 5.0) < 1e-9) & (abs(y) < 2.0))
    (curve,), notes = fitted(SHEET.cut(column), led((6.5, 0.1), (14.0, 0.1)))
    assert 5.0 + 0.4 < ends(curve)[0, 0] < 6.5
    assert len(notes) == 1


def test_two_leads_share_the_room_between_them():
    curves, notes = fitted(
        SHEET, led((2.0, 0.1), (8.0, 0.1)), led((11.0, 0.2), (18.0, 0.2), before=3.0)
    )
    gap = ends(curves[1])[0, 0] - ends(curves[0])[3, 0]
    assert gap > 1.25 - 1e-9
    assert curves[0].leads[1] + curves[1].leads[0] > 0.5
    assert notes


def test_a_line_that_is_there_needs_no_room_for_its_leads():
    # The ring of edges at r = 9.6 is half an edge off the rim.
    ring = annulus(4.0, 10.0, n_around=80, n_radial=15)
    arc = PathCurve.circle((0, 0, 0), 9.6, start_deg=10.0, end_deg=150.0).with_leads(3.0, 3.0)
    (curve,), notes = fitted(ring, arc.mapped(lambda x: x[:, :2]))
    assert curve.leads == (3.0, 3.0)
    assert notes == []
    result = imprint(ring, arc)
    assert not result.changed
    # The first node is that next before the end of the lead, 3 mm along a polygon of 80 sides.
    angle = np.degrees(np.arctan2(*result.mesh.nodes[result.chains[0], 1::-1].T))
    start = 10.0 + np.degrees(3.0 / 9.6)
    assert start - 4.5 < angle[result.first[0]] <= start + 1e-6


def test_the_first_node_of_a_path_without_leads_is_that_of_its_chain():
    result = imprint(SHEET, PathCurve.line((-1.0, 0.1), (21.0, 0.1)))
    assert result.first == (0,)
