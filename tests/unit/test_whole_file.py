"""Files are whole or not there."""

import os

import pytest

from shellcut.files.whole_file import atomic_write, temporary_path
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
    assert temporary_path(path).name == "a.part.txt"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_a_link_stays_a_link_and_a_device_a_device(tmp_path):
    (tmp_path / "there.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "there.txt")
    with atomic_write(tmp_path / "link.txt") as temporary:
        temporary.write_text("new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "there.txt").read_text() == "new"
    os.mkfifo(tmp_path / "pipe")
    with atomic_write(tmp_path / "pipe") as temporary:
        assert temporary == tmp_path / "pipe"
    assert (tmp_path / "pipe").is_fifo()
