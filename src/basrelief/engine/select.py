"""Which engine a name stands for."""

from __future__ import annotations

import functools

from basrelief.engine.engine import Engine
from basrelief.errors import EngineError

NAMES = ("auto", "cpu", "gpu")


@functools.cache
def choose_engine(name: str = "auto") -> Engine:
    """The engine of a name: "cpu", "gpu", or "auto", a real GPU where there is one, else the CPU.

    Raises EngineError for another name, and where "gpu" is asked for and there is none.
    """
    if name == "cpu":
        from basrelief.engine.cpu import CpuEngine

        return CpuEngine()
    if name == "gpu":
        from basrelief.engine.gpu import GpuEngine

        return GpuEngine()
    if name == "auto":
        from basrelief.engine.gpu import real_gpu

        return choose_engine("gpu" if real_gpu() else "cpu")
    raise EngineError(f"no engine is called {name!r}; use one of {', '.join(NAMES)}")
