"""The guillotine
==============

A straight blade cuts a clamped strip. In theory the force is G h = 3.219 N. ::

    python examples/guillotine.py --size 0.4 --out DIR

writes history.csv, summary.json, force.png, energy.png, snapshots and guillotine.vtkhdf into DIR.
``shellcut run guillotine -o DIR`` does the same.
"""

import argparse
from pathlib import Path

from shellcut import guillotine, warmup


def main() -> None:
    parser = argparse.ArgumentParser(description="a straight blade cuts a clamped strip")
    parser.add_argument("--size", type=float, default=0.4, help="edge length of the quads [mm]")
    parser.add_argument("--length", type=float, default=30.0, help="of the strip [mm]")
    parser.add_argument("--out", type=Path, required=True, help="folder for the results")
    parser.add_argument("--classical", action="store_true", help="cables never meet the blade")
    options = parser.parse_args()

    warmup(["guillotine"])
    case = guillotine(options.size, length=options.length, directional=not options.classical)
    case.run(options.out)
    print((options.out / "summary.json").read_text(), end="")


if __name__ == "__main__":
    main()
