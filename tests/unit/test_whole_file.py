"""Files are whole or not there."""

import os

import pytest

from shellcut.files.whole_file import aside_of, written_whole
from small_disk import REFUSAL, files_of_at_most


def test_a_file_takes_the_place_of_the_former_when_it_is_whole(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with written_whole(path) as aside:
        aside.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_what_fails_leaves_the_former_and_nothing_else(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(OSError, match=REFUSAL), files_of_at_most(100), written_whole(path) as aside:
        aside.write_text("x" * 1000)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]
    assert aside_of(path).name == "a.part.txt"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_a_link_stays_a_link_and_a_device_a_device(tmp_path):
    (tmp_path / "there.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "there.txt")
    with written_whole(tmp_path / "link.txt") as aside:
        aside.write_text("new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "there.txt").read_text() == "new"
    os.mkfifo(tmp_path / "pipe")
    with written_whole(tmp_path / "pipe") as aside:
        assert aside == tmp_path / "pipe"
    assert (tmp_path / "pipe").is_fifo()
