"""What a checkpoint keeps of an object by names: arrays, numbers, tables, objects, nothing."""

from typing import NamedTuple

import numpy as np
import pytest

from shellcut.numerics.kept import Kept


class Rows(NamedTuple):
    place: np.ndarray
    force: np.ndarray


class Clock(Kept):
    kept_names = ("_time",)

    def __init__(self, time):
        self._time = time


class Term(Kept):
    kept_names = "_rows", "_clock", "count", "_far", "_none"

    def __init__(self, n, time):
        self._rows, self._clock = Rows(np.full((n, 3), time), np.zeros(n)), Clock(time)
        self.count, self._far, self._none, self.other = n, np.arange(n), None, n


def test_what_is_named_is_copied_and_nothing_else():
    term, again = Term(4, 0.5), Term(2, 0.0)
    clock = again._clock
    again.restore(term.saved())
    term._far[:] = term._rows.place[:] = 9
    np.testing.assert_array_equal(again._rows.place, np.full((4, 3), 0.5))
    assert again._far.tolist() == [0, 1, 2, 3]
    assert again._clock is clock
    assert (clock._time, again.count, again._none, again.other) == (0.5, 4, None, 2)


def test_a_table_with_rows_of_another_shape_is_refused():
    saved = Term(4, 0.5).saved()
    saved["rows"]["place"] = np.zeros((4, 2))
    said = r"_rows\.place must have rows of shape \(3,\), got \(4, 2\)"
    with pytest.raises(ValueError, match=said):
        Term(2, 0.0).restore(saved)
