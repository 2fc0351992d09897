"""Vectors and matrices of the shader subset, for shaders that run as plain Python.

Components are NumPy float32 (int32 for `IVec2`), so that a shader stepped through in a debugger
computes the same bits as the compiled one. Values are immutable.

A `Vec` swizzles as in GLSL: `v.xy`, `v.zyx`, `c.rgb`. Operators work component by component, with
scalars broadcast.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

_SWIZZLES = ("xyzw", "rgba")


def swizzle_indices(name: str, size: int) -> tuple[int, ...] | None:
    """Component indices of a swizzle, or None where it is not a swizzle of that size."""
    for letters in _SWIZZLES:
        indices = tuple(letters.find(letter) for letter in name)
        if 1 <= len(name) <= 4 and all(0 <= index < size for index in indices):
            return indices
    return None


class _Vector:
    """Base of the vectors; subclasses set `size`, `component` and `_scalar`."""

    size: ClassVar[int]
    component: ClassVar[type]
    _scalar: ClassVar[Callable[[Any], Any]]
    __slots__ = ("_components",)
    _components: tuple[Any, ...]

    def __init__(self, *parts: Any) -> None:
        flat: list[Any] = []
        for part in parts:
            flat.extend(part._components if isinstance(part, _Vector) else (part,))
        if len(flat) == 1:
            flat *= self.size
        if len(flat) != self.size:
            raise TypeError(f"{type(self).__name__} takes {self.size} components, not {len(flat)}")
        object.__setattr__(self, "_components", tuple(type(self)._scalar(c) for c in flat))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("vectors are immutable; build a new one")

    def __getattr__(self, name: str) -> Any:
        indices = swizzle_indices(name, self.size)
        if indices is None:
            raise AttributeError(f"{type(self).__name__} has no component {name!r}")
        parts = [self._components[index] for index in indices]
        if len(parts) == 1:
            return parts[0]
        vector = _OF_SIZE.get((self.component, len(parts)))
        if vector is None:
            raise AttributeError(f"there is no vector of {len(parts)} ints for {name!r}")
        return vector(*parts)

    def __iter__(self) -> Iterator[Any]:
        return iter(self._components)

    def __len__(self) -> int:
        return self.size

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(str(c) for c in self._components)})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self._components == other._components

    def __hash__(self) -> int:
        return hash(self._components)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), self._components

    def map(self, function: Callable[..., Any], *others: Any) -> Self:
        """Vector of function(component, …); scalars among `others` are broadcast."""
        rows = [o._components if isinstance(o, _Vector) else (o,) * self.size for o in others]
        return type(self)(
            *(function(*parts) for parts in zip(self._components, *rows, strict=True))
        )

    def _zip(self, other: Any, operation: Callable[[Any, Any], Any]) -> Any:
        if type(other) is type(self):
            right = other._components
        elif np.isscalar(other):
            right = (type(self)._scalar(other),) * self.size
        else:
            return NotImplemented
        return type(self)(*map(operation, self._components, right))

    def __neg__(self) -> Self:
        return type(self)(*(-c for c in self._components))

    def __add__(self, other: Self | float) -> Self:
        return self._zip(other, lambda a, b: a + b)

    def __radd__(self, other: float) -> Self:
        return self._zip(other, lambda a, b: b + a)

    def __sub__(self, other: Self | float) -> Self:
        return self._zip(other, lambda a, b: a - b)

    def __rsub__(self, other: float) -> Self:
        return self._zip(other, lambda a, b: b - a)

    def __mul__(self, other: Self | float) -> Self:
        return self._zip(other, lambda a, b: a * b)

    def __rmul__(self, other: float) -> Self:
        return self._zip(other, lambda a, b: b * a)


class _FloatVector(_Vector):
    __slots__ = ()
    component = float
    _scalar = np.float32

    def __truediv__(self, other: Self | float) -> Self:
        return self._zip(other, lambda a, b: a / b)

    def __rtruediv__(self, other: float) -> Self:
        return self._zip(other, lambda a, b: b / a)


class Vec2(_FloatVector):
    """Two float32 components, x and y."""

    __slots__ = ()
    size = 2
    if TYPE_CHECKING:
        x: float
        y: float
        xy: Vec2
        yx: Vec2
        xx: Vec2
        yy: Vec2


class Vec3(_FloatVector):
    """Three float32 components: x, y, z, or r, g, b."""

    __slots__ = ()
    size = 3
    if TYPE_CHECKING:
        x: float
        y: float
        z: float
        r: float
        g: float
        b: float
        xy: Vec2
        yx: Vec2
        xz: Vec2
        zx: Vec2
        yz: Vec2
        zy: Vec2
        xyz: Vec3
        yzx: Vec3
        zxy: Vec3
        zyx: Vec3
        rgb: Vec3


class Vec4(_FloatVector):
    """Four float32 components: x, y, z, w, or r, g, b, a."""

    __slots__ = ()
    size = 4
    if TYPE_CHECKING:
        x: float
        y: float
        z: float
        w: float
        r: float
        g: float
        b: float
        a: float
        xy: Vec2
        yx: Vec2
        zw: Vec2
        xz: Vec2
        yw: Vec2
        rg: Vec2
        xyz: Vec3
        rgb: Vec3


class IVec2(_Vector):
    """Two int32 components, x and y; arithmetic wraps."""

    __slots__ = ()
    size = 2
    component = int
    _scalar = np.int32
    if TYPE_CHECKING:
        x: int
        y: int
        xy: IVec2
        yx: IVec2


_OF_SIZE: dict[tuple[type, int], type[_Vector]] = {
    (t.component, t.size): t for t in (Vec2, Vec3, Vec4, IVec2)
}


class Mat3:
    """3 × 3 matrix of three columns, the images of the axes x, y and z; `m @ v` transforms v."""

    __slots__ = ("x", "y", "z")
    x: Vec3
    y: Vec3
    z: Vec3

    def __init__(self, x: Vec3, y: Vec3, z: Vec3) -> None:
        for name, column in zip("xyz", (x, y, z), strict=True):
            object.__setattr__(self, name, Vec3(*column))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("matrices are immutable; build a new one")

    def __matmul__(self, v: Vec3) -> Vec3:
        return self.x * v.x + self.y * v.y + self.z * v.z

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mat3) and (self.x, self.y, self.z) == (other.x, other.y, other.z)

    def __hash__(self) -> int:
        return hash((self.x, self.y, self.z))

    def __repr__(self) -> str:
        return f"Mat3({self.x}, {self.y}, {self.z})"

    def __reduce__(self) -> tuple[Any, ...]:
        return Mat3, (self.x, self.y, self.z)
