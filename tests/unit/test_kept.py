"""What a checkpoint keeps of an object by names."""

from typing import NamedTuple

import numpy as np
import pytest

from shellcut.numerics.kept import Kept


class Rows(NamedTuple):
    place: np.ndarray
    force: np.ndarray


class Term(Kept):
    kept_names = "_rows", "_far", "_none"

    def __init__(self, n):
        self._rows, self._far = Rows(np.full((n, 3), 0.5), np.zeros(n)), np.arange(n)
        self._none, self.other = None, n


def test_what_is_named_is_copied_and_nothing_else_and_rows_of_another_shape_are_refused():
    term, again = Term(4), Term(2)
    again.restore(term.saved())
    term._far[:] = term._rows.place[:] = 9
    np.testing.assert_array_equal(again._rows.place, np.full((4, 3), 0.5))
    assert (again._far.tolist(), again._none, again.other) == ([0, 1, 2, 3], None, 2)
    saved = term.saved()
    saved["rows"]["place"] = np.zeros((4, 2))
    said = r"_rows\.place must have rows of shape \(3,\), got \(4, 2\)"
    with pytest.raises(ValueError, match=said):
        Term(2).restore(saved)
