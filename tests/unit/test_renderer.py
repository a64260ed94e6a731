"""Whether PyVista can draw is found out without harm."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from shellcut.view import renderer, why_not_pyvista


@pytest.fixture(autouse=True)
def fresh(monkeypatch):
    monkeypatch.delenv(renderer.CHOICE, raising=False)
    renderer._tried.cache_clear()
    renderer._say_once.cache_clear()
    yield
    renderer._tried.cache_clear()
    renderer._say_once.cache_clear()


def pretend(monkeypatch, outcome):
    """Let the attempt end as told; return how often it was made."""
    made = []

    def run(command, **options):
        made.append(command)
        if isinstance(outcome, Exception):
            raise outcome
        return subprocess.CompletedProcess(command, outcome)

    monkeypatch.setattr(renderer.subprocess, "run", run)
    monkeypatch.setattr(renderer.importlib.util, "find_spec", lambda name: object())
    return made


@pytest.mark.parametrize(
    ("outcome", "said"),
    [
        (0, None),
        (1, "PyVista failed (exit code 1)"),
        (-11, "VTK crashed (signal 11): no screen, EGL or OSMesa"),
        (subprocess.TimeoutExpired("python", 60.0), "PyVista drew nothing within 60 s"),
        (OSError("no fork"), "no process to try PyVista in: no fork"),
    ],
)
def test_every_end_of_the_attempt_has_its_sentence(monkeypatch, outcome, said):
    made = pretend(monkeypatch, outcome)
    reason = why_not_pyvista()
    assert reason is None if said is None else reason.startswith(said)
    assert why_not_pyvista() == reason
    assert len(made) == 1  # remembered


def test_the_environment_can_decide(monkeypatch):
    made = pretend(monkeypatch, 0)
    monkeypatch.setenv(renderer.CHOICE, "matplotlib")
    assert why_not_pyvista() == "SHELLCUT_RENDERER=matplotlib"
    assert made == []


def test_pyvista_that_is_not_there_is_not_tried(monkeypatch):
    made = pretend(monkeypatch, 0)
    monkeypatch.setattr(renderer.importlib.util, "find_spec", lambda name: None)
    assert "pip install shellcut[view]" in why_not_pyvista()
    assert made == []


def test_the_fallback_is_said_once_in_one_line(monkeypatch, caplog):
    pretend(monkeypatch, -11)
    for _ in range(3):
        assert not renderer.pyvista_or_say("drawn by Matplotlib")
    assert len(caplog.records) == 1
    message = caplog.records[0].getMessage()
    assert message.endswith("; drawn by Matplotlib")
    assert "\n" not in message


def test_a_machine_without_any_gl_falls_back_alive(tmp_path):
    # The real thing: EGL's drivers hidden, no screen; VTK then crashes, in its own process.
    pytest.importorskip("pyvista", reason="needs shellcut[view]")
    if sys.platform != "linux":
        pytest.skip("hides the drivers of Linux")
    hidden = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
    hidden["__EGL_VENDOR_LIBRARY_DIRS"] = str(tmp_path)
    script = (
        "import sys; sys.path.insert(0, sys.argv[2])\n"
        "from opening_frame import opening_frame\n"
        "from shellcut.view import draw_scene\n"
        "draw_scene(sys.argv[1], opening_frame(20.0, n_side=6), size=(400, 250))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, tmp_path / "scene.png", Path(__file__).parent],
        env=hidden,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "scene.png").stat().st_size > 1000
    if done.stderr:  # a machine may have another way to render, then there is nothing to say
        assert done.stderr.startswith("no 3-D rendering: ")
        assert done.stderr.count("\n") == 1
