"""Where the time of a call goes: its seconds by step.

    with Timings() as timings:
        render("materials/rock").save("rock.png")
    print(timings)

Code names its step by `with step("encode"):`, which costs nothing while no `Timings` are taken. A
step within another one pauses it, so that no second counts twice. Threads have steps of their own;
where they overlap, as in films, the steps add up to more than the whole.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator

STEPS = ("load", "bake", "compile", "draw", "encode", "write")
"""Reading maps and making their mip levels; baking tables; compiling programs or loading them from
the cache; drawing, and reading the pixels back from a GPU; encoding pictures; writing files."""


class Timings:
    """A context that measures the steps of all threads; there is one at a time.

    Parameters
    ----------
    since : float, optional
        The `time.perf_counter` from which the total counts, by default that of the beginning.

    Attributes
    ----------
    seconds : dict
        Seconds spent in each step, in the order of `STEPS`.
    total : float
        Seconds until the end of the context, or until now.
    """

    def __init__(self, since: float | None = None) -> None:
        self.seconds = dict.fromkeys(STEPS, 0.0)
        self._began = time.perf_counter() if since is None else since
        self._ended: float | None = None
        self._lock = threading.Lock()

    def __enter__(self) -> Timings:
        global _current
        _current = self
        return self

    def __exit__(self, *_: object) -> None:
        global _current
        self._ended = time.perf_counter()
        _current = None

    @property
    def total(self) -> float:
        return (self._ended or time.perf_counter()) - self._began

    def add(self, name: str, seconds: float) -> None:
        """Count seconds, which may be negative, for a step."""
        with self._lock:
            self.seconds[name] += seconds

    def __str__(self) -> str:
        """A line for each step, for the time outside all steps, and for the total."""
        rest = max(0.0, self.total - sum(self.seconds.values()))
        rows = {**self.seconds, "other": rest, "total": self.total}
        return "\n".join(f"{name:8}{1e3 * seconds:8.1f} ms" for name, seconds in rows.items())


_current: Timings | None = None
_thread = threading.local()


@contextlib.contextmanager
def step(name: str) -> Iterator[None]:
    """Count the time within the context for a step of `STEPS`."""
    timings = _current
    if timings is None:
        yield
        return
    outer: str | None = getattr(_thread, "step", None)
    _thread.step = name
    began = time.perf_counter()
    try:
        yield
    finally:
        seconds = time.perf_counter() - began
        timings.add(name, seconds)
        if outer is not None:
            timings.add(outer, -seconds)
        _thread.step = outer
