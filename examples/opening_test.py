"""The opening test
================

A ring of four teeth cuts a circle out of a clamped film. ::

    python examples/opening_test.py --mesh {quick,M1,M2} --out DIR

leaves history.csv, summary.json, splits.csv, torque.png, energy.png, snapshots and opening.vtkhdf
in DIR; with ``--compare`` also torque_compared.png, the same cut by classical cables beside it.
"""

import argparse
import sys
from pathlib import Path

from shellcut import opening_test, warmup
from shellcut.history import read_history
from shellcut.models.opening import steady_work_per_radian
from shellcut.progress import Progress
from shellcut.tool_shapes import tooth_ring
from shellcut.view import draw_torque


def main() -> None:
    parser = argparse.ArgumentParser(description="a ring of four teeth opens a film")
    parser.add_argument("--mesh", choices=["quick", "M1", "M2"], default="quick")
    parser.add_argument("--out", type=Path, required=True, help="folder for the results")
    parser.add_argument("--eta", type=float, default=60.0, help="edge to sheet [deg]")
    parser.add_argument("--pitch", type=float, default=12.0, help="advance a turn [mm]")
    parser.add_argument("--angle", type=float, default=95.0, help="angle to turn by [deg]")
    parser.add_argument("--duration", type=float, default=6.0e-3, help="time it takes [s]")
    parser.add_argument("--phase", type=float, default=0.0, help="teeth turned by [deg]")
    parser.add_argument("--classical", action="store_true", help="cables never meet the blade")
    parser.add_argument(
        "--compare", action="store_true", help="run classical cables too, both in one picture"
    )
    options = parser.parse_args()

    with Progress(1.0, "opening", "-") as progress:
        progress.note("compiling (first run only)")
        warmup(["force"])
    cut(options, options.out, directional=not options.classical)
    if options.compare:
        cut(options, options.out / "classical", directional=False)
        draw_both(options.out)
    expected = steady_work_per_radian(pitch=options.pitch, edge_inclination_deg=options.eta)
    sys.stdout.write(
        (options.out / "summary.json").read_text()
        + f"theory: n G h (r + (p/2 pi) cot eta) = {expected:.1f} N*mm a radian\n"
    )


def cut(options: argparse.Namespace, folder: Path, *, directional: bool) -> None:
    case = opening_test(
        options.mesh,
        tool=tooth_ring(edge_inclination_deg=options.eta, phase_deg=options.phase),
        pitch=options.pitch,
        angle_deg=options.angle,
        duration=options.duration,
        directional=directional,
    )
    case.run(folder)


def draw_both(folder: Path) -> None:
    ours, _ = read_history(folder / "history.csv")
    classical, _ = read_history(folder / "classical" / "history.csv")
    draw_torque(
        folder / "torque_compared.png",
        ours["angle"],
        ours["torque"],
        contact=ours["torque_contact"],
        joints=ours["torque_joints"],
        second=(classical["angle"], classical["torque"]),
        second_label="classical cables, which never meet the blade",
    )


if __name__ == "__main__":
    main()
