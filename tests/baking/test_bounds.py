"""Bounds of `exact`: no height lies above a record, at any size, bit depth and edge."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from basrelief import baking
from basrelief.baking.levels import levels_of
from basrelief.engine import choose_device
from basrelief.techniques.exact_records import (
    BLOCK,
    FAR,
    FAR_2,
    FAR_3,
    FAR_4,
    FAR_BLOCK,
    MAX_HEADROOM,
    MAX_SLOPE,
    MIN_HEADROOM,
    PLANE,
    WINDOW,
)

SIZES = st.integers(1, 23)


def heights_of(rows: int, columns: int, levels: int, seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    return (random.integers(0, levels + 1, (rows, columns)) / levels).astype(np.float32)


def ahead(heights: np.ndarray, edge: str, block: tuple[int, int], side: int, cells: int, back):
    """Heights in the window of a block, (v, u), from its back corner on."""
    places = []
    for number, count, reversed_ in zip(block, heights.shape, back, strict=True):
        steps = np.arange(cells + 1)
        along = (number + 1) * side - steps if reversed_ else number * side + steps
        places.append(along % count if edge == "wrap" else np.clip(along, 0, count - 1))
    return heights[np.ix_(*places)]


def split_records(table: np.ndarray, shape: tuple[int, int]):
    """Near and far records by quadrant: (v backwards, u backwards) → (rows, columns, 4)."""
    records = []
    top = 0
    for side in (BLOCK, FAR_BLOCK):
        rows, columns = (-(-n // side) for n in shape)
        records.append(
            {
                (v, u): table[
                    top + v * rows : top + (v + 1) * rows, u * columns : (u + 1) * columns
                ]
                for v in (0, 1)
                for u in (0, 1)
            }
        )
        top += 2 * rows
    assert table.shape[0] == top
    return records


def assert_near_is_safe(rows, columns, edge, levels, seed, device="cpu") -> None:
    """Check that no height ahead of a block is above its plane or its window."""
    heights = heights_of(rows, columns, levels, seed)
    near, _ = split_records(baking.bounds(heights, edge, device), heights.shape)
    for back, records in near.items():
        block = tuple(np.random.default_rng(seed).integers(0, records.shape[:2]))
        headroom, *codes, window = records[block].astype(np.float32) / np.float32(65535)
        highest = ahead(heights, edge, block, BLOCK, WINDOW, back).max()
        assert 1.0 - window - 4 / 65535 <= highest <= 1.0 - window
        below = ahead(heights, edge, block, BLOCK, PLANE, back).astype(float)
        slope_u, slope_v = ((float(code) * 2 - 1) * MAX_SLOPE for code in codes)
        away = np.arange(PLANE + 1)
        corner = 1.0 - (MIN_HEADROOM + float(headroom) * (MAX_HEADROOM - MIN_HEADROOM))
        plane = corner + slope_u * away[None, :] + slope_v * away[:, None]
        assert (below <= plane).all()
        # and the plane is tight
        assert (plane - below).min() < 0.003


def assert_far_is_safe(rows, columns, edge, levels, seed, device="cpu") -> None:
    """Check that no height ahead of a block is above its windows."""
    heights = heights_of(rows, columns, levels, seed) * np.float32(0.7)
    _, far = split_records(baking.bounds(heights, edge, device), heights.shape)
    for back, records in far.items():
        block = tuple(np.random.default_rng(seed).integers(0, records.shape[:2]))
        for blocks, code in zip((FAR, FAR_2, FAR_3, FAR_4), records[block], strict=True):
            cells = blocks * FAR_BLOCK
            highest = ahead(heights, edge, block, FAR_BLOCK, cells, back).max()
            headroom = code / np.float32(65535)
            assert 1.0 - headroom - 4 / 65535 <= highest <= 1.0 - headroom


@settings(max_examples=40)
@given(
    SIZES, SIZES, st.sampled_from(["wrap", "clamp"]), st.sampled_from([1, 4, 255, 65535]),
    st.integers(0, 10_000),
)  # fmt: skip
def test_near_records_are_on_the_safe_side(rows, columns, edge, levels, seed) -> None:
    assert_near_is_safe(rows, columns, edge, levels, seed)


@settings(max_examples=40)
@given(
    SIZES, SIZES, st.sampled_from(["wrap", "clamp"]), st.sampled_from([1, 255, 65535]),
    st.integers(0, 10_000),
)  # fmt: skip
def test_far_records_are_on_the_safe_side(rows, columns, edge, levels, seed) -> None:
    assert_far_is_safe(rows, columns, edge, levels, seed)


@pytest.mark.gpu
@settings(max_examples=40)
@given(
    SIZES, SIZES, st.sampled_from(["wrap", "clamp"]), st.sampled_from([1, 4, 255, 65535]),
    st.integers(0, 10_000),
)  # fmt: skip
@example(1, 1, "wrap", 65535, 3)
@example(1, 23, "wrap", 65535, 3)
@example(19, 1, "clamp", 65535, 3)
def test_records_are_on_the_safe_side_on_a_gpu(rows, columns, edge, levels, seed) -> None:
    gpu = choose_device("gpu")
    assert_near_is_safe(rows, columns, edge, levels, seed, gpu)
    assert_far_is_safe(rows, columns, edge, levels, seed, gpu)


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
@pytest.mark.parametrize("shape", [(37, 53), (1, 40), (16, 9)])
def test_the_table_of_all_levels_contains_that_of_each(shape, device) -> None:
    """One below the other."""
    heights = heights_of(*shape, 65535, 4)
    whole = baking.bounds(heights, "wrap", device, all_levels=True)
    row = 0
    for level in levels_of(heights):
        expected = baking.bounds(level, "wrap", device)
        part = whole[row : row + len(expected)]
        np.testing.assert_array_equal(part[:, : expected.shape[1]], expected)
        assert not part[:, expected.shape[1] :].any()
        row += len(expected)
    assert row == len(whole)


def test_a_plane_is_its_own_bound() -> None:
    """The records of a ramp have its slope, in each quadrant."""
    heights = np.broadcast_to(np.linspace(0.2, 0.8, 33, dtype=np.float32), (16, 33)).copy()
    near, _ = split_records(baking.bounds(heights, "clamp"), heights.shape)
    for (_, u), records in near.items():
        inner = records[2:-3, 3:-4].astype(float)
        slope = (inner[..., 1] / 65535 * 2 - 1) * MAX_SLOPE
        np.testing.assert_allclose(slope, (-1 if u else 1) * 0.6 / 32, atol=1e-5)
        np.testing.assert_allclose((inner[..., 2] / 65535 * 2 - 1) * MAX_SLOPE, 0.0, atol=1e-5)


def test_a_map_of_height_0_has_the_largest_headroom() -> None:
    table = baking.bounds(np.zeros((5, 7), np.float32), "wrap")
    near, far = split_records(table, (5, 7))
    for records in near.values():
        assert (records[..., 3] >= 65534).all()
    for records in far.values():
        assert (records >= 65534).all()


@pytest.mark.gpu
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_engines_bake_equal_tables(edge) -> None:
    """Up to one code, as engines may round to neighbouring codes, both of them safe."""
    heights = heights_of(37, 53, 65535, 1)
    cpu, gpu = (baking.bounds(heights, edge, choose_device(name)) for name in ("cpu", "gpu"))
    np.testing.assert_allclose(cpu.astype(int), gpu.astype(int), atol=1)
