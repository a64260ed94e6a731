"""The folder of a run with a made-up torque, for what reads results."""

from contextlib import closing

import numpy as np

from opening_frame import opening_frame
from shellcut.results.history import HistoryWriter
from shellcut.results.vtkhdf import VtkHdfWriter


def write_run(folder, name, angle, torque, **lengths):
    """Write one frame and a row of history an angle [deg] and torque [N*mm]; return the folder.

    lengths : further columns [mm].
    """
    folder.mkdir()
    with closing(VtkHdfWriter(folder / f"{name}.vtkhdf")) as writer:
        writer.append(opening_frame(0.0, n_side=4))
    columns = [("time", "s"), ("angle", "deg"), ("torque", "N*mm")]
    columns += [(name, "mm") for name in lengths]
    with HistoryWriter(folder / "history.csv", columns) as history:
        rows = zip(1e-5 * np.arange(len(angle)), angle, torque, *lengths.values(), strict=True)
        for row in rows:
            history.append(dict(zip((column for column, _ in columns), row, strict=True)))
    return folder
