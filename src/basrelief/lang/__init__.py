"""The shader subset of Python, and its compilers: shaders run as Python, on the CPU and on the GPU.

`@shader` marks a function, `@struct` a record, `@slot` a function whose body is bound when a
program is made, `@static` a record of static conditions, `@resources` a group of maps. Types and
intrinsics are imported from here. `CONVENTIONS.md` states the rules.
"""

# all intrinsics, so that a new one is written in its module alone
from basrelief.lang import elementary, intrinsics
from basrelief.lang.elementary import *  # noqa: F403
from basrelief.lang.intrinsics import *  # noqa: F403
from basrelief.lang.intrinsics import BY_FUNCTION
from basrelief.lang.resources import Buffer, HeightField, Map, Texture, resources
from basrelief.lang.shader import Shader, bound, shader, slot, watched
from basrelief.lang.types import ShaderError, TypeSlot, static, static_fields, struct
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4
from basrelief.settings import setting

_MODULES = (elementary.__name__, intrinsics.__name__)
__all__ = [
    "Buffer", "HeightField", "IVec2", "Map", "Mat3", "Shader", "ShaderError", "Texture", "TypeSlot",
    "Vec2", "Vec3", "Vec4", "bound", "resources", "setting", "shader", "slot", "static",
    "static_fields", "struct", "watched",
    *(f.__name__ for f in BY_FUNCTION if f.__module__ in _MODULES),
]  # fmt: skip
