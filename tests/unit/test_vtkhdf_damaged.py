"""A result file holds what was appended; damage is refused, and never read as other numbers."""

import dataclasses

import h5py
import numpy as np
import pytest

from damaged.mutations import mutated
from opening_frame import opening_frame
from shellcut.frame import Frame
from shellcut.results.hdf_columns import Columns, fletcher32
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


RNG = np.random.default_rng(7)
BLOCKS = {
    "float": [RNG.normal(size=(n, 3)).astype(np.float32) for n in (1, 5000, 4096, 17)],
    "double": [RNG.normal(size=n) for n in (3, 4097)],
    "id": [RNG.integers(0, 2**40, n) for n in (4096, 1)],
    "byte": [RNG.integers(0, 3, n).astype(np.uint8) for n in (9000, 2)],
}


@pytest.mark.parametrize("noise", [False, True])
@pytest.mark.parametrize("name", BLOCKS)
def test_blocks_of_a_packed_column_are_read_back(tmp_path, name, noise):
    blocks = BLOCKS[name]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        columns = Columns(file)
        columns.create("data/rows", blocks[0].dtype, blocks[0].shape[1:], packed=True)
        begins = []
        for block in blocks:
            begins.append(columns.end("data/rows"))
            columns.write("data/rows", begins[-1], block, noise=noise)
    with h5py.File(tmp_path / "a.h5") as file:
        for begin, block in zip(begins, blocks, strict=True):
            assert begin % 4096 == 0  # a chunk of its own
            np.testing.assert_array_equal(file["data/rows"][begin : begin + len(block)], block)


def test_equal_numbers_take_next_to_no_room_and_are_read_back(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        columns = Columns(file)
        for name, number in (("zero", 0.0), ("one", 1.0)):
            columns.create(name, np.float32, (3,), packed=True)
            columns.write(name, 0, np.full((8192, 3), number, np.float32))
            assert file[name].id.get_storage_size() < 0.01 * 8192 * 12
    block = np.zeros((9000, 3), np.float32)
    block[8999, 2] = 7.0
    with h5py.File(tmp_path / "a.h5", "w") as file:
        columns = Columns(file)
        columns.create("x", np.float32, (3,), packed=True)
        columns.write("x", 0, block)
        assert file["x"].id.get_num_chunks() == 1
    with h5py.File(tmp_path / "a.h5") as file:
        np.testing.assert_array_equal(file["x"], block)


@pytest.mark.parametrize("n", [1, 2, 3, 360, 721, 722, 4096, 50_001])
@pytest.mark.parametrize("kind", ["zeros", "ones", "noise"])
def test_the_checksum_is_that_of_hdf5(tmp_path, n, kind):
    rows = {"zeros": np.zeros(n), "ones": np.full(n, 255), "noise": RNG.integers(0, 256, n)}[kind]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        data = file.create_dataset("x", data=rows.astype(np.uint8), chunks=(n,), fletcher32=True)
        file.flush()
        _, chunk = data.id.read_direct_chunk((0,))
    assert chunk[:-4] == rows.astype(np.uint8).tobytes()
    assert fletcher32(chunk[:-4]) == chunk[-4:]
