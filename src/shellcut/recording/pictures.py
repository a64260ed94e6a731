"""Pictures of a run, drawn in a process of their own while the run continues.

A picture takes as long as some thousand steps of a small film. The run waits for pictures only
where many are pending, and before a checkpoint.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from shellcut.child_process import Child, ChildDied
from shellcut.unit import showing, units_shown

# Pictures that may be pending; and nodes in all of them together.
_MOST_PENDING, _MOST_NODES = 8, 200_000

# Processes of runs that have ended: a process takes a second to start.
_idle: list[Child] = []


class Pictures:
    """Draws the pictures of a run, one after the other.

    Parameters
    ----------
    n_node : int
        Size of the film: of a large one a single picture may be pending.
    """

    def __init__(self, n_node: int) -> None:
        self._most = max(1, min(_MOST_PENDING, _MOST_NODES // n_node))
        self._child: Child | None = None
        self._pending: deque[tuple[Any, ...]] = deque()
        self.failed = False
        """Whether a picture could not be drawn."""

    def draw(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Begin to call a function that draws, in the units in which the caller shows values.

        Function and arguments can be pickled. Raises the error of an earlier picture, if any.
        """
        self._wait(0 if self._child is None else self._most - 1)
        if self._child is None:
            idle = [child for child in _idle if child.lives()]
            _idle[:] = idle[1:]
            with suppress(OSError):  # no process may be started
                self._child = idle[0] if idle else Child()
        call = _in_units, units_shown(), function, *arguments
        self._pending.append(call)
        if self._child is not None:
            self._child.begin(*call)

    def settle(self) -> None:
        """Wait until all pictures are drawn; raises the error of one of them, if any."""
        self._wait(0)

    def close(self) -> None:
        """Wait for pending pictures; leave the process to the next run."""
        try:
            self.settle()
        finally:
            if self._child is not None and not self._pending and self._child.lives():
                _idle.append(self._child)
            self._child = None

    def _wait(self, n: int) -> None:
        """Wait until at most n pictures are pending."""
        while len(self._pending) > n:
            try:
                self._end_first()
            except BaseException:
                self.failed = True
                raise

    def _end_first(self) -> None:
        """Wait for the first pending picture; without a process, draw it here."""
        try:
            if self._child is None:
                function, *arguments = self._pending[0]
                function(*arguments)
            else:
                self._child.result()
        except ChildDied:  # killed, or out of memory
            self._child = None
            return
        except Exception:
            self._pending.popleft()
            raise
        except BaseException:  # Ctrl-C ends the process
            self._child = None
            raise
        self._pending.popleft()


def _in_units(units: str, function: Callable[..., Any], *arguments: Any) -> None:
    with showing(units):
        function(*arguments)
