"""Works of a blade per length of its cut, over whole node periods of the steady part."""

import numpy as np

from shellcut.models import Case


def steady_works(
    case: Case, size: float, begin: float, *names: str
) -> tuple[list[float], float, np.ndarray]:
    """Run; return mean growths [N] of works, the largest imbalance, and rows of travel and works.

    The means are over periods of ``size`` [mm] from ``begin`` [mm] on; the imbalance is relative to
    the first of the works.
    """
    sim, rows = case.simulation, []
    while sim.state.time < case.duration:
        sim.step()
        book, path = sim.ledger, sim.motion.coordinate(sim.state.time)
        rows.append((path, *(getattr(book, name) for name in names), book.imbalance))
    path, *works, imbalance = np.array(rows).T
    length = int((path[-1] - begin) / size) * size
    ends = np.array([begin, begin + length])
    means = [float(np.diff(np.interp(ends, path, work))[0] / length) for work in works]
    return means, float(np.abs(imbalance).max() / works[0].max()), np.array([path, *works])
