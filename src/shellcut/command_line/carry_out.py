"""Carry a model out in a folder: say what is done, run, say what came of it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .exit_code import BAD_INPUT, DONE, INTERRUPTED, STOPPED
from .run_log import RunLog

if TYPE_CHECKING:
    from shellcut.model_file import Model

USED, LOG = "used.toml", "run.log"

_FIGURES = {
    "n_step": "steps",
    "wall_s": "stepping and output [s]",
    "torque_plateau_Nmm": "torque, mean of 30 to 70 deg [N*mm]",
    "torque_peak_Nmm": "torque, peak [N*mm]",
    "axial_force_plateau_N": "axial force, mean of 30 to 70 deg [N]",
    "force_plateau_N": "force, mean of the last 60 % [N]",
    "force_peak_N": "force, peak [N]",
    "tool_work_Nmm": "work of the tool [N*mm]",
    "cohesive_work_Nmm": "work of the cables [N*mm]",
    "crack_length_mm": "crack length [mm]",
    "n_cable_created": "cables made",
    "n_cable_jointed": "cables met by the blade",
    "n_cable_broken": "cables broken",
    "imbalance_rel": "largest imbalance of the energies, of the work [-]",
    "kinetic_rel": "largest kinetic energy, of the work [-]",
}
"""What of ``summary.json`` is said at the end."""


def carry_out(
    model: Model,
    folder: Path,
    log: RunLog,
    *,
    resume: bool = False,
    replaces: Sequence[Path] = (),
) -> int:
    """Build the model, run it into the folder, and return the exit code.

    Parameters
    ----------
    model : Model
        What to run.
    folder : Path
        Where to; made once the model has been built.
    log : RunLog
        Takes every line.
    resume : bool
        Go on with the run in the folder.
    replaces : sequence of Path
        Files of an earlier run, removed once the model has been built.
    """
    from shellcut.model_file import ModelFileError
    from shellcut.simulation import UnstableStep

    try:
        with log.library_said():
            _run(model, folder, log, resume, replaces)
    except ModelFileError as problem:
        log.say(str(problem), stream=sys.stderr)
        return BAD_INPUT
    except UnstableStep as problem:
        log.say(f"stopped: {problem}", stream=sys.stderr)
        log.say(f"what there was up to this step is in {folder}", stream=sys.stderr)
        return STOPPED
    except KeyboardInterrupt:
        hint = f"to go on: shellcut resume {folder}" if log.is_open else "nothing was written"
        log.say(f"interrupted; {hint}", stream=sys.stderr)
        return INTERRUPTED
    except OSError as problem:
        log.say(str(problem), stream=sys.stderr)
        return BAD_INPUT
    except ValueError as problem:
        if not resume:  # the model was checked: this is an error of the library
            raise
        log.say(str(problem), stream=sys.stderr)
        return BAD_INPUT
    finally:
        log.close()
    return DONE


def _run(model: Model, folder: Path, log: RunLog, resume: bool, replaces: Sequence[Path]) -> None:
    from shellcut._jit import on_compilation
    from shellcut.account import start_lines
    from shellcut.model_file.model import digest_of
    from shellcut.resistance import Resistance
    from shellcut.warmup import warmup

    began: list[float] = []

    def compiling() -> None:
        began.append(time.perf_counter())
        log.say("compiling (first run only, about half a minute) ...")

    with on_compilation(compiling):
        case = model.build()
        for path in replaces:
            path.unlink()
        folder.mkdir(parents=True, exist_ok=True)
        log.open(folder / LOG)
        if resume:
            log.say(f"resuming {folder}")
        else:
            model.write(folder / USED)
        digest = digest_of(folder / USED)
        log.say(f"shellcut {version('shellcut')}, {USED} with sha256 {digest}")
        sim = case.simulation
        assert sim.motion is not None
        if case.imprint is not None and case.imprint.changed:
            log.say(case.imprint.report())
        for line in start_lines(sim, Resistance(sim.motion), case.duration):
            log.say(line)
        warmup([sim.fracture.criterion])
    if began:
        log.say(f"compiled in {time.perf_counter() - began[0]:.0f} s")
    options: dict[str, Any] = {**model.run_options(), "log": log.keep}
    if resume:
        options["resume"] = True
    case.run(folder, **options)
    _say_end(folder, log)


def _say_end(folder: Path, log: RunLog) -> None:
    summary = json.loads((folder / "summary.json").read_text())
    for name, words in _FIGURES.items():
        if name in summary:
            log.say(f"{words:<52} {summary[name]:>12,.6g}")
    files = sorted(path.name for path in folder.iterdir() if path.is_file())
    log.say(f"in {folder}: {', '.join(files)}")
