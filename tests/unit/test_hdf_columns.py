"""Columns that grow: what HDF5 reads back is what was appended."""

import h5py
import numpy as np
import pytest

from shellcut.results.hdf_columns import Columns, fletcher32

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
