import numpy as np
import pytest

from shellcut import ImprintError, Mesh
from shellcut.imprinting.film_plane import FilmPlane
from shellcut.mesh.structured import annulus, cylinder, disc, rectangle


def tilted(mesh, shift=(1.0, -2.0, 3.0)):
    q, _ = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [-0.3, 1.0, 0.7], [0.2, -0.9, 1.1]]))
    q *= np.sign(np.linalg.det(q))
    return Mesh.from_arrays(mesh.nodes @ q.T + shift, mesh.quads, node_sets=mesh.node_sets)


def test_there_and_back_in_any_plane():
    mesh = tilted(rectangle(4.0, 2.0, size=0.5))
    film = FilmPlane(mesh)
    np.testing.assert_allclose(film.lift(film.x), mesh.nodes, atol=1e-14)
    np.testing.assert_allclose(film.normal, mesh.directors[0], atol=1e-14)
    at = film.x[mesh.quads]
    p, q = at[:, 1] - at[:, 0], at[:, 3] - at[:, 0]
    assert (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] > 0.0).all()  # counter-clockwise


def test_a_sheet_in_z_0_keeps_its_coordinates():
    mesh = disc(3.0, n_side=6)
    film = FilmPlane(mesh)
    np.testing.assert_array_equal(film.x, mesh.nodes[:, :2])
    np.testing.assert_array_equal(film.lift(film.x), mesh.nodes)


def test_a_curved_film_is_refused():
    with pytest.raises(ImprintError, match="flat films only"):
        FilmPlane(cylinder(5.0, 8.0, n_around=20, n_along=8, arc_deg=90.0))


def test_the_rim_falls_into_pieces_at_corners_and_at_ends_of_sets():
    sheet = Mesh.from_arrays(
        *(getattr(rectangle(4.0, 2.0, size=0.5), n) for n in ("nodes", "quads"))
    )
    film = FilmPlane(sheet)
    assert sorted(len(p.nodes) for p in film.pieces) == [5, 5, 9, 9]
    assert film.corner.sum() == 4
    part = sheet.nodes_where(lambda x, y, z: (y < -0.9) & (x > 0.9) & (x < 2.1))
    film = FilmPlane(sheet.with_sets(node_sets={"part": part}))
    assert np.flatnonzero(film.corner).tolist() == [0, 2, 4, 8, 36, 44]  # its ends, four corners
    ring = FilmPlane(annulus(2.0, 3.0, n_around=40, n_radial=3))
    # the sets cover a loop each and end nowhere
    assert [p.curve.closed for p in ring.pieces] == [True, True]
    assert not ring.corner.any()


def test_nodes_of_pre_cracks_and_set_borders_are_pinned():
    sheet = rectangle(4.0, 2.0, size=0.5)
    middle = sheet.nodes_where(lambda x, y, z: (abs(y) < 1e-9) & (x < 1.6))
    cut = sheet.cut(middle)
    film = FilmPlane(cut)
    # twins on both flanks, and the tip
    assert np.flatnonzero(film.cracked).tolist() == sorted(
        [*middle, *np.flatnonzero(cut.origin != np.arange(cut.n_node))]
    )
    patch = sheet.nodes_where(lambda x, y, z: x > 1.9)
    film = FilmPlane(sheet.with_sets(node_sets={"patch": patch}))
    border = sheet.nodes_where(lambda x, y, z: (abs(x - 2.0) < 1e-9) & (abs(y) < 0.9))
    assert np.flatnonzero(film.pinned).tolist() == border.tolist()
