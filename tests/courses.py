"""What the ledger of a run says along its way."""

import numpy as np


def course(sim, until, *names, every=100):
    """Run until a time [s], or until ``until(sim)`` holds; return way and entries of the ledger.

    Rows, one for the way of the tool, the time without one, and one an entry, of every so many
    steps.
    """
    reached = until if callable(until) else (lambda one: one.state.time >= until)
    rows = []
    while not reached(sim):
        sim.step()
        if sim.state.step % every == 0:
            book = sim.close_ledger()
            now = sim.state.time
            way = now if sim.motion is None else sim.motion.coordinate(now)
            rows.append([way, *(getattr(book, name) for name in names)])
    return np.array(rows).T


def growth(way, work, first, last):
    """Return by how much a work grows per way, from one place to another."""
    return float(np.diff(np.interp([first, last], way, work))[0] / (last - first))


def largest_share(imbalance, work, least):
    """Return the largest imbalance over the work done so far, once that is more than ``least``."""
    counted = work > least
    return np.abs(imbalance[counted] / work[counted]).max()


def worst(tool, imbalance):
    """Return the largest imbalance after the first tenth of the tool's work, relative to that."""
    return np.abs(imbalance[tool > 0.1 * tool.max()]).max() / tool.max()
