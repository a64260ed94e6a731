"""Write 0.8 of a run's torque as a German test machine would; print how the two must compare.

The figures are worked out here from the numbers in the file, by the definitions of
``docs/howto/compare.md`` and without the library's comparison.
"""

import json
import sys
from pathlib import Path

import numpy as np

import shellcut

EVERY = 7  # rows; the points of the file stand on rows of the history

history = shellcut.read(sys.argv[1]).history
angle, torque = history["angle"], history["torque"]
peak = int(np.argmax(torque))
rows = np.union1d(np.arange(300, 1700, EVERY), [peak])
lines = ["Kappe 7;;", "Nr;Winkel [Grad];Drehmoment [Ncm]"]
texts = [(f"{angle[k]:.6f}", f"{0.08 * torque[k]:.6f}") for k in rows]
lines += [f"{n};{x};{y}".replace(".", ",") for n, (x, y) in enumerate(texts)]
Path(sys.argv[2]).write_text("\n".join([*lines, ""]), encoding="latin-1")

x = np.array([float(x) for x, _ in texts])
measured = np.array([10.0 * float(y) for _, y in texts])  # N*mm
simulated = np.interp(x, angle, torque)
weights = np.zeros_like(x)
weights[:-1] += 0.5 * np.diff(x)
weights[1:] += 0.5 * np.diff(x)
rms = float(np.sqrt((weights * (simulated - measured) ** 2).sum() / (x[-1] - x[0])))
inside = (angle > x[0]) & (angle < x[-1])
fine_x = np.concatenate([x[:1], angle[inside], x[-1:]])
fine_y = np.interp(fine_x, angle, torque)
work = float(np.trapezoid(fine_y, np.radians(fine_x)))
work_measured = float(np.trapezoid(measured, np.radians(x)))
print(
    json.dumps(
        {
            "rms": rms,
            "rms_relative": rms / measured.max(),
            "peak_simulated": torque[peak],
            "peak_measured": measured.max(),
            "peak_error": torque[peak] / measured.max() - 1.0,
            "peak_at_measured": angle[peak],
            "work_simulated": work,
            "work_measured": work_measured,
            "work_error": work / work_measured - 1.0,
        }
    )
)
