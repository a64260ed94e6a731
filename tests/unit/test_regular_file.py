"""What is no file, or too much of one, is refused at once: nothing here may wait or fill memory."""

import os
import re
from pathlib import Path

import pytest

from shellcut import (
    TableMotion,
    evaluate_tensile,
    read,
    read_drawing,
    read_film,
    read_measured_curve,
    read_model,
    read_tool,
)
from shellcut.files.file_list import FileList
from shellcut.files.regular_file import read_regular
from shellcut.formats import cad_surface, drawing, errors
from shellcut.results.history import read_history
from shellcut.results.splits_csv import read_splits
from shellcut.results.vtkhdf_reader import VtkHdfReader

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
    "film.svg": read_drawing,
    "curve.csv": read_measured_curve,
    "specimen.csv": evaluate_tensile,
    "motion.csv": TableMotion.read_csv,
    "model.toml": read_model,
}


def test_a_file_is_read_whole_and_not_beyond_its_limit(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"0123456789")
    assert read_regular(path, 10) == b"0123456789"
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
        **dict.fromkeys((".dxf", ".svg"), drawing.LARGEST_FILE),
        **dict.fromkeys((".step", ".iges"), cad_surface.LARGEST_FILE),
    }.get(Path(name).suffix, errors.LARGEST_FILE)
    with (tmp_path / name).open("wb") as file:
        file.truncate(limit + 1)
    told = re.escape(f"must hold {limit // 10**6:,} MB at most, got {limit // 10**6:,} MB or more")
    with pytest.raises(ValueError, match=told):
        READERS[name](tmp_path / name)
