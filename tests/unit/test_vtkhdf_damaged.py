"""A result file that is not what was written is refused; damage is never read as other numbers."""

import dataclasses

import h5py
import numpy as np
import pytest

from damaged.mutations import mutated
from opening_frame import opening_frame
from shellcut.frame import Frame
from shellcut.results.run_results import read
from shellcut.results.vtkhdf import VtkHdfWriter
from shellcut.results.vtkhdf_reader import ResultFileError, VtkHdfReader
from test_vtkhdf import Reading, frames, write


@pytest.fixture(autouse=True)
def _no_waiting(monkeypatch):
    """No run writes these files."""
    monkeypatch.setattr("shellcut.results.vtkhdf_reader._TICK_S", 0.0)
    monkeypatch.setattr("shellcut.results.vtkhdf_reader._HELD_UP_S", 0.0)


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    path = tmp_path_factory.mktemp("sound") / "run.vtkhdf"
    write(path, frames(5))
    return path


def numbers(reader):
    """Return every number and text that a reader gives, as bytes by name."""
    held = {
        "times": reader.times,
        "coordinates": reader.coordinates,
        "coordinate": f"{reader.coordinate_name} {reader.coordinate_unit}",
    }
    for k in range(reader.n_frame):
        frame, pose = reader.frame(k), reader.pose(k)
        held |= {f"{k} {f.name}": getattr(frame, f.name) for f in dataclasses.fields(Frame)}
        held |= {f"{k} pose {i}": part for i, part in enumerate(pose or ())}
    return {n: v.tobytes() if isinstance(v, np.ndarray) else repr(v) for n, v in held.items()}


def test_no_damage_is_read_as_other_numbers(tmp_path):
    # so many points that they are left unpacked: nothing but the checksums guards them
    path, rng = tmp_path / "run.vtkhdf", np.random.default_rng(250)
    write(path, [opening_frame(angle, n_side=46, time=1e-3 * angle) for angle in (20.0, 40.0)])
    content, right = path.read_bytes(), numbers(VtkHdfReader(path))
    refused = 0
    for _ in range(80):
        damaged, way = mutated(rng, content, text=False)
        path.write_bytes(damaged)
        try:
            found = numbers(VtkHdfReader(path))
        except ResultFileError:
            refused += 1
            continue
        other = [name for name, value in found.items() if value != right.get(name)]
        assert (other, len(found)) == ([], len(right)), way
    assert refused > 30  # the rest hits what is not read: filling, names and links for VTK


@pytest.mark.parametrize("name", ["Values", "CellOffsets", "PointOffsets"])
def test_every_place_of_the_rows_is_covered(sound, tmp_path, name):
    path = tmp_path / "run.vtkhdf"
    path.write_bytes(sound.read_bytes())
    with h5py.File(path, "r+") as file:
        file[f"VTKHDF/Steps/{name}"][3] += 1
    with pytest.raises(ResultFileError, match=r"time, figures or pose of frame 3 are not what was"):
        VtkHdfReader(path)
    with pytest.raises(ValueError, match="is damaged; start anew"):
        VtkHdfWriter(path, until=np.inf)


def test_names_and_units_are_covered(sound, tmp_path):
    path = tmp_path / "run.vtkhdf"
    path.write_bytes(sound.read_bytes())
    with h5py.File(path, "r+") as file:
        names = list(file["shellcut"].attrs["scalar_units"])
        file["shellcut"].attrs["scalar_units"] = ["N" if n == "N*mm" else n for n in names]
    with pytest.raises(ResultFileError, match="frame 0 are not what was written"):
        VtkHdfReader(path)


def test_frames_lost_or_damaged_are_named(sound, tmp_path):
    path = tmp_path / "run.vtkhdf"
    path.write_bytes(sound.read_bytes())
    with h5py.File(path, "r+") as file:
        begin = file["VTKHDF/Steps/PointOffsets"][2]
        file["VTKHDF/PointData/director"][begin + 5, 1] += 1e-3
    results = read(path)
    assert results.frame(1).time < results.frame(3).time
    with pytest.raises(ResultFileError, match="the arrays of frame 2 are not what was written"):
        results.frame(2)
    with h5py.File(path, "r+") as file:
        file["VTKHDF/Steps"].attrs["NSteps"] = 4
    with pytest.raises(ResultFileError, match="it counts 4 frames and has 5"):
        VtkHdfReader(path)
    with h5py.File(path, "r+") as file:  # as a killed run leaves it
        file["shellcut"].attrs["n_frame"] = -1
    assert VtkHdfReader(path).n_frame == 4


def test_a_flipped_bit_is_refused_by_other_readers_too(sound, tmp_path):
    path = tmp_path / "run.vtkhdf"
    with h5py.File(sound) as file:
        places = {
            name: file[f"VTKHDF/{name}"].id.get_chunk_info(0).byte_offset
            for name in ("Points", "Connectivity", "CellData/membrane stress [MPa]")
        }
    for name, place in places.items():
        content = bytearray(sound.read_bytes())
        content[place + 60] ^= 4
        path.write_bytes(content)
        with h5py.File(path) as file, pytest.raises(OSError, match=r"[Cc]an't .*read"):
            file[f"VTKHDF/{name}"][:]


def test_vtk_does_not_show_a_flipped_bit(sound, tmp_path, capfd):
    path = tmp_path / "run.vtkhdf"
    with h5py.File(sound) as file:
        place = file["VTKHDF/Points"].id.get_chunk_info(0).byte_offset
    content = bytearray(sound.read_bytes())
    content[place + 60] ^= 64
    path.write_bytes(content)
    reading = Reading(path)
    reading.reader.SetStep(0)
    reading.reader.Update()
    points = reading.reader.GetOutput().GetPoints()
    assert points is None or points.GetNumberOfPoints() == 0
    assert "ERR" in capfd.readouterr().err
