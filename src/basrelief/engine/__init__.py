"""Engines, which run a program for each pixel of a picture; they know nothing of scenes.

`cpu` compiles with LLVM and runs on all cores; `gpu` runs WGSL through WebGPU. Both implement
`Engine`, and compute the same planes within the tolerances that the tests state.
"""

from basrelief.engine.engine import Canvas, Engine, PlaneBuffer, Planes, check_sampling
from basrelief.engine.select import choose_device, engine_of

__all__ = [
    "Canvas",
    "Engine",
    "PlaneBuffer",
    "Planes",
    "check_sampling",
    "choose_device",
    "engine_of",
]
