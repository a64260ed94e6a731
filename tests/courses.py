"""What a run says along its way."""

import numpy as np

UNDAMPED = {"damping_alpha": 0.0, "damping_beta": 0.0}


def recorded(sim, until, read, every=1):
    """Run until a time [s], or until ``until(sim)`` holds; return rows of what ``read(sim)`` gives.

    Of every so many steps; the numbers of one step are a column.
    """
    reached = until if callable(until) else (lambda one: one.state.time >= until)
    columns = []
    while not reached(sim):
        sim.step()
        if sim.state.step % every == 0:
            columns.append(read(sim))
    return np.array(columns).T


def course(sim, until, *names, every=100, close=True):
    """Run as :func:`recorded`; return the way of the tool and entries of the ledger.

    The time is the way where there is no tool. ``close`` : the ledger, which takes time.
    """

    def read(sim):
        book, now = sim.close_ledger() if close else sim.ledger, sim.state.time
        way = now if sim.motion is None else sim.motion.coordinate(now)
        return [way, *(getattr(book, name) for name in names)]

    return recorded(sim, until, read, every)


def moved_by(way):
    """Return whether the tool has moved by a way, as a condition of a run."""
    return lambda sim: sim.motion.coordinate(sim.state.time) >= way


def growth(way, work, first, last):
    """Return by how much a work grows per way, from one place to another."""
    return float(np.diff(np.interp([first, last], way, work))[0] / (last - first))


def over_periods(way, works, first, size):
    """Return the growths of works per way over whole spacings of the nodes from a place on."""
    last = first + int((way[-1] - first) / size) * size
    return [growth(way, work, first, last) for work in works]


def largest_share(imbalance, work, least):
    """Return the largest imbalance over the work done so far, once that is more than ``least``."""
    counted = work > least
    return np.abs(imbalance[counted] / work[counted]).max()


def worst(tool, imbalance):
    """Return the largest imbalance after the first tenth of the tool's work, relative to that."""
    return np.abs(imbalance[tool > 0.1 * tool.max()]).max() / tool.max()


def steady_works(case, size, begin, *names):
    """Run a case; return growths [N] of works, the largest imbalance, and rows of way and works.

    The growths are over whole spacings ``size`` [mm] of the nodes from ``begin`` [mm] on; the
    imbalance is relative to the first of the works.
    """
    names = *names, "imbalance"
    way, *works, imbalance = course(case.simulation, case.duration, *names, every=1, close=False)
    share = float(np.abs(imbalance).max() / works[0].max())
    return over_periods(way, works, begin, size), share, np.array([way, *works])
