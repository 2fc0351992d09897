"""Materials from integer arithmetic: the same bytes with every processor, Python and NumPy.

They use no elementary functions, no linear algebra and no random generator of NumPy.
"""

from __future__ import annotations

import functools
import hashlib

import numpy as np
from numpy.typing import NDArray

from basrelief import Map, Material

COLUMNS, ROWS = 45, 30
"""Size of the heights: not square, one side odd, no powers of two."""


def random_bytes(name: str, *shape: int) -> NDArray[np.int64]:
    """Reproducible numbers from 0 to 255 for a name and a shape."""
    stream = hashlib.shake_128(name.encode()).digest(int(np.prod(shape)))
    return np.frombuffer(stream, np.uint8).astype(np.int64).reshape(shape)


def value_noise(name: str, rows: int, columns: int, cell: int, largest: int) -> NDArray[np.int64]:
    """Periodic value noise from 0 to `largest`: `cell` texels from one random number to the next.

    Bilinear, in integers; `cell` divides both sides.
    """
    values = random_bytes(name, rows // cell, columns // cell)
    for axis in (0, 1):
        near = np.repeat(values, cell, axis)
        far = np.repeat(np.roll(values, -1, axis), cell, axis)
        share = np.arange(near.shape[axis]).reshape((-1, 1) if axis == 0 else (1, -1)) % cell
        values = near * (cell - share) + far * share
    return values * largest // (255 * cell * cell)


def heights() -> NDArray[np.int64]:
    """Hills with a terrace and a pit, 0 to 65535: slopes, walls, flat ground."""
    rough = 3 * value_noise("hills", ROWS, COLUMNS, 5, 65535) + value_noise(
        "bumps", ROWS, COLUMNS, 1, 65535
    )
    made = rough // 4
    made[4:12, 6:19] = 47000
    made[17:25, 26:37] = 3000
    return made


@functools.cache
def towers() -> Map:
    """Heights of a wide plain with a few towers, for long rays without a hit."""
    rows, columns, cell = 200, 300, 10
    plain = value_noise("plain", rows, columns, 4, 9000)
    built = random_bytes("towers", rows // cell, columns // cell) > 240
    return map_of(plain + 50000 * built.repeat(cell, 0).repeat(cell, 1), 16)


def normals() -> NDArray[np.int64]:
    """Codes of normals that lean by up to about 35°, 0 to 65535, (rows, columns, 3)."""
    x, y = (value_noise(name, ROWS, COLUMNS, 5, 30000) + 17768 for name in ("east", "north"))
    return np.stack([x, y, np.full_like(x, 60000)], 2)


def colors(name: str, rows: int, columns: int) -> NDArray[np.int64]:
    """Random colours, 20 to 235, (rows, columns, 3)."""
    return 20 + random_bytes(name, rows, columns, 3) * 215 // 255


def map_of(codes: NDArray[np.int64], bits: int = 8, *, srgb: bool = False) -> Map:
    """A map of codes, (rows, columns) or (rows, columns, channels)."""
    pixels = codes.astype(f"uint{bits}")
    return Map(pixels if pixels.ndim == 3 else pixels[:, :, None], srgb, "integer arithmetic")


@functools.cache
def material() -> Material:
    """Every map but opacity and emission, of three sizes."""
    return Material(
        "exact",
        base_color=map_of(colors("base color", 20, 30), srgb=True),
        normal=map_of(normals(), 16),
        height=map_of(heights(), 16),
        occlusion=map_of(128 + value_noise("occlusion", 20, 30, 5, 127)),
        roughness=map_of(40 + value_noise("roughness", 30, 45, 5, 215)),
        metallic=map_of(value_noise("metallic", 10, 15, 5, 255)),
        layer_mask=map_of(value_noise("mask", 20, 30, 5, 255)),
        depth=0.13,
        tile=1.0,
    )


@functools.cache
def opacity() -> Map:
    """Holes and opaque areas with soft transitions."""
    return map_of(np.clip(4 * value_noise("opacity", 20, 30, 5, 255) - 220, 0, 255))


@functools.cache
def emission() -> Map:
    """Radiance up to 0.4375, in sixteenths, which floats hold exactly."""
    codes = random_bytes("emission", 10, 15, 3)
    return Map((codes // 32).astype(np.float32) / np.float32(16.0), False, "integer arithmetic")


@functools.cache
def layer_material() -> Material:
    """Colours, normals and heights of a second layer."""
    return Material(
        "layer",
        base_color=map_of(colors("layer color", 12, 18), srgb=True),
        normal=map_of(normals()[::2, ::2] // 257),
        height=map_of(value_noise("layer height", 20, 30, 2, 255)),
    )


def single_texels() -> dict[str, Map]:
    """Maps of one texel."""
    return {
        "base_color": map_of(colors("one color", 1, 1)),
        "normal": map_of(np.full((1, 1, 3), 200)),
        "height": map_of(np.full((1, 1), 77)),
        "occlusion": map_of(np.full((1, 1), 180)),
        "roughness": map_of(np.full((1, 1), 90)),
        "metallic": map_of(np.full((1, 1), 30)),
        "layer_mask": map_of(np.full((1, 1), 140)),
    }
