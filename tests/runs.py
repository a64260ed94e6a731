"""Run a case into a folder and read what it left."""

import json

import numpy as np

from shellcut.results.history import read_history


def run(case, folder):
    """Run without pictures and return summary and history."""
    case.run(folder, n_frame=4, n_snapshot=0, curves=False, progress=False)
    summary = json.loads((folder / "summary.json").read_text())
    return summary, read_history(folder / "history.csv")[0]


def mean_force(history, energy, start, length):
    """Return the growth of an energy over a piece of the path [N]."""
    path = history["path"]
    assert path[-1] >= start + length
    ends = np.interp([start, start + length], path, history[energy])
    return float((ends[1] - ends[0]) / length)


def broken_ratio(case):
    """Return work over G A of every broken cable."""
    cable = case.simulation.state.cable
    broken = cable.status[: cable.count] == 2
    fracture_energy = case.simulation.law.fracture_energy
    return cable.work[: cable.count][broken] / (fracture_energy * cable.area[: cable.count][broken])
