"""Progress of a run: a bar on a terminal, otherwise about ten plain lines.

Progress is the share of the work that is done. Bar, lines and time left all use this one number;
an angle or a path would not do, because a tool starts slowly, may rest, or move back.

Any error of the display (a closed pipe, a full disk under a redirected stream) switches it off; it
never stops the run.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Mapping
from typing import Any, TextIO

from shellcut.unit import with_unit

BAR_INTERVAL = 0.2
"""Shortest time between two drawings of the bar [s]."""
LINE_INTERVAL = 10.0
"""Shortest time between two plain lines [s]."""
LINE_SHARE = 0.1
"""Smallest share of the run between two plain lines."""
_BAR_WIDTH = 12
_ROUND_OFF = 1e-9
"""Round-off: a share of 0.2 may arrive as 0.19999999999999998."""


class Progress:
    """Show progress of a run, some values and the time left.

    Values are shown in ``figure_units``, by name. The stream is standard error by default. On a
    terminal a bar is drawn in place, with as many values as fit beside it, the first two of them
    without names. Elsewhere plain lines are written, with the first two values: at most one every
    :data:`LINE_INTERVAL` and :data:`LINE_SHARE`. ``log`` receives every plain line.
    """

    def __init__(
        self,
        label: str,
        *,
        figure_units: Mapping[str, str] | None = None,
        stream: TextIO | None = None,
        log: Callable[[str], None] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._label = label
        self._figure_units = dict(figure_units or {})
        self._stream = sys.stderr if stream is None else stream
        self._log = log
        self._clock = clock
        self._alive = self._stream is not None  # pythonw and some services have no stderr
        self._bar: Any = None
        self._due = self._share_due = -float("inf")
        self._first: tuple[float, float] | None = None  # time, share
        self._shown: int | None = None  # step
        self._latest: tuple[float, int, dict[str, float]] | None = None
        self._guard(self._begin)
        self._interval = BAR_INTERVAL if self._bar else LINE_INTERVAL

    @property
    def wants(self) -> bool:
        """Whether an update would be drawn now; asking costs 0.3 us."""
        return self._alive and self._clock() >= self._due

    def update(self, share: float, *, step: int, **figures: float) -> None:
        """Show the share done and the values if a drawing is due (0.5 us otherwise).

        A number of steps done is shown once.
        """
        if not self._alive or step == self._shown:
            return
        now, self._latest = self._clock(), (share, step, figures)
        if now < self._due:
            return
        self._first = self._first or (now, share)
        self._due = now + BAR_INTERVAL
        if self._bar is not None or share >= self._share_due:
            self._due, self._share_due = now + self._interval, share + LINE_SHARE
            self._guard(self._show)

    def close(self) -> None:
        """Show the last update and end the display; a second call does nothing."""
        if self._latest is not None:
            self._guard(self._show)
        if self._bar is not None:
            self._guard(self._bar.stop)
        self._alive = False

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _guard(self, show: Callable[[], None]) -> None:
        if not self._alive:
            return
        try:
            show()
        except Exception:  # of any kind: the display must not stop the run
            self._alive = False

    def _begin(self) -> None:
        if self._stream.isatty():
            self._bar = _bar_on(self._stream)
        if self._bar:
            self._task = self._bar.add_task(self._label, total=1.0, done=0, text="")
            self._bar.start()

    def _show(self) -> None:
        assert self._latest is not None
        assert self._first is not None
        share, step, figures = self._latest
        now, self._latest = self._clock(), None
        began, start = self._first
        left = []
        if start < share < 1.0:
            seconds = (now - began) * (1.0 - share) / (share - start)
            left.append(f"{duration(seconds)} left")
        values = [with_unit(v, self._figure_units.get(name, "")) for name, v in figures.items()]
        named = [f"{name} {value}" for name, value in zip(figures, values, strict=True)]
        self._shown = step
        if self._bar:
            # The units tell the first two figures apart, the line is short.
            first = [" ".join(values[:2])] if values else []
            taken = len(self._label) + _BAR_WIDTH + len("100 %") + 3  # a blank before each column
            room = self._bar.console.width - taken
            # As many of the texts as the line has room for.
            text = ""
            for one in (*first, *left, *named[2:]):
                longer = f"{text}, {one}" if text else one
                if len(longer) > room:
                    break
                text = longer
            done = percent(share)
            self._bar.update(self._task, completed=share, done=done, text=text, refresh=True)
        else:
            line = f"{percent(share)} %"
            if said := ", ".join([*named[:2], *left]):
                line += f": {said}"
            if self._log is not None:
                self._log(line)
            self._stream.write(f"{self._label}: {line}\n")
            self._stream.flush()


def _bar_on(stream: TextIO) -> Any:
    # a bar of rich, drawn only on request: no thread beside the time loop; None if it cannot be
    try:
        from rich.console import Console
        from rich.progress import BarColumn, TextColumn
        from rich.progress import Progress as RichProgress
        from rich.table import Column
    except ImportError:  # rich comes with meshio, but that is not guaranteed
        return None
    console = Console(file=stream)
    if not console.is_terminal or console.is_dumb_terminal:
        return None
    whole = Column(no_wrap=True)
    return RichProgress(
        TextColumn("{task.description}", table_column=whole),
        BarColumn(bar_width=_BAR_WIDTH),
        TextColumn("{task.fields[done]} %", table_column=whole),
        TextColumn("{task.fields[text]}", markup=False, table_column=Column(ratio=1)),
        console=console,
        auto_refresh=False,
        expand=True,
    )


def percent(share: float) -> int:
    """Return the whole percent done; 100 only at the end.

    Examples
    --------
    >>> percent(0.2), percent(0.9999), percent(1.0003)
    (20, 99, 100)
    """
    if not share > 0.0:  # nan too
        return 0
    return math.floor(100.0 * min(share, 1.0) + _ROUND_OFF)


def duration(seconds: float) -> str:
    """Return a time in words, as "1 min 25 s"."""
    minutes, s = divmod(max(0, round(seconds)), 60)
    hours, m = divmod(minutes, 60)
    if hours:
        return f"{hours} h {m:02d} min"
    return f"{m} min {s:02d} s" if m else f"{s} s"
