"""Print the version of shellcut that the binary files of a run carry."""

import json
import sys
from pathlib import Path

import h5py

out = Path(sys.argv[1])
with h5py.File(out / "opening.vtkhdf") as result, h5py.File(out / "checkpoint.h5") as checkpoint:
    versions = {
        "opening.vtkhdf": result["shellcut"].attrs["version"],
        "checkpoint.h5": checkpoint.attrs["version"],
    }
print(json.dumps(versions))
