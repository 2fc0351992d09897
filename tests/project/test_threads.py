"""Work on several threads: order, errors, and the number of threads."""

from __future__ import annotations

import threading
import time

import pytest

from basrelief.threads import core_count, map_on_threads


def test_results_come_in_the_order_of_the_items() -> None:
    """The first item waits for the second, which another thread takes."""
    second_done = threading.Event()

    def square(number: int) -> int:
        if number == 0:
            assert second_done.wait(30)
        else:
            second_done.set()
        return number * number

    assert list(map_on_threads(square, range(50), threads=2)) == [n * n for n in range(50)]
    assert list(map_on_threads(square, range(1, 1))) == []


def test_an_error_is_raised_and_the_rest_dropped() -> None:
    started = []

    def fail_at_3(number: int) -> int:
        started.append(number)
        if number == 3:
            raise ValueError("no 3")
        if number > 3:
            time.sleep(0.01)
        return number

    results = map_on_threads(fail_at_3, range(1_000), threads=1)
    assert [next(results) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(ValueError, match="no 3"):
        next(results)
    assert len(started) < 1_000


def test_there_are_at_most_as_many_threads_as_requested() -> None:
    names = set(map_on_threads(lambda _: threading.current_thread().name, range(200), threads=3))
    assert 1 <= len(names) <= 3
    assert core_count() >= 1
