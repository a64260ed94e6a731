"""A case, a simulation and the end time of its run, and the options that models hand on to it."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, TypedDict, TypeVar

from shellcut.arguments import Option
from shellcut.arrays import Floats
from shellcut.checks import ModelCheck, check_model
from shellcut.contact.settings import Contact
from shellcut.files.run_folder import USED
from shellcut.fracture.options import Fracture
from shellcut.loads.adhesion import Adhesion
from shellcut.loads.loads import Load
from shellcut.loads.supports import Support
from shellcut.recording.recorder import Recorder, RunEnded
from shellcut.recording.run_options import RunArguments
from shellcut.signals import Interruption
from shellcut.simulation.hooks import Hook, StopWhen
from shellcut.simulation.simulation import Simulation
from shellcut.simulation.stable_step import Stepping
from shellcut.tool.force_term import ForceTerm

if TYPE_CHECKING:
    from typing_extensions import Unpack

_MOST_STEPS = 1e11
"""Steps of the longest run allowed: two months with the smallest film."""


class ModelOptions(TypedDict, total=False):
    """Arguments of :class:`Simulation` that no model sets itself, for type checkers."""

    loads: Sequence[Load]
    contact: Contact | None
    fracture: Fracture | None
    stepping: Stepping | None
    directional: bool
    damping_alpha: float
    damping_beta: float | None
    damping_share: float | None
    velocity: Floats | None
    terms: Sequence[ForceTerm | Adhesion]
    quasi_static: float | None
    imperfection: int | None
    threads: int | None


class CutOptions(ModelOptions, total=False):
    """Those of a cut, which may have supports besides its clamp."""

    supports: Sequence[Support]


_Options = TypeVar("_Options", ModelOptions, CutOptions, dict[str, Any])

_log = logging.getLogger(__name__)

Clamp: TypeAlias = Annotated[
    Sequence[str], Option("", "node set or sets that are clamped", form="names")
]
Notch: TypeAlias = Annotated[
    float,
    Option(
        "mm", "length of the cut at the cutting edge that meets the film first; 0: none", least=0
    ),
]


def time_of_travel(travel: float, speed: float, ramp: float) -> float:
    """Return the time [s] of a travel along a strip [mm] whose speed rises over a ramp."""
    if not travel > 0.0:
        raise ValueError(f"travel must be positive, got {travel:.4g} mm: lengthen the strip")
    return travel / speed + 0.5 * ramp


PAPER_DAMPING = 5e-8
"""Stiffness damping of [Frangi2010] 5.2 [s], for the paper's meshes and strips like them."""


def damped_by(beta: float, options: _Options) -> _Options:
    """Return options of a simulation with a stiffness damping [s], unless they have one."""
    if options.get("damping_beta") is None and options.get("damping_share") is None:
        options["damping_beta"] = beta
    return options


@dataclass(frozen=True)
class Case:
    """A simulation that is ready to run.

    ValueError is raised for a run of absurdly many steps, a sign of a wrong number in the model.
    """

    name: str
    """Stem of the result file and title of the pictures."""
    simulation: Simulation
    """At t = 0."""
    duration: float
    """End of the run [s]."""

    def __post_init__(self) -> None:
        dt = self.simulation.dt
        steps = self.duration / dt
        if not steps <= _MOST_STEPS:
            raise ValueError(
                f"a run must take {_MOST_STEPS:.0e} steps at most, this one of {self.duration:.4g} "
                f"s at a step of {dt:.4g} s would take {steps:.2g}: "
                f"{self.simulation.time_step.reason()}"
            )

    @cached_property
    def check(self) -> ModelCheck:
        """Result of the checks before the run; call it at t = 0."""
        return check_model(self.simulation, self.duration)

    def run(self, folder: str | os.PathLike[str], **options: Unpack[RunArguments]) -> None:
        """Run to the end and write everything to ``folder``, see :class:`Recorder`.

        Doubts of the model's checks are logged as warnings before the run, doubts about its
        results after it.

        Ctrl-C (SIGINT) and SIGTERM stop the run after the current step: the files are closed, a
        checkpoint is written, and a line says where it stopped. The signal then acts as usual:
        Ctrl-C raises KeyboardInterrupt, SIGTERM ends the process. A second signal acts at once
        and skips this.

        Parameters
        ----------
        folder : path
            Output folder.
        **options
            Fields of :class:`~shellcut.recording.run_options.RunOptions`: numbers of rows,
            frames and pictures; progress; checkpoints; ``resume`` to continue the run in
            ``folder``. A run that has already ended is left unchanged, and a line says so.

        Raises
        ------
        KeyboardInterrupt
            After Ctrl-C.
        UnstableStep
            If the solution blows up; the files are closed, the last good checkpoint is kept.
        FileNotFoundError, CheckpointError, RefusedModel, FolderInUse, FileExistsError, FolderLost
            As of :class:`Recorder`; so is OSError where a file cannot be written.
        ValueError
            If the simulation has already run; nothing in the folder has been changed.
        """
        if self.simulation.state.step:
            raise ValueError(
                f"a case can run once, but this one is at step {self.simulation.state.step}: build "
                "it again, and run it anew or with resume=True"
            )
        try:
            recorder = self.recorder(folder, **options)
        except RunEnded as ended:
            _log.warning("%s; nothing was changed", ended)
            return
        self.go(recorder)

    def recorder(
        self,
        folder: str | os.PathLike[str],
        *,
        also: Sequence[str] = (),
        **options: Unpack[RunArguments],
    ) -> Recorder:
        """Return what writes the run to a folder, which it holds; options of :class:`Recorder`."""
        sim, until, name = self.simulation, self.duration, self.name
        return Recorder(sim, folder, until=until, name=name, check=self.check, also=also, **options)

    def go(self, recorder: Recorder, also: Sequence[Hook] = ()) -> None:
        """Run to the end with a given recorder and further hooks, as :meth:`run` does.

        The recorder, of this simulation up to ``duration``, is closed at the end in any case.
        """
        with Interruption() as interruption:
            hooks: list[Hook] = [recorder, StopWhen(lambda: interruption.requested), *also]
            self.simulation.run(self.duration, hooks)
        if interruption.requested and self.simulation.state.time < self.duration:
            _log.warning("%s", self.interrupted(recorder))
        if interruption.ends_process:  # last chance to print the verdict
            for handler in logging.getLogger("shellcut").handlers:
                handler.flush()
        interruption.deliver()

    def interrupted(self, recorder: Recorder) -> str:
        """Return where a run stopped that was interrupted, and how it is continued."""
        folder = recorder.folder
        how = f", resume from the checkpoint in {folder}"
        if (folder / USED).exists():  # of a command
            how = f": shellcut resume {folder}"
        return f"{self.name} stopped at {recorder.place()}; to continue{how}"
