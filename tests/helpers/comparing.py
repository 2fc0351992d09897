"""Bit-exact comparison of a shader run in plain Python and compiled.

Programs read one record of a `Buffer` per pixel, so that one compiled program sees many values.
"""

from __future__ import annotations

import functools
import importlib.util
import itertools
import sys
from pathlib import Path

import numpy as np

from basrelief.engine.cpu import CpuEngine
from basrelief.lang import IVec2, bound
from basrelief.lang.program import Program
from basrelief.lang.types import fields_of, leaf_values

IMPORTS = """
from basrelief.lang import *
"""

FLOATS = [
    0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 1.5, -2.5, 3.0, 0.1, -0.7, 7.25, 1e-3, -1e-3, 123.456, -1e4,
    8191.5, 16777216.0, -16777217.0, 2147483648.0, -2147483648.0, 2147483520.0, 4e9, -4e9, 1e20,
    3.4028235e38, -3.4028235e38, 1.1754944e-38, -1.1754944e-38, 1e-40, -1e-45, 5.877472e-39,
    0.99999994, 1.0000001, 3.1415927, -1.5707964, float("inf"), float("-inf"), float("nan"),
]  # fmt: skip
"""Floats at boundaries: signs of zero, denormals, ends of the range, NaN."""

INTS = [
    0, 1, -1, 2, -2, 3, -3, 5, 7, -7, 16, 31, -32, 127, 1000, -1000, 65535, 65536, 8388607,
    16777217, -16777217, 1073741824, 2147483647, -2147483647, -2147483648,
]  # fmt: skip
"""Ints at boundaries: signs, powers of two, ends of the range."""


@functools.cache
def cpu(lanes: int = 8, threads: int = 1) -> CpuEngine:
    return CpuEngine(lanes=lanes, threads=threads)


_numbers = itertools.count()


def write_module(folder: Path, text: str, name: str | None = None):
    """Import a module from a file with a text, since shaders need source files."""
    name = name or f"written_{next(_numbers)}"
    path = folder / f"{name}.py"
    path.write_text(IMPORTS + text)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def bits(value) -> int:
    """32 bits of a float, int or bool; one number for every NaN."""
    if isinstance(value, float | np.floating):
        assert isinstance(value, np.float32), f"{value!r} is no float32"
        return 0x7FC00000 if value != value else int(value.view(np.int32))
    return int(value)


def interpreted(entry, size, values, bindings=None):
    """Planes of a program, by calling its entry in Python for each pixel: arrays of bits."""
    width, height = size
    names = [name for name, _ in Program(entry, bindings or {}).planes]
    result = entry.signature[1]
    planes = {name: np.zeros((height, width), np.int64) for name in names}
    with bound(bindings or {}):
        for y, x in itertools.product(range(height), range(width)):
            record = entry(IVec2(x, y), **values)
            for name, leaf in zip(names, leaf_values(record, result), strict=True):
                planes[name][y, x] = bits(leaf)
    return planes


def compiled(entry, size, values, bindings=None, lanes=8, threads=1, edge="wrap"):
    """The planes of a program from the CPU engine: arrays of bits."""
    program = Program(entry, bindings or {}, edge)
    planes = cpu(lanes, threads).run(program, values, size)
    words_by_name = {}
    for name, plane in planes.items():
        words = np.ascontiguousarray(plane).view(np.int32).astype(np.int64)
        if plane.dtype == np.float32:
            words[np.isnan(plane)] = 0x7FC00000
        words_by_name[name] = words
    return words_by_name


def assert_same(expected, actual, describe=None) -> None:
    """Fail with the first position at which planes of bits differ."""
    assert expected.keys() == actual.keys()
    for name, plane in expected.items():
        places = np.argwhere(plane != actual[name])
        if len(places):
            y, x = places[0]
            what = describe(name, x, y) if describe else ""
            raise AssertionError(
                f"{name} at ({x}, {y}): plain {shown(plane[y, x])}, compiled "
                f"{shown(actual[name][y, x])}; {len(places)} of {plane.size} differ. {what}"
            )


def shown(word) -> str:
    word = int(word) & 0xFFFFFFFF
    return f"{word:#010x} ({np.uint32(word).view(np.float32)}, {np.uint32(word).view(np.int32)})"


def assert_python_is_cpu(entry, size, values, bindings=None, lanes=(8,), edge="wrap") -> None:
    expected = interpreted(entry, size, values, bindings)
    for count in lanes:
        actual = compiled(entry, size, values, bindings, count, edge=edge)

        def describe(name, x, y):
            inputs = [v.items[min(x, len(v) - 1)] for v in values.values() if hasattr(v, "items")]
            return f"lanes {count}, inputs {inputs}"  # noqa: B023

        assert_same(expected, actual, describe)


def record_fields(record) -> list[str]:
    return list(fields_of(record))
