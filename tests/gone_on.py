"""A run that goes on from a checkpoint, compared with the uninterrupted one."""

import numpy as np

from shellcut.numerics.kernel_tables import TableAddress
from shellcut.recording.checkpoint import load_checkpoint, save_checkpoint


def flat(saved, prefix=""):
    """Return nested dictionaries as one, of arrays."""
    rows = {}
    for name, value in saved.items():
        rows |= (
            flat(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value}
        )
    return {name: np.array(value) for name, value in rows.items()}


def differing(a, b):
    """Return the names of what is saved of one simulation and not the same of the other."""
    mine, other = flat(a.saved()), flat(b.saved())
    assert mine.keys() == other.keys()
    return [
        name
        for name, rows in mine.items()
        if rows.dtype != other[name].dtype or not np.array_equal(rows, other[name])
    ]


# Follows from the state whenever it is asked for, at the latest at the next step.
_CACHES = {
    "_tables",
    "_partings",
    "_table",
    "_nodes",
    "_pool",
    "_address",
    "_addresses",
    "_driven_address",
}


def numbers_of(thing, path="sim", seen=None):
    """Return every array and number that can be reached from an object, by its path."""
    seen = set() if seen is None else seen
    if isinstance(thing, TableAddress):
        thing = thing.table
    if isinstance(thing, (bool, int, float, str, np.ndarray)):
        return {path: np.array(thing)}
    if not isinstance(thing, tuple):  # whether two places share one is of no meaning
        if id(thing) in seen:
            return {}
        seen.add(id(thing))
    parts = {}
    if isinstance(thing, dict):
        parts = {f"[{key!r}]": value for key, value in thing.items()}
    elif isinstance(thing, (list, tuple)):
        parts = {f"[{k}]": value for k, value in enumerate(thing)}
    elif type(thing).__module__.startswith("shellcut"):
        names = {*getattr(thing, "__dict__", {}), *getattr(thing, "_fields", ())} - _CACHES
        parts = {f".{name}": getattr(thing, name) for name in sorted(names)}
    found = {}
    for name, part in parts.items():
        found |= numbers_of(part, path + name, seen)
    return found


def check_goes_on(build, reached, path, n_step):
    """Save a run that has ``reached`` something; go on with it and from the file on two threads.

    Returns the run, its ledger closed.
    """
    sim, other = build(threads=1), build(threads=2)
    while not reached(sim):
        sim.step()
        assert sim.state.step < 20_000
    save_checkpoint(sim, path)
    load_checkpoint(other, path)
    before = sim.state.node.x.copy()
    for one in (sim, other):
        for _ in range(n_step):
            one.step()
        one.close_ledger()
    assert differing(sim, other) == []
    assert not np.array_equal(sim.state.node.x, before)
    assert abs(sim.ledger.imbalance) < 5e-3 * sim.ledger.put_in
    return sim
