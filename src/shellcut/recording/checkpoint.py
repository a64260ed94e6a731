"""Checkpoints: all that has changed since a simulation was built, in one HDF5 file.

The file begins with a text of 512 bytes, HDF5's user block: what it is, the number of its format,
and the SHA-256 of all that follows. It is compared before HDF5 sees the file, which might find
other numbers in a damaged one, or types that are none.

A checkpoint holds no model. The simulation is built again from the same inputs, by the same script
or model file, and then takes over the checkpoint; functions of the user's own (factors of loads,
velocities of supports) are part of the script. What makes a run what it is, mesh, material, tool
and so on, is written down as text and digests, and compared before anything is taken over.

From a checkpoint a run goes on bit for bit: each class names its own history in ``saved`` and takes
it over in ``restore``; what follows from it by the same functions is made again.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from shellcut.files.whole_file import write_all, written_whole
from shellcut.simulation.simulation import Simulation
from shellcut.tool.pose import Pose

_KIND = "shellcut checkpoint"
_FORMAT = 7  # to be raised whenever the names or the meaning of what is saved change

_HEADER = 512  # bytes; the least that HDF5 takes for a user block
_FORMAT_TOLD = re.compile(rb"%s, format (\d{1,9})\n" % _KIND.encode())
_HDF5 = b"\x89HDF\r\n\x1a\n"  # begins a file without user block, as of format 3 and before
_PIECE = 1 << 20  # bytes read at a time

# What names and describes an input without being part of it.
_LABELS = frozenset({"name", "parameters"})

_KINDS_OF_NUMBERS = {"b": "bool", "i": "int", "u": "int", "f": "float", "U": "text", "O": "text"}

_MOST_DIFFERENCES = 10
_SHOWN = 9  # numbers of an array that are written out


class CheckpointError(ValueError):
    """A file that is no checkpoint, or one of another model; the message lists what differs."""


def save_checkpoint(
    sim: Simulation,
    path: str | os.PathLike[str],
    *,
    extra: Mapping[str, Any] | None = None,
) -> None:
    """Write a checkpoint; the run is not changed by it.

    The file is written beside ``path`` and takes its place when it is complete and on the disk: a
    kill or a full disk leaves the former checkpoint as it was.

    Parameters
    ----------
    sim : Simulation
        Between two steps.
    path : path
        The file, by custom ``checkpoint.h5``.
    extra : mapping of str, optional
        Numbers, texts and arrays to go with it, nested if need be; :func:`load_checkpoint` returns
        them.

    Raises
    ------
    RuntimeError
        If an exception has left the simulation in the middle of a step.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from shellcut.models import guillotine
    >>> folder = tempfile.TemporaryDirectory()
    >>> def build():
    ...     return guillotine(1.0, length=6.0, width=4.0, travel=1.5).simulation
    >>> sim = build()
    >>> sim.run(1e-6)
    >>> save_checkpoint(sim, f"{folder.name}/checkpoint.h5")
    >>> again = build()
    >>> load_checkpoint(again, f"{folder.name}/checkpoint.h5")
    {}
    >>> again.state.step == sim.state.step
    True
    >>> folder.cleanup()
    """
    if not sim.between_steps:
        raise RuntimeError(
            f"a checkpoint is made between two steps, but step {sim.state.step} was not completed; "
            "go on from an earlier checkpoint"
        )
    path = Path(path)
    # In memory first: what meets a full disk shall not be HDF5, see hdf_target.
    image = io.BytesIO()
    with h5py.File(image, "w", userblock_size=_HEADER) as file:
        file.attrs["version"] = version("shellcut")
        inputs = json.dumps(_described_inputs(sim))
        _write(file, {"inputs": inputs, "run": sim.saved(), "extra": dict(extra or {})})
    image.getbuffer()[:_HEADER] = _header(hashlib.sha256(image.getbuffer()[_HEADER:]).hexdigest())
    with written_whole(path) as aside, aside.open("wb", buffering=0) as target:
        write_all(target, image.getbuffer())
        os.fsync(target.fileno())


def load_checkpoint(sim: Simulation, path: str | os.PathLike[str]) -> dict[str, Any]:
    """Put a simulation that was just built into the state of a checkpoint; return its ``extra``.

    Parameters
    ----------
    sim : Simulation
        Built from the same inputs, at its first step; the number of threads and the
        :class:`Stepping` may differ.
    path : path
        A file of :func:`save_checkpoint`.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    CheckpointError
        If it is no checkpoint, damaged, of another format, or of other inputs, with all that
        differs; the simulation is then as it was.
    ValueError
        If the simulation has already run.

    Examples
    --------
    >>> import tempfile
    >>> from shellcut.models import guillotine
    >>> folder = tempfile.TemporaryDirectory()
    >>> path = f"{folder.name}/checkpoint.h5"
    >>> def build():
    ...     return guillotine(1.0, length=6.0, width=4.0, notch=1.0).simulation
    >>> save_checkpoint(build(), path, extra={"note": "at rest"})
    >>> load_checkpoint(build(), path)
    {'note': 'at rest'}
    >>> folder.cleanup()
    """
    if sim.state.step:
        raise ValueError(
            f"a checkpoint is loaded into a simulation just built, this one is at step "
            f"{sim.state.step}: build it again"
        )
    path = Path(path)
    content = _read_file(path)
    known, given = json.loads(content["inputs"]), _described_inputs(sim)
    differing = [
        f"{name}: {known.get(name, 'nothing')} in the checkpoint, "
        f"{given.get(name, 'nothing')} in this simulation"
        for name in {**known, **given}
        if known.get(name) != given.get(name)
    ]
    if not differing:
        # Tables that are empty at the start have no types yet to compare with.
        differing = [*_differing_layout("run", sim.saved(), content["run"])]
    if not differing:
        differing = _differing_poses(sim, content["run"])
    if differing:
        more = len(differing) - _MOST_DIFFERENCES
        lines = differing[:_MOST_DIFFERENCES] + ([f"and {more} more"] if more > 0 else [])
        raise CheckpointError(
            f"{path} belongs to another model; build the simulation as it was, or begin anew:\n"
            + "\n".join(f"- {line}" for line in lines)
        )
    try:
        sim.restore(content["run"])
    except (ValueError, TypeError, KeyError, IndexError, AttributeError) as problem:
        raise CheckpointError(
            f"{path} cannot be taken over ({problem}): another program wrote it; begin anew, with "
            "the simulation built again"
        ) from problem
    extra: dict[str, Any] = content["extra"]
    return extra


def _header(digest: str) -> bytes:
    text = f"{_KIND}, format {_FORMAT}\nsha256 of what follows: {digest}\n"
    return text.encode().ljust(_HEADER, b"\0")


def _read_file(path: Path) -> dict[str, Any]:
    if not path.exists():
        raise FileNotFoundError(f"there is no checkpoint {path}")
    damage = f"{path} is damaged, or no checkpoint of shellcut"
    if not path.is_file():
        raise CheckpointError(f"{damage} (no regular file)")
    try:
        with path.open("rb") as file:
            header = file.read(_HEADER)
            digest = hashlib.sha256()
            while piece := file.read(_PIECE):
                digest.update(piece)
        told = _FORMAT_TOLD.match(header)
        if (told and int(told[1]) != _FORMAT) or header.startswith(_HDF5):
            found = f"has format {int(told[1])}" if told else "is none, or of an older format"
            raise CheckpointError(
                f"{path} {found}; this version of shellcut reads its checkpoints of format "
                f"{_FORMAT}: go on with the version that wrote it, or begin anew"
            )
        if header != _header(digest.hexdigest()):
            raise CheckpointError(f"{damage} (its SHA-256 is another); begin anew")
        with h5py.File(path, "r") as file:
            content = _read(file)
    except OSError as problem:
        raise CheckpointError(f"{damage} ({problem}); begin anew") from problem
    if set(content) != {"inputs", "run", "extra"}:
        raise CheckpointError(f"{damage} (it holds {', '.join(content)}); begin anew")
    return content


# ---------------------------------------------------------------- dictionaries in HDF5


def _write(group: Any, content: Mapping[str, Any]) -> None:
    for name, value in content.items():
        if isinstance(value, Mapping):
            _write(group.create_group(name), value)
            continue
        rows = np.asarray(value)
        if rows.dtype.kind == "U":
            rows = rows.astype(h5py.string_dtype())
        group.create_dataset(name, data=rows)


def _read(group: Any) -> dict[str, Any]:
    content: dict[str, Any] = {}
    for name, node in group.items():
        if isinstance(node, h5py.Group):
            content[name] = _read(node)
            continue
        text = h5py.check_string_dtype(node.dtype) is not None
        rows = np.asarray((node.asstr() if text else node)[()])
        content[name] = rows.item() if rows.ndim == 0 else rows
    return content


# ---------------------------------------------------------------- what a run is made of


def _described_inputs(sim: Simulation) -> dict[str, str]:
    """Return every number and array of the inputs as text, by a name like "law.strength"."""
    return dict(line for name, value in sim.inputs.items() for line in _described(name, value))


def _described(name: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, np.ndarray):
        yield name, _digest(value)
    elif is_dataclass(value):
        yield name, type(value).__name__
        for item in fields(value):
            if item.init and item.name not in _LABELS:
                yield from _described(f"{name}.{item.name}", getattr(value, item.name))
    elif isinstance(value, Mapping):
        for key, one in value.items():
            yield from _described(f"{name}[{key!r}]", one)
    elif isinstance(value, Sequence) and not isinstance(value, str):
        if all(isinstance(one, (int, float, np.number)) for one in value):
            yield name, _digest(np.array(value, float))
            return
        yield name, f"{len(value)} entries"
        for k, one in enumerate(value):
            yield from _described(f"{name}[{k}]", one)
    elif callable(value):
        yield name, "a function"
    elif isinstance(value, (int, float, np.number)):
        yield name, repr(float(value))
    elif value is None or isinstance(value, str):
        yield name, repr(value)
    else:
        yield name, type(value).__name__


def _digest(rows: Any) -> str:
    if rows.size <= _SHOWN:
        return str(rows.tolist())
    digest = hashlib.sha256(rows.tobytes()).hexdigest()[:16]
    return f"{' x '.join(map(str, rows.shape))} numbers ({digest})"


def _differing_layout(name: str, wanted: Any, found: Any) -> Iterator[str]:
    """Yield what of the checkpoint could not be taken over: names and kinds of numbers."""
    if isinstance(wanted, Mapping) and isinstance(found, Mapping):
        for key in {**wanted, **found}:
            if key in wanted and key in found:
                yield from _differing_layout(f"{name}.{key}", wanted[key], found[key])
            else:
                there = "in the checkpoint" if key in found else "in this simulation"
                yield f"{name}.{key}: only {there}"
    elif isinstance(wanted, Mapping) or isinstance(found, Mapping):
        yield f"{name}: a group in one, not in the other"
    elif np.size(wanted) and np.size(found) and _kind_of(wanted) != _kind_of(found):
        yield f"{name}: {_kind_of(found)} in the checkpoint, {_kind_of(wanted)} in this simulation"


def _kind_of(value: Any) -> str:
    rows = np.asarray(value)
    kind = _KINDS_OF_NUMBERS.get(rows.dtype.kind, str(rows.dtype))
    return f"{kind} of {rows.ndim} dimensions" if rows.ndim else kind


def _differing_poses(sim: Simulation, run: dict[str, Any]) -> list[str]:
    """Compare the tool's present pose, which any motion has, also one of the user's own."""
    if sim.motion is None:
        return []
    time = run["state"]["time"]
    pose = Pose.of(*sim.motion.pose(time))._asdict()
    return [
        f"motion: the {name} at {time:.6g} s is {run['pose'][name].tolist()} in the checkpoint, "
        f"{found.tolist()} in this simulation"
        for name, found in pose.items()
        if not np.array_equal(found, run["pose"][name])
    ]
