"""Handing work out: every part once, sums in order, no more threads than asked for."""

import numpy as np
import pytest

from shellcut.numerics.jit import BoundOnce
from shellcut.numerics.threads import Workers, in_order


@pytest.mark.parametrize("threads", [1, 3])
def test_every_part_is_done_once(threads):
    workers = Workers(10, threads)
    done = np.zeros(workers.count, int)

    def part(k, count, by):
        assert count == threads
        done[k] += by

    workers.run(BoundOnce(part), 2)
    assert done.tolist() == [2] * threads


def test_an_error_of_any_part_reaches_the_caller():
    def part(k, _count):
        if k == 1:
            raise RuntimeError("part 1")

    with pytest.raises(RuntimeError, match="part 1"):
        Workers(10, 2).run(BoundOnce(part))


def test_totals_are_over_all_parts_in_their_order():
    assert in_order(np.array([[1.0, 2.0]])) == [1.0, 2.0]
    # 1e16 + 1 + 1 from the left keeps 1e16, from the right it would not.
    assert in_order(np.array([[1e16, 1.0], [1.0, 2.0], [1.0, 4.0]])) == [1e16, 7.0]


def test_a_small_film_has_one_thread_and_nonsense_is_refused():
    assert Workers(49_999).count == 1
    for nonsense in (0, 100_000, 2.0):
        with pytest.raises(ValueError, match=f"threads must be .*, got {nonsense}"):
            Workers(10, nonsense)


def test_more_threads_than_cores_are_said(monkeypatch, caplog):
    monkeypatch.setattr("shellcut.numerics.threads.available_cores", lambda: 2)
    Workers(10, 2)
    assert not caplog.messages
    assert Workers(10, 3).count == 3
    assert caplog.messages == [
        "3 threads share 2 cores: the run is slower than with one thread per core"
    ]
