"""Whether a window can be opened is found out without harm."""

import os
import subprocess
import sys

import pytest

from shellcut.view import renderer, why_no_window


@pytest.fixture(autouse=True)
def fresh():
    why_no_window.cache_clear()
    yield
    why_no_window.cache_clear()


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
        (1, "no screen that VTK can open"),
        (-11, "no screen that VTK can open"),
        (subprocess.TimeoutExpired("python", 60.0), "VTK opened nothing within 60 s"),
        (OSError("no fork"), "no process to try VTK in: no fork"),
    ],
)
def test_every_end_of_the_attempt_has_its_sentence(monkeypatch, outcome, said):
    made = pretend(monkeypatch, outcome)
    assert why_no_window() == said
    assert why_no_window() == said
    assert len(made) == 1  # remembered


def test_pyvista_that_is_not_there_is_not_tried(monkeypatch):
    made = pretend(monkeypatch, 0)
    monkeypatch.setattr(renderer.importlib.util, "find_spec", lambda name: None)
    assert "pip install shellcut[view]" in why_no_window()
    assert made == []


def test_a_machine_without_any_gl_survives(tmp_path):
    # The real thing: EGL's drivers hidden, no screen; VTK then crashes, in its own process.
    pytest.importorskip("pyvista", reason="needs shellcut[view]")
    if sys.platform != "linux":
        pytest.skip("hides the drivers of Linux")
    hidden = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
    hidden["__EGL_VENDOR_LIBRARY_DIRS"] = str(tmp_path)
    script = "from shellcut.view import why_no_window; print(why_no_window())"
    done = subprocess.run(
        [sys.executable, "-c", script], env=hidden, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (done.stdout, done.stderr) == ("no screen that VTK can open\n", "")
