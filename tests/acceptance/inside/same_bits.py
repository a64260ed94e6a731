"""Print which data sets of two HDF5 files are not the same bits."""

import json
import sys

import h5py
import numpy as np

differ = []
with h5py.File(sys.argv[1]) as one, h5py.File(sys.argv[2]) as other:

    def compare(name, item):
        """Compare one data set with its like."""
        if isinstance(item, h5py.Dataset):
            a, b = np.asarray(item), np.asarray(other[name]) if name in other else None
            if b is None or a.dtype != b.dtype or a.tobytes() != b.tobytes():
                differ.append(name)

    one.visititems(compare)
    missing = []
    other.visit(lambda name: missing.append(name) if name not in one else None)
print(json.dumps({"differ": differ + missing}))
