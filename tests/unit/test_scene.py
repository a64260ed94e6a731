"""Scenes and movies."""

import dataclasses
import itertools
import subprocess
import sys

import numpy as np
import pytest

import shellcut
from opening_frame import EDGE_COLOR, opening_frame
from run_folder import write_run
from shellcut.command_line import main
from shellcut.view import Look, draw_movie, draw_scene, movie, progress, snapshot
from shellcut.view.fields import at_corners, fields_of

FRAMES = [opening_frame(angle, n_side=10) for angle in (5.0, 25.0, 45.0)]
SIZE = (480, 320)

pillow = pytest.importorskip("PIL.Image", reason="needs shellcut[plot]")
pytest.importorskip("matplotlib", reason="needs shellcut[plot]")


def pixels(path):
    with pillow.open(path) as picture:
        return np.asarray(picture.convert("RGB")) / 255.0


def near(image, color, tolerance=0.12):
    return int((np.abs(image - np.asarray(color)).max(axis=-1) < tolerance).sum())


def test_a_scene_shows_edges_flanks_and_film(tmp_path, capfd):
    draw_scene(tmp_path / "scene.png", FRAMES[2], size=SIZE)
    image = pixels(tmp_path / "scene.png")
    assert image.shape == (320, 480, 3)
    drawn = image[35:260]  # without title and legend
    without = dataclasses.replace(
        FRAMES[2], edge_points=np.zeros((0, 2, 3)), edge_tooth=np.zeros(0, int)
    )
    draw_scene(tmp_path / "without.png", without, size=SIZE)
    edges = near(drawn, EDGE_COLOR)
    assert edges > 15
    assert near(pixels(tmp_path / "without.png")[35:260], EDGE_COLOR) < 0.2 * edges
    assert (drawn < 0.95).any(axis=2).mean() > 0.2
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("look", "color", "least", "most"),
    [
        # Share of the picture that has the colour of the film's largest stress, viridis' yellow.
        ({}, (0.95, 0.9, 0.2), 0.1, 0.9),
        ({"field": "largest principal, bottom"}, (0.95, 0.9, 0.2), 0.0, 0.01),
        ({"colormap": "inferno"}, (0.95, 0.9, 0.2), 0.0, 0.01),
        ({"high": 1000.0}, (0.95, 0.9, 0.2), 0.0, 0.01),
        ({"hide": ["film"]}, (0.95, 0.9, 0.2), 0.0, 0.01),
        ({"zoom": 0.3}, (0.95, 0.9, 0.2), 0.005, 0.08),
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
    count = {}
    for part in ("none", "tool", "mesh", "flanks", "cables"):
        hide = [] if part == "none" else [part]
        draw_scene(tmp_path / "s.png", FRAMES[2], look=Look(hide=hide), size=SIZE)
        count[part] = pixels(tmp_path / "s.png")[35:260]
    for part in ("tool", "mesh", "flanks", "cables"):
        assert (np.abs(count[part] - count["none"]).max(axis=2) > 0.02).sum() > 40, part


@pytest.mark.parametrize("of", ["quad", "node"])
def test_smooth_colours_run_from_node_to_node_and_not_across_a_crack(of):
    frame = FRAMES[2]
    field = fields_of(frame)["thickness" if of == "quad" else "displacement z"]
    rng = np.random.default_rng(3)
    values = rng.uniform(size=len(frame.quads if of == "quad" else frame.points))
    field = dataclasses.replace(field, values=lambda _: values)
    smooth, flat = (at_corners(field, frame, smooth) for smooth in (True, False))
    for node in frame.crack_edges[0].ravel():  # of one flank: the mean of its own quads
        at = frame.quads == node
        mean = values[at.any(axis=1)].mean() if of == "quad" else values[node]
        np.testing.assert_allclose(smooth[at], mean)
    assert np.ptp(flat, axis=1).max() == 0.0
    np.testing.assert_allclose(
        flat[:, 0], values if of == "quad" else values[frame.quads].mean(axis=1)
    )


def test_names_and_limits_of_fields():
    frame = dataclasses.replace(
        FRAMES[0], quad_principal=np.tile([4.0, -12.0], (len(FRAMES[0].quads), 1))
    )
    # sqrt(16 + 48 + 144) = 14.42
    np.testing.assert_allclose(Look(field="von Mises").field_of(frame).values(frame), np.sqrt(208))
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
    with pytest.raises(ValueError, match="hide must be") as refused:
        Look(hide=["shaft"], elevation=91.0, zoom=0.0)
    for said in ("got ['shaft']", "elevation must be", "zoom must be positive"):
        assert said in str(refused.value)


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
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="needs shellcut[movie]")
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


def test_a_movie_says_how_far_it_is(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(progress, "LINE_INTERVAL", 0.0)
    draw_movie(tmp_path / "cut.gif", FRAMES, size=(240, 160))
    said = capsys.readouterr().err.splitlines()
    assert [line.split(" %: ")[0] for line in said] == [f"cut.gif: {n}" for n in (0, 33, 66, 100)]
    assert "frames/s" in said[-1]
    assert "0 s left" in said[-1]


def test_the_command_draws_the_frames_of_a_folder(tmp_path, monkeypatch, capsys):
    folder = write_run(tmp_path / "run", "cut", [0.0, 1.0], [0.0, 5.0])
    path = tmp_path / "cut.gif"
    assert main(["view", str(folder), "-o", str(path), "--low", "0", "--high", "20"]) == 0
    with pillow.open(path) as drawn:
        assert drawn.n_frames == shellcut.read(folder).n_frame
    out, err = capsys.readouterr()
    assert out.startswith(f"{path} (")
    assert "100 %" in err
    assert main(["view", str(folder), "-o", "cut.gif", "--field", "tresca"]) == 2
    err = capsys.readouterr().err
    assert "got 'tresca'" in err
    assert main(["view", str(folder), "--frame", "0"]) == 0
    still = folder / "frame_0000.png"
    assert capsys.readouterr().out.startswith(f"{still} (")
    assert main(["view", str(folder), "-o", str(tmp_path / "last.png")]) == 0
    assert (tmp_path / "last.png").read_bytes() == still.read_bytes()
    capsys.readouterr()
    assert main(["view", str(folder), "--frame", "9"]) == 2
    assert "0 to 0, got 9" in capsys.readouterr().err
    for wrong, said in [
        (["-o", "a.gif", "--frame", "0"], "--frame belongs to a picture"),
        (["-o", "a.png", "--frames", "2"], "--frames belongs to page and movie"),
        (["-o", "a.html", "--size", "100", "80"], "the page fills its window"),
    ]:
        assert main(["view", str(folder), *wrong]) == 2
        assert said in capsys.readouterr().err
    assert main(["view", str(tmp_path / "none")]) == 2
    assert "none" in capsys.readouterr().err


def test_what_a_movie_needs_is_told(tmp_path, monkeypatch):
    with pytest.raises(ValueError, match="even") as refused:
        draw_movie(tmp_path / "cut.avi", [], size=(101, 50), fps=0.0)
    for said in (".mp4 or .webp or .gif", "one frame", "even numbers", "fps"):
        assert said in str(refused.value)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr("shutil.which", lambda name: None)
    with pytest.raises(ImportError, match=r"pip install shellcut\[movie\]"):
        draw_movie(tmp_path / "cut.mp4", FRAMES[:1], size=SIZE)
    pytest.importorskip("imageio_ffmpeg", reason="needs shellcut[movie]")
    with pytest.raises(OSError, match=r"ffmpeg could not write .*rate"):
        draw_movie(tmp_path / "cut.mp4", FRAMES[:1], size=SIZE, fps=1e300)
    assert list(tmp_path.iterdir()) == []
