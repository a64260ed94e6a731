"""The page with a run in three dimensions: its packed tables, and what a reader does with it."""

import base64
import dataclasses
import io
import json
import re
import sys
import zlib
from contextlib import closing

import numpy as np
import pytest

import shellcut
from browser import opened
from opening_frame import opening_frame
from shellcut.command_line import main, view
from shellcut.results.vtkhdf import VtkHdfWriter
from shellcut.scene_page import packed_scene, scene_scripts
from shellcut.scene_page import page as page_module
from shellcut.scene_page.packed_run import pack_ids, pack_numbers
from shellcut.view import Look
from shellcut.view.look import at_corners, fields_of

ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0)
CUT = 17  # a quad that is a pentagon in the last frame


def with_pentagon(frame):
    """Return the frame with a node in the middle of the first side of a quad."""
    a, b, c, d = frame.quads[CUT]
    new = len(frame.points)
    quads = np.pad(frame.quads, ((0, 0), (0, 1)), mode="edge")
    quads[CUT] = a, new, b, c, d

    def more(table):
        return np.vstack((table, 0.5 * (table[a] + table[b])))

    return dataclasses.replace(
        frame,
        quads=quads,
        points=more(frame.points),
        reference=more(frame.reference),
        director=more(frame.director),
        velocity=more(frame.velocity),
        held=np.append(frame.held, False),
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run whose film is cut further from frame to frame."""
    folder = tmp_path_factory.mktemp("run")
    frames = [opening_frame(angle, n_side=10) for angle in ANGLES]
    frames[-1] = with_pentagon(frames[-1])
    with closing(VtkHdfWriter(folder / "a <cut>.vtkhdf")) as writer:
        for k, frame in enumerate(frames):
            damage = np.linspace(0.0, 0.1 * k, len(frame.quads))
            writer.append(dataclasses.replace(frame, quad_history={"damage [-]": damage}))
    return folder


@pytest.fixture(scope="module")
def results(folder):
    return shellcut.read(folder)


def unpacked(described, data):
    """Return the integers of every frame, one by one."""
    stream = io.BytesIO(zlib.decompress(base64.b64decode(data)))
    columns = described["columns"]
    frames, before = [], np.zeros((0, columns), int)
    for rows in described["rows"]:
        count = rows * columns
        planes = [stream.read(count) for _ in range(described["bytes"])]
        table = np.zeros((rows, columns), int)
        for at in range(count):
            folded = sum(plane[at] << (8 * k) for k, plane in enumerate(planes))
            change = -(folded // 2) - 1 if folded % 2 else folded // 2
            row, column = at % rows, at // rows
            known = before[row, column] if row < len(before) else 0
            table[row, column] = (known + change) % (1 << (8 * described["bytes"]))
        frames.append(table)
        before = table
    assert stream.read() == b""
    return frames


class TestTables:
    @pytest.mark.parametrize("largest", [9, 65_535, 65_536, 2_000_000_000])
    def test_ids_are_exact(self, largest):
        random = np.random.default_rng(4)
        tables = [random.integers(0, largest, (n, 3), endpoint=True) for n in (5, 8, 0, 2)]
        tables[0][0, 0] = largest
        packed = pack_ids(tables)
        assert packed[0]["bytes"] == (2 if largest < 65_536 else 4)
        for given, found in zip(tables, unpacked(*packed), strict=True):
            np.testing.assert_array_equal(found, given)

    def test_narrow_tables_repeat_their_last_column_and_equal_ones_take_no_room(self):
        narrow, wide = np.array([[1, 2, 3, 4]]), np.array([[1, 2, 3, 4, 5], [6, 7, 8, 8, 8]])
        found = unpacked(*pack_ids([narrow, wide]))
        assert [table.tolist() for table in found] == [[[1, 2, 3, 4, 4]], wide.tolist()]
        ids = np.random.default_rng(6).integers(0, 2000, (2000, 4))
        one, many = (len(pack_ids([ids] * n)[1]) for n in (1, 50))
        assert many - one < 49 * 0.005 * one  # the bytes of the 49 others are zero

    def test_numbers_are_exact_to_half_a_step_of_their_column(self):
        random, size = np.random.default_rng(5), np.array([1.0, 1e-3, 0.0])
        tables = [random.normal(size=(n, 3)) * size + 7.0 for n in (0, 40, 60)]
        packed = pack_numbers(tables)
        low, step = (np.array(packed[0][name]) for name in ("low", "step"))
        for given, found in zip(tables, unpacked(*packed), strict=True):
            error = np.abs(low + found * step - given)
            assert (error <= 0.5001 * step).all()
        # 65,535 steps over the range of a column
        spans = np.ptp(np.concatenate(tables), axis=0)
        np.testing.assert_allclose(step[:2], spans[:2] / 65_535)


class TestFile:
    def test_a_page_is_complete_in_itself(self, results, tmp_path):
        page = shellcut.view_html(results, tmp_path / "cut.html")
        html = page.path.read_text(encoding="utf-8")
        assert page.n_byte == page.path.stat().st_size
        assert (page.frames, page.dropped) == ([0, 1, 2, 3, 4], "")
        assert str(page).endswith("5 of 5 frames")
        texts = "<h1>a &lt;cut&gt;</h1>", "default-src 'none'", "The MIT License"
        for text in (*texts, "three.js authors"):
            assert text in html
        # the name of the element's language is no address that is loaded
        known = {"http://www.w3.org/1999/xhtml", "https://threejs.org/license"}
        assert set(re.findall(r"https?://[\w./]+", html)) <= known

    def test_frames_and_look_are_chosen(self, folder, results, tmp_path):
        look = Look(field="damage", high=0.5, hide=["tool"], flat=True, elevation=20.0)
        page = shellcut.view_html(folder, tmp_path / "cut.html", frames=3, look=look)
        assert page.frames == [0, 2, 4]
        html = page.path.read_text(encoding="utf-8")
        content = json.loads(re.search(r'class="content">(.*)</script>', html)[1])
        assert [frame["number"] for frame in content["frames"]] == [0, 2, 4]
        fields = {field["name"]: field for field in content["fields"]}
        assert list(fields) == list(fields_of(results.frame(-1)))
        assert (fields["damage"]["unit"], fields["damage"]["limits"]) == ("-", [0.0, 0.5])
        assert fields["largest principal"]["limits"][1] != 0.5
        shown = content["look"]
        assert (shown["field"], shown["hide"], shown["smooth"]) == ("damage", ["tool"], False)
        assert shown["camera"] == [20.0, -60.0, 1.0]

    def test_a_page_that_is_too_large_gets_fewer_frames_and_says_so(
        self, results, tmp_path, monkeypatch
    ):
        whole = shellcut.view_html(results, tmp_path / "whole.html")
        room = round(0.6 * whole.n_byte + 0.4 * len(scene_scripts()))
        monkeypatch.setattr(page_module, "_LARGEST", room)
        page = shellcut.view_html(results, tmp_path / "cut.html")
        assert 2 <= len(page.frames) < 5
        assert (page.frames[0], page.frames[-1]) == (0, 4)
        assert page.n_byte <= room + 20_000  # style and texts
        assert re.match(r"all 5 frames would need 0\.\d+ MB, the limit is 0\.\d+ MB", page.dropped)
        assert page.dropped in page.path.read_text(encoding="utf-8")

    def test_what_cannot_be_written_is_refused(self, results, tmp_path):
        path = tmp_path / "cut.html"
        with pytest.raises(ValueError, match=r"one of largest principal; .*damage; got 'tresca'"):
            shellcut.view_html(results, path, look=Look(field="tresca"))
        with pytest.raises(ValueError, match="at least one frame, got frames=0"):
            shellcut.view_html(results, path, frames=0)
        with pytest.raises(ValueError, match=r"2 frames must fit into 0\.005 MB, they take"):
            packed_scene(results, None, 5_000)
        with pytest.raises(FileNotFoundError, match="folder of a run"):
            shellcut.view_html(tmp_path / "none", path)
        assert not path.exists()

    def test_the_command_writes_it(self, folder, tmp_path, capsys):
        path = str(tmp_path / "cut.html")
        command = ["view", str(folder), "-o", path, "--frames", "2", "--field", "speed"]
        assert main(command) == 0
        assert re.fullmatch(r".*cut\.html \(0\.\d MB\), 2 of 5 frames\n", capsys.readouterr().out)
        assert main([*command, "--low", "1", "--high", "0"]) == 2
        assert "low must be below high" in capsys.readouterr().err

    def test_without_a_name_it_is_opened_where_there_is_a_screen(self, folder, monkeypatch):
        shown, page = [], folder / "view.html"
        monkeypatch.setattr(view.webbrowser, "open", shown.append)
        monkeypatch.setattr(sys, "platform", "linux")
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        for screen in ("", ":0"):
            monkeypatch.setenv("DISPLAY", screen)
            assert main(["view", str(folder), "--frames", "2"]) == 0
            assert page.is_file()
        page.unlink()
        assert shown == [page.resolve().as_uri()]


@pytest.fixture(scope="module")
def scene(folder, tmp_path_factory):
    """The page in a browser, unpacked."""
    path = tmp_path_factory.mktemp("page") / "cut.html"
    shellcut.view_html(folder, path)
    with opened(path, 640, 560) as scene:
        scene.page.wait_for_selector(".scene3d[data-ready]")
        yield scene


def click(scene, across=0.5, down=0.5):
    """Click at a place of the canvas; return quad, node, place and value that are read there."""
    box = scene.page.locator("canvas").bounding_box()
    scene.page.mouse.click(box["x"] + across * box["width"], box["y"] + down * box["height"])
    return read(scene)


def read(scene):
    said = scene.page.inner_text(".read").replace("−", "-")
    found = re.fullmatch(r"quad (\d+), node (\d+) at \((.*)\) mm: (.+?) ([-\d.e]+) ?(\S*)", said)
    assert found, said
    place = [float(number) for number in found[3].split(", ")]
    return int(found[1]), int(found[2]), place, (found[4], float(found[5]), found[6])


def choose(scene, frame=None, field=None):
    if frame is not None:
        scene.page.locator(".slider").fill(str(frame))
    if field is not None:
        scene.page.select_option(".field", label=field)
        unit = {"displacement": "mm", "damage": ""}.get(field, "MPa")
        shows(scene, ".unit", unit)


def shows(scene, part, text):
    """Wait until a part of the page shows a text."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright")
    playwright.expect(scene.page.locator(part)).to_have_text(text, timeout=20_000)


def canvas(scene):
    """Return the drawn picture in 0..1, without the text at its top."""
    pillow = pytest.importorskip("PIL.Image", reason="needs shellcut-fem[plot]")
    scene.page.wait_for_timeout(100)  # it is drawn with the next picture of the screen
    drawn = pillow.open(io.BytesIO(scene.page.locator("canvas").screenshot()))
    return np.asarray(drawn.convert("RGB"))[50:] / 255.0


class TestInABrowser:
    @pytest.mark.parametrize("k", [1, 4])
    def test_a_click_reads_the_value_of_the_results_file(self, scene, results, k):
        choose(scene, frame=k, field="largest principal stress")
        frame = results.frame(k)
        quad, node, place, (label, value, unit) = click(scene, 0.55, 0.6)
        assert (label, unit) == ("largest principal stress", "MPa")
        assert node in frame.quads[quad]
        # Half a step of 65,535 over the range, and the rounding of the text.
        np.testing.assert_allclose(place, frame.points[node], rtol=0.0, atol=20.4 / 65_535)
        assert value == pytest.approx(frame.quad_principal[quad, 0], rel=0.0, abs=18.0 / 65_535)

        choose(scene, field="displacement")
        assert read(scene)[:2] == (quad, node)
        moved = np.linalg.norm(frame.displacement[node])
        assert read(scene)[3] == (
            "displacement",
            pytest.approx(moved, rel=0.0, abs=2.0 / 65_535),
            "mm",
        )
        choose(scene, field="damage")
        damage = frame.quad_history["damage [-]"][quad]
        assert read(scene)[3] == ("damage", pytest.approx(damage, rel=0.0, abs=0.4 / 65_535), "")

    def test_the_place_lies_under_the_pointer(self, scene, results):
        scene.page.click(".reset")
        choose(scene, frame=2)
        _, node, _, _ = click(scene)
        # The camera looks at the middle of the film of three frames, from 42° above at -60°.
        up, around = np.radians([42.0, -60.0])
        toward = np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])
        right = np.array([-np.sin(around), np.cos(around), 0.0])
        axes = np.stack((right, np.cross(toward, right), toward))
        across = np.concatenate([results.frame(k).points for k in (0, 2, 4)]) @ axes.T
        middle = 0.5 * (across.min(axis=0) + across.max(axis=0)) @ axes
        beside = np.cross(results.frame(2).points[node] - middle, toward)
        assert np.linalg.norm(beside) < 1.2  # a quad's side is 1.5 mm

    def test_the_mark_follows_its_quad(self, scene, results):
        choose(scene, frame=1, field="displacement")
        quad = click(scene, 0.5, 0.62)[0]
        choose(scene, frame=3)
        assert read(scene)[0] == quad
        assert read(scene)[1] in results.frame(3).quads[quad]
        assert scene.page.locator(".course polyline").count() == 1
        click_beside = scene.page.locator("canvas").bounding_box()
        scene.page.mouse.click(
            click_beside["x"] + 5, click_beside["y"] + click_beside["height"] - 5
        )
        assert scene.page.inner_text(".read") == "Click the film to read a value."

    def test_flanks_and_tool_are_drawn_and_switched(self, scene):
        choose(scene, frame=3, field="largest principal stress")
        whole = canvas(scene)
        assert (np.ptp(whole, axis=2) > 0.2).mean() > 0.1  # the film has colours
        dark = (whole.max(axis=2) < 0.15).sum()
        red = ((whole[..., 0] > 0.7) & (whole[..., 1] < 0.3)).sum()
        assert dark > 150
        assert red > 40
        for name in ("crack flank", "cutting edge", "tool"):
            scene.page.get_by_role("button", name=name).click()
        bare = canvas(scene)
        assert (bare.max(axis=2) < 0.15).sum() < 0.2 * dark
        assert ((bare[..., 0] > 0.7) & (bare[..., 1] < 0.3)).sum() == 0
        for name in ("crack flank", "cutting edge", "tool"):
            scene.page.get_by_role("button", name=name).click()
        np.testing.assert_allclose(canvas(scene), whole, atol=0.02)

    def test_colours_follow_field_and_limits(self, scene):
        choose(scene, frame=3, field="largest principal stress")
        first = canvas(scene)
        scene.page.locator(".high").fill("1000")
        scene.page.locator(".high").press("Enter")
        assert np.abs(canvas(scene) - first).mean() > 0.01
        choose(scene, field="displacement")
        low, high = (float(scene.page.input_value(end)) for end in (".low", ".high"))
        assert low == 0.0
        assert 0.5 < high < 5.0

    def test_lines_have_the_colours_of_the_legend(self, scene):
        told = scene.page.evaluate(
            "() => { const { content, view } = document.querySelector('.scene3d').panel;"
            " return content.legend.filter(({ area }) => !area).map((entry) => ["
            "  entry.switch, entry.color, view.parts[entry.switch].material.color.getStyle()]); }"
        )
        assert {"flanks", "edges"} < {name for name, *_ in told}
        for name, color, drawn in told:
            rgb = [int(number) for number in re.findall(r"\d+", drawn)]
            np.testing.assert_allclose(rgb, 255.0 * np.array(color), atol=1.0, err_msg=name)

    def test_the_film_is_hidden_and_its_colours_are_flat_on_request(self, scene, results):
        choose(scene, frame=3, field="largest principal stress")
        scene.page.get_by_role("button", name="mesh").click()
        smooth = canvas(scene)
        for name, least, most in [("smooth colours", 0.002, 0.1), ("film", 0.1, 1.0)]:
            button = scene.page.get_by_role("button", name=name)
            button.click()
            assert least < np.abs(canvas(scene) - smooth).mean() < most, name
            button.click()
            np.testing.assert_allclose(canvas(scene), smooth, atol=0.02)
        scene.page.get_by_role("button", name="mesh").click()
        frame = results.frame(3)
        means = scene.page.evaluate(
            "() => { const { film } = document.querySelector('.scene3d').panel.view;"
            " const length = film.quads.length / film.width;"
            " const quads = Float32Array.from({ length }, (_, k) => k);"
            " return Array.from(film.means(quads, 'quad')); }"
        )
        numbers = dataclasses.replace(
            fields_of(frame)["thickness"], values=lambda frame: np.arange(len(frame.quads))
        )
        corners = at_corners(numbers, frame, smooth=True)
        np.testing.assert_allclose(np.asarray(means)[frame.quads], corners, rtol=1e-6)

    def test_dragging_turns_and_reset_turns_back(self, scene):
        choose(scene, frame=3)
        scene.page.click(".reset")
        first = canvas(scene)
        box = scene.page.locator("canvas").bounding_box()
        scene.page.mouse.move(box["x"] + 100, box["y"] + 100)
        scene.page.mouse.down()
        scene.page.mouse.move(box["x"] + 300, box["y"] + 150, steps=3)
        scene.page.mouse.up()
        assert np.abs(canvas(scene) - first).mean() > 0.01
        scene.page.click(".reset")
        np.testing.assert_allclose(canvas(scene), first, atol=0.02)

    def test_it_plays_to_the_end(self, scene):
        choose(scene, frame=4)
        # The page notes the labels itself: on a slow machine it may be at the end before we ask.
        scene.page.evaluate(
            """() => {
                const play = document.querySelector(".play");
                window.labels = [];
                new MutationObserver(() => window.labels.push(play.ariaLabel))
                    .observe(play, {attributeFilter: ["aria-label"]});
            }"""
        )
        scene.page.click(".play")
        shows(scene, ".play", "▶")
        scene.page.wait_for_function("window.labels.length > 1")
        labels = scene.page.evaluate("window.labels")
        assert (labels[0], labels[-1]) == ("pause", "play")
        assert scene.page.inner_text(".which") == "frame 4"

    def test_nothing_goes_wrong_and_nothing_is_loaded(self, scene):  # the last one
        assert scene.wrong == []
        assert [url for url in scene.loaded if not url.startswith("file:")] == []
        assert len(scene.loaded) == 1
