"""Pictures beside a run: drawn in another process, in order; nothing is lost if that one dies."""

import multiprocessing
import os
import sys
import time
from contextlib import closing

import pytest

from shellcut import child_process
from shellcut.recording import pictures
from shellcut.recording.pictures import Pictures
from shellcut.unit import showing, shown


@pytest.fixture(autouse=True)
def no_process_left():
    yield
    pictures._idle.clear()


def note(path, text=""):
    """Write who draws, in which unit."""
    with path.open("a") as file:
        file.write(f"{os.getpid()} {shown('mm')[0]} {text}\n")


def note_late(path, text):
    time.sleep(0.2)
    note(path, text)


def drawn(path):
    return [line.split() for line in path.read_text().splitlines()]


def test_another_process_draws_in_order_and_in_the_units_of_the_caller(tmp_path):
    path = tmp_path / "a"
    with closing(Pictures(n_node=9)) as some:
        with showing("in"):
            some.draw(note_late, path, "first")
        some.draw(note, path, "second")
        some.settle()
        (first, *rest), second = drawn(path)
        assert rest == ["in", "first"]
        assert second == [first, "mm", "second"]
        assert int(first) != os.getpid()
    with closing(Pictures(n_node=9)) as more:  # of the next run, by the same process
        more.draw(note, path)
    assert drawn(path)[-1] == [first, "mm"]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_fork_has_a_process_of_its_own(tmp_path):
    def draw(name):
        with closing(Pictures(n_node=9)) as some:
            some.draw(note, tmp_path / name)

    draw("before")
    fork = multiprocessing.get_context("fork").Process(target=draw, args=["fork"])
    fork.start()
    fork.join()
    draw("after")
    first, in_fork, again = (drawn(tmp_path / name)[0][0] for name in ("before", "fork", "after"))
    assert first == again
    assert in_fork not in (first, str(os.getpid()), str(fork.pid))


def test_of_a_large_film_one_picture_is_pending(tmp_path):
    with closing(Pictures(n_node=10**6)) as some:
        some.draw(note_late, tmp_path / "a", "first")
        some.draw(note, tmp_path / "a", "second")
        assert drawn(tmp_path / "a")[0][-1] == "first"


def test_what_a_process_that_dies_has_not_drawn_is_drawn_here(tmp_path):
    with closing(Pictures(n_node=9)) as some:
        some.draw(note, tmp_path / "a")
        some.draw(os._exit, 1)
        # The one that ends a process is not tried here.
        some._pending.pop()
        some.draw(note, tmp_path / "b")
        some.settle()
        assert drawn(tmp_path / "b") == [[str(os.getpid()), "mm"]]
        some.draw(note, tmp_path / "c")  # by a new one
    pids = [drawn(tmp_path / name)[0][0] for name in "ac"]
    assert len({*pids, str(os.getpid())}) == 3
    assert not some.failed


@pytest.mark.parametrize("program", ["frozen", "without an interpreter"])
def test_where_no_process_can_be_started_pictures_are_drawn_here(tmp_path, monkeypatch, program):
    if program == "frozen":
        monkeypatch.setattr(sys, "frozen", True, raising=False)
    else:
        monkeypatch.setattr(child_process.spawn, "get_executable", lambda: "no interpreter")
    with closing(Pictures(n_node=9)) as some:
        some.draw(note, tmp_path / "a")
        some.settle()
    assert drawn(tmp_path / "a") == [[str(os.getpid()), "mm"]]


def test_an_error_is_raised_once(tmp_path):
    with closing(Pictures(n_node=9)) as some:
        some.draw(os.mkdir, tmp_path / "a" / "b")
        some.draw(note, tmp_path / "c")
        with pytest.raises(FileNotFoundError, match="b"):
            some.settle()
        assert some.failed
        some.settle()
    assert (tmp_path / "c").exists()
