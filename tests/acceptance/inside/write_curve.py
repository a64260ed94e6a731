"""Write a run's torque over its angle as a table with units in its headings."""

import json
import sys
from pathlib import Path

import shellcut

history = shellcut.read(sys.argv[1]).history
rows = zip(history["angle"], history["torque"], strict=True)
lines = ["angle [deg],torque [N*mm]", *(f"{x:.6f},{y:.6f}" for x, y in rows)]
Path(sys.argv[2]).write_text("\n".join([*lines, ""]), encoding="utf-8")
print(json.dumps({"rows": len(lines) - 1}))
