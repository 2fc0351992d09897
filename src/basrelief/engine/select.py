"""Choice of the engine for a device."""

from __future__ import annotations

import functools
import sys
import threading
from pathlib import Path

from basrelief.engine.engine import Engine
from basrelief.errors import DeviceError

DEVICES = ("auto", "cpu", "gpu")


_engines: dict[str, Engine] = {}
_lock = threading.Lock()


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
        The same object for the same name, until its device is lost.

    Raises
    ------
    DeviceError
        For another name, and for "gpu" if no GPU can be used.
    """
    if name not in DEVICES:
        raise DeviceError(f"no device is called {name!r}; use one of {', '.join(DEVICES)}")
    if name == "auto":
        return choose_device("gpu" if has_hardware_gpu() else "cpu")
    with _lock:
        if name not in _engines or _engines[name].is_lost:
            _engines[name] = _new_engine(name)
        return _engines[name]


def _new_engine(name: str) -> Engine:
    if name == "cpu":
        from basrelief.engine.cpu import CpuEngine

        return CpuEngine()
    from basrelief.engine.gpu import GpuEngine

    return GpuEngine()


def engine_of(device: str | Engine) -> Engine:
    """The engine for a device name; an engine is returned unchanged."""
    return choose_device(device) if isinstance(device, str) else device


_DEVICE_FILES = ("dri/renderD*", "nvidia[0-9]*", "nvhost*", "dxg", "kfd", "kgsl*", "mali*")
"""Device files of graphics cards on Linux, also under WSL and on embedded boards."""


def _has_device_file() -> bool:
    """Whether Linux has a device file of a graphics card; True on other systems.

    Saves a machine without one the second that starting a software driver takes.
    """
    if not sys.platform.startswith("linux"):
        return True
    return any(next(Path("/dev").glob(pattern), None) for pattern in _DEVICE_FILES)


@functools.cache
def has_hardware_gpu() -> bool:
    """Whether there is a GPU that is not a software adapter."""
    if not _has_device_file():
        return False
    from basrelief.engine.gpu import request_adapter

    try:
        adapter = request_adapter()
    except DeviceError:
        return False
    return adapter.info["adapter_type"] != "CPU"
