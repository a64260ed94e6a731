"""Checkpoints: everything that changed since the simulation was built, in one HDF5 file.

The file begins with 512 bytes of text (HDF5's user block): the kind of file, its format number and
the SHA-256 of the rest. Loading compares the digest before HDF5 opens the file, because HDF5 may
read wrong numbers or invalid types from a damaged file.

A checkpoint does not contain the model (docs/howto/resume.md). It lists the inputs as text and
digests, and loading compares them first.

A resumed run continues bit for bit: each class saves its own history in ``saved`` and loads it in
``restore``; everything that follows from the history is recomputed.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from shellcut.arguments import checked
from shellcut.files.distribution import VERSION
from shellcut.files.whole_file import atomic_write, write_all
from shellcut.tool.pose_of_motion import pose_at

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_KIND = "shellcut checkpoint"
_FORMAT = 41  # raise it whenever names or meaning of the saved values change

_HEADER = 512  # bytes; the smallest user block HDF5 accepts
_FORMAT_TOLD = re.compile(rb"%s, format (\d{1,9})\n" % _KIND.encode())
_PIECE = 1 << 20  # bytes read at a time

# Fields that only name or describe an input.
_LABELS = frozenset({"name", "parameters"})

_MOST_DIFFERENCES = 10
_SHOWN = 9  # arrays up to this many numbers are written out


class CheckpointError(ValueError):
    """The file is no checkpoint, or belongs to another model; the message lists the differences."""


@checked
def save_checkpoint(
    sim: Simulation,
    path: str | os.PathLike[str],
    *,
    extra: Mapping[str, Any] | None = None,
) -> None:
    """Write a checkpoint; this does not change the run.

    The file is written under a temporary name and replaces ``path`` once it is complete on the
    disk: after a kill or on a full disk the previous checkpoint is still there.

    Parameters
    ----------
    sim : Simulation
        Between two steps.
    path : path
        The file, usually ``checkpoint.h5``.
    extra : mapping of str, optional
        Numbers, texts and arrays to store with it, nested if needed; :func:`load_checkpoint`
        returns them.

    Raises
    ------
    RuntimeError
        If an exception stopped the simulation in the middle of a step.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> from shellcut.models import guillotine
    >>> def build():
    ...     return guillotine(1.0, length=6.0, width=4.0, travel=1.5).simulation
    >>> sim, again = build(), build()
    >>> sim.run(1e-6)
    >>> save_checkpoint(sim, "checkpoint.h5", extra={"note": "begun"})
    >>> load_checkpoint(again, "checkpoint.h5"), again.state.step == sim.state.step
    ({'note': 'begun'}, True)
    """
    if not sim.between_steps:
        raise RuntimeError(
            f"a checkpoint must be made between two steps, but step {sim.state.step} was not "
            "completed; resume from an earlier checkpoint"
        )
    path = Path(path)
    # Build the file in memory: HDF5 must not hit a full disk itself, see hdf_target.
    image = io.BytesIO()
    with h5py.File(image, "w", userblock_size=_HEADER) as file:
        file.attrs["version"] = VERSION
        inputs = json.dumps(_described_inputs(sim))
        _write(file, {"inputs": inputs, "run": sim.saved(), "extra": dict(extra or {})})
    image.getbuffer()[:_HEADER] = _header(hashlib.sha256(image.getbuffer()[_HEADER:]).hexdigest())
    with atomic_write(path) as temporary, temporary.open("wb", buffering=0) as target:
        write_all(target, image.getbuffer())
        os.fsync(target.fileno())


@checked
def load_checkpoint(sim: Simulation, path: str | os.PathLike[str]) -> dict[str, Any]:
    """Put a newly built simulation into the state of a checkpoint; return its ``extra``.

    Parameters
    ----------
    sim : Simulation
        Built from the same inputs and not yet run; the number of threads and the
        :class:`Stepping` may differ.
    path : path
        A file written by :func:`save_checkpoint`.

    Raises
    ------
    FileNotFoundError
        If the file does not exist.
    CheckpointError
        If the file is no checkpoint, is damaged, has another format or other inputs; the message
        lists all differences, and the simulation is unchanged.
    ValueError
        If the simulation has already run.

    Examples
    --------
    >>> extra = load_checkpoint(built_again, "out/checkpoint.h5")  # doctest: +SKIP
    """
    if sim.state.step:
        raise ValueError(
            f"a checkpoint must be loaded into a simulation that has not run yet, but this one is "
            f"at step {sim.state.step}: build it again"
        )
    path = Path(path)
    content = _read_file(path)
    known, given = json.loads(content["inputs"]), _described_inputs(sim)
    differing = [
        f"{name}: {known.get(name, 'nothing')} in the checkpoint, "
        f"{given.get(name, 'nothing')} in this simulation"
        for name in {**known, **given}
        if known.get(name) != given.get(name)
    ] or _differing_poses(sim, content["run"])
    if differing:
        more = len(differing) - _MOST_DIFFERENCES
        lines = differing[:_MOST_DIFFERENCES] + ([f"and {more} more"] if more > 0 else [])
        raise CheckpointError(
            f"{path} belongs to another model; build the same simulation again, or start anew:\n"
            + "\n".join(f"- {line}" for line in lines)
        )
    sim.restore(content["run"])
    return dict(content["extra"])


def _header(digest: str) -> bytes:
    text = f"{_KIND}, format {_FORMAT}\nsha256 of what follows: {digest}\n"
    return text.encode().ljust(_HEADER, b"\0")


def _read_file(path: Path) -> dict[str, Any]:
    if not path.exists():
        raise FileNotFoundError(f"there is no checkpoint {path}")
    damage = f"{path} is damaged, or not a checkpoint of shellcut"
    if not path.is_file():
        raise CheckpointError(f"{damage} (not a regular file)")
    try:
        with path.open("rb") as file:
            header = file.read(_HEADER)
            digest = hashlib.sha256()
            while piece := file.read(_PIECE):
                digest.update(piece)
        told = _FORMAT_TOLD.match(header)
        if told and int(told[1]) != _FORMAT:
            raise CheckpointError(
                f"{path} has format {int(told[1])}; this version of shellcut reads checkpoints of "
                f"format {_FORMAT}: resume with the version that wrote it, or start a new run"
            )
        if header != _header(digest.hexdigest()):
            raise CheckpointError(f"{damage} (wrong SHA-256); start a new run")
        with h5py.File(path, "r") as file:
            return _read(file)
    except OSError as problem:
        raise CheckpointError(f"{damage} ({problem}); start a new run") from problem


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


# ---------------------------------------------------------------- inputs of a run


def _described_inputs(sim: Simulation) -> dict[str, str]:
    """Return every number and array of the inputs as text, under names like "law.strength"."""
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


def _differing_poses(sim: Simulation, run: dict[str, Any]) -> list[str]:
    """Compare the tool's present pose: this works for any motion, also a user's own class."""
    if sim.motion is None:
        return []
    time = run["state"]["time"]
    pose = pose_at(sim.motion, time)._asdict()
    return [
        f"motion: the {name} at {time:.6g} s is {run['pose'][name].tolist()} in the checkpoint, "
        f"{found.tolist()} in this simulation"
        for name, found in pose.items()
        if not np.array_equal(found, run["pose"][name])
    ]
