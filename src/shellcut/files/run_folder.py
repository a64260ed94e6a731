"""Names of the files of a run in its folder.

======================  ===========================================================================
``run.files``           list of all of them, :mod:`shellcut.files.file_list`
``run.lock``            during the run, :mod:`shellcut.files.folder_lock`
``history.csv``         a row at equal intervals of time, :mod:`shellcut.recording.recorder`
``NAME.vtkhdf``         the frames, :mod:`shellcut.results.vtkhdf`
``snapshot_00.png`` ..  pictures of the film during the run
``checkpoint.h5``       state to resume from, :mod:`shellcut.recording.checkpoint`
``summary.json``        results, when it ends, :mod:`shellcut.recording.run_summary`
``splits.csv``          every split, when it ends, :mod:`shellcut.results.history`
``torque.png``          or ``force.png``, and ``energy.png``: curves, when it ends
``used.toml``           of runs of model files: the model with all defaults filled in
``run.log``             of these too, :mod:`shellcut.recording.run_log`
======================  ===========================================================================
"""

from __future__ import annotations

from pathlib import Path

from .file_list import FileList

HISTORY = "history.csv"
CHECKPOINT = "checkpoint.h5"
SUMMARY = "summary.json"
SPLITS = "splits.csv"
ENERGY_PICTURE = "energy.png"
USED, LOG = "used.toml", "run.log"

_SNAPSHOT = "snapshot_"


def result_file(folder: Path, name: str) -> Path:
    """Return the path of the frames of a run."""
    return folder / f"{name}.vtkhdf"


def resistance_picture(folder: Path, resistance: str) -> Path:
    """Return the path of the curve of the torque or force."""
    return folder / f"{resistance}.png"


def snapshot(folder: Path, number: int) -> Path:
    """Return the path of a picture of the film, counted from 0."""
    return folder / f"{_SNAPSHOT}{number:02d}.png"


def snapshots(folder: Path, first: int = 0) -> list[Path]:
    """Return the existing pictures of the film, in order, starting with a number.

    These are the pictures listed by the run; without a list, all files with such names.
    """
    numbered = [
        (int(number), path)
        for path in folder.glob(f"{_SNAPSHOT}*.png")
        if (number := path.stem.removeprefix(_SNAPSHOT)).isdecimal()
    ]
    listed = FileList(folder).names
    return [
        path
        for number, path in sorted(numbered)
        if number >= first and (path.name in listed or not listed)
    ]
