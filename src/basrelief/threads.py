"""Work on several threads, for code that releases Python's lock: NumPy, engines, codecs."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")


def core_count() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def map_on_threads(
    function: Callable[[T], R], items: Iterable[T], threads: int | None = None
) -> Iterator[R]:
    """Results of a function for items, in their order, computed on threads, by default one for each
    core.

    An error that the function raises is raised here; items whose turn has not come are dropped.
    """
    with ThreadPoolExecutor(threads or core_count()) as pool:
        yield from pool.map(function, items)
