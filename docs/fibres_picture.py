"""Draw the torque of the opening test with six cables along each segment and with two at its ends.

    python docs/fibres_picture.py SIX TWO [FILE.png]

SIX is the folder of ``shellcut run opening``, TWO of the same with ``--set fracture.fibres=0``.
"""

import sys

import matplotlib.pyplot as plt

import shellcut


def main(six, two, path="docs/img/fibres_torque.png"):
    """Draw the picture."""
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 3.6), layout="constrained", sharey=True)
    for out, label, colour in ((two, "two, at its ends", "0.6"), (six, "six, along it", "C0")):
        history = shellcut.read(out).history
        for ax in axes:
            ax.plot(history["angle"], history["torque"], colour, lw=1.0, label=label)
    axes[0].set(xlim=(0, 95), ylabel="torque [N·mm]")
    axes[1].set(xlim=(4, 20), ylim=(-10, 180))
    axes[1].legend(frameon=False, loc="lower right", title="cables of a segment")
    for ax in axes:
        ax.set_xlabel("angle [°]")
        ax.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
