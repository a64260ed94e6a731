"""Columns that grow: what HDF5 reads back is what was appended."""

import h5py
import numpy as np
import pytest

from shellcut.results.hdf_columns import Columns

RNG = np.random.default_rng(7)
BLOCKS = {
    "float": [RNG.normal(size=(n, 3)).astype(np.float32) for n in (1, 5000, 4096, 17)],
    "double": [RNG.normal(size=n) for n in (3, 4097)],
    "id": [RNG.integers(0, 2**40, n) for n in (4096, 1)],
    "byte": [RNG.integers(0, 3, n).astype(np.uint8) for n in (9000, 2)],
}


@pytest.mark.parametrize("name", BLOCKS)
def test_blocks_of_a_packed_column_are_read_back(tmp_path, name):
    blocks = BLOCKS[name]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        columns = Columns(file)
        columns.create("data/rows", blocks[0].dtype, blocks[0].shape[1:], written="packed")
        begins = []
        for block in blocks:
            begins.append(columns.end("data/rows"))
            columns.write("data/rows", begins[-1], block)
    with h5py.File(tmp_path / "a.h5") as file:
        for begin, block in zip(begins, blocks, strict=True):
            assert begin % 4096 == 0  # a chunk of its own
            np.testing.assert_array_equal(file["data/rows"][begin : begin + len(block)], block)


def test_rows_and_plain_blocks_follow_each_other(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        columns = Columns(file)
        columns.create("time", np.float64)
        columns.create("pair", np.int64, (2,))
        columns.create("offsets", np.int64, written="blocks")
        for k in range(300):
            columns.write("time", columns.end("time"), np.array([0.1 * k]))
            columns.write("pair", columns.end("pair"), np.array([(k, -k)]))
        columns.write("offsets", columns.end("offsets"), np.arange(10))
        columns.write("offsets", columns.end("offsets"), np.arange(5000))
    with h5py.File(tmp_path / "a.h5") as file:
        np.testing.assert_array_equal(file["time"], 0.1 * np.arange(300))
        np.testing.assert_array_equal(file["pair"][:, 1], -np.arange(300))
        assert file["offsets"].shape == (5010,)


def test_zeros_take_no_room_and_equal_numbers_next_to_none(tmp_path):
    block = np.zeros((5000, 3), np.float32)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        columns = Columns(file)
        columns.create("x", np.float32, (3,), written="packed")
        columns.write("x", 0, block)
        columns.write("x", columns.end("x"), block + 7.0)
        assert file["x"].id.get_num_chunks() == 2  # of the second block
        assert file["x"].id.get_storage_size() < 0.01 * 8192 * 12
    with h5py.File(tmp_path / "a.h5") as file:
        np.testing.assert_array_equal(file["x"][:5000], block)
        np.testing.assert_array_equal(file["x"][8192:], block + 7.0)
