"""Meshes that no run could take are refused before a node of them is made."""

import pytest

from shellcut.mesh import film_size
from shellcut.mesh.film_file import read_film
from shellcut.mesh.mesh import MeshError
from shellcut.mesh.outline import mesh_from_outline
from shellcut.mesh.structured import annulus, cylinder, disc, rectangle
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.tool import ToolError

SHEET = [(0, 0), (10, 0), (10, 6), (0, 6)]
LONG = [(0, 0), (1e5, 0), (1e5, 0.5), (0, 0.5)]

MAKERS = {
    "sheet by size": (lambda: rectangle(6e9, 4.0, size=0.4), "about 150,000,000,000, which take"),
    "sheet without end": (
        lambda: rectangle(1e200, 1e200, size=1e-200),
        "about inf, which take inf",
    ),
    "sheet by counts": (lambda: rectangle(1.0, 1.0, n_x=9000, n_y=9000), "81,000,000, .* 73.1 GB"),
    "a count alone": (
        lambda: rectangle(1.0, 1.0, n_x=10**400, n_y=1),
        "n_x must be from 1 to 10,000,000",
    ),
    "disc": (lambda: disc(5.0, n_side=5000), "about 31,840,000, .* lower n_side or n_layer"),
    "disc of layers": (lambda: disc(5.0, n_side=99, n_layer=10**6), "about 396,009,801"),
    "ring": (
        lambda: annulus(1.0, 2.0, n_around=10**6, n_radial=75),
        "about 75,000,000, .* 67.7 GB",
    ),
    "roof": (lambda: cylinder(1.0, 2.0, n_around=10**6, n_along=75), "lower n_around or n_along"),
    "outline": (lambda: mesh_from_outline(SHEET, size=1e-3), "about 60,000,000, .* enlarge size"),
    "long outline": (lambda: mesh_from_outline(LONG, size=1.0), "50,000 edges of a size around at"),
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
    monkeypatch.setattr(film_size, "MOST_QUADS", 5)
    with pytest.raises(MeshError, match=r"5 quads at most, .* about 6, .*: mesh coarser"):
        read_film(tmp_path / "film.inp", unit="mm", triangles="split")


def test_memory_of_the_machine_counts_where_it_is_known(monkeypatch):
    monkeypatch.setattr(film_size, "_memory", lambda: 1e9)
    film_size.check_film_size(1e6, "enlarge size")
    with pytest.raises(MeshError, match=r"this machine's memory of 1 GB, .* which take 1.8 GB: e"):
        film_size.check_film_size(2e6, "enlarge size")
    monkeypatch.setattr(film_size, "_memory", lambda: None)
    film_size.check_film_size(2e6, "enlarge size")


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
