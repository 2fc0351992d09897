"""The engine that runs programs on a device."""

from __future__ import annotations

import functools

from basrelief.engine.engine import Engine
from basrelief.errors import DeviceError

DEVICES = ("auto", "cpu", "gpu")


@functools.cache
def choose_device(name: str = "auto") -> Engine:
    """The engine for a device: "cpu", "gpu" or "auto".

    "auto" is a real GPU where there is one, and otherwise the CPU. Raises DeviceError for another
    name, and for "gpu" where there is none.
    """
    if name == "cpu":
        from basrelief.engine.cpu import CpuEngine

        return CpuEngine()
    if name == "gpu":
        from basrelief.engine.gpu import GpuEngine

        return GpuEngine()
    if name == "auto":
        from basrelief.engine.gpu import has_hardware_gpu

        return choose_device("gpu" if has_hardware_gpu() else "cpu")
    raise DeviceError(f"no device is called {name!r}; use one of {', '.join(DEVICES)}")


def engine_of(device: str | Engine) -> Engine:
    """The engine for a device; an engine is returned as it is."""
    return choose_device(device) if isinstance(device, str) else device
