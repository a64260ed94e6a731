"""A row of the table: what a user does, its limits, and the check of what comes of it."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple


class Outcome(NamedTuple):
    """What the table shows of a row."""

    measured: str
    verdict: str
    reason: str = ""


@dataclass(frozen=True)
class Row:
    """One row."""

    do: Callable
    """Does it for a user and returns what was measured; fails by an assertion."""
    minute: str
    """When a user gets there."""
    what: str
    seconds: float
    """Time limit."""
    limit: str = ""
    """Other limits, checked by the row itself."""
    needs: tuple[str, ...] = ()
    """Properties of the user that must be there before the clock starts."""

    def outcome(self, user):
        """Do it, against the clock."""
        start = time.perf_counter()
        try:
            for need in self.needs:
                getattr(user, need)
            start = time.perf_counter()
            measured = self.do(user)
        except Exception as reason:  # a row that breaks must not hide those that follow
            return Outcome(f"{time.perf_counter() - start:.1f} s", "FAILED", str(reason))
        taken = time.perf_counter() - start
        if taken > self.seconds:
            return Outcome(f"{taken:.1f} s; {measured}", "FAILED", "over its time limit")
        return Outcome(f"{taken:.1f} s; {measured}", "passed")


ROWS = []
"""In the order in which they are declared."""


def row(*about, **limits):
    """Declare what a function does as a row; see `Row`."""
    return lambda do: ROWS.append(Row(do, *about, **limits))


def assert_said(said, *words):
    """Fail unless all the words were said."""
    missing = [word for word in words if word not in said]
    assert not missing, f"{missing} not in what was said:\n{said.strip()[-2000:]}"
