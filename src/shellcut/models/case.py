"""A case: a simulation and when it ends."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from shellcut.checks import ModelCheck, check_model
from shellcut.imprinting import ImprintResult
from shellcut.recording.recorder import Recorder, RunEnded
from shellcut.recording.signals import Interruption
from shellcut.simulation.hooks import Hook, StopWhen
from shellcut.simulation.simulation import Simulation

_MOST_STEPS = 1e11
"""Steps of the longest run: two months of the smallest film."""

_log = logging.getLogger(__name__)


def check_length(simulation: Simulation, duration: float) -> None:
    """Refuse a run of more steps than anyone waits for: a number of its model is nonsense.

    Raises
    ------
    ValueError
        Saying what sets the step.
    """
    steps = duration / simulation.dt
    if not steps <= _MOST_STEPS:
        raise ValueError(
            f"a run must take {_MOST_STEPS:.0e} steps at most, this one of {duration:.4g} s at a "
            f"step of {simulation.dt:.4g} s would take {steps:.2g}: "
            f"{simulation.time_step.reason()}"
        )


@dataclass(frozen=True)
class Case:
    """A simulation that is ready to run.

    Attributes
    ----------
    name : str
        Stem of the result file and title of the pictures.
    simulation : Simulation
        At t = 0.
    duration : float
        End of the run [s].
    imprint : ImprintResult or None
        What putting the blade's path into the mesh did; None where it was not asked for.
    """

    name: str
    simulation: Simulation
    duration: float
    imprint: ImprintResult | None = None

    @cached_property
    def check(self) -> ModelCheck:
        """What the checks before the run find; to be asked for at t = 0."""
        return check_model(self.simulation, self.duration)

    def run(self, folder: str | os.PathLike[str], **options: Any) -> None:
        """Run to the end and leave everything in ``folder``, see :class:`Recorder`.

        What the checks of the model doubt is logged before the run, what the figures of the run
        doubt after it, as warnings of the library.

        Ctrl-C (SIGINT) and SIGTERM end the run after the step it is in: the files are closed, a
        checkpoint is written, and a line says where it stopped. Then the signal takes its usual
        effect: Ctrl-C raises KeyboardInterrupt, SIGTERM ends the process. A second one does so at
        once, and leaves what there was.

        Parameters
        ----------
        folder : path
            Where to.
        **options
            As the fields of :class:`~shellcut.recording.run_options.RunOptions`: how many rows,
            frames and pictures; progress; checkpoints; ``resume`` to go on with the run in
            ``folder``, which is left as it is if it has ended, and a line says so.

        Raises
        ------
        KeyboardInterrupt
            After Ctrl-C.
        UnstableStep
            If the solution blows up; the files are closed, the last good checkpoint is kept.
        FileNotFoundError, CheckpointError
            If there is nothing to resume, or it is another model's.
        RefusedModel
            If a check of the model refuses it; nothing in the folder has been touched.
        FolderInUse
            If another run writes in the folder; it is not disturbed.
        FileExistsError
            If something there that no run has written would be replaced.
        FolderLost
            If somebody removes, moves or empties the folder during the run.
        OSError
            If a file cannot be written: after a full disk, free space and go on with ``resume``.
        ValueError
            If the simulation has been run already, or would take more steps than anyone waits for;
            nothing in the folder has been touched.
        """
        if self.simulation.state.step:
            raise ValueError(
                f"a case is run once, this one is at step {self.simulation.state.step}: build it "
                "again, and run it anew or with resume=True"
            )
        check_length(self.simulation, self.duration)
        try:
            recorder = Recorder(
                self.simulation,
                folder,
                until=self.duration,
                name=self.name,
                check=self.check,
                **options,
            )
        except RunEnded as ended:
            _log.warning("%s; nothing was changed", ended)
            return
        self.go(recorder)

    def go(self, recorder: Recorder) -> None:
        """Run to the end with a recorder of one's own, as :meth:`run` does.

        Parameters
        ----------
        recorder : Recorder
            Of this simulation, up to ``duration``; closed when the run ends, however it ends.

        Raises
        ------
        KeyboardInterrupt, UnstableStep, FolderLost, OSError
            As :meth:`run`.
        """
        with Interruption() as interruption:
            hooks: list[Hook] = [recorder, StopWhen(lambda: interruption.requested)]
            self.simulation.run(self.duration, hooks)
        if interruption.requested and self.simulation.state.time < self.duration:
            _log.warning(
                "%s stopped at %s; to go on, resume from the checkpoint in %s",
                self.name,
                recorder.place(),
                recorder.folder,
            )
        if interruption.ends_process:  # then this is the last chance to say what was kept back
            for handler in logging.getLogger("shellcut").handlers:
                handler.flush()
        interruption.deliver()
