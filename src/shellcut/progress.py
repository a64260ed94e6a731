"""How far a run is: a bar on a terminal, a plain line now and then elsewhere.

Whatever goes wrong while showing it (a closed pipe, a full disk under a redirected stream) switches
the display off; it never stops the run.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Any, TextIO

BAR_INTERVAL = 0.2
"""Least time between two drawings of the bar [s]."""
LINE_INTERVAL = 10.0
"""Least time between two plain lines [s]."""


class Progress:
    """Show how far a run is, its figures, its speed and the time left.

    Parameters
    ----------
    total : float
        Where the run ends, in ``unit``.
    label : str
        What is running.
    unit : str
        Unit of the position, e.g. ``"deg"``.
    figure_units : mapping of str to str, optional
        Units of the figures given to `update`, by name, e.g. ``{"torque": "N*mm", "imbalance":
        "%"}``.
    position_name : str
        What the position is, e.g. ``"angle"``.
    stream : text stream, optional
        Where to; standard error by default. On a terminal a bar is drawn in place, elsewhere
        plain lines are written, at most one every `LINE_INTERVAL`.
    log : callable, optional
        Also given every line of text that is shown; what is drawn in place is not.
    clock : callable
        Returns the time [s]; for tests.
    """

    def __init__(
        self,
        total: float,
        label: str,
        unit: str,
        *,
        figure_units: Mapping[str, str] | None = None,
        position_name: str = "angle",
        stream: TextIO | None = None,
        log: Callable[[str], None] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._total = total
        self._label = label
        self._unit = unit
        self._figure_units = dict(figure_units or {})
        self._position_name = position_name
        self._stream = sys.stderr if stream is None else stream
        self._log = log
        self._clock = clock
        self._alive = self._stream is not None  # pythonw and some services have no stderr
        self._bar: _Bar | None = None
        self._due = -float("inf")
        self._first: tuple[float, float] | None = None  # time, position
        self._shown: tuple[float, int] | None = None  # time, step
        self._latest: tuple[float, int, dict[str, float]] | None = None
        self._guard(self._begin)
        self._interval = BAR_INTERVAL if self._bar else LINE_INTERVAL

    @property
    def wants(self) -> bool:
        """Whether an update would be drawn now; asking costs 0.3 us."""
        return self._alive and (self._first is None or self._clock() >= self._due)

    def update(self, position: float, *, step: int, **figures: float) -> None:
        """Show the position and the figures if a drawing is due (0.5 us if none is).

        Parameters
        ----------
        position : float
            Where the run is, in the unit given.
        step : int
            Number of the time step, for the steps per second.
        **figures : float
            What else is of interest, by name.
        """
        if not self._alive:
            return
        now = self._clock()
        if now < self._due and self._first is not None:
            self._latest = position, step, figures
            return
        if self._first is None:
            self._first = now, position
        self._latest = position, step, figures
        self._due = now + self._interval
        self._guard(self._show)

    def note(self, text: str) -> None:
        """Show a line of text at once, e.g. ``"compiling (first run only)"``."""
        if self._log is not None:
            self._log(text)
        self._guard(lambda: self._bar.note(text) if self._bar else self._write(text))

    def close(self) -> None:
        """Show the last position and end the display; a second call does nothing."""
        if self._latest is not None:
            self._guard(self._show)
        if self._bar is not None:
            self._guard(self._bar.close)
        self._alive = False

    def __enter__(self) -> Progress:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _guard(self, show: Callable[[], None]) -> None:
        if not self._alive:
            return
        try:
            show()
        except Exception:  # of any kind: a display is not worth a run
            self._alive = False

    def _begin(self) -> None:
        if self._stream.isatty():
            self._bar = _Bar.on_terminal(self._stream, self._total, self._label)

    def _show(self) -> None:
        assert self._latest is not None
        assert self._first is not None
        position, step, figures = self._latest
        now = self._clock()
        texts = [f"{self._position_name} {_number(position, self._unit)}"]
        for name, value in figures.items():
            texts.append(f"{name} {_number(value, self._figure_units.get(name, ''))}")
        if self._shown is not None and now > self._shown[0] and step > self._shown[1]:
            texts.append(f"{(step - self._shown[1]) / (now - self._shown[0]):,.0f} steps/s")
        self._shown = now, step
        began, start = self._first
        if position > start:
            left = (now - began) * (self._total - position) / (position - start)
            texts.append(f"{_duration(left)} left")
        if self._bar:
            self._bar.draw(position, ", ".join(texts))
        else:
            done = 100.0 * position / self._total if self._total else 100.0
            line = f"{done:.0f} %: {', '.join(texts)}"
            if self._log is not None:
                self._log(line)
            self._write(line)

    def _write(self, text: str) -> None:
        self._stream.write(f"{self._label}: {text}\n")
        self._stream.flush()


class _Bar:
    # A bar of rich, drawn only when told to: no thread beside the time loop.

    def __init__(self, bar: Any, label: str, total: float) -> None:
        self._bar = bar
        self._task = bar.add_task(label, total=total, text="")
        bar.start()

    @classmethod
    def on_terminal(cls, stream: TextIO, total: float, label: str) -> _Bar | None:
        try:
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn
            from rich.progress import Progress as RichProgress
        except ImportError:  # rich comes with meshio, but nothing promises it
            return None
        console = Console(file=stream)
        if not console.is_terminal or console.is_dumb_terminal:
            return None
        columns = (
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            TextColumn("{task.percentage:.0f} %"),
            TextColumn("{task.fields[text]}", markup=False),
        )
        return cls(RichProgress(*columns, console=console, auto_refresh=False), label, total)

    def draw(self, position: float, text: str) -> None:
        self._bar.update(self._task, completed=position, text=text, refresh=True)

    def note(self, text: str) -> None:
        self._bar.console.print(text, markup=False, highlight=False)

    def close(self) -> None:
        self._bar.stop()


def _number(value: float, unit: str) -> str:
    # Four figures are enough to watch a run; "%" and units stand apart from the number.
    value += 0.0  # no minus before a zero
    digits = f"{value:.1f}" if 0.1 <= abs(value) < 1e5 else f"{value:.3g}"
    return f"{digits} {unit}".rstrip()


def _duration(seconds: float) -> str:
    minutes, s = divmod(max(0, round(seconds)), 60)
    hours, m = divmod(minutes, 60)
    if hours:
        return f"{hours} h {m:02d} min"
    return f"{m} min {s:02d} s" if m else f"{s} s"
