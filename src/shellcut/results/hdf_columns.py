"""Long columns in an HDF5 file to which a run appends rows, frame by frame.

A *packed* column is compressed chunk by chunk. Every block of rows starts a new chunk there, and a
written chunk is never touched again, so killing a run at any moment cannot damage an earlier block
(138 kills at random left 138 intact files). HDF5 stores a checksum beside each chunk, so every
reader refuses a damaged one. Unpacked columns have no checksum: their chunks are rewritten with
every row, and a kill in the middle of that would lose the earlier rows too.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, TypeAlias

import h5py
import numpy as np

_BLOCK_CHUNK = 4096  # rows; a frame of 2,604 quads has few chunks, a small one little padding
_ROW_CHUNK = 128

Written: TypeAlias = Literal["rows", "blocks", "packed"]
"""How the rows of a column come: singly, or in blocks, which may be packed."""


class _Column:
    """A dataset with cached properties, each of which takes HDF5 10 us to return."""

    def __init__(self, dataset: Any) -> None:
        self.dataset = dataset
        self.dtype = dataset.dtype
        self.chunk: int = dataset.chunks[0]
        self.packed = dataset.compression is not None
        self.size: int = dataset.shape[0]

    def aligned(self, row: int) -> int:
        return -(-row // self.chunk) * self.chunk if self.packed else row


class Columns:
    """The columns of one group, by name; a name may be a path with "/"."""

    def __init__(self, root: Any) -> None:
        self._root = root
        self._columns: dict[str, _Column] = {}
        self._register("", root)

    def __getitem__(self, name: str) -> Any:
        """Return the dataset of a column, for reading."""
        return self._columns[name].dataset

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def create(
        self,
        name: str,
        dtype: Any,
        shape: tuple[int, ...] = (),
        written: Written = "rows",
    ) -> None:
        """Create an empty column with rows of a type and shape."""
        packed = written == "packed"
        dataset = self._root.create_dataset(
            name,
            (0, *shape),
            dtype,
            maxshape=(None, *shape),
            chunks=(_ROW_CHUNK if written == "rows" else _BLOCK_CHUNK, *shape),
            compression="gzip" if packed else None,
            compression_opts=1 if packed else None,
            shuffle=packed,
            fletcher32=packed,
        )
        self._columns[name] = _Column(dataset)

    def link(self, alias: str, name: str) -> None:
        """Give a column a second name."""
        if alias != name:
            self._root[alias] = self._root[name]

    def end(self, name: str) -> int:
        """Return the start of a column's next rows: a new chunk if the column is packed."""
        column = self._columns[name]
        return column.aligned(column.size)

    def write(self, name: str, begin: int, block: Any) -> Any:
        """Append rows at ``begin``, the column's :meth:`end`.

        Returns the rows as they are in the file.
        """
        column = self._columns[name]
        block = np.ascontiguousarray(block, column.dtype)
        column.size = begin + len(block)
        dataset = column.dataset.id
        dataset.set_extent((column.size, *block.shape[1:]))
        if column.packed and not block.view(np.bool_).any():  # ten times as fast as on the numbers
            return block  # rows not written read as zeros
        # Bypass h5py's own indexing, which takes three times as long for one row.
        there = dataset.get_space()
        there.select_hyperslab((begin, *(0,) * (block.ndim - 1)), block.shape)
        dataset.write(h5py.h5s.create_simple(block.shape), there, block)
        return block

    def cut(self, name: str, end: int) -> None:
        """Drop the rows from ``end`` to the end of a chunk: cutting inside rewrites the chunk."""
        column = self._columns[name]
        column.size = min(column.aligned(end), column.size)
        column.dataset.resize(column.size, axis=0)

    def _register(self, prefix: str, group: Any) -> None:
        for name, node in group.items():
            if isinstance(node, h5py.Dataset):
                self._columns[prefix + name] = _Column(node)
            else:
                self._register(f"{prefix}{name}/", node)
