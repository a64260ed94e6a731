"""What a run leaves in its folder, by name.

======================  ===========================================================================
``history.csv``         a row at equal intervals of time, :mod:`shellcut.history_row`
``NAME.vtkhdf``         the frames, :mod:`shellcut.vtkhdf`
``NAME.pvd``            them too if asked for, with ``NAME_frames``, :mod:`shellcut.pvd`
``snapshot_00.png`` ..  pictures of the film during the run
``checkpoint.h5``       where to go on from, :mod:`shellcut.checkpoint`
``summary.json``        figures, when it ends, :mod:`shellcut.run_summary`
``splits.csv``          every split, when it ends, :mod:`shellcut.split_table`
``torque.png``          or ``force.png``, and ``energy.png``: curves, when it ends
======================  ===========================================================================
"""

from __future__ import annotations

from pathlib import Path

HISTORY = "history.csv"
CHECKPOINT = "checkpoint.h5"
SUMMARY = "summary.json"
SPLITS = "splits.csv"
ENERGY_PICTURE = "energy.png"

_SNAPSHOT = "snapshot_"


def result_file(folder: Path, name: str) -> Path:
    """Return the path of the frames of a run."""
    return folder / f"{name}.vtkhdf"


def frame_list(folder: Path, name: str) -> Path:
    """Return the path of the list of the frames as PVD + VTU."""
    return folder / f"{name}.pvd"


def resistance_picture(folder: Path, resistance: str) -> Path:
    """Return the path of the curve of the torque or force."""
    return folder / f"{resistance}.png"


def snapshot(folder: Path, number: int) -> Path:
    """Return the path of a picture of the film, counted from 0."""
    return folder / f"{_SNAPSHOT}{number:02d}.png"


def snapshots(folder: Path, first: int = 0) -> list[Path]:
    """Return the pictures of the film that are there, from a number on, in their order."""
    numbered = [
        (int(number), path)
        for path in folder.glob(f"{_SNAPSHOT}*.png")
        if (number := path.stem.removeprefix(_SNAPSHOT)).isdecimal()
    ]
    return [path for number, path in sorted(numbered) if number >= first]
