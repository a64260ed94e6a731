"""Files are whole or not there."""

import os

import pytest

from shellcut.files.whole_file import atomic_write, opened, unfinished, write_text
from small_disk import REFUSAL, files_of_at_most


def test_a_file_takes_the_place_of_the_former_when_it_is_whole(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with atomic_write(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_what_fails_leaves_the_former_and_nothing_else(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with (
        pytest.raises(OSError, match=REFUSAL),
        files_of_at_most(100),
        atomic_write(path) as temporary,
    ):
        temporary.write_text("x" * 1000)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_a_device_stays_a_device(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with atomic_write(tmp_path / "pipe") as temporary:
        assert temporary == tmp_path / "pipe"
    assert (tmp_path / "pipe").is_fifo()


WRITERS = {
    "whole": lambda path: write_text(path, "new"),
    "grown": lambda path: opened(path, "a+").close(),
    "gone on with": lambda path: opened(path, "r+").close(),
}


@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS)
@pytest.mark.parametrize("there", ["there.txt", "nothing.txt"])
def test_nothing_is_written_through_a_link(tmp_path, write, there):
    (tmp_path / "there.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / there)
    with pytest.raises(OSError, match="must not be a link"):
        write(tmp_path / "link.txt")
    assert (tmp_path / "there.txt").read_text() == "old"
    assert sorted(os.listdir(tmp_path)) == ["link.txt", "there.txt"]


def test_a_new_file_takes_the_place_of_a_link_and_not_of_what_it_leads_to(tmp_path):
    (tmp_path / "there.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "there.txt")
    with opened(tmp_path / "link.txt", "w") as file:
        file.write(b"new")
    assert (tmp_path / "there.txt").read_text() == "old"
    assert (tmp_path / "link.txt").read_text() == "new"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_a_pipe_in_the_place_of_a_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.txt")
    with pytest.raises(OSError, match="must be a regular file"):
        opened(tmp_path / "a.txt", "a+")


def test_what_a_killed_process_leaves_is_known_by_its_name(tmp_path):
    path = tmp_path / ("a" * 200 + ".h5")
    with atomic_write(path) as temporary:
        (tmp_path / "a.part.h5").write_text("mine")
        assert unfinished(path) == [temporary]
        assert unfinished(tmp_path / "a.h5") == []
