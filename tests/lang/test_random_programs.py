"""Random programs: plain Python and the CPU compute the same, for any number of lanes.

The environment variable RANDOM_PROGRAMS, `first:count`, replaces the default seeds.
"""

from __future__ import annotations

import os

import numpy as np
import pytest

from basrelief.lang import Buffer
from helpers.comparing import FLOATS, INTS, assert_python_is_cpu, write_module
from helpers.random_programs import Writer

WIDTHS = (1, 3, 7, 13)


def seeds() -> range:
    first, _, count = os.environ.get("RANDOM_PROGRAMS", "0:16").partition(":")
    return range(int(first), int(first) + int(count))


def items_of(module, seed: int, count: int) -> Buffer:
    draw = np.random.default_rng(seed)
    rows = []
    for _ in range(count):
        a, b = (
            float(draw.choice(FLOATS)) if draw.random() < 0.3 else float(draw.normal(0, 3))
            for _ in range(2)
        )
        i, j = (
            int(draw.choice(INTS)) if draw.random() < 0.3 else int(draw.integers(-4, 9))
            for _ in range(2)
        )
        rows.append(module.Input(a, b, i, j, bool(draw.random() < 0.5)))
    return Buffer(rows)


@pytest.mark.parametrize("seed", seeds())
def test_python_is_cpu(folder, seed):
    module = write_module(folder, Writer(seed).program())
    items = items_of(module, seed, 40)
    lanes = (4, 8, 16)[seed % 3]
    for width in (WIDTHS[seed % len(WIDTHS)], 37):
        assert_python_is_cpu(module.entry, (width, 1), {"items": items}, lanes=[lanes])


@pytest.mark.parametrize("seed", [1001, 1002])
def test_all_lane_counts_and_a_wide_picture(folder, seed):
    module = write_module(folder, Writer(seed, size=5).program())
    items = items_of(module, seed, 1003)
    assert_python_is_cpu(module.entry, (1003, 1), {"items": items}, lanes=(4, 8, 16))
