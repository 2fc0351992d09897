"""Reads of maps and buffers, within and beyond their edges.

Plain Python against the CPU, bit for bit, and against the padding of NumPy.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from basrelief.lang import Buffer, HeightField, IVec2, Texture, corners, stored, texel
from helpers.comparing import assert_python_is_cpu, compiled, write_module

SHADERS = """
@struct
class Place:
    x: int
    y: int
    level: int

@struct
class UvPlace:
    u: float
    v: float
    level: float

@struct
class Item:
    a: float
    i: int
    flag: bool
    v: Vec3

@struct
class Read:
    heights: Vec4
    colour: Vec4
    field_size: IVec2
    map_size: IVec2
    field_levels: int
    map_levels: int

@struct
class Listed:
    item: Item
    count: int

@shader
def read(
    pixel: IVec2, field: HeightField, map: Texture, places: Buffer[Place]
) -> Read:
    place = places[pixel.x]
    cell = IVec2(place.x, place.y)
    return Read(
        corners(field, cell, place.level), texel(map, cell, place.level),
        size(field, place.level), size(map, place.level), levels(field), levels(map),
    )

@shader
def read_at(pixel: IVec2, field: HeightField, map: Texture, uv_places: Buffer[UvPlace]) -> Read:
    place = uv_places[pixel.x]
    level = int(place.level)
    shape = size(field, level)
    cell = IVec2(int(place.u * float(shape.x) - 0.5), int(place.v * float(shape.y) - 0.5))
    return Read(corners(field, cell, level), texel(map, cell, level), shape, shape, 0, 0)

@shader
def heights_of(field: HeightField, x: int) -> Vec4:
    return corners(field, IVec2(x, 1), 0)

@struct
class Record:
    numbers: Vec4

@shader
def record(pixel: IVec2, map: Texture) -> Record:
    return Record(stored(map, pixel))

@shader
def in_branches(pixel: IVec2, field: HeightField, map: Texture, places: Buffer[Place]) -> Read:
    place = places[pixel.x]
    result = Vec4(0.0)
    if place.x > 0:
        result = heights_of(field, place.x)
        if place.level == 1:
            return Read(result, Vec4(1.0), IVec2(1), IVec2(2), 3, 4)
        result = result + texel(map, IVec2(place.y, place.x), 0)
    return Read(result, Vec4(0.0), IVec2(0), IVec2(0), 0, 0)

@shader
def listed(pixel: IVec2, items: Buffer[Item], places: Buffer[Place]) -> Listed:
    return Listed(items[places[pixel.x].x], len(items))

@shader
def summed(pixel: IVec2, items: Buffer[Item]) -> Listed:
    total = Vec3(0.0)
    count = 0
    for k in range(len(items)):
        item = items[k]
        if item.flag:
            total = total + item.v * item.a
            count = count + item.i
    return Listed(Item(total.x, count, count > 3, total), count)
"""

SIZES = [(1, 1), (1, 4), (5, 1), (2, 2), (4, 4), (3, 5), (7, 2), (13, 8)]
FAR = [-(2**31), -(2**24) - 1, -1000, -9, -3, -2, -1, 0, 1, 2, 3, 5, 8, 1000, 2**24 + 1, 2**31 - 1]


@pytest.fixture(scope="module")
def module(folder):
    return write_module(folder, SHADERS)


def mips(first):
    """Levels of a map down to one texel, with different values in each."""
    levels = [first]
    while max(levels[-1].shape[:2]) > 1:
        height, width = levels[-1].shape[:2]
        shape = (max(1, height // 2), max(1, width // 2))
        smaller = levels[-1][: shape[0], : shape[1]]
        levels.append((smaller * 0.75).astype(first.dtype))
    return levels


def maps(width, height, edge, *, all_levels=True):
    draw = np.random.default_rng(width * 100 + height)
    heights = draw.random((height, width)).astype(np.float32)
    colours = draw.integers(0, 65536, (height, width, 4)).astype(np.uint16)
    colours.flat[0], colours.flat[-1] = 0, 65535
    stop = None if all_levels else 1
    return HeightField(mips(heights)[:stop], edge), Texture(mips(colours)[:stop], edge)


def places_of(module, width, height):
    near = range(-2, max(width, height) + 3)
    cells = [*itertools.product(near, near), *itertools.product(FAR, FAR)]
    levels = [0, 1, 2, 3, 9, -1, 2**31 - 1, -(2**31)]
    return Buffer([module.Place(x, y, levels[n % len(levels)]) for n, (x, y) in enumerate(cells)])


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize(("width", "height"), SIZES)
def test_python_is_cpu(module, width, height, edge):
    field, map = maps(width, height, edge, all_levels=(width, height) != (13, 8))
    places = places_of(module, width, height)
    values = {"field": field, "map": map, "places": places}
    assert_python_is_cpu(module.read, (len(places), 1), values, edge=edge)


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_the_border_equals_the_padding_of_numpy(edge):
    field, map = maps(5, 3, edge)
    heights, colours = field.levels[0], map.levels[0]
    mode = "wrap" if edge == "wrap" else "edge"
    padded = np.pad(heights, 1, mode=mode)
    around = np.pad(colours, ((1, 1), (1, 1), (0, 0)), mode=mode)
    for y, x in itertools.product(range(-1, 3), range(-1, 5)):
        result = list(corners(field, IVec2(x, y), 0))
        # padding shifts indices by one
        assert result == [*padded[y + 1, x + 1 : x + 3], *padded[y + 2, x + 1 : x + 3]]
    for y, x in itertools.product(range(-1, 4), range(-1, 6)):
        result = list(texel(map, IVec2(x, y), 0))
        assert result == [np.float32(c) for c in around[y + 1, x + 1]]


def test_the_smallest_and_largest_16_bit_values():
    map = Texture([np.array([[[0, 65535, 1, 32768]]], np.uint16)])
    result = texel(map, IVec2(0, 0), 0)
    assert tuple(result) == (0.0, 65535.0, 1.0, 32768.0)
    assert tuple(stored(map, IVec2(0, 0))) == tuple(result)


def test_records_of_a_table(module):
    _, map = maps(7, 3, "wrap")
    assert_python_is_cpu(module.record, (7, 3), {"map": map})
    planes = compiled(module.record, (7, 3), {"map": map})
    for channel, name in enumerate("xyzw"):
        numbers = planes[f"numbers.{name}"].astype(np.uint32).view(np.float32)
        np.testing.assert_array_equal(numbers, map.levels[0][..., channel])


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_coordinates_that_are_not_finite(module, edge):
    """NaN, infinities and huge coordinates read texels of the map, never other memory."""
    numbers = [float("nan"), float("inf"), float("-inf"), 1e30, -1e30, 3e9, -3e9, 0.5, -0.25, 7.0]
    uv_places = Buffer([module.UvPlace(*row) for row in itertools.product(numbers, repeat=3)])
    field, map = maps(7, 3, edge)
    values = {"field": field, "map": map, "uv_places": uv_places}
    assert_python_is_cpu(module.read_at, (len(uv_places), 1), values, edge=edge)
    planes = compiled(module.read_at, (len(uv_places), 1), values, edge=edge)
    heights = planes["heights.x"].astype(np.uint32).view(np.float32)
    assert np.isin(heights, np.concatenate([level.ravel() for level in field.levels])).all()


def test_reads_in_branches(module):
    field, map = maps(3, 5, "wrap")
    draw = np.random.default_rng(1)
    places = Buffer([module.Place(*map_) for map_ in draw.integers(-3, 6, (53, 3)).tolist()])
    values = {"field": field, "map": map, "places": places}
    assert_python_is_cpu(module.in_branches, (53, 1), values, lanes=(4, 8, 16))


def items_of(module, count):
    draw = np.random.default_rng(count)
    return Buffer(
        [
            module.Item(float(draw.normal()), int(n), bool(n % 3), tuple(draw.normal(size=3)))
            for n in range(count)
        ],
        module.Item,
    )


@pytest.mark.parametrize("count", [0, 1, 2, 7])
def test_items_within_and_beyond(module, count):
    places = Buffer([module.Place(x, 0, 0) for x in FAR])
    values = {"items": items_of(module, count), "places": places}
    assert_python_is_cpu(module.listed, (len(FAR), 1), values)
    assert_python_is_cpu(module.summed, (3, 1), {"items": values["items"]})


def test_an_empty_buffer_needs_a_record_type():
    with pytest.raises(ValueError, match="record"):
        Buffer([])


def test_maps_of_the_wrong_kind_are_refused():
    with pytest.raises(ValueError, match="uint16"):
        Texture([np.zeros((2, 2, 4), np.uint8)])
    with pytest.raises(ValueError, match="uint16"):
        Texture([np.zeros((2, 2, 3), np.uint16)])
    with pytest.raises(ValueError, match="one level"):
        HeightField([])
