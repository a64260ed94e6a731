"""What is no file, or too much of one, is refused at once; files are whole or not there."""

import os
import re
import tracemalloc
from pathlib import Path

import pytest

from shellcut import (
    TableMotion,
    read,
    read_drawing,
    read_film,
    read_measured_curve,
    read_model,
    read_tool,
)
from shellcut.files.file_list import FileList
from shellcut.files.regular_file import read_regular
from shellcut.files.whole_file import atomic_write, opened, unfinished, write_text
from shellcut.formats import cad_surface, errors
from shellcut.mesh import drawing
from shellcut.results.history import read_history, read_splits
from shellcut.results.vtkhdf_reader import VtkHdfReader
from small_disk import REFUSAL, files_of_at_most

OBSTACLES = {
    "pipe": lambda path: os.mkfifo(path),
    "device": lambda path: path.symlink_to("/dev/zero"),
    "folder": lambda path: path.mkdir(),
}
of_unix = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes and devices")


READERS = {
    "film.inp": read_film,
    "film.k": read_film,
    "film.msh": read_film,
    "film.vtu": read_film,
    "film.vtk": read_film,
    "tool.stl": read_tool,
    "tool.obj": read_tool,
    "tool.ply": read_tool,
    "tool.step": read_tool,
    "tool.iges": read_tool,
    "film.dxf": read_drawing,
    "curve.csv": read_measured_curve,
    "motion.csv": TableMotion.read_csv,
    "model.toml": read_model,
}


def test_a_file_is_read_whole_and_not_beyond_its_limit(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"0123456789")
    tracemalloc.start()
    try:
        assert read_regular(path, 10) == read_regular(path) == b"0123456789"
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()
    with pytest.raises(OSError, match="must hold 0 MB at most, got 0 MB or more"):
        read_regular(path, 9)
    told_by_no_system = Path("/proc/self/status")
    if told_by_no_system.exists():
        assert told_by_no_system.stat().st_size == 0
        assert read_regular(told_by_no_system, 10_000).startswith(b"Name:")
        with pytest.raises(OSError, match="at most"):
            read_regular(told_by_no_system, 10)


@of_unix
@pytest.mark.parametrize("what", OBSTACLES)
@pytest.mark.parametrize("name", READERS)
def test_what_is_no_regular_file_is_not_waited_for(tmp_path, name, what):
    if (name, what) == ("model.toml", "folder"):
        pytest.skip("a folder is that of a run")
    OBSTACLES[what](tmp_path / name)
    with pytest.raises(ValueError, match=f"{name}.*must be a regular file, got a {what}"):
        READERS[name](tmp_path / name)


@of_unix
@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("a.vtkhdf", VtkHdfReader),
        ("history.csv", read_history),
        ("splits.csv", read_splits),
        ("run.files", lambda path: FileList(path.parent).add("a.vtkhdf")),
        ("a.vtkhdf", lambda path: read(path.parent)),
    ],
)
def test_a_pipe_among_results_is_not_waited_for(tmp_path, name, read):
    os.mkfifo(tmp_path / name)
    with pytest.raises(OSError, match=f"{name} must be a regular file, got a pipe|has {name},"):
        read(tmp_path / name)


@pytest.mark.parametrize("name", READERS)
def test_a_file_too_large_is_not_read(tmp_path, name):
    # as long as the limit and one byte more, and empty: no system keeps its zeros
    limit = {
        ".toml": 10_000_000,
        ".dxf": drawing.LARGEST_FILE,
        **dict.fromkeys((".step", ".iges"), cad_surface.LARGEST_FILE),
    }.get(Path(name).suffix, errors.LARGEST_FILE)
    with (tmp_path / name).open("wb") as file:
        file.truncate(limit + 1)
    told = re.escape(f"must hold {limit // 10**6:,} MB at most, got {limit // 10**6:,} MB or more")
    with pytest.raises(ValueError, match=told):
        READERS[name](tmp_path / name)


def test_a_file_takes_the_place_of_the_former_only_when_it_is_whole(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with atomic_write(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]
    with (
        pytest.raises(OSError, match=REFUSAL),
        files_of_at_most(100),
        atomic_write(path) as temporary,
    ):
        temporary.write_text("x" * 1000)
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


@of_unix
def test_a_pipe_is_kept_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with atomic_write(tmp_path / "pipe") as temporary:
        assert temporary == tmp_path / "pipe"
    assert (tmp_path / "pipe").is_fifo()
    with pytest.raises(OSError, match="must be a regular file"):
        opened(tmp_path / "pipe", "a+")


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


def test_what_a_killed_process_leaves_is_known_by_its_name(tmp_path):
    path = tmp_path / ("a" * 200 + ".h5")
    with atomic_write(path) as temporary:
        (tmp_path / "a.part.h5").write_text("mine")
        assert unfinished(path) == [temporary]
        assert unfinished(tmp_path / "a.h5") == []
