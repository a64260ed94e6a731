"""From a file's cells to a film: units, triangles, orientation, names, size, all that is said."""

import logging
import os

import meshio
import numpy as np
import pytest

from known_film import LEFT, NODES, QUADS, check_geometry, moebius_strip
from shellcut import mesh_from_outline, read_film
from shellcut.formats.errors import FileError
from shellcut.mesh import checks
from shellcut.mesh.film_file import divided_in_four
from shellcut.mesh.mesh import Mesh, MeshError
from shellcut.mesh.structured import annulus, cylinder, disc, rectangle
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.tool import ToolError

LINES = np.stack([LEFT[:-1], LEFT[1:]], axis=1)


def written(tmp_path, cells, nodes=NODES, **data):
    path = tmp_path / "film.vtu"
    meshio.Mesh(nodes, cells, **data).write(path)
    return path


@pytest.mark.parametrize(
    ("scale", "unit"), [(1.0, "mm"), (1e-3, "m"), (1.0 / 25.4, "inch"), (1e3, "um"), (1e-3, None)]
)
def test_units(tmp_path, scale, unit):
    mesh = read_film(written(tmp_path, {"quad": QUADS}, scale * NODES), unit=unit)
    check_geometry(mesh)


def test_a_size_between_units_is_refused_with_the_file(tmp_path):
    path = written(tmp_path, {"quad": QUADS}, NODES / 25.4)
    with pytest.raises(
        FileError, match=rf"{path}: the unit must be given, because the film is 0.1969 units"
    ):
        read_film(path)


MIXED = {  # the last quad as two triangles
    "quad": QUADS[:-1],
    "triangle": np.array([QUADS[-1][[0, 1, 2]], QUADS[-1][[0, 2, 3]]]),
}


class TestTriangles:
    def test_are_split_by_choice(self, tmp_path, caplog):
        part = [np.zeros(9, np.int32), np.array([1, 1], np.int32)]
        left = np.isin(np.arange(18), LEFT).astype(np.int32)
        path = written(tmp_path, MIXED, point_data={"left": left}, cell_data={"corner": part})
        mesh = read_film(path, unit="mm", triangles="split")
        assert mesh.n_quad == 4 * 9 + 3 * 2
        assert (mesh.edges().n_quad == 1).sum() == 2 * 14  # of the border: nothing has come apart
        assert mesh.quad_areas().sum() == pytest.approx(10.0, rel=1e-14)  # round-off
        assert mesh.quad_areas()[mesh.quad_set("corner")].sum() == pytest.approx(1.0, rel=1e-14)
        np.testing.assert_array_equal(
            np.sort(mesh.nodes[mesh.node_set("left")][:, 1]), [0.0, 0.5, 1.0, 1.5, 2.0]
        )
        assert "2 triangles are split in three and 9 quads in four: now 42 quads" in caplog.text

    def test_lines_of_a_group_take_their_middles(self, tmp_path):
        lines = {**MIXED, "line": LINES}
        marks = [np.zeros(9, np.int32), np.zeros(2, np.int32), np.ones(2, np.int32)]
        path = written(tmp_path, lines, cell_data={"left": marks})
        mesh = read_film(path, unit="mm", triangles="split")
        assert len(mesh.node_set("left")) == 5
        assert not mesh.quad_sets


def test_a_good_file_with_its_unit_says_nothing(tmp_path, caplog):
    with caplog.at_level(logging.DEBUG):
        read_film(written(tmp_path, {"quad": QUADS}), unit="mm")
    assert not caplog.records


def test_a_moebius_strip_is_refused_with_its_place(tmp_path):
    nodes, quads = moebius_strip(24)
    path = written(tmp_path, {"quad": quads}, nodes)
    with pytest.raises(FileError, match="a sheet must have two sides, got 24 quads around"):
        read_film(path)


def test_a_mesh_that_is_no_film_names_the_file(tmp_path):
    nodes = NODES.copy()
    nodes[17, 2] = 50.0
    path = written(tmp_path, {"quad": QUADS}, nodes)
    with pytest.raises(MeshError, match=rf"{path} holds no film \(ids count from 0"):
        read_film(path)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (QUADS[2][[0, 2, 1, 3]], r"got quad 2 at \(.*\) degenerate or a bow-tie; merge nodes"),
        (QUADS[7], r"got the same four nodes in quad 2 at \(.*\) and quad 7 at \("),
    ],
)
def test_a_wrong_quad_is_named_before_quads_are_turned(tmp_path, caplog, wrong, said):
    quads = QUADS.copy()
    quads[2] = wrong
    with pytest.raises(MeshError, match=rf"film\.vtu holds no film .*{said}"):
        read_film(written(tmp_path, {"quad": quads}), unit="mm")
    assert "turned over" not in caplog.text


SHEET = [(0, 0), (10, 0), (10, 6), (0, 6)]
LONG = [(0, 0), (1e5, 0), (1e5, 0.5), (0, 0.5)]

MAKERS = {
    "sheet by size": (lambda: rectangle(6e9, 4.0, size=0.4), "about 150,000,000,000, which take"),
    "sheet without end": (lambda: rectangle(1e200, 1e200, size=1e-200), "about inf, which take"),
    "sheet by counts": (lambda: rectangle(1.0, 1.0, n_x=9000, n_y=9000), "81,000,000, .* 73.1 GB"),
    "a count alone": (lambda: rectangle(1.0, 1.0, n_x=10**400, n_y=1), "n_x must be from 1 to 10,"),
    "disc": (lambda: disc(5.0, n_side=5000), "about 31,840,000, .* lower n_side or n_layer"),
    "ring": (lambda: annulus(1.0, 2.0, n_around=10**6, n_radial=75), "about 75,000,000, .* 67.7"),
    "roof": (lambda: cylinder(1.0, 2.0, n_around=10**6, n_along=75), "lower n_around or n_along"),
    "outline": (lambda: mesh_from_outline(SHEET, size=1e-3), "about 60,000,000, .* enlarge size"),
    "long outline": (lambda: mesh_from_outline(LONG, size=1.0), "50,000 quad sides around them at"),
}


@pytest.mark.parametrize("name", MAKERS)
def test_a_film_too_large_is_refused_before_it_is_made(name):
    make, told = MAKERS[name]
    with pytest.raises(ValueError, match=told):
        make()


def test_triangles_are_counted_before_they_are_split(tmp_path, monkeypatch):
    nodes = "".join(f"{k}, {x}, {y}\n" for k, (x, y) in enumerate(SHEET, start=1))
    deck = f"*NODE\n{nodes}*ELEMENT, TYPE=S3\n1, 1, 2, 3\n2, 1, 3, 4\n"
    (tmp_path / "film.inp").write_text(deck)
    assert read_film(tmp_path / "film.inp", unit="mm", triangles="split").n_quad == 6
    monkeypatch.setattr(checks, "MOST_QUADS", 5)
    with pytest.raises(MeshError, match=r"5 quads at most, .* about 6, .*: mesh coarser"):
        read_film(tmp_path / "film.inp", unit="mm", triangles="split")


def test_memory_of_the_machine_counts_where_it_is_known(monkeypatch):
    names = ["SC_PHYS_PAGES", "SC_PAGE_SIZE"]
    monkeypatch.setattr(os, "sysconf", dict(zip(names, (1e6, 1e3), strict=True)).__getitem__)
    checks.check_film_size(1e6, "enlarge size")
    with pytest.raises(MeshError, match=r"this machine's memory of 1 GB, .* which take 1.8 GB: e"):
        checks.check_film_size(2e6, "enlarge size")
    monkeypatch.delattr(os, "sysconf")
    checks.check_film_size(2e6, "enlarge size")


@pytest.mark.parametrize(
    "size", [{"n_arc": 10**6}, {"n_arc": 10**9}, {"radius": 1e12, "n_teeth": 10**6}]
)
def test_a_ring_of_too_many_triangles_is_refused(size):
    with pytest.raises(ToolError, match=r"triangles, 1,000,000 at most: lower n_arc"):
        tooth_ring(**size)


def test_a_tool_is_not_moved_out_of_its_own_precision():
    blade = straight_blade()  # 6 mm high
    assert blade.translated((5e6, 0.0, 0.0)).vertices[:, 0].min() > 4e6
    with pytest.raises(ValueError, match=r"within 1e\+06 times the tool's size of 6 mm"):
        blade.translated((1e9, 0.0, 0.0))


class TestDivided:
    def test_sets_areas_and_orientation_stay(self, tmp_path):
        path = tmp_path / "sheet.inp"
        path.write_text(
            "*NODE\n1, 0., 0.\n2, 3., 0.\n3, 7., 0.5\n4, 0., 2.\n5, 3., 3.\n6, 6., 2.\n"
            "*ELEMENT, TYPE=S4R\n7, 1, 2, 5, 4\n8, 2, 3, 6, 5\n"
            "*NSET, NSET=left\n1, 4\n*ELSET, ELSET=right\n8\n"
        )
        whole, fine = (read_film(path, unit="mm", refine=n) for n in (0, 2))
        assert fine.n_quad == 16 * whole.n_quad
        assert fine.quad_areas().sum() == pytest.approx(whole.quad_areas().sum(), rel=1e-14)
        assert (fine.directors == whole.directors[0]).all()
        left = fine.nodes[fine.node_set("left")]
        assert sorted(left[:, 1]) == [0.0, 0.5, 1.0, 1.5, 2.0]
        assert (left[:, 0] == 0.0).all()
        right = fine.quad_set("right")
        assert fine.quad_areas()[right].sum() == pytest.approx(whole.quad_areas()[1], rel=1e-14)

    def test_a_cylinder_stays_round(self):
        mesh = cylinder(5.0, 4.0, n_around=36, n_along=4)
        fine = divided_in_four(Mesh.from_arrays(mesh.nodes, mesh.quads))
        off = abs(np.hypot(fine.nodes[:, 0], fine.nodes[:, 2]) - 5.0)
        assert off.max() < 4e-5  # of cubics, (turn)^4; chords are 1.9e-2 off

    def test_a_seam_gets_the_same_places_on_both_sides(self):
        n, rows = 18, 5
        closed = cylinder(5.0, 4.0, n_around=n, n_along=rows - 1).nodes.reshape(rows, n, 3)
        nodes = np.concatenate([closed, closed[:, :1]], axis=1)  # opened along one line
        ids = np.arange(rows * (n + 1)).reshape(rows, n + 1)
        corners = (ids[:-1, :-1], ids[:-1, 1:], ids[1:, 1:], ids[1:, :-1])
        fine = divided_in_four(
            Mesh.from_arrays(
                nodes.reshape(-1, 3),
                np.stack(corners, axis=-1).reshape(-1, 4),
                node_sets={"one": ids[:, 0], "other": ids[:, -1]},
            )
        )
        one, other = (fine.nodes[fine.node_set(name)] for name in ("one", "other"))
        assert len(one) == 2 * rows - 1
        np.testing.assert_array_equal(one, other)
        off = abs(np.hypot(fine.nodes[:, 0], fine.nodes[:, 2]) - 5.0)
        assert off.max() < 6e-4  # 0.076 on chords; also beside the seam

    def test_a_fold_stays_sharp(self):
        sheet = rectangle(8.0, 4.0, size=1.0)
        x, y, _ = sheet.nodes.T
        turn, beyond = np.radians(50.0), np.maximum(x - 4.0, 0.0)
        folded = np.stack([x - (1 - np.cos(turn)) * beyond, y, np.sin(turn) * beyond], axis=1)
        fine = divided_in_four(Mesh.from_arrays(folded, sheet.quads))
        x, _, z = fine.nodes.T
        off = np.where(x < 4.0, z, np.sin(turn) * (x - 4.0) - np.cos(turn) * z)
        assert abs(off).max() < 1e-14

    def test_too_many_quads_are_refused(self, tmp_path):
        sheet = rectangle(60.0, 60.0, size=1.0)
        path = written(tmp_path, {"quad": sheet.quads}, sheet.nodes)
        with pytest.raises(MeshError, match="lower refine, or mesh coarser"):
            read_film(path, unit="mm", refine=6)
