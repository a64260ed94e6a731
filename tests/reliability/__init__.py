"""Is anything lost, or silently wrong: trials of the promises, all by run.py."""

import sys
from pathlib import Path

# The trials use what tests of the suite have; pytest adds only the folders that it collects.
for _part in ("", "regression", "unit", "verification"):
    if (_folder := str(Path(__file__).parents[1] / _part)) not in sys.path:
        sys.path.append(_folder)
