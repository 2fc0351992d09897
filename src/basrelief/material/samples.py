"""Procedural samples: seamless materials with all their maps, drawn from a seed.

The same name, size and seed give the same maps on one machine. Between machines, codes may differ
by one, since elementary functions are rounded differently.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError, suggestion
from basrelief.material.material import Map, Material, Note
from basrelief.material.opening import hole
from basrelief.material.patterns import PATTERNS, Canvas, Relief
from basrelief.material.patterns.canvas import to_unit

SAMPLES = (*PATTERNS, "hole")
"""Names of the procedural samples."""

OPENING = 0.6
"""Opening of the sample `hole`, 0 to 1."""

_SIDE = 512
"""Default side of a sample, in texels."""
LARGEST = 16384
"""Largest side of a sample, in texels."""


def sample(name: str, size: int | tuple[int, int] = _SIDE, seed: int = 0) -> Material:
    """Draw a procedural material.

    It has base colour, normal, height, occlusion and roughness maps, some also metallic or opacity.
    All maps repeat without a seam. Heights and normals have 16 bits. `depth` and `tile` are set,
    and the normals match the resulting `scale`.

    Parameters
    ----------
    name : str
        One of `basrelief.material.SAMPLES`, such as "bricks", "cobbles" or "terrain".
    size : int or (int, int), default 512
        Side of a square, or (height, width), in texels, 1 to 16384. A larger size shows the same
        pattern in finer detail.
    seed : int, default 0
        Seed of the random numbers, 0 or above.

    Returns
    -------
    Material

    Raises
    ------
    InputError
        For an unknown name, and for a size or a seed out of range.
    """
    if name not in SAMPLES:
        raise InputError(
            f"there is no sample {name!r}; {suggestion(name, SAMPLES, 'choose one of')}"
        )
    height, width = (size, size) if isinstance(size, int) else size
    if not (1 <= height <= LARGEST and 1 <= width <= LARGEST):
        raise InputError(f"sample {name}: a side has 1 to {LARGEST} texels, not {height}×{width}")
    if seed < 0:
        raise InputError(f"sample {name}: a seed is a whole number from 0, not {seed}")
    options: dict[str, Any] = {"size": size} if (height, width) != (_SIDE, _SIDE) else {}
    options |= {"seed": seed} if seed else {}
    if name == "hole":
        cracks, dust = (sample(part, (height, width), seed) for part in ("cracks", "dust"))
        material = replace(hole(cracks, dust, OPENING), name=name)
    else:
        material = _material(name, seed, PATTERNS[name](Canvas(height, width, seed)))
    return material.with_origin(f"sample:{name}", options)


def _material(name: str, seed: int, relief: Relief) -> Material:
    heights = to_unit(relief.height)
    scale = relief.depth / relief.tile

    def map_of(kind: str, values: NDArray[Any], bits: int = 8, srgb: bool = False) -> Map:
        return Map(_codes(values, bits), srgb, f"sample {name}, {kind}")

    def plane_of(kind: str, values: NDArray[Any] | None, bits: int = 8) -> Map | None:
        return None if values is None else map_of(kind, values[:, :, None], bits)

    material = Material(
        name,
        base_color=map_of("base colour", relief.color, srgb=True),
        normal=map_of("normal", normals(heights, scale) * 0.5 + 0.5, bits=16),
        opacity=plane_of("opacity", relief.opacity),
        tile=relief.tile,
        notes=(Note(f"procedural sample {name}", f"drawn from seed {seed}"),),
    )
    if relief.detail:
        return material
    return replace(
        material,
        height=plane_of("height", heights, bits=16),
        occlusion=plane_of("occlusion", occlusion(heights, scale)),
        roughness=plane_of("roughness", relief.roughness),
        metallic=plane_of("metallic", relief.metallic),
        depth=relief.depth,
    )


def normals(heights: NDArray[np.floating], scale: float) -> NDArray[np.float32]:
    """Unit normals (h, w, 3), x right, y up in the picture, of periodic heights (h, w) in 0…1.

    By central differences; `scale` is the height range as a fraction of the picture's width.
    """
    per_texel = heights * (scale * heights.shape[1] / 2)
    rise_right = np.roll(per_texel, -1, axis=1) - np.roll(per_texel, 1, axis=1)
    rise_up = np.roll(per_texel, 1, axis=0) - np.roll(per_texel, -1, axis=0)
    length = np.sqrt(rise_right * rise_right + rise_up * rise_up + 1)
    return np.stack([-rise_right / length, -rise_up / length, 1 / length], 2).astype(np.float32)


def occlusion(heights: NDArray[np.floating], scale: float) -> NDArray[np.float32]:
    """Approximate ambient occlusion, 1 unoccluded, (h, w), of periodic heights (h, w) in 0…1.

    Not ray-traced: at four radii, the mean height around a texel less its own, divided by the
    radius, gives the slope of the surroundings above it.
    """
    width = heights.shape[1]
    spectrum = np.fft.rfft2(heights)
    along_y = np.fft.fftfreq(heights.shape[0])[:, None] ** 2
    along_x = np.fft.rfftfreq(width)[None, :] ** 2
    occluded = np.zeros_like(heights, dtype=np.float64)
    for radius in (1 / 256, 1 / 128, 1 / 64, 1 / 32):
        if radius * width < 0.75:  # finer than a texel: the blur would ring
            continue
        blur = np.exp(-2 * (np.pi * radius * width) ** 2 * (along_x + along_y))
        mean = np.fft.irfft2(spectrum * blur, s=heights.shape)
        occluded += np.maximum(mean - heights, 0) * scale / radius
    return (1 / (1 + 0.6 * occluded)).astype(np.float32)


def _codes(values: NDArray[Any], bits: int) -> NDArray[Any]:
    max_code = 2**bits - 1
    codes: NDArray[Any] = np.rint(np.clip(values, 0, 1) * max_code)
    return codes.astype(np.uint8 if bits == 8 else np.uint16)
