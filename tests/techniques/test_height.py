"""The bilinear height field against a float64 reference, in Python and on both engines."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.engine.cpu import CpuEngine
from basrelief.lang import HeightField, IVec2, Vec2, shader, struct
from basrelief.lang.frontend import analyse
from basrelief.lang.program import Program
from basrelief.techniques.height import sharp

SMALL = np.array([[0.0, 0.25, 1.0], [0.5, 0.125, 0.75]], np.float32)
"""Two rows of three different texels."""


def index(i: int, count: int, edge: str) -> int:
    return i % count if edge == "wrap" else min(max(i, 0), count - 1)


def reference(heights: np.ndarray, u: float, v: float, edge: str) -> float:
    """Bilinear between texel centres at (i + ½) ÷ N, in float64."""
    rows, columns = heights.shape
    x, y = u * columns - 0.5, v * rows - 0.5
    left, top = math.floor(x), math.floor(y)
    total = 0.0
    for row, down in ((top, 1 - (y - top)), (top + 1, y - top)):
        for column, across in ((left, 1 - (x - left)), (left + 1, x - left)):
            texel = heights[index(row, rows, edge), index(column, columns, edge)]
            total += float(texel) * across * down
    return total


def read(field: HeightField, u: float, v: float) -> np.float32:
    """The shader, run as plain Python."""
    return sharp(field, Vec2(u, v))


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_the_shader_is_in_the_subset(edge: str) -> None:
    assert analyse(sharp, static_value=lambda name: edge).entry.name == "sharp"


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_texel_centres_give_the_stored_heights(edge: str) -> None:
    field = HeightField([SMALL], edge)
    for row in range(2):
        for column in range(3):
            place = (column + 0.5) / 3, (row + 0.5) / 2
            assert read(field, *place) == pytest.approx(SMALL[row, column], abs=1e-6)


def test_heights_between_centres_are_bilinear() -> None:
    """Worked out by hand, between the first two columns and the two rows."""
    field = HeightField([SMALL], "clamp")
    assert read(field, 1 / 3, 0.25) == pytest.approx((0.0 + 0.25) / 2, abs=1e-6)
    assert read(field, 1 / 6, 0.5) == pytest.approx((0.0 + 0.5) / 2, abs=1e-6)
    # a quarter of a texel to the right of the first centre, three quarters down
    u, v = (0.5 + 0.25) / 3, (0.5 + 0.75) / 2
    upper, lower = 0.25 * 0.25, 0.5 * 0.75 + 0.125 * 0.25
    assert read(field, u, v) == pytest.approx(0.25 * upper + 0.75 * lower, abs=1e-6)


def test_edges_wrap_or_clamp() -> None:
    """At (0, 0) four tiles meet; a clamped map has its first texel there."""
    wrapped, clamped = HeightField([SMALL], "wrap"), HeightField([SMALL], "clamp")
    corners = (SMALL[0, 0] + SMALL[0, 2] + SMALL[1, 0] + SMALL[1, 2]) / 4
    assert read(wrapped, 0, 0) == pytest.approx(corners)
    assert read(wrapped, 2, -1) == pytest.approx(corners)
    assert read(clamped, 0, 0) == SMALL[0, 0]
    assert read(clamped, 7, -3) == SMALL[0, 2]
    assert read(clamped, -7, 3) == SMALL[1, 0]
    assert read(clamped, 1 / 6, 1) == SMALL[1, 0]


@given(
    st.integers(1, 7),
    st.integers(1, 5),
    st.floats(-3, 3, width=32),
    st.floats(-3, 3, width=32),
    st.sampled_from(["wrap", "clamp"]),
    st.integers(0, 2**32 - 1),
)
def test_heights_equal_the_reference(
    columns: int, rows: int, u: float, v: float, edge: str, seed: int
) -> None:
    heights = np.random.default_rng(seed).random((rows, columns)).astype(np.float32)
    field = HeightField([heights], edge)  # type: ignore[arg-type]
    # uv is rounded by 2⁻²⁴ of up to 3 × 7 texels, and heights differ by up to 1 per texel
    wanted = reference(heights, u, v, edge)
    assert read(field, u, v) == pytest.approx(wanted, abs=5e-6)


@given(st.floats(-9, 9, width=32), st.floats(-9, 9, width=32), st.sampled_from(["wrap", "clamp"]))
def test_a_single_texel_is_flat(u: float, v: float, edge: str) -> None:
    field = HeightField([np.array([[0.3]])], edge)  # type: ignore[arg-type]
    assert read(field, u, v) == pytest.approx(0.3, abs=1e-7)


# --- on the engines -----------------------------------------------------------------------------


@struct
class Read:
    """The height that a pixel reads."""

    height: float


@shader
def reading(at: IVec2, field: HeightField) -> Read:
    """A little more than three tiles of the field."""
    uv = Vec2(float(at.x) * 0.0517 - 1.53, float(at.y) * 0.0917 - 1.21)
    return Read(sharp(field, uv))


SIZE = (67, 31)


def field_of(edge: str) -> HeightField:
    random = np.random.default_rng(4)
    return HeightField([random.random((9, 14)), random.random((4, 7))], edge)  # type: ignore[arg-type]


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_the_cpu_reads_the_same_bits_as_python(edge: str) -> None:
    field = field_of(edge)
    planes = CpuEngine().run(Program(reading, edge=edge), {"field": field}, SIZE)  # type: ignore[arg-type]
    for x, y in [(0, 0), (66, 30), (12, 7), (33, 30), (66, 0), (29, 13), (30, 14)]:
        one = reading(IVec2(x, y), field)
        assert planes["height"][y, x] == one.height


@pytest.mark.gpu
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_the_gpu_reads_the_same(edge: str) -> None:
    from basrelief.engine.gpu import GpuEngine

    field = field_of(edge)
    program = Program(reading, edge=edge)  # type: ignore[arg-type]
    cpu = CpuEngine().run(program, {"field": field}, SIZE)
    gpu = GpuEngine().run(program, {"field": field}, SIZE)
    for name in ("height",):
        np.testing.assert_allclose(gpu[name], cpu[name], atol=3e-6)


def test_16_bit_heights_are_not_rounded() -> None:
    """Neighbouring 16-bit codes, and a thousandth of the step between them, are distinguished."""
    codes = np.array([[40000, 40001]]) / 65535
    field = HeightField([codes], "clamp")
    low, high = (read(field, u, 0.5) for u in (0.25, 0.75))
    assert float(low) == np.float32(codes[0, 0])
    assert float(high) == np.float32(codes[0, 1])
    between = read(field, 0.25 + 0.5 * 0.3, 0.5)
    assert (between - low) / (high - low) == pytest.approx(0.3, abs=0.01)
