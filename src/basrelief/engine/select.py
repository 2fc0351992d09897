"""Choice of the engine for a device."""

from __future__ import annotations

import functools

from basrelief.engine.engine import Engine
from basrelief.errors import DeviceError

DEVICES = ("auto", "cpu", "gpu")


@functools.cache
def choose_device(name: str = "auto") -> Engine:
    """Choose the engine for a device.

    Parameters
    ----------
    name
        "cpu", "gpu" or "auto": a GPU that is not a software adapter if there is one, otherwise the
        CPU.

    Returns
    -------
    Engine
        The same object for the same name.

    Raises
    ------
    DeviceError
        For another name, and for "gpu" if no GPU can be used.
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
    """The engine for a device name; an engine is returned unchanged."""
    return choose_device(device) if isinstance(device, str) else device
