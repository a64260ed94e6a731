"""Count what comes of damaged films and tools, format by format: ``python -m damaged 400``."""

import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from .mutations import mutated
from .outcomes import film_of, outcome, read_quietly, tool_of
from .samples import FILMS, TOOLS

COLUMNS = ("refused", "same", "said", "names", "coordinates", "sets", "elements", "TRACEBACK")


def main(n, only="", seed=20261122, show=0):
    print(f"{'format':<18}" + "".join(f"{c:>12}" for c in COLUMNS))
    with tempfile.TemporaryDirectory() as folder:
        for kind, samples in (("film", FILMS), ("tool", TOOLS)):
            for name, (file, content_of, text) in samples.items():
                if only in name:
                    count(kind, name, Path(folder) / file, content_of(), text, n, seed, show)


def count(kind, name, path, content, text, n, seed, show):
    path.write_bytes(content)
    sound = read_quietly(film_of if kind == "film" else tool_of, path)
    rng = np.random.default_rng(seed)
    found = Counter()
    for k in range(n):
        damaged, way = mutated(rng, content, text=text)
        path.write_bytes(damaged)
        try:
            what = outcome(kind, path, sound)
        except Exception as error:
            what = "TRACEBACK"
            print(k, way, repr(error)[:300])
        found[what] += 1
        if what in COLUMNS[-3 - show :]:
            print(f"   {k} {way}: {what}: {first_difference(content, damaged)}")
    print(f"{name:<18}" + "".join(f"{found[c]:>12}" for c in COLUMNS), flush=True)


def first_difference(a, b):
    at = next((k for k in range(min(len(a), len(b))) if a[k] != b[k]), min(len(a), len(b)))
    return f"{a[max(0, at - 20) : at + 20]!r} -> {b[max(0, at - 20) : at + 20]!r}"


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:3], show=int(sys.argv[3]) if len(sys.argv) > 3 else 0)
