"""Films with small quads along the path of the cutting edges."""

import numpy as np
import pytest

from shellcut import ModelFileError, mesh_from_outline, opening_test, read_model
from shellcut.mesh.checks import MeshError
from shellcut.model_file.model import model_text
from shellcut.models.path_film import film_along_path
from shellcut.study.plan import Definition
from shellcut.tool.motion import ScrewMotion, StraightMotion
from shellcut.tool.shapes import straight_blade, tooth_ring

SQUARE = [[-12, -12], [12, -12], [12, 12], [-12, 12]]
SCREW = ScrewMotion.over(angle_deg=30.0, duration=2e-3, pitch=12.0)


def outline_of(rng, kind):
    """Return a random outline about the origin, 14 to 26 mm across, and its holes."""
    if kind == "convex":
        angle = np.arange(9) * 2.0 * np.pi / 9 + rng.uniform(-0.15, 0.15, 9)
        radius = np.full(9, rng.uniform(9.0, 13.0))
    else:
        angle = 2.0 * np.pi * np.arange(240) / 240
        waves, depth = rng.integers(2, 7), rng.uniform(0.05, 0.3)
        radius = rng.uniform(8.0, 12.0) * (1.0 + depth * np.cos(waves * angle + rng.uniform(0, 6)))
    points = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points *= rng.uniform(0.7, 1.0, 2)
    if kind == "L":
        a, b = rng.uniform(8.0, 13.0, 2)
        c, d = rng.uniform(2.0, 6.0, 2)
        points = np.array([[-a, -b], [a, -b], [a, d], [c, d], [c, b], [-a, b]])
    holes = []
    if rng.random() < 0.5:
        n = rng.choice([4, 6, 90])
        around = 2.0 * np.pi * np.arange(n) / n + rng.uniform(0, 1)
        size = rng.uniform(0.4, 1.6)
        at = rng.uniform(-1.5, 1.5, 2)
        holes = [at + size * np.stack([np.cos(around), np.sin(around)], axis=1)]
    return points, holes


def random_case(seed):
    """Return outline and what film_along_path takes beside it."""
    rng = np.random.default_rng(seed)
    outline, holes = outline_of(rng, ("convex", "wavy", "L")[seed % 3])
    size = float(rng.choice([0.8, 0.5, 0.3]))
    reach = float(np.abs(outline).max(axis=0).min())
    move = seed // 3 % 3
    if move == 2:
        tool = straight_blade(height=4.0).translated((-1.3 * reach, rng.uniform(-2, 2), 0.0))
        motion = StraightMotion([1.0, rng.uniform(-0.3, 0.3), 0.0], speed=1e4)
        duration = 1e-4 * reach * rng.uniform(0.6, 3.0)
    else:
        tool = tooth_ring(
            n_teeth=int(rng.integers(1, 5)),
            radius=reach * rng.uniform(0.4, 0.95),
            phase_deg=rng.uniform(0, 90),
            edge_inclination_deg=rng.uniform(60, 90),
        )
        pitch = rng.uniform(4.0, 16.0) if move else 0.0
        tool = tool if move else tool.translated((0.0, 0.0, -2.0))
        motion = ScrewMotion.over(angle_deg=rng.uniform(20, 120), duration=1e-3, pitch=pitch)
        duration = 1e-3
    given = {"tool": tool, "motion": motion, "duration": duration, "size_at_path": size}
    return outline, given | {"holes": holes}


@pytest.fixture
def gmsh():
    return pytest.importorskip("gmsh", exc_type=ImportError)


SLOW = [pytest.param(seed, marks=pytest.mark.slow) for seed in range(9, 60)]


@pytest.mark.parametrize("seed", [*range(9), *SLOW])
def test_random_outlines_teeth_and_motions_give_sound_quads(gmsh, seed):
    outline, given = random_case(seed)
    film = film_along_path(outline, **given)
    assert film.scaled_jacobian().min() >= 0.45
    # Nodes of a smooth outline lie on it, and not on its vertices: chords cut off some area.
    assert film.quad_areas().sum() == pytest.approx(area_of(outline, given["holes"]), rel=0.03)
    sides = film.edge_lengths()
    assert sides.min() > 0.3 * given["size_at_path"]
    assert sides.max() < 13.0 * given["size_at_path"]


def area_of(outline, holes):
    x, y = np.asarray(outline).T
    own = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    return own - sum(area_of(hole, ()) for hole in holes)


def test_sides_rise_with_the_distance_from_the_points_and_borders_fit_them(gmsh):
    line = np.stack([np.linspace(-12.0, 12.0, 200), np.full(200, 4.0)], axis=1)
    film = mesh_from_outline(SQUARE, size=3.0, near=line, size_near=0.3)
    centre = film.nodes[film.quads].mean(axis=1)
    side, off = np.sqrt(film.quad_areas()), abs(centre[:, 1] - 4.0)
    wanted = np.clip(0.3 + 0.25 * (off - 0.3), 0.3, 3.0)
    assert np.median(side[off < 0.5]) == pytest.approx(0.3, rel=0.15)
    assert np.percentile(side / wanted, [5, 50, 95]) == pytest.approx([0.8, 1.0, 1.2], abs=0.15)
    rim = film.node_set("rim")
    assert set(rim) == set(film.boundary_nodes())
    assert len(rim) % 2 == 0
    ends = film.nodes[np.append(rim, rim[0])]
    length, middle = np.linalg.norm(np.diff(ends, axis=0), axis=1), 0.5 * (ends[1:] + ends[:-1])
    upright = abs(middle[:, 0]) == 12.0
    close = upright & (abs(middle[:, 1] - 4.0) < 0.5)
    assert length[close].max() < 0.45
    assert length[upright & (middle[:, 1] < -8.0)].min() > 1.5


def test_a_small_hole_is_round_in_a_coarse_part_of_the_film(gmsh):
    angle = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
    hole = 1.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1) - 9.0
    film = mesh_from_outline(SQUARE, size=3.0, holes=[hole], near=[[9.0, 9.0]], size_near=0.5)
    assert len(film.node_set("hole_1")) >= 16
    assert film.scaled_jacobian().min() > 0.45


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"near": [[0, 0]]}, "near and size_near belong together"),
        ({"near": [[0, 0]], "size_near": 2.0}, "size_near must be at most size, 1 mm, got 2 mm"),
        ({"near": [0, 0], "size_near": 0.1}, r"near must be points of shape \(n, 2\), got"),
        ({"near": [[0, np.inf]], "size_near": 0.1}, "near must be finite"),
        ({"near": [[0, 0]], "size_near": 1e-6}, "outline and holes must have 50,000 quad sides"),
    ],
)
def test_fields_that_cannot_be_are_refused(given, words):
    with pytest.raises(ValueError, match=words):
        mesh_from_outline(SQUARE, size=1.0, **given)


def test_a_film_is_moved_before_it_is_meshed_along_the_path_of_the_tool(gmsh):
    asked = {"membrane.radius": 13.0, "membrane.size_at_path": 0.8}
    mesh = read_model("opening", {**asked, "membrane.shift": [2.0, -1.0, -0.5]}).parts().mesh
    rim = mesh.nodes[mesh.node_set("rim")]
    np.testing.assert_allclose(rim.max(axis=0) + rim.min(axis=0), [4.0, -2.0, -1.0], atol=0.02)
    centre = mesh.nodes[mesh.quads].mean(axis=1)
    side = np.sqrt(mesh.quad_areas())
    on_path = np.abs(np.hypot(centre[:, 0], centre[:, 1]) - 9.4) < 0.4
    middle = np.hypot(centre[:, 0], centre[:, 1]) < 2.0
    assert np.median(side[on_path]) < 1.0 < 1.5 < np.median(side[middle])


def test_one_film_is_fine_under_the_paths_of_all_tools(gmsh):
    teeth = [tooth_ring(radius=r) for r in (4.0, 9.4)]
    common = {"motion": SCREW, "duration": 2e-3, "size_at_path": 0.5}
    film = film_along_path(11.0, tool=teeth, **common)
    one = film_along_path(11.0, tool=teeth[0], **common)

    def side_at(film, radius):
        centre = film.nodes[film.quads].mean(axis=1)
        radii, angle = np.hypot(*centre[:, :2].T), np.arctan2(centre[:, 1], centre[:, 0])
        # Teeth begin at 0 and turn by 30 degrees.
        on = (abs(radii - radius) < 0.7) & (angle > 0.0) & (angle < np.radians(30.0))
        return np.median(np.sqrt(film.quad_areas()[on]))

    assert [side_at(film, r) for r in (4.0, 9.4)] == pytest.approx([0.5, 0.5], rel=0.15)
    assert side_at(one, 4.0) == pytest.approx(0.5, rel=0.15)
    assert side_at(one, 9.4) > 1.0


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"outline": 0.0}, "the radius must be positive and finite, got 0 mm"),
        ({"outline": 5.0}, "no cutting edge passes through the film during the motion: check"),
        ({"size": 0.1}, "size must be size_at_path or more, 0.4 mm, got 0.1 mm: enlarge size"),
        ({"holes": [[[0, 0], [30, 0], [0, 30]]]}, "holes must lie inside the outline"),
    ],
)
def test_films_that_cannot_be_along_a_path_are_refused(given, words):
    film = {"outline": 11.0, "tool": tooth_ring(), "motion": SCREW, "duration": 2e-3}
    with pytest.raises(MeshError, match=words):
        film_along_path(**film | given)


def two_caps(folder):
    """Write teeth on two radii; return the files."""
    caps = [str(folder / f"cap_{radius}.stl") for radius in (4, 9)]
    for cap, radius in zip(caps, (4.0, 9.4), strict=True):
        tooth_ring(radius=radius).write(cap)
    return caps


def test_tools_that_are_compared_cut_one_film(gmsh, tmp_path):
    caps, size = two_caps(tmp_path), {"membrane.radius": 11, "membrane.size_at_path": 0.8}
    planned = Definition("opening", {"tool.file": caps}, {**size, "tool.unit": "mm"}).plan()
    models = [planned.model_of(run) for run in planned.runs]
    assert [model.sections["membrane"].tools for model in models] == [tuple(caps)] * 2
    films = [model.parts().mesh for model in models]
    np.testing.assert_array_equal(films[0].nodes, films[1].nodes)
    alone = film_of_model({**size, "tool.unit": "mm", "tool.file": caps[1]})
    assert alone.n_quad < films[0].n_quad


@pytest.mark.parametrize("given", [{"membrane.n_side": 18}, {"membrane.tools": "first"}])
def test_a_film_is_shared_only_if_it_is_meshed_along_paths_and_nothing_is_given(tmp_path, given):
    caps = two_caps(tmp_path)
    given = {key: [caps[0]] if key == "membrane.tools" else one for key, one in given.items()}
    settings = {"membrane.radius": 11, "tool.unit": "mm", **given}
    planned = Definition("opening", {"tool.file": caps}, settings).plan()
    tools = planned.model_of(planned.runs[1]).sections["membrane"].tools
    assert tools == tuple(given.get("membrane.tools", ()))


def test_a_tool_that_is_among_those_of_its_film_is_written_and_read(tmp_path):
    caps, used = two_caps(tmp_path), tmp_path / "used.toml"
    keys = {"membrane.radius": 11, "tool.unit": "mm", "tool.file": caps[0], "membrane.tools": caps}
    used.write_text(model_text(read_model("opening", keys)), encoding="utf-8")
    again = read_model(used)
    assert sorted(again.recorded) == sorted(caps)
    assert again.changed_files() == []


def film_of_model(keys):
    return read_model("opening", keys).parts().mesh


def test_films_of_model_files(gmsh):
    default = film_of_model({"mesh": "path"})
    assert 700 < default.n_quad < 1000  # 922: the whole circle, at 0.4 mm
    np.testing.assert_array_equal(opening_test("path").simulation.mesh.nodes, default.nodes)
    assert film_of_model({"mesh": "path", "membrane.size_at_path": 0.8}).n_quad < 450
    large = {"membrane.radius": 15, "tool.radius": 13.4}
    hole = {"membrane.size_at_path": 0.8, "membrane.holes": [[[-1, -1], [1, -1], [1, 1], [-1, 1]]]}
    disc = film_of_model(large | hole)
    radii = np.hypot(*disc.nodes[disc.node_set("rim"), :2].T)
    assert radii == pytest.approx(15.0, rel=1e-5)  # the polygon of 1,024 sides
    assert "hole_1" in disc.node_sets
    assert film_of_model(large | {"membrane.n_side": 18}).n_quad == 468  # structured
    plain = film_of_model({"membrane.outline": SQUARE, "membrane.size": 1.5})
    np.testing.assert_array_equal(plain.nodes, mesh_from_outline(SQUARE, size=1.5).nodes)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"size_at_path": 0.4}, "size_at_path is for a disc meshed by Gmsh, but"),
        ({"radius": 9, "n_layer": 4}, "n_layer needs n_side; without both"),
        ({"radius": 9, "n_side": 9, "size": 1}, "size is for a disc meshed by Gmsh, but n_side"),
        ({"file": __file__, "size_at_path": 0.4}, "films that Gmsh meshes .* leave it out, or set"),
        ({"radius": 9, "tools": [__file__]}, "tools are files read as .tool. file is"),
        ({"radius": 9, "tools": ["gone.stl"]}, "membrane..tools: there is no file .*gone.stl"),
    ],
)
def test_keys_that_do_not_go_together(given, words):
    with pytest.raises(ModelFileError, match=words):
        read_model("opening", {f"membrane.{name}": one for name, one in given.items()}).build()


@pytest.mark.parametrize(("size", "told"), [(1.5, True), (0.4, False)])
def test_sides_too_long_to_fold_are_distrusted_with_the_size_to_set(gmsh, size, told):
    keys = {"membrane.radius": 10.2, "membrane.size": size, "motion.angle_deg": 20}
    case = read_model("opening", keys).build()
    found = [one for one in map(str, case.check.doubts) if "bending lengths" in one]
    assert bool(found) == told
    assert all("set membrane.size_at_path = 0.4" in one for one in found)
