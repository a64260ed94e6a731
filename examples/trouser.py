"""The trouser test
================

Two legs of a notched strip are pulled apart, out of its plane, and tear it. In theory the forces on
the two legs add up to G h = 2.304 N. ::

    python examples/trouser.py --size 0.5 --out DIR

writes history.csv, summary.json, force.png, energy.png, snapshots and trouser.vtkhdf into DIR.
``shellcut run trouser -o DIR`` does the same.
"""

import argparse
from pathlib import Path

from shellcut import trouser


def main() -> None:
    parser = argparse.ArgumentParser(description="two legs of a strip are pulled apart")
    parser.add_argument("--size", type=float, default=0.5, help="edge length of the quads [mm]")
    parser.add_argument("--length", type=float, default=19.0, help="of the strip [mm]")
    parser.add_argument("--out", type=Path, required=True, help="folder for the results")
    options = parser.parse_args()

    case = trouser(options.size, length=options.length)
    case.run(options.out)
    print((options.out / "summary.json").read_text(), end="")


if __name__ == "__main__":
    main()
