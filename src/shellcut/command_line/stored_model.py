"""The model that a run has stored in its folder, as the run began with it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shellcut.files.run_folder import USED

if TYPE_CHECKING:
    from shellcut.model_file import Model


def stored_model(folder: Path) -> Model:
    """Return the model in the folder of a run.

    Raises
    ------
    OSError
        If there is no folder or no model in it, if the model or a file that it reads has been
        changed since the run began, or if the run is still active.
    """
    from shellcut.files.folder_lock import refuse_if_in_use
    from shellcut.model_file import read_model
    from shellcut.model_file.writer import is_as_written

    used = folder / USED
    if not folder.is_dir():
        raise FileNotFoundError(f"{folder}: there is no such folder")
    if not used.is_file():
        raise FileNotFoundError(f"{folder} holds no {USED}: it is not a folder of shellcut run")
    refuse_if_in_use(folder)
    model = read_model(used)
    wrong = []
    if not is_as_written(used.read_text(encoding="utf-8")):
        wrong.append(f"{used} has been changed")
    wrong += [f"{path} is gone or has been changed" for path in model.changed_files()]
    if wrong:
        raise OSError(
            "\n".join(f"{text} since the run began" for text in wrong)
            + "\nput it back, or run the model again into another folder"
        )
    return model
