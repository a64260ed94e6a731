"""Lines about the progress of a study: which run ended how, and how long the rest will take."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress

from shellcut.model_file.key_index import with_values
from shellcut.results.summary_figures import key_figures
from shellcut.view.progress import duration

from .one_run import Outcome
from .plan import Plan
from .table import TABLE

_SHOWN = ("torque_plateau_Nmm", "force_plateau_N", "torque_peak_Nmm", "force_peak_N")
"""Figures of which the first that a run has is shown."""


class StudyProgress:
    """Says when a run ends; ``say`` takes a line, which goes to standard error by default."""

    def __init__(
        self, plan: Plan, n_done: int, jobs: int, say: Callable[[str], None] | None
    ) -> None:
        self._plan, self._n_run = plan, len(plan.runs)
        self._began, self._done_before = time.monotonic(), n_done
        self.say = say or _to_standard_error
        """Says a line."""
        at_a_time = "one after the other" if jobs == 1 else f"{jobs} at a time"
        self.say(f"{self._n_run} runs, {n_done} of them done before; {at_a_time}")

    def ended(self, number: int, outcome: Outcome, n_ended: int) -> None:
        """Say how a run ended."""
        values = with_values(self._plan.runs[number].values)
        said = f"{outcome.status}: {outcome.reason}" if outcome.reason else outcome.status
        if outcome.status == "done":
            shown = [name for name in _SHOWN if name in outcome.figures][:1]
            figures = key_figures(outcome.figures, shown)
            said = f"{outcome.seconds:.1f} s" + "".join(f", {name} {v}" for name, v in figures)
            if n := len(outcome.doubts):
                said += f", distrusted by {n} check" + "s" * (n > 1)
        left, new = self._n_run - n_ended, n_ended - self._done_before
        if left > 0 and new > 0:
            said += f"; {duration((time.monotonic() - self._began) / new * left)} left"
        self.say(f"[{n_ended}/{self._n_run}] {values or 'as given'}: {said}")

    def end(self, outcomes: Mapping[int, Outcome]) -> None:
        """Say how the study ended."""
        ended = [one.status for one in outcomes.values()]
        counts = ((ended.count(status), status) for status in ("done", "failed", "stopped"))
        said = ", ".join(f"{n} {status}" for n, status in counts if n)
        if n := sum(bool(one.doubts) for one in outcomes.values()):
            said += f", {n} distrusted (see {TABLE})"
        self.say(f"{said}, in {duration(time.monotonic() - self._began)}")


def _to_standard_error(line: str) -> None:
    with suppress(OSError):  # a closed pipe
        print(line, file=sys.stderr, flush=True)
