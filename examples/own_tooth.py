"""Another tooth
=============

Compare the torque of four teeth whose edges stand at 60° to the film with that of five at 40°. ::

    python examples/own_tooth.py --out DIR

writes both runs and torque.png into DIR. The five teeth from the command line::

    shellcut run opening --set mesh=quick --set teeth=5 --set edge_inclination_deg=40 -o DIR
"""

import argparse
from pathlib import Path

import shellcut
from shellcut.view import Curve, Diagram, draw_curves

SETTINGS = {
    "membrane.mesh": "quick",
    "motion.angle_deg": 50.0,
    "motion.duration": "3.1 ms",
}


def main() -> None:
    parser = argparse.ArgumentParser(description="four teeth and five of another shape")
    parser.add_argument("--out", type=Path, required=True, help="folder for the results")
    options = parser.parse_args()

    four = cut(options.out / "four", {})
    five = cut(options.out / "five", {"tool.teeth": 5, "tool.edge_inclination_deg": 40.0})
    curves = [
        Curve("four teeth at 60°", four.history["torque"], "other", x=four.history["angle"]),
        Curve("five teeth at 40°", five.history["torque"]),
    ]
    torque = Diagram(five.history["angle"], curves, "angle", "deg", "torque", "N*mm")
    draw_curves(options.out / "torque.png", [torque])
    for name, results in (("four", four), ("five", five)):
        window = results.steady_window.text("deg")
        print(f"{name} teeth: {results.summary['torque_plateau_Nmm']:.0f} N*mm over {window}")


def cut(folder: Path, tool: dict[str, object]) -> shellcut.results.Results:
    case = shellcut.read_model("opening", SETTINGS | tool).build()
    case.run(folder, n_snapshot=0, progress=False)
    return shellcut.read(folder)


if __name__ == "__main__":
    main()
