"""Use ``shellcut.read`` as a notebook would, and print what was found."""

import json
import sys
from pathlib import Path

import numpy as np

import shellcut

out = Path(sys.argv[1])
results = shellcut.read(out)
torque = results.history["torque"]
assert np.isfinite(torque).all()
assert len(torque) == len(results.history["angle"]) > 1000
frame = results.frame(10)
assert frame.points.shape[1] == 3
assert np.isfinite(frame.points).all()
assert len(frame.crack_edges), "there must be a crack in frame 10"
picture = out / "torque_again.png"
results.plot_torque(picture)
assert picture.stat().st_size > 10_000
picture.unlink()
found = {
    "peak": float(torque.max()),
    "unit": results.units["torque"],
    "n_frame": results.n_frame,
    "crack": float(results.cut_quality()["crack_length"][-1]),
    "rows": len(torque),
}
try:
    table = results.to_pandas()
except ImportError as missing:
    found["without_pandas"] = str(missing)
else:
    found["rows_pandas"] = len(table)
    (column,) = (name for name in table.columns if name.split(" [")[0] == "torque")
    assert np.array_equal(table[column].to_numpy(), torque)
print(json.dumps(found))
