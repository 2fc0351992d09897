"""Engines run a program over the pixels of a picture; they know nothing of scenes.

`cpu` compiles with LLVM and runs on all cores; `gpu` runs WGSL through WebGPU. Both have one
interface, `Engine`, and give the same planes within the tolerances that the tests state.
"""

from basrelief.engine.engine import Engine, Planes
from basrelief.engine.select import choose_device, engine_of

__all__ = ["Engine", "Planes", "choose_device", "engine_of"]
