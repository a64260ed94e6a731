"""Which arrays a step reads and writes, found out by trial, and how many bytes they are.

A floor that every memory-bound step has: each array read once and, if it changes, written once.
What counts is not taken from a list of names but tried on a small disc: an array that differs
after a step is written; one whose alteration alters anything else after the step is read. Flags
(one byte a row) are left out, as altering them could send a kernel out of its arrays; so are arrays
of whole numbers that are zero throughout.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from shellcut import Simulation

Array = np.ndarray[Any, Any]

_TRIAL_SIDE = 8  # quads along the core's side of the disc on which it is tried


def arrays_of(sim: Simulation) -> dict[str, Array]:
    """Return the arrays of shell and state by their path, each piece of memory once."""
    found: dict[str, Array] = {}
    for root in ("state", "shell"):  # the shell keeps hold of the state
        _collect(getattr(sim, root), root, found, set())
    owners = {_owner_id(array) for array in found.values() if array.base is None}
    seen: set[tuple[Any, ...]] = set()
    kept = {}
    for path, array in found.items():
        key = (array.__array_interface__["data"][0], array.shape, array.strides)
        is_view = array.base is not None and _owner_id(array) in owners
        if array.size and not is_view and key not in seen:
            seen.add(key)
            kept[path] = array
    return kept


def _owner_id(array: Array) -> int:
    while isinstance(array.base, np.ndarray):
        array = array.base
    return id(array)


def _collect(thing: Any, path: str, found: dict[str, Array], met: set[int]) -> None:
    if id(thing) in met:
        return
    if isinstance(thing, np.ndarray):
        if thing.dtype.kind in "fiu":
            found[path] = thing
        return
    if isinstance(thing, (list, tuple)):
        parts = {str(i): part for i, part in enumerate(thing)}
    elif isinstance(thing, dict):
        parts = {str(key): part for key, part in thing.items()}
    elif type(thing).__module__.split(".")[0] == "shellcut":
        slots = getattr(type(thing), "__slots__", ())
        parts = {**getattr(thing, "__dict__", {}), **{s: getattr(thing, s) for s in slots}}
    else:
        return
    met.add(id(thing))
    for name, part in parts.items():
        _collect(part, f"{path}.{name}", found, met)


def accesses(build: Callable[[int], Simulation]) -> dict[str, int]:
    """Return how often a step goes over each array: 1 if it reads it, 2 if it changes it.

    Parameters
    ----------
    build : callable
        Makes the simulation on a disc with so many quads along its core's side.
    """
    before = _after_steps(build, 2)
    reference = _after_steps(build, 3)
    counts = {}
    for path in before:
        if before[path] != reference[path]:
            counts[path] = 2
        elif _is_read(build, path, reference):
            counts[path] = 1
    return counts


def bytes_per_step(sim: Simulation, counts: dict[str, int]) -> int:
    """Return the bytes of one step, with the accesses found on a small disc."""
    arrays = arrays_of(sim)
    return sum(arrays[path].nbytes * n for path, n in counts.items() if path in arrays)


def _after_steps(build: Callable[[int], Simulation], steps: int) -> dict[str, bytes]:
    sim = build(_TRIAL_SIDE)
    for _ in range(steps):
        sim.step()
    return {path: array.tobytes() for path, array in arrays_of(sim).items()}


def _is_read(build: Callable[[int], Simulation], path: str, reference: dict[str, bytes]) -> bool:
    sim = build(_TRIAL_SIDE)
    sim.step()
    sim.step()
    array = arrays_of(sim)[path]
    if not array.flags.writeable:
        array.flags.writeable = True
    # Whole numbers are indices or counts: zero is a valid one.
    array[...] = 0 if array.dtype.kind in "iu" else array * 1.001 + 0.001
    try:
        sim.step()
    except RuntimeError:  # the altered disc blew up: the array matters
        return True
    after = {p: a.tobytes() for p, a in arrays_of(sim).items()}
    return any(after.get(p) != value for p, value in reference.items() if p != path)


if __name__ == "__main__":
    # In a process of its own: an altered index could end it.
    import json
    import sys

    from benchmarks.discs import build_mesh, pressurised_disc

    print(json.dumps(accesses(lambda side: pressurised_disc(build_mesh(side), sys.argv[1]))))
