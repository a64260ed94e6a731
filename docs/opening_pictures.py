"""Draws ``img/opening.png`` and ``img/torque.png``, the pictures of the README and the first pages.

First ``python examples/opening_test.py --mesh M1 --compare --out OUT`` (a minute), then
``python docs/opening_pictures.py OUT``.
"""

import sys
from pathlib import Path

import numpy as np

import shellcut
from shellcut.view import draw_snapshot, draw_torque

IMAGES = Path(__file__).parent / "img"
ANGLE = 59.0  # deg: flaps stand open, all teeth are in the film


def main(folder):
    """Draw both from the runs in a folder."""
    run, classical = shellcut.read(folder), shellcut.read(folder / "classical").history
    nearest = int(np.argmin(np.abs(run.coordinates - ANGLE)))
    draw_snapshot(IMAGES / "opening.png", run.frame(nearest), stress_limits=(0.0, 18.0))
    history = run.history
    draw_torque(
        IMAGES / "torque.png",
        history["angle"],
        history["torque"],
        contact=history["torque_contact"],
        joints=history["torque_joints"],
        second=(classical["angle"], classical["torque"]),
        second_label="classical cables, which never meet the blade",
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
