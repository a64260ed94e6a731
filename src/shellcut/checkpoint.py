"""Checkpoints: all that has changed since a simulation was built, in one HDF5 file.

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
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .simulation import Simulation

_KIND = "shellcut checkpoint"
_FORMAT = 2  # to be raised whenever the names or the meaning of what is saved change

# What names and describes an input without being part of it.
_LABELS = frozenset({"name", "parameters"})

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
    # In memory first: HDF5 that meets a full disk can neither go on nor close its file.
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        file.attrs["kind"], file.attrs["format"] = _KIND, _FORMAT
        file.attrs["version"] = version("shellcut")
        inputs = json.dumps(_described_inputs(sim))
        content = {"inputs": inputs, "run": sim.saved(), "extra": dict(extra or {})}
        file.attrs["sha256"] = _checksum(content)
        _write(file, content)
    aside = path.with_name(path.name + ".new")
    try:
        with aside.open("wb") as target:
            target.write(image.getbuffer())
            target.flush()
            os.fsync(target.fileno())
        os.replace(aside, path)
    except BaseException:  # of a full disk, or of a second Ctrl-C
        aside.unlink(missing_ok=True)
        raise


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
        differing = _differing_poses(sim, content["run"])
    if differing:
        more = len(differing) - _MOST_DIFFERENCES
        lines = differing[:_MOST_DIFFERENCES] + ([f"and {more} more"] if more > 0 else [])
        raise CheckpointError(
            f"{path} belongs to another model; build the simulation as it was, or begin anew:\n"
            + "\n".join(f"- {line}" for line in lines)
        )
    sim.restore(content["run"])
    extra: dict[str, Any] = content["extra"]
    return extra


def _read_file(path: Path) -> dict[str, Any]:
    if not path.exists():
        raise FileNotFoundError(f"there is no checkpoint {path}")
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("kind") != _KIND:
                raise CheckpointError(f"{path} is no checkpoint of shellcut")
            found = file.attrs["format"]
            if found != _FORMAT:
                raise CheckpointError(
                    f"{path} has format {found}, this version of shellcut reads format {_FORMAT}: "
                    "go on with the version that wrote it, or begin anew"
                )
            content = _read(file)
            if _checksum(content) != file.attrs["sha256"]:
                raise OSError("its contents do not match its checksum")
    except (OSError, KeyError, RuntimeError) as problem:
        raise CheckpointError(
            f"{path} is damaged, or no checkpoint of shellcut ({problem}); begin anew"
        ) from problem
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


def _checksum(content: Mapping[str, Any]) -> str:
    """Return a digest of all names and values, whatever their order."""
    digest = hashlib.sha256()
    for name in sorted(content):
        value = content[name]
        digest.update(name.encode())
        if isinstance(value, Mapping):
            digest.update(_checksum(value).encode())
            continue
        rows = np.asarray(value)
        numbers = rows.dtype.kind in "biuf"
        digest.update(rows.tobytes() if numbers else str(rows.tolist()).encode())
    return digest.hexdigest()


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


def _differing_poses(sim: Simulation, run: dict[str, Any]) -> list[str]:
    """Compare the tool's present pose, which any motion has, also one of the user's own."""
    if sim.motion is None:
        return []
    time = run["state"]["time"]
    pose = dict(zip(("rotation", "translation"), sim.motion.pose(time), strict=True))
    return [
        f"motion: the {name} at {time:.6g} s is {run[name].tolist()} in the checkpoint, "
        f"{found.tolist()} in this simulation"
        for name, found in pose.items()
        if not np.array_equal(found, run[name])
    ]
