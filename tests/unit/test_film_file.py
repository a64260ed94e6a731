"""From a file's cells to a film: units, triangles, orientation, names, all that is said."""

import logging

import meshio
import numpy as np
import pytest

from known_film import LEFT, NODES, QUADS, check_geometry
from shellcut.formats.errors import FileError
from shellcut.mesh.film_file import read_film
from shellcut.mesh.mesh import MeshError

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
    def test_are_refused_with_their_count_and_ids(self, tmp_path):
        with pytest.raises(FileError, match=r"got 2 triangles beside 9 quads \(ids 9, 10\)"):
            read_film(written(tmp_path, MIXED), unit="mm")

    def test_are_split_by_choice(self, tmp_path, caplog):
        part = [np.zeros(9, np.int32), np.array([1, 1], np.int32)]
        left = np.isin(np.arange(18), LEFT).astype(np.int32)
        path = written(tmp_path, MIXED, point_data={"left": left}, cell_data={"corner": part})
        mesh = read_film(path, unit="mm", triangles="split")
        assert mesh.n_quad == 4 * 9 + 3 * 2
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


def test_quads_against_their_neighbours_are_turned(tmp_path, caplog):
    quads = QUADS.copy()
    quads[[1, 4, 5]] = quads[[1, 4, 5]][:, ::-1]
    mesh = read_film(written(tmp_path, {"quad": quads}), unit="mm")
    check_geometry(mesh)
    assert (mesh.directors[:, 2] == 1.0).all()
    assert "3 of 10 quads are turned over" in caplog.text


def test_a_good_file_with_its_unit_says_nothing(tmp_path, caplog):
    with caplog.at_level(logging.DEBUG):
        read_film(written(tmp_path, {"quad": QUADS}), unit="mm")
    assert not caplog.records


def test_a_moebius_strip_is_refused_with_its_place(tmp_path):
    n = 24
    angle = 2.0 * np.pi * np.arange(n) / n
    side = 0.5 * np.stack(
        [np.cos(angle) * np.cos(angle / 2), np.sin(angle) * np.cos(angle / 2), np.sin(angle / 2)], 1
    )
    middle = 5.0 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    low, high = np.arange(n), n + np.arange(n)
    ends = np.roll(low, -1), np.roll(high, -1)
    ends[0][-1], ends[1][-1] = high[0], low[0]
    quads = np.stack([low, ends[0], ends[1], high], axis=1)
    path = written(tmp_path, {"quad": quads}, np.concatenate([middle - side, middle + side]))
    with pytest.raises(FileError, match="a sheet must have two sides, got 24 quads around"):
        read_film(path)


def test_a_mesh_that_is_no_film_names_the_file(tmp_path):
    nodes = NODES.copy()
    nodes[17, 2] = 50.0
    path = written(tmp_path, {"quad": QUADS}, nodes)
    with pytest.raises(MeshError, match=rf"{path} holds no film \(ids count from 0"):
        read_film(path)


def test_t_joints_are_refused(tmp_path):
    nodes = np.concatenate([NODES, NODES[:6] + np.array([0.0, 0.0, 1.0])])
    wall = np.array([[0, 1, 19, 18]])
    path = written(tmp_path, {"quad": np.concatenate([QUADS, wall])}, nodes)
    with pytest.raises(MeshError, match="normals of neighbouring quads"):
        read_film(path, unit="mm")
    inside = np.array([[6, 7, 19, 18]])
    path = written(tmp_path, {"quad": np.concatenate([QUADS, inside])}, nodes)
    with pytest.raises(MeshError, match="one or two quads"):
        read_film(path, unit="mm")


def test_a_film_in_space(tmp_path):
    turn = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])
    mesh = read_film(written(tmp_path, {"quad": QUADS}, NODES @ turn.T), unit="mm")
    np.testing.assert_allclose(mesh.directors, np.tile(turn[:, 2], (18, 1)), atol=1e-14)
