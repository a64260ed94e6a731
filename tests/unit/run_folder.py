"""The folder of a run with a made-up torque, for what reads results."""

import numpy as np

from opening_frame import opening_frame
from shellcut.history import HistoryWriter
from shellcut.vtkhdf import VtkHdfWriter


def write_run(folder, name, angle, torque):
    """Write one frame and a row of history an angle [deg] and torque [N*mm]; return the folder."""
    folder.mkdir()
    with VtkHdfWriter(folder / f"{name}.vtkhdf") as writer:
        writer.append(opening_frame(0.0, n_side=4))
    columns = [("time", "s"), ("angle", "deg"), ("torque", "N*mm")]
    with HistoryWriter(folder / "history.csv", columns) as history:
        for time, a, t in zip(1e-5 * np.arange(len(angle)), angle, torque, strict=True):
            history.append({"time": time, "angle": a, "torque": t})
    return folder
