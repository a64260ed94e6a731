"""Print how the torque's parts and its work agree with the torque and the tool's work."""

import json
import sys

import numpy as np

import shellcut

h = shellcut.read(sys.argv[1]).history
torque, peak = h["torque"], h["torque"].max()
teeth = sum(h[name] for name in h if name.startswith("torque_tooth_"))
terms = h["torque_contact"] + h["torque_points"] + h["torque_joints"]
parts = max(np.abs(part - torque).max() for part in (terms, teeth))
cutting = (h["angle"] > 15.0) & (h["angle"] < 70.0)
# The screw's advance is 12 mm a turn, downwards; the axial force resists it.
work = np.trapezoid(torque, np.radians(h["angle"]))
work += np.trapezoid(h["axial_force"], 12.0 * h["angle"] / 360.0)
print(
    json.dumps(
        {
            "least": torque[cutting].min(),
            "parts": parts / peak,
            "work": work / h["tool_work"][-1] - 1.0,
        }
    )
)
