"""Print when the last frame of a run was written."""

import json
import sys

import shellcut

results = shellcut.read(sys.argv[1])
frame = results.frame(-1)
print(json.dumps({"time": frame.time, "n_frame": results.n_frame, "n_point": len(frame.points)}))
