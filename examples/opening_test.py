"""The opening test
================

A ring of four teeth cuts a circle out of a clamped film. ::

    python examples/opening_test.py --mesh {quick,M1,M2} --out DIR

writes history.csv, summary.json, splits.csv, torque.png, energy.png, snapshots and opening.vtkhdf
into DIR. ``shellcut run opening --set mesh=quick -o DIR`` does the same. ``--compare`` also runs
classical cables, which never meet the blade, in DIR/classical, and draws both curves in
torque_compared.png.
"""

import argparse
import sys
from pathlib import Path

from shellcut import opening_test, read, warmup
from shellcut.models.opening import steady_work_per_radian
from shellcut.view import Curve, Diagram, draw_curves


def main() -> None:
    parser = argparse.ArgumentParser(description="a ring of four teeth opens a film")
    parser.add_argument("--mesh", choices=["quick", "M1", "M2"], default="quick")
    parser.add_argument("--out", type=Path, required=True, help="folder for the results")
    parser.add_argument("--angle", type=float, default=95.0, help="angle to turn by [deg]")
    parser.add_argument("--duration", type=float, default=6.0e-3, help="time it takes [s]")
    parser.add_argument("--compare", action="store_true", help="run classical cables too")
    options = parser.parse_args()

    print("compiling (first run only)", file=sys.stderr, flush=True)
    warmup(["opening"])
    cut(options, options.out, directional=True)
    if options.compare:
        cut(options, options.out / "classical", directional=False)
        draw_both(options.out)
    print((options.out / "summary.json").read_text(), end="")
    print(f"theory: n G h (r + (p/2 pi) cot eta) = {steady_work_per_radian():.1f} N*mm a radian")


def cut(options: argparse.Namespace, folder: Path, *, directional: bool) -> None:
    case = opening_test(
        options.mesh,
        angle_deg=options.angle,
        duration=options.duration,
        directional=directional,
    )
    case.run(folder)


def draw_both(folder: Path) -> None:
    ours, classical = read(folder).history, read(folder / "classical").history
    joints, theory = ours["torque_joints"], steady_work_per_radian()
    curves = [
        Curve(
            "classical cables, which never meet the blade",
            classical["torque"],
            "tooth",
            x=classical["angle"],
        ),
        Curve("from contact", ours["torque"] - joints, "contact"),
        Curve("total", ours["torque"]),
        Curve("from cables at the edge", joints, "joints"),
        Curve(f"theory: {theory:.1f} N·mm", [theory, theory], "level", x=[0.0, 90.0]),
    ]
    diagram = Diagram(ours["angle"], curves, "angle", "deg", "torque", "N*mm")
    draw_curves(folder / "torque_compared.png", [diagram])


if __name__ == "__main__":
    main()
