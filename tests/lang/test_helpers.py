"""Helpers of shading languages in plain Python, against the intrinsics and operators they are for.

And the text of all intrinsics as GLSL, by the reference compiler; `test_gpu_agrees.py` runs WGSL.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from test_map_reads import mips
from test_operators import TABLES, table_module

from basrelief.lang import (
    HeightField,
    IVec2,
    Texture,
    Vec2,
    copysign,
    corners,
    helpers,
    size,
    texel,
)
from basrelief.lang.frontend import analyse
from basrelief.lang.targets.glsl import print_glsl
from helpers.comparing import IMPORTS, INTS, write_module
from helpers.glsl import assert_compiles

CELLS = [IVec2(x, y) for x, y in itertools.product((-9, -2, -1, 0, 1, 2, 4, 5, 6, 1000), repeat=2)]
SIZES = [(1, 1), (1, 4), (5, 3), (4, 4)]


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("shape", SIZES)
def test_reads_of_maps(shape, edge):
    draw = np.random.default_rng(5)
    field = HeightField(mips(draw.random(shape, np.float32)), edge)
    colors = draw.integers(0, 65536, (*shape, 4)).astype(np.uint16)
    map = Texture(mips(colors), edge)
    for level, cell in itertools.product((-1, 0, 1, 2, 9), CELLS):
        assert helpers.corners(field, cell, level) == corners(field, cell, level)
        assert helpers.texel(map, cell, level) == texel(map, cell, level)
        finest = helpers.size_of_level(size(field, 0), len(field.levels), level)
        assert finest == size(field, level)
    rows, columns = shape
    for x, y in itertools.product(range(-1, columns), range(-1, rows)):
        whole = helpers.corners_of_finest(field, Vec2(float(x), float(y)))
        assert whole == corners(field, IVec2(x, y), 0)


def test_division_of_ints():
    for a, b in itertools.product(INTS, repeat=2):
        quotient, rest = divmod(a, b) if b else (0, 0)
        assert helpers.floor_divide(a, b) == np.int64(quotient).astype(np.int32)
        assert helpers.floor_modulo(a, b) == rest


def test_signs_and_powers():
    for x, y in itertools.product((0.0, -0.0, 1.5, -2.0, 1e-40), repeat=2):
        assert helpers.copy_sign(x, y).tobytes() == copysign(x, y).tobytes()
    assert helpers.power(2.0, 3.0) == 8.0
    assert helpers.power(0.0, 0.0) == 1.0
    assert helpers.power(-1.0, 2.0) == 0.0
    for logarithm in (helpers.log_clamped, helpers.log2_clamped):
        assert logarithm(1.0) == 0.0
        assert np.isfinite(logarithm(-1.0))


@pytest.mark.parametrize("table", TABLES)
def test_intrinsics_as_glsl(folder, tmp_path, table):
    buffered, _ = table_module(folder, table)
    text = Path(buffered.__file__).read_text().removeprefix(IMPORTS)
    text = text.replace("items: Buffer[Input]", "item: Input")
    text = text.replace("    item = items[pixel.x]\n", "")
    functions = print_glsl(analyse(write_module(folder, text).entry), "wrap")
    main = "out vec4 color;\nvoid main() { color = vec4(0.0); }\n"
    assert_compiles(f"#version 330\n{functions}\n{main}", tmp_path)
