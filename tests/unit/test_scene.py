"""Pictures and movies: the renderer's geometry, what a scene shows, fields and their scales."""

import dataclasses
import itertools
import subprocess
import sys

import numpy as np
import pytest

import shellcut
from opening_frame import EDGE_COLOR, RADIUS, opening_frame
from run_folder import write_run
from shellcut import CohesiveLaw, guillotine
from shellcut.command_line import main
from shellcut.frame import Frame
from shellcut.unit import showing
from shellcut.view import Look, draw_movie, draw_scene, movie, snapshot
from shellcut.view._raster import LAMP, Camera, Canvas, view_axes
from shellcut.view.look import at_corners, field_limits, fields_of
from shellcut.view.snapshot import close_camera, tooth_ball, whole_camera

pillow = pytest.importorskip("PIL.Image", reason="needs shellcut-fem[plot]")
pytest.importorskip("matplotlib", reason="needs shellcut-fem[plot]")

FRAMES = [opening_frame(angle, n_side=10) for angle in (5.0, 25.0, 45.0)]
SIZE = (480, 320)
RED, BLUE = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
CORNER = np.array([[[0.0, 0, 0], [40, 0, 0], [0, 40, 0]]])
"""A triangle over half of a picture of 40 x 40 pixels."""


def pixels(path):
    with pillow.open(path) as picture:
        return np.asarray(picture.convert("RGB")) / 255.0


def near(image, color, tolerance=0.12):
    """Return how many pixels have about a colour."""
    return int((np.abs(image - np.asarray(color)).max(axis=-1) < tolerance).sum())


def membrane_only():
    """A frame without tool and cut."""
    frame = opening_frame(0.0, n_side=6)
    left_out = ("tool", "edge", "cable", "crack", "scalar")
    names = [f.name for f in dataclasses.fields(Frame) if not f.name.startswith(left_out)]
    return Frame(**{name: getattr(frame, name) for name in names})


class TestCanvas:
    def test_depth_is_that_of_the_plane_for_any_size_and_orientation(self):
        rng = np.random.default_rng(5)
        corners = rng.uniform(0.0, 1.0, size=(40, 3, 3)) * [60.0, 50.0, 9.0]
        canvas = Canvas((50, 60))
        canvas.draw(corners, RED)
        # slow reference: every pixel against every triangle
        y, x = np.divmod(np.arange(50 * 60), 60)
        wanted = np.full(50 * 60, -np.inf)
        for triangle in corners:
            matrix = np.vstack((triangle[:, :2].T, np.ones(3)))
            weight = np.linalg.solve(matrix, np.stack((x + 0.5, y + 0.5, np.ones(len(x)))))
            inside = (weight >= 0.0).all(axis=0)
            wanted[inside] = np.maximum(wanted[inside], (triangle[:, 2] @ weight)[inside])
        # Round-off of single precision, of depths up to 9 pixels.
        np.testing.assert_allclose(canvas.depth, wanted, rtol=0.0, atol=9.0 * 2.0**-23)

    def test_values_run_from_corner_to_corner_and_light_follows_the_normal(self):
        greys = np.linspace(0.0, 1.0, 256)[:, None] * np.ones(3)
        canvas = Canvas((40, 40))
        canvas.draw(CORNER, greys, np.array([[0.0, 1.0, 0.5]]))
        y, x = np.divmod(np.arange(40 * 40), 40)
        wanted = ((x + 0.5) + 0.5 * (y + 0.5)) / 40.0  # slow reference: barycentric
        seen = np.isfinite(canvas.depth)
        assert seen.sum() > 700
        np.testing.assert_allclose(canvas.color[seen, 0], wanted[seen], atol=0.5 / 255.0 + 1e-6)

        def bright(normal):
            lit = Canvas((40, 40))
            lit.draw(CORNER, 0.5 * np.ones(3), normals=np.tile(normal, (1, 3, 1)))
            return float(lit.color[0, 0])

        aside = np.array([0.3, -0.2, 0.9])
        assert bright(3.0 * LAMP) > bright([0.0, 0.0, 1.0]) > bright(aside)
        # The film has two sides alike; the length of a normal does not matter.
        for factor in (-1.0, 7.0):
            assert bright(factor * aside) == pytest.approx(bright(aside), rel=1e-6)

    def test_a_shadow_falls_where_the_lamp_does_not_see(self):
        square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
        ground, lid = 10.0 * square, square + np.array([0.0, 0.0, 3.0])
        camera = Camera(np.eye(3), np.zeros(3), 10.0, (200, 200))
        lamp = Camera(view_axes(LAMP, np.array([0.0, 1.0, 0.0])), np.zeros(3), 10.0, (400, 400))
        fan = np.array([[0, 1, 2], [0, 2, 3]])
        canvas, seen = Canvas(camera.shape), Canvas(lamp.shape)
        canvas.draw(camera.project(ground[fan]), np.ones(3))
        for part in (ground, lid):
            seen.draw(lamp.project(part[fan]), np.zeros(3))
        canvas.darken(camera, lamp, seen)
        y, x = np.divmod(np.arange(200 * 200), 200)
        at = camera.points(np.stack((x + 0.5, y + 0.5, canvas.depth), axis=1))
        # slow reference: where the ray to the lamp meets the plane of the lid
        over = at + LAMP / LAMP[2] * 3.0
        inside = np.abs(over[:, :2]).max(axis=1)
        dark = canvas.color[:, 0] < 0.99
        assert dark[inside < 0.5].all()
        # The lid ends at 1; its soft rim is four pixels of 0.1 mm wide, drawn out by 1 / 0.66.
        assert not dark[inside > 1.0 + 0.4 / LAMP[2]].any()
        np.testing.assert_allclose(camera.project(at)[:, :2], np.stack((x + 0.5, y + 0.5), 1))

    def test_a_layer_shows_only_in_front_unless_through(self):
        sheet = np.array([[[0.0, 0, 0], [8, 0, 0], [0, 8, 0]]])
        for offset, through, seen in ((1, False, 1), (-1, False, 0), (-1, True, 1)):
            canvas, layer = Canvas((4, 4)), Canvas((4, 4))
            canvas.draw(sheet, RED)
            layer.draw(sheet + np.array([0, 0, offset]), BLUE)
            canvas.blend(layer, 0.5, through=through)
            np.testing.assert_allclose(canvas.color[0], 0.5 * (RED + BLUE) if seen else RED)

    def test_lines_have_their_width_and_nothing_is_drawn_of_nothing(self):
        canvas = Canvas((20, 40))
        ends = np.array([[[5.0, 10.0, 0], [35, 10, 0]], [[20.0, 4, 0], [20, 4, 0]]])
        canvas.draw_lines(ends, BLUE, 4.0)
        drawn = np.isfinite(canvas.depth).reshape(20, 40)
        assert drawn[:, 30].sum() == 4
        assert drawn[2:6, 18:22].all()  # a segment without length is a dot
        canvas = Canvas((4, 4))
        canvas.draw(np.zeros((0, 3, 3)), RED)
        canvas.draw_lines(np.zeros((0, 2, 3)), RED, 2.0)
        canvas.draw(np.full((1, 3, 3), 99.0), RED)  # outside, and without area
        assert np.isinf(canvas.depth).all()


@pytest.mark.parametrize("toward", [(1.0, 2.0, 3.0), (0.0, 0.0, 1.0), (0.0, 0.0, -2.0)])
def test_camera_axes_are_a_right_handed_frame(toward):
    axes = view_axes(np.array(toward), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) > 0.0
    np.testing.assert_allclose(axes[2], toward / np.linalg.norm(toward))


def test_projection_puts_the_centre_in_the_middle_and_up_on_top():
    axes = view_axes(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    camera = Camera(axes, np.array([1.0, 2.0, 3.0]), 10.0, (80, 100))
    at = camera.project(np.array([[1.0, 2, 3], [2.0, 2, 3], [1.0, 2, 4], [1.0, 1, 3]]))
    np.testing.assert_allclose(at, [[50, 40, 0], [60, 40, 0], [50, 30, 0], [50, 40, 10]])


@pytest.mark.parametrize("angle", [0.0, 30.0, 80.0])
def test_the_close_camera_goes_with_the_tooth_and_shows_all_of_it(angle):
    frame = opening_frame(angle, n_side=10)
    centre, radius = tooth_ball(frame)
    tooth = frame.tool_points[frame.tool_triangles[frame.tool_tooth == 1]].reshape(-1, 3)
    assert np.linalg.norm(tooth - centre, axis=1).max() < radius
    # One scale for all pictures of a run.
    assert radius == pytest.approx(tooth_ball(opening_frame(20.0, n_side=10))[1], rel=1e-6)
    whole = whole_camera([frame], (300, 400), Look(), [(centre, radius)])
    height, width = whole.shape
    x, y, _ = whole.project(centre)
    assert whole.scale * radius < min(x, y, width - x, height - y)
    camera = close_camera(frame, whole, (300, 400))
    np.testing.assert_array_equal(camera.axes, whole.axes)
    assert camera.scale > whole.scale
    assert np.linalg.norm(camera.centre[:2]) == pytest.approx(RADIUS, abs=0.5)
    # most cables of this tooth, and its edge, are in the picture
    near_tooth = np.linalg.norm(frame.cable_segments.mean(axis=1) - camera.centre, axis=1) < 2.0
    shown = np.concatenate((frame.edge_points[:12], frame.cable_segments[near_tooth]))
    at = camera.project(shown.reshape(-1, 3))[:, :2]
    assert ((at > 0) & (at < [800, 600])).all(axis=1).mean() > 0.9


def test_a_snapshot_shows_cables_edges_and_tool(tmp_path):
    frame = opening_frame(45.0)
    left_out = ("cable_", "tool_triangles", "tool_tooth", "crack_edges")
    names = [f.name for f in dataclasses.fields(Frame) if f.name.startswith(left_out)]
    uncut = dataclasses.replace(frame, **{name: getattr(frame, name)[:0] for name in names})
    orange, blue, flanks = (1.0, 0.55, 0.0), (0.0, 0.75, 1.0), (0.05, 0.05, 0.05)
    counts = []
    for shown in (frame, uncut):
        draw_scene(tmp_path / "snap.png", shown, close_up=True, size=(800, 400))
        image = pixels(tmp_path / "snap.png")
        assert image.shape == (400, 800, 3)
        right = image[50:350, 455:785]
        counts.append([near(right, color, 0.15) for color in (orange, blue, EDGE_COLOR, flanks)])
    drawn, missing = counts
    # measured 357, 20, 72, 288 and 0, 0, 54, 158 (the scale bar and its text)
    assert drawn[0] > 200
    assert drawn[1] > 10
    assert min(drawn[2], missing[2]) > 40
    assert drawn[3] > missing[3] + 80
    assert missing[0] < 0.1 * drawn[0]  # yellow film
    assert missing[1] == 0


@pytest.mark.parametrize("colormap", ["viridis", "turbo"])
def test_light_keeps_the_hue_of_the_map(colormap):
    rng = np.random.default_rng(3)
    for color in Look(colormap=colormap).colors()[::16]:
        canvas = Canvas((40, 40))
        canvas.draw(CORNER, color, normals=rng.normal(size=(1, 3, 3)))
        seen = canvas.color[np.isfinite(canvas.depth)]
        assert seen.max() <= 1.0 + 1e-6
        factor = seen @ color / (color @ color)
        np.testing.assert_allclose(seen, factor[:, None] * color, atol=1e-6)
        assert np.ptp(factor) > 0.05


def test_a_membrane_alone_is_drawn_in_one_panel_and_what_cannot_be_written_is_refused(tmp_path):
    path = tmp_path / "snap.png"
    draw_scene(path, membrane_only(), close_up=True, size=(360, 240))
    assert (pixels(path)[60:200, 100:260] < 0.99).any(axis=2).mean() > 0.8
    path.unlink()
    with pytest.raises(ValueError, match=r"ends with \.png, .*a page's with \.html; got 'a\.xyz'"):
        draw_scene(tmp_path / "a.xyz", membrane_only())
    with pytest.raises(ValueError, match=r"at least 160 x 160 pixels, got \(10, 10\)"):
        draw_scene(path, membrane_only(), size=(10, 10))
    assert list(tmp_path.iterdir()) == []


def no_process():
    raise OSError


def test_the_scale_of_a_run_ends_at_its_strength_in_the_unit_shown(tmp_path, monkeypatch):
    ends = []
    monkeypatch.setattr(
        "shellcut.view.snapshot.add_color_bar",
        lambda _figure, _look, limits, _shown, _box, label: ends.append((*limits, label)),
    )
    monkeypatch.setattr("shellcut.recording.pictures.Child", no_process)  # drawn here
    monkeypatch.setattr("shellcut.recording.pictures._idle", [])
    strip = {"length": 6.0, "width": 4.0, "notch": 1.0, "travel": 0.2, "speed": 8000.0}
    case = guillotine(1.0, **strip, law=CohesiveLaw(strength=12.0))
    with showing("in, lbf"):
        case.run(tmp_path / "run", n_snapshot=1, curves=False, progress=False)
    low, high, label = ends[0]
    assert low == 0.0
    assert high == pytest.approx(12.0 * 145.0377, rel=1e-6)
    assert label == "largest principal stress [lbf/in²]"


# Of the film's largest stress in viridis.
YELLOW = (0.95, 0.9, 0.2)


@pytest.mark.parametrize(
    ("look", "color", "least", "most"),
    [
        # Share of the picture that has the colour.
        ({}, YELLOW, 0.1, 0.9),
        ({"field": "largest principal, bottom"}, YELLOW, 0.0, 0.01),
        ({"colormap": "inferno"}, YELLOW, 0.0, 0.01),
        ({"high": 1000.0}, YELLOW, 0.0, 0.01),
        ({"hide": ["film"]}, YELLOW, 0.0, 0.01),
        ({"zoom": 0.3}, YELLOW, 0.005, 0.08),
        ({}, EDGE_COLOR, 2e-4, 0.1),
        ({"hide": ["edges"]}, EDGE_COLOR, 0.0, 1e-4),
    ],
)
def test_a_look_is_kept(tmp_path, look, color, least, most):
    top = np.tile([18.0, 0.0], (len(FRAMES[2].quads), 1))
    strained = dataclasses.replace(FRAMES[2], quad_principal_top=top)
    whole = {"field": "largest principal, top", "low": 0.0, "high": 18.0} | look
    draw_scene(tmp_path / "s.png", strained, look=Look(**whole), size=SIZE)
    drawn = pixels(tmp_path / "s.png")[35:260]
    assert least <= near(drawn, color, 0.2) / drawn[..., 0].size <= most


def test_parts_hide_what_they_name(tmp_path):
    def drawn(*hide):
        draw_scene(tmp_path / "s.png", FRAMES[2], look=Look(hide=hide), size=SIZE)
        return pixels(tmp_path / "s.png")[35:260]

    whole = drawn()
    for part in ("tool", "mesh", "flanks", "cables"):
        assert (np.abs(drawn(part) - whole).max(axis=2) > 0.02).sum() > 40, part


@pytest.mark.parametrize("of", ["quad", "node"])
def test_smooth_colours_run_from_node_to_node_and_not_across_a_crack(of):
    frame = FRAMES[2]
    n, name = (len(frame.quads), "thickness") if of == "quad" else (len(frame.points), "speed")
    values = np.random.default_rng(3).uniform(size=n)
    field = dataclasses.replace(fields_of(frame)[name], values=lambda _: values)
    smooth, flat = (at_corners(field, frame, smooth) for smooth in (True, False))
    for node in frame.crack_edges[0].ravel():  # of one flank: the mean of its own quads
        at = frame.quads == node
        mean = values[at.any(axis=1)].mean() if of == "quad" else values[node]
        np.testing.assert_allclose(smooth[at], mean)
    assert np.ptp(flat, axis=1).max() == 0.0
    own = values if of == "quad" else values[frame.quads].mean(axis=1)
    np.testing.assert_allclose(flat[:, 0], own)


@pytest.mark.parametrize(
    ("arrays", "sign", "limits"),
    [
        ([np.zeros(9)], 0, (0.0, 1.0)),
        ([np.array([]), np.array([])], 0, (0.0, 1.0)),
        ([np.full(3, 5.0)], 0, (0.0, 5.0)),
        ([np.full(4000, 1.0), np.append(np.zeros(4000), 1e3)], 1, (0.0, 1.0)),
        ([np.array([-3.0, 0.1])], -1, (-3.0, 0.0)),
        ([-np.ones(9)], 1, (0.0, 1.0)),
        # Of 100 values to 14.4 nearly all.
        ([np.linspace(3.0, 14.4, 100)], 1, (0.0, 15.0)),
    ],
)
def test_scales_are_round_and_enclose_nearly_all_numbers_of_all_frames(arrays, sign, limits):
    assert field_limits(arrays, sign) == limits


def test_names_and_limits_of_fields():
    principal = np.tile([4.0, -12.0], (len(FRAMES[0].quads), 1))
    frame = dataclasses.replace(FRAMES[0], quad_principal=principal)
    # sqrt(16 + 48 + 144) = 14.42
    np.testing.assert_allclose(Look(field="von Mises").field_of(frame).values(frame), np.sqrt(208))
    damaged = dataclasses.replace(frame, quad_history={"damage [-]": principal[:, 0]})
    damage = fields_of(damaged)["damage"]
    assert (damage.unit, damage.of) == ("-", "quad")
    smallest = Look(field="smallest principal").field_of(frame)
    values = [smallest.values(frame)]
    assert Look().limits_for(values, smallest.sign) == (-15.0, 0.0)
    assert Look(high=5.0).limits_for(values, smallest.sign) == (-15.0, 5.0)
    for wrong, said in [
        ({"field": "tresca"}, r"von Mises.*got 'tresca'"),
        ({"colormap": "no"}, r"such as viridis.*got 'no'"),
        ({"low": 7.0, "high": 7.0}, "low must be below high, got 7 and 7"),
    ]:
        with pytest.raises(ValueError, match=said):
            draw_scene("never.png", frame, look=Look(**wrong))
    wrong = r"hide must be .*got \['shaft'\](.|\n)*elevation must be(.|\n)*zoom must be positive"
    with pytest.raises(ValueError, match=wrong):
        Look(hide=["shaft"], elevation=91.0, zoom=0.0)


@pytest.mark.parametrize("name", ["cut.gif", "cut.webp"])
def test_a_gif_and_a_webp_have_all_frames(tmp_path, name):
    draw_movie(tmp_path / name, FRAMES, size=SIZE, fps=5.0)
    with pillow.open(tmp_path / name) as movie:
        assert (movie.n_frames, movie.size) == (3, SIZE)
        shown = []
        for k in range(3):
            movie.seek(k)
            shown.append(np.asarray(movie.convert("RGB"), dtype=float))
            assert movie.info["duration"] == 200
    assert min(np.abs(a - b).mean() for a, b in itertools.pairwise(shown)) > 0.5


def test_an_mp4_has_all_frames(tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="needs shellcut-fem[movie]")
    draw_movie(tmp_path / "cut.mp4", FRAMES, size=SIZE)
    ffmpeg = imageio_ffmpeg.get_ffmpeg_exe()
    told = subprocess.run([ffmpeg, "-i", tmp_path / "cut.mp4"], capture_output=True, text=True)
    assert "h264" in told.stderr
    assert "480x320" in told.stderr
    raw = ["-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    read = subprocess.run([ffmpeg, "-i", tmp_path / "cut.mp4", *raw], stdout=subprocess.PIPE)
    shown = np.frombuffer(read.stdout, np.uint8).reshape(-1, 320, 480, 3).astype(float)
    assert len(shown) == 3
    assert min(np.abs(a - b).mean() for a, b in itertools.pairwise(shown)) > 0.5


def test_every_image_of_a_movie_is_the_still_of_its_frame(tmp_path, monkeypatch):
    # The first has neither flanks nor cables: parts of the scene come while the movie runs.
    frames = [opening_frame(0.0, n_side=10), FRAMES[1]]
    made, kept = [], []
    count = snapshot.whole_camera
    monkeypatch.setattr(snapshot, "whole_camera", lambda *of: made.append(1) or count(*of))

    def keep(path, images, *_):
        kept.extend(images)
        path.touch()

    monkeypatch.setitem(movie.MOVIES, ".gif", keep)
    draw_movie(tmp_path / "cut.gif", frames, size=SIZE, look=Look(low=0.0, high=15.0))
    assert len(kept) == len(frames)
    # What lasts is made once for all of them, which is most of the time that a picture takes.
    assert len(made) == 1
    for k, (frame, image) in enumerate(zip(frames, kept, strict=True)):
        path = tmp_path / f"{k}.png"
        others = [*frames[:k], *frames[k + 1 :]]
        draw_scene(path, frame, size=SIZE, together_with=others, look=Look(low=0.0, high=15.0))
        np.testing.assert_array_equal(image, np.rint(255.0 * pixels(path)))


def test_the_command_draws_the_frames_of_a_folder(tmp_path, capsys):
    folder = write_run(tmp_path / "run", "cut", [0.0, 1.0], [0.0, 5.0])
    path, view = tmp_path / "cut.gif", ["view", str(folder)]
    assert main([*view, "-o", str(path), "--low", "0", "--high", "20"]) == 0
    with pillow.open(path) as drawn:
        assert drawn.n_frames == shellcut.read(folder).n_frame
    out, err = capsys.readouterr()
    assert out.startswith(f"{path} (")
    assert "100 %" in err
    assert main([*view, "--frame", "0"]) == 0
    still = folder / "frame_0000.png"
    assert capsys.readouterr().out.startswith(f"{still} (")
    assert main([*view, "-o", str(tmp_path / "last.png")]) == 0
    assert (tmp_path / "last.png").read_bytes() == still.read_bytes()
    for wrong, said in [
        (["-o", "cut.gif", "--field", "tresca"], "got 'tresca'"),
        (["--frame", "9"], "0 to 0, got 9"),
        (["-o", "a.gif", "--frame", "0"], "--frame belongs to a picture"),
        (["-o", "a.png", "--frames", "2"], "--frames belongs to page and movie"),
        (["-o", "a.html", "--size", "100", "80"], "the page fills its window"),
    ]:
        assert main([*view, *wrong]) == 2
        assert said in capsys.readouterr().err


def test_what_a_movie_needs_is_told(tmp_path, monkeypatch):
    with pytest.raises(ValueError, match="even") as refused:
        draw_movie(tmp_path / "cut.avi", [], size=(101, 50), fps=0.0)
    for said in (".mp4 or .webp or .gif", "one frame", "even numbers", "fps"):
        assert said in str(refused.value)
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "imageio_ffmpeg", None)
        patch.setattr("shutil.which", lambda name: None)
        with pytest.raises(ImportError, match=r"pip install 'shellcut-fem\[movie\]'"):
            draw_movie(tmp_path / "cut.mp4", FRAMES[:1], size=SIZE)
    pytest.importorskip("imageio_ffmpeg", reason="needs shellcut-fem[movie]")
    with pytest.raises(OSError, match=r"ffmpeg could not write .*rate"):
        draw_movie(tmp_path / "cut.mp4", FRAMES[:1], size=SIZE, fps=1e300)
    assert list(tmp_path.iterdir()) == []
