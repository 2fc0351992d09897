"""From a material's maps to what programs read: pyramids of heights and of 16-bit channels.

Colours become linear before they are averaged; levels are area averages of the one before, exact
for odd sizes too. A map is turned into a pyramid once while it lives. What is baked from heights is
baked by the engine that draws, and told apart by how that rounds.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief import baking
from basrelief.baking.levels import halved, levels_of
from basrelief.baking.tables import table
from basrelief.engine import Engine
from basrelief.images import srgb_decode
from basrelief.lang.resources import Edge, Filter, HeightField, Texture
from basrelief.material.material import Map, Material
from basrelief.techniques import Bake

_UNIT = 65535
_PLAIN_COLOR = 0.6
"""What stands for a missing colour, as in `shading.surfaces.standard.base_color_of`."""
_made: weakref.WeakKeyDictionary[Any, dict[Any, Any]] = weakref.WeakKeyDictionary()


def height_field(material: Material, edge: Edge, filter: Filter = "sharp") -> HeightField | None:
    """The material's heights, to be read in some way; None where it has none."""
    height = material.height
    if height is None:
        return None

    def make() -> HeightField:
        return HeightField(levels_of(height.linear()[:, :, 0]), edge)

    sharp: HeightField = _once(height, ("heights", edge, "sharp"), make)
    return _once(height, ("heights", edge, filter), lambda: sharp.filtered(filter))


def bake_texture(
    material: Material, edge: Edge, bake: Bake | None, engine: Engine, *, all_levels: bool = False
) -> Texture | None:
    """What a technique has baked from the heights, or from all their levels; None without any."""
    height = material.height
    if height is None or bake is None:
        return None

    def make() -> Texture:
        heights = height.linear()[:, :, 0]
        return Texture([table(bake, heights, edge, engine, all_levels=all_levels)], edge)

    return _once(height, ("baked", bake, edge, all_levels, engine.rounding), make)


def base_color(material: Material, edge: Edge) -> Texture | None:
    """Linear colour with opacity, None where the material has neither."""
    color, opacity = material.base_color, material.opacity
    if color is None and opacity is None:
        return None

    def make() -> Texture:
        shape = _largest(color, opacity)
        if color is None:
            channels = [np.full(shape, round(_PLAIN_COLOR * _UNIT), np.uint16)] * 3
        else:
            pixels = _fractions(color)
            channels = [_resized(pixels[:, :, k : k + 1], shape) for k in range(3)]
        alpha = None if opacity is None else _resized(_fractions(opacity), shape)
        return _texture([*channels, alpha], edge, cut_out=alpha is not None)

    return _once(material, ("base color", edge), make)


def normal(material: Material, edge: Edge, scale: float, engine: Engine) -> Texture | None:
    """Tangent-space normals; where there is no map those of the heights, at a relief's scale.

    Both are those of square texels. Of normals from heights only the latest are kept.
    """
    if material.normal is not None:
        held = material.normal
        return _once(held, ("normal", edge), lambda: _texture([*_channels(held)], edge))
    height = material.height
    if height is None or scale <= 0.0:
        return None
    latest = _made.setdefault(height, {})
    slopes = (edge, scale, engine.rounding)
    if latest.get("slopes") != slopes:
        heights = height.linear()[:, :, 0]
        latest["normal"] = _texture(_normals_of(heights, scale, edge, engine), edge)
        latest["slopes"] = slopes
    return latest["normal"]


def response(material: Material, edge: Edge) -> Texture | None:
    """Occlusion, roughness, metallic and the layer's mask in one texture, None without any."""
    maps = (material.occlusion, material.roughness, material.metallic, material.layer_mask)
    if all(each is None for each in maps):
        return None

    def make() -> Texture:
        shape = _largest(*maps)
        channels = []
        for one, missing in zip(maps, (1.0, 0.8, 0.0, 1.0), strict=True):
            if one is None:
                channels.append(np.full(shape, round(missing * _UNIT), np.uint16))
            else:
                channels.append(_resized(_fractions(one), shape))
        return _texture(channels, edge)

    return _once(material, ("response", edge), make)


def emission(material: Material, edge: Edge) -> Texture | None:
    """Emission as fractions of its `emission_scale`, None where there is none."""
    light = material.emission
    if light is None:
        return None

    def make() -> Texture:
        if light.pixels.dtype != np.float32:
            return _texture([*_channels(light)], edge)
        share = np.clip(light.pixels / emission_scale(material), 0.0, 1.0)
        return _texture([*_channels(Map(share, light.srgb, light.source))], edge)

    return _once(light, ("emission", edge), make)


def emission_scale(material: Material) -> float:
    """The emission that a texture's 1 stands for: of floats the largest value, else 1."""
    light = material.emission
    if light is None or light.pixels.dtype != np.float32:
        return 1.0
    return _once(light, "glow", lambda: max(float(light.pixels.max()), 1e-9))


@dataclass(frozen=True)
class TextureSource:
    """What a texture of the surface is made of: the material's maps that its channels hold.

    `light` says that these are light, not data; `of_heights` that heights stand for a missing map.
    """

    texture: Callable[[Material, Edge, float, Engine], Texture | None]
    channels: Mapping[str, tuple[int, ...]]
    light: bool = False
    of_heights: bool = False

    def has(self, material: Material, scale: float) -> bool:
        """Whether a material gives one, its relief of some scale; nothing is made to know that."""
        maps = (getattr(material, name) for name in self.channels)
        sloping = self.of_heights and material.height is not None and scale > 0.0
        return sloping or any(each is not None for each in maps)


MATERIAL_TEXTURES: dict[str, TextureSource] = {
    "base_color": TextureSource(
        lambda material, edge, *_: base_color(material, edge),
        {"base_color": (0, 1, 2), "opacity": (3,)},
        light=True,
    ),
    "normal": TextureSource(normal, {"normal": (0, 1, 2)}, of_heights=True),
    "response": TextureSource(
        lambda material, edge, *_: response(material, edge),
        {"occlusion": (0,), "roughness": (1,), "metallic": (2,), "layer_mask": (3,)},
    ),
    "emission": TextureSource(
        lambda material, edge, *_: emission(material, edge), {"emission": (0, 1, 2)}, light=True
    ),
}
"""The textures that a surface reads of its material (`shading.surfaces.surface.SurfaceMaps`)."""
LAYER_TEXTURES: dict[str, TextureSource] = {
    "layer_color": MATERIAL_TEXTURES["base_color"],
    "layer_normal": MATERIAL_TEXTURES["normal"],
}
"""Those that it reads of the material that lies over it."""


def _once(owner: Any, key: Any, make: Callable[[], Any]) -> Any:
    held = _made.setdefault(owner, {})
    if key not in held:
        held[key] = make()
    return held[key]


# --- pixels --------------------------------------------------------------------------------------


def _fractions(one: Map) -> NDArray[np.uint16]:
    """A map's pixels as linear 16-bit fractions of one."""
    pixels = one.pixels
    if pixels.dtype == np.float32:
        linear = np.clip(one.linear(), 0.0, 1.0)
        return np.rint(linear * np.float32(_UNIT)).astype(np.uint16)
    # integers by a table: no float copy of a large map
    count = 256 if pixels.dtype == np.uint8 else 65536
    codes = np.linspace(0.0, 1.0, count)
    table = srgb_decode(codes) if one.srgb else codes
    return np.rint(table * _UNIT).astype(np.uint16)[pixels]


def _largest(*maps: Map | None) -> tuple[int, int]:
    """Rows and columns of the map with the most texels."""
    shapes = [(m.height, m.width) for m in maps if m is not None]
    return max(shapes, key=lambda shape: shape[0] * shape[1])


def _channels(one: Map) -> NDArray[np.uint16]:
    """The same, channels first."""
    return _fractions(one).transpose(2, 0, 1)


def _resized(pixels: NDArray[np.uint16], shape: tuple[int, int]) -> NDArray[np.uint16]:
    """One channel at another size, bilinear and seamless at the edges."""
    one = pixels[:, :, 0]
    for axis, wanted in enumerate(shape):
        have = one.shape[axis]
        if have == wanted:
            continue
        place = (np.arange(wanted) + 0.5) * have / wanted - 0.5
        first = np.floor(place).astype(int)
        share = (place - first).reshape((-1, 1) if axis == 0 else (1, -1))
        a, b = (np.take(one, (first + k) % have, axis) for k in (0, 1))
        one = np.rint(a * (1.0 - share) + b * share).astype(np.uint16)
    return one


def _texture(channels: list[Any], edge: Edge, *, cut_out: bool = False) -> Texture:
    """A pyramid of four channels; a missing last one is all ones, of a cut-out it is opacity."""
    height, width = channels[0].shape
    first = np.full((height, width, 4), _UNIT, np.uint16)
    for index, channel in enumerate(channels):
        if channel is not None:
            first[:, :, index] = channel
    levels = [first]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(_next_level(levels[-1], cut_out=cut_out))
    return Texture(levels, edge)


def _next_level(level: NDArray[np.uint16], *, cut_out: bool) -> NDArray[np.uint16]:
    """The next level; of a cut-out, colours count as much as they are opaque."""
    if not cut_out:
        return np.rint(halved(level)).astype(np.uint16)
    # a little weight for all, so that what is wholly see-through keeps its own colour
    weight = level[:, :, 3:].astype(np.float32) + 1.0
    color = halved(level[:, :, :3] * weight) / halved(weight)
    return np.rint(np.concatenate([color, halved(level[:, :, 3:])], 2)).astype(np.uint16)


def _normals_of(
    heights: NDArray[np.float32], scale: float, edge: Edge, engine: Engine
) -> list[Any]:
    """Encoded normals of a height field, channels first."""
    made = baking.normal_map(heights, edge, scale, engine)
    return [np.rint((made[:, :, k] * 0.5 + 0.5) * _UNIT).astype(np.uint16) for k in range(3)]
