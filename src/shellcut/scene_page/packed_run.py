"""Frames of a run as the content of a page: tables that change, and what stays.

Every frame has one table of integers, its rows the entities (nodes, quads, cables), which may be
more or fewer in the next. A table is packed as the difference to the frame before, of the rows that
both have, column after column: the film moves little between two frames, so nearly all bytes are
zero. Negative differences are folded between the positive ones (0, -1, 1, -2, ...), the low bytes
of a frame come before its high bytes, and zlib takes the rest. ``tables.js`` unpacks them.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats, Ints
from shellcut.frame import Frame
from shellcut.results.run_results import Results
from shellcut.unit import shown
from shellcut.view import Look, legend_of, title_parts, tool_creases
from shellcut.view.look import Field

_LOOK = Look()
_LEVEL = 7  # of zlib
_LARGEST = 65535

Unsigned = npt.NDArray[Any]
Rows = list[Any]
"""One array for each frame."""

_TABLES: dict[str, tuple[Callable[[Frame], Any], Any]] = {
    "points": (lambda frame: frame.points, np.float32),
    "cables": (lambda frame: frame.cable_segments.reshape(-1, 6), np.float32),
    "quads": (lambda frame: frame.quads, np.int32),
    "flanks": (lambda frame: frame.crack_edges.reshape(-1, 4), np.int32),
    "states": (lambda frame: frame.cable_state[:, None], np.int32),
}
"""Tables of a frame besides its fields, and as what they are kept: numbers, or ids."""
_CABLES = {"cable, straight": "straight", "cable, bent around the edge": "jointed"}
"""What these entries of the legend switch in ``scene.js``; the others switch their part."""


def _column_of(field: Field, frame: Frame) -> Floats:
    return field.values(frame)[:, None]


def packed(
    results: Results, numbers: Sequence[int], fields: Sequence[Field], look: Look
) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the description of a page's content, ready for JSON, and the packed tables by name.

    Frames are read one after the other; what the page shows of them is kept in single precision.
    """
    of_fields = {f"field-{k}": field for k, field in enumerate(fields)}
    made = _TABLES | {name: (partial(_column_of, f), np.float32) for name, f in of_fields.items()}
    rows: dict[str, Rows] = {name: [] for name in made}
    frames, legend, tool = [], dict[str, dict[str, Any]](), dict[str, Any]()
    for number in numbers:
        frame = results.frame(number)
        pose = [*frame.tool_rotation.ravel().tolist(), *frame.tool_translation.tolist()]
        frames.append({"number": number, "caption": title_parts(frame), "pose": pose})
        for name, (table, kind) in made.items():
            rows[name].append(table(frame).astype(kind))
        for entry in legend_of([frame]):
            legend[entry.name] = {
                "name": entry.name,
                "area": entry.is_area,
                "part": entry.part,
                "switch": _CABLES.get(entry.name, entry.part),
                "color": entry.color,
            }
        if not tool and (len(frame.tool_triangles) or len(frame.edge_points)):
            tool = _tool(frame)
    packers: dict[Any, Callable[[Rows], PackedTable]] = {
        np.int32: pack_ids,
        np.float32: pack_numbers,
    }
    tables = {name: packers[made[name][1]](each) for name, each in rows.items()}
    described = {
        "name": results.name,
        "length": shown("mm"),
        "frames": frames,
        "fields": [
            {
                "table": name,
                "name": field.name,
                "label": field.label,
                "unit": field.unit,
                "of": field.of,
                "limits": (look if field.name == look.field else _LOOK).limits_for(
                    [values[:, 0] for values in rows[name]], field.sign
                ),
            }
            for name, field in of_fields.items()
        ],
        "look": {
            "colors": np.round(look.colors(64), 3).tolist(),
            "field": look.field,
            "smooth": not look.flat,
            "hide": list(look.hide),
            "camera": [look.elevation, look.azimuth, look.zoom],
        },
        "tool": tool,
        "legend": list(legend.values()),
        "tables": {name: table for name, (table, _) in tables.items()},
    }
    return described, {name: data for name, (_, data) in tables.items()}


def as_json(described: object) -> str:
    """Return JSON that cannot end the script element around it."""
    text = json.dumps(described, separators=(",", ":"), ensure_ascii=False)
    return text.replace("<", "\\u003c")


def _tool(frame: Frame) -> dict[str, Any]:
    """Return the tool in its body frame: vertices and ends of edges [mm], triangles, creases."""

    def body(points: Floats) -> list[float]:
        own = (points.reshape(-1, 3) - frame.tool_translation) @ frame.tool_rotation
        return [float(f"{number:.7g}") for number in own.ravel().tolist()]

    return {
        "points": body(frame.tool_points),
        "triangles": frame.tool_triangles.ravel().tolist(),
        "creases": tool_creases(frame).ravel().tolist(),
        "edges": body(frame.edge_points),
    }


# --- packed tables --------------------------------------------------------------------------------


PackedTable: TypeAlias = tuple[dict[str, Any], str]
"""One table of all frames: what unpacking needs, and the packed bytes in base64.

Unpacking needs the number of ``columns``, that of ``rows`` in every frame, the ``bytes`` of a
number, 2 or 4, and of each column the value of the integer 0, ``low``, and of a difference of 1,
``step``; both are empty for ids.
"""


def pack_ids(tables: Sequence[Ints]) -> PackedTable:
    """Pack integers from 0 on, exactly; one table, shape (n_row, n_column), for each frame.

    A table of fewer columns than the others repeats its last one.
    """
    columns = max(table.shape[1] for table in tables)
    largest = max((int(table.max()) for table in tables if table.size), default=0)
    kind: Any = np.uint16 if largest <= _LARGEST else np.uint32
    whole = [
        np.pad(table, ((0, 0), (0, columns - table.shape[1])), mode="edge").astype(kind)
        if len(table)
        else np.zeros((0, columns), kind)
        for table in tables
    ]
    return _packed(whole, [], [])


def pack_numbers(tables: Sequence[Floats]) -> PackedTable:
    """Pack numbers in 65,536 steps over the range of their column: exact to half a step."""
    filled = [table for table in tables if len(table)] or [np.zeros((1, tables[0].shape[1]))]
    low = np.min([table.min(axis=0) for table in filled], axis=0).astype(float)
    high = np.max([table.max(axis=0) for table in filled], axis=0).astype(float)
    step = (high - low) / _LARGEST
    step[step == 0.0] = 1.0
    whole = [np.rint((table - low) / step).astype(np.uint16) for table in tables]
    return _packed(whole, low.tolist(), step.tolist())


def _packed(tables: Sequence[Unsigned], low: list[float], step: list[float]) -> PackedTable:
    n_byte, columns = tables[0].dtype.itemsize, tables[0].shape[1]
    packer = zlib.compressobj(_LEVEL)
    parts = []
    before = tables[0][:0]
    for table in tables:
        common = min(len(before), len(table))
        change = table.copy()
        change[:common] -= before[:common]  # wraps, and so does the sum that unpacks it
        parts.append(packer.compress(_planes(change)))
        before = table
    parts.append(packer.flush())
    data = base64.b64encode(b"".join(parts)).decode("ascii")
    described = {
        "columns": columns,
        "rows": [len(table) for table in tables],
        "bytes": n_byte,
        "low": low,
        "step": step,
    }
    return described, data


def _planes(change: Unsigned) -> bytes:
    """Return the folded numbers, column after column, all low bytes before all high bytes."""
    n_byte = change.dtype.itemsize
    signed = np.ascontiguousarray(change.T).ravel().astype(f"<u{n_byte}").view(f"<i{n_byte}")
    folded = (signed << 1) ^ (signed >> (8 * n_byte - 1))
    return np.ascontiguousarray(folded.view(np.uint8).reshape(-1, n_byte).T).tobytes()
