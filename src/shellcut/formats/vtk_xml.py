"""VTK's XML files, .vtu and .vtp: text, base64 and raw data, compressed by zlib, LZMA or LZ4.

Follows "VTK XML Formats" (docs.vtk.org) and, for LZ4, the description of its block format.
"""

from __future__ import annotations

import base64
import binascii
import lzma
import re
import zlib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from shellcut.arrays import Ints, Numbers

from .budget import Budget
from .errors import FileError, read_bytes
from .vtk_grid import VtkGrid, joined, stacked

_TYPES = {
    f"{kind}Int{bits}": f"{kind[:1].lower() or 'i'}{bits // 8}"
    for kind in ("", "U")
    for bits in (8, 16, 32, 64)
} | {"Float32": "f4", "Float64": "f8"}
_POLY = {"Verts": 2, "Lines": 4, "Polys": 7, "Strips": 6}  # in the order of the cell data
_APPENDED = re.compile(rb"<AppendedData[^>]*>\s*_")
_FLOATS, _INTS = "f", "iu"


def read_vtk_xml(path: Path) -> VtkGrid:
    """Read a .vtu or .vtp file of any version.

    Raises
    ------
    FileError
        If it is none of these, or its declarations and its content do not match.
    """
    return _Reader(path, read_bytes(path)).grid()


class _Reader:
    def __init__(self, path: Path, content: bytes):
        self.path, self.budget = path, Budget(path)
        self.appended = b""
        if found := _APPENDED.search(content):
            end = content.rfind(b"</AppendedData>")
            if end < found.end():
                raise self._error("<AppendedData> must end: the file is cut short")
            self.appended = content[found.end() : end]
            content = content[: found.end()] + content[end:]
        try:
            self.root = ElementTree.fromstring(content)
        except (ElementTree.ParseError, LookupError, ValueError) as reason:
            raise self._error(f"it is no XML: {reason}") from None
        self.kind = self.root.get("type", "")
        if self.root.tag != "VTKFile" or self.kind not in ("UnstructuredGrid", "PolyData"):
            raise self._error(
                "a <VTKFile> of type UnstructuredGrid or PolyData must come first, got "
                f"<{self.root.tag}> of type {self.kind!r}"
            )
        self.order = ">" if self.root.get("byte_order") == "BigEndian" else "<"
        self.header = np.dtype(self.order + _TYPES.get(self.root.get("header_type", ""), "u4"))
        self.compressor = (
            self.root.get("compressor", "").removeprefix("vtk").removesuffix("DataCompressor")
        )
        if self.compressor not in ("", "ZLib", "LZMA", "LZ4"):
            raise self._error(
                f"data must be compressed by ZLib, LZMA or LZ4, got {self.compressor}"
            )

    def grid(self) -> VtkGrid:
        pieces = [self._piece(p) for p in self.root.iterfind(f"{self.kind}/Piece")]
        grid = joined(self.path, pieces)
        if fields := len(self.root.findall(f"{self.kind}/FieldData/*")):
            grid.unused["arrays of the field data"] = fields
        return grid

    def _piece(self, piece: Any) -> VtkGrid:
        n_point = self._count(piece, "NumberOfPoints")
        unused: dict[str, int] = {}
        points = self._array(piece.find("Points/DataArray"), "points", _FLOATS + _INTS)
        if points.shape != (n_point, 3):
            raise self._error(f"{n_point} points of 3 coordinates are declared, got {points.shape}")
        if self.kind == "PolyData":
            types, ends, nodes = stacked(
                [
                    (kind, *self._cells(piece, name, count))
                    for name, kind in _POLY.items()
                    if (count := self._count(piece, f"NumberOf{name}"))
                ]
            )
        else:
            types = self._plain(piece, "Cells/DataArray[@Name='types']")
            ends, nodes = self._cells(piece, "Cells", self._count(piece, "NumberOfCells"))
        data = (
            self._named(piece.find("PointData"), unused),
            self._named(piece.find("CellData"), unused),
        )
        return VtkGrid(points.astype(np.float64), types, ends, nodes, *data, unused)

    def _cells(self, piece: Any, where: str, count: int) -> tuple[Ints, Ints]:
        ends = self._plain(piece, f"{where}/DataArray[@Name='offsets']")
        if len(ends) != count:
            raise self._error(f"{count} cells in <{where}> are declared, got {len(ends)}")
        return ends, self._plain(piece, f"{where}/DataArray[@Name='connectivity']")

    def _plain(self, piece: Any, where: str) -> Ints:
        values: Ints = self._array(piece.find(where), where, _INTS).ravel().astype(np.int64)
        return values

    def _named(self, data: Any, unused: dict[str, int]) -> dict[str, Numbers]:
        arrays = {}
        for element in data if data is not None else ():
            name = element.get("Name", "")
            if element.tag != "DataArray" or element.get("type") not in _TYPES:
                unused[f"array {name!r} of {element.get('type')}"] = 1
                continue
            arrays[name] = self._array(element, f"array {name!r}", _FLOATS + _INTS)
        return arrays

    def _count(self, piece: Any, name: str) -> int:
        text = piece.get(name, "0")
        if not text.strip().isdecimal():
            raise self._error(f"{name} must be a whole number, got {text!r}")
        return int(text)

    # --- arrays -----------------------------------------------------------------------------------

    def _array(self, element: Any, what: str, kinds: str) -> Numbers:
        if element is None:
            raise self._error(f"there must be {what}, but it is missing")
        kind = _TYPES.get(element.get("type", ""), "")
        if not kind or kind[0] not in kinds:
            raise self._error(f"{what} must be numbers, got type {element.get('type')!r}")
        dtype = np.dtype(self.order + kind)
        try:
            values = self._values(element, dtype)
            n = int(element.get("NumberOfComponents", 1))
            return values.reshape(-1, n) if n > 1 else values
        except FileError:
            raise
        except (ValueError, OverflowError, LookupError, zlib.error, lzma.LZMAError) as reason:
            raise self._error(
                f"the data of {what} cannot be read: {reason}; is it damaged, or cut short?"
            ) from None

    def _values(self, element: Any, dtype: Any) -> Numbers:
        how = element.get("format", "")
        if how == "ascii":
            return np.array((element.text or "").split()).astype(dtype)
        if how == "binary":
            coded, at, encoded = (element.text or "").strip().encode(), 0, True
        elif how == "appended":
            coded, at = self.appended, int(element.get("offset", ""))
            found = self.root.find("AppendedData")
            encoded = found is not None and found.get("encoding") == "base64"
        else:
            raise ValueError(f"format {how!r}")
        return np.frombuffer(self._bytes(coded, at, encoded), dtype)

    def _bytes(self, coded: bytes, at: int, encoded: bool) -> bytes:
        # a head of sizes, then the data; base64 codes both together, but apart if compressed
        size = self.header.itemsize
        n = int(np.frombuffer(_taken(coded, at, size, encoded)[0], self.header)[0])
        if not self.compressor:
            self.budget.take("bytes unpacked", n)
            return _taken(coded, at, size + n, encoded)[0][size:]
        head, at = _taken(coded, at, (3 + n) * size, encoded)
        _, whole, last, *packed = np.frombuffer(head, self.header).tolist()
        sizes = [whole] * n
        if n and last:
            sizes[-1] = last
        self.budget.take("bytes unpacked", sum(sizes))
        data, _ = _taken(coded, at, sum(packed), encoded)
        blocks, first = [], 0
        for length, unpacked in zip(packed, sizes, strict=True):
            blocks.append(self._unpacked(data[first : first + length], unpacked))
            first += length
        return b"".join(blocks)

    def _unpacked(self, packed: bytes, size: int) -> bytes:
        if self.compressor == "ZLib":
            block = zlib.decompressobj().decompress(packed, size)
        elif self.compressor == "LZMA":
            block = lzma.LZMADecompressor().decompress(packed, size)
        else:
            block = lz4_block(packed, size)
        if len(block) != size:
            raise ValueError(f"a block must hold {size} bytes, got {len(block)}")
        return block

    def _error(self, problem: str) -> FileError:
        return FileError(self.path, problem)


def _taken(coded: bytes, at: int, n: int, encoded: bool) -> tuple[bytes, int]:
    # n bytes from a place, and the place behind them
    stop = at + (-(-n // 3) * 4 if encoded else n)
    if at < 0 or stop > len(coded):
        raise ValueError(f"{stop - at:,} bytes are declared, {max(len(coded) - at, 0):,} are there")
    part = coded[at:stop]
    try:
        return (base64.b64decode(part, validate=True)[:n] if encoded else part), stop
    except binascii.Error as reason:
        raise ValueError(f"it is no base64: {reason}") from None


def lz4_block(packed: bytes, size: int) -> bytes:
    r"""Return the ``size`` bytes of a block of LZ4: literals, then a copy of what came before, ...

    Raises
    ------
    ValueError, IndexError
        If the block is damaged.

    Examples
    --------
    >>> lz4_block(b"\x34abc\x03\x00\x10!", 12)
    b'abcabcabcab!'
    """
    found = bytearray()
    at = 0

    def length(nibble: int, at: int) -> tuple[int, int]:
        while nibble >= 15:  # further bytes add to it, up to one below 255
            nibble, at = nibble + packed[at], at + 1
            if packed[at - 1] < 255:
                break
        return nibble, at

    while at < len(packed):
        token = packed[at]
        n, at = length(token >> 4, at + 1)
        found += packed[at : at + n]
        at += n
        if at >= len(packed):
            break
        back = packed[at] | packed[at + 1] << 8
        n, at = length(token & 15, at + 2)
        n += 4
        if not 0 < back <= len(found) or len(found) + n > size:
            raise ValueError("a copy leads out of its block")
        start = len(found) - back
        found += (found[start : start + n] * (n // back + 1))[:n]
    return bytes(found)
