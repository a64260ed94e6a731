"""The window of a run, drawn off screen: slider, keys, fields, and values that are read."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from opening_frame import opening_frame
from run_folder import write_run
from shellcut.command_line import main, view
from shellcut.view.fields import chosen_fields, field_limits
from shellcut.view.window import Window

pytest.importorskip("matplotlib", reason="needs shellcut[plot]")


class Frames:
    """A run of three frames."""

    def __init__(self, frames):
        self.frames, self.n_frame = frames, len(frames)

    def frame(self, k):
        return self.frames[k]


RUN = Frames([opening_frame(angle, n_side=10) for angle in (5.0, 25.0, 45.0)])


@pytest.fixture(scope="module")
def window():
    pytest.importorskip("pyvista", reason="needs shellcut[view]")
    # VTK crashes where it has neither a screen nor EGL nor OSMesa.
    attempt = "import pyvista; pyvista.Plotter(off_screen=True).screenshot(return_img=True)"
    if subprocess.run([sys.executable, "-c", attempt], check=False).returncode:
        pytest.skip("VTK draws nothing here")
    window = Window(RUN, size=(480, 320), off_screen=True)
    window._plotter.show(auto_close=False, interactive=False)
    yield window
    window.close()


def image(window):
    return window._plotter.screenshot(return_img=True) / 255.0


def click(window, x, y):
    """Press and release the mouse; return what is read then."""
    interactor = window._plotter.iren.interactor
    interactor.SetEventInformation(x, y)
    interactor.LeftButtonPressEvent()
    interactor.LeftButtonReleaseEvent()
    return window._reading


def test_the_slider_changes_the_frame(window):
    assert window.number == 2
    slider = window._slider
    last = image(window)
    slider.GetRepresentation().SetValue(0.2)
    slider.InvokeEvent("InteractionEvent")
    assert window.number == 0
    assert np.abs(image(window) - last).mean() > 0.005
    window._plotter.iren.interactor.SetKeySym("Right")
    window._plotter.iren.interactor.KeyPressEvent()
    assert window.number == 1
    assert slider.GetRepresentation().GetValue() == 1.0
    window.show_frame(7)
    assert window.number == 2


def test_a_click_reads_the_value_and_follows_its_quad(window):
    window.show_field("largest principal")
    window.show_frame(2)
    found = click(window, 240, 150)
    frame = RUN.frame(2)
    assert found.node in frame.quads[found.quad]
    assert found.value == frame.quad_principal[found.quad, 0]
    np.testing.assert_array_equal(found.place, frame.points[found.node])
    assert str(found).startswith(f"quad {found.quad}, node {found.node} at (")
    assert str(found).endswith(f"{found.value:.5g} MPa")
    window.show_field("displacement")
    window.show_frame(1)
    moved = np.linalg.norm(RUN.frame(1).displacement[window._reading.node])
    assert window._reading.value == moved
    assert window._reading.quad == found.quad
    assert window.pick(5, 5) is None  # beside the film
    assert window._reading.quad == found.quad


def test_the_place_that_is_read_lies_under_the_pointer(window):
    window.show_frame(2)
    for quad in (3, 40, 77):
        middle = RUN.frame(2).points[RUN.frame(2).quads[quad]].mean(axis=0)
        window._plotter.renderer.SetWorldPoint(*middle, 1.0)
        window._plotter.renderer.WorldToDisplay()
        x, y, _ = window._plotter.renderer.GetDisplayPoint()
        assert window.pick(round(x), round(y)).quad == quad


def test_the_next_field_has_its_colours_and_its_scale(window):
    window.show_field("largest principal")
    before = image(window)
    window._next_field()
    assert window.field.name == "smallest principal"
    assert list(window._plotter.scalar_bars.keys()) == ["smallest principal stress [MPa]"]
    assert np.abs(image(window) - before).mean() > 0.005
    with pytest.raises(ValueError, match=r"one of largest principal; .*got 'tresca'"):
        window.show_field("tresca")


def test_a_window_needs_a_frame():
    pytest.importorskip("pyvista", reason="needs shellcut[view]")
    with pytest.raises(ValueError, match="at least one frame"):
        Window(Frames([]), off_screen=True)


def test_the_command_opens_it_or_says_what_else_there_is(tmp_path, monkeypatch, capsys):
    folder = write_run(tmp_path / "run", "cut", [0.0, 1.0], [0.0, 5.0])
    monkeypatch.setattr(view, "why_no_window", lambda: "no screen")
    assert main(["view", str(folder)]) == 2
    said = capsys.readouterr().err
    assert "no screen. --html FILE writes a page" in said
    opened = []

    class Shown:
        def __init__(self, results, field, *, limits):
            opened.append((results.n_frame, field, limits))

        def show(self):
            opened.append("shown")

    monkeypatch.setattr(view, "why_no_window", lambda: None)
    monkeypatch.setattr("shellcut.view.window.Window", Shown)
    assert main(["view", str(folder), "--field", "speed", "--limits", "0", "9"]) == 0
    assert opened == [(1, "speed", (0.0, 9.0)), "shown"]
    assert main(["view", str(folder), "--field", "speed", "--field", "thickness"]) == 2
    assert "starts with one --field, got 2" in capsys.readouterr().err


def test_scales_enclose_nearly_all_numbers_of_all_frames():
    zero = np.zeros(len(RUN.frame(0).quads))
    frame = dataclasses.replace(RUN.frame(0), quad_history={"damage [-]": zero})
    (damage,) = chosen_fields(frame, ["damage"])
    assert (damage.unit, damage.of) == ("-", "quad")
    assert field_limits([damage.values(frame)]) == (0.0, 1.0)
    assert field_limits([np.array([]), np.array([])]) == (0.0, 1.0)
    assert field_limits([np.full(3, 5.0)]) == (0.0, 5.0)
    assert field_limits([np.full(4000, 1.0), np.append(np.zeros(4000), 1e3)], 1) == (0.0, 1.0)
    assert field_limits([np.array([-3.0, 0.1])], -1) == (-3.0, 0.0)
