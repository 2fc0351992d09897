"""Textures of materials: mip pyramids of heights and of 16-bit channels.

Colours are linear before they are averaged. Each mip level is the area average of the level before,
exact for odd sizes too. Textures are cached as long as their maps exist. Bakes run on the engine
that draws, and are cached by its rounding.
"""

from __future__ import annotations

import functools
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
from basrelief.images import look_up, srgb_decode
from basrelief.images.resize import resized
from basrelief.lang.resources import Edge, Filter, HeightField, Texture
from basrelief.material.material import Map, Material
from basrelief.techniques import Bake
from basrelief.threads import map_on_threads

_UNIT = 65535
"""The 16-bit code of 1."""
_DEFAULT_COLOR = 0.6
"""Default for a missing colour, as in `shading.surfaces.standard.base_color_of`."""
_cache: weakref.WeakKeyDictionary[Any, dict[Any, Any]] = weakref.WeakKeyDictionary()


def make_textures(
    material: Material, makers: Mapping[str, Callable[[], Texture | HeightField | None]]
) -> dict[str, Texture | HeightField]:
    """The textures that functions make, without missing ones; a material's first are made on two
    threads. The functions run no programs."""
    is_new = material not in _cache
    _cache.setdefault(material, {})
    if is_new:
        # more at once would take more memory than drawing does
        textures = [*map_on_threads(lambda make: make(), makers.values(), 2)]
    else:
        textures = [make() for make in makers.values()]
    named = zip(makers, textures, strict=True)
    return {name: texture for name, texture in named if texture is not None}


def height_field(material: Material, edge: Edge, filter: Filter = "sharp") -> HeightField | None:
    """The material's height field, read with a filter; None without heights."""
    height = material.height
    if height is None:
        return None

    def make() -> HeightField:
        return HeightField(levels_of(height.linear()[:, :, 0]), edge)

    sharp: HeightField = _cached(height, ("heights", edge, "sharp"), make)
    return _cached(height, ("heights", edge, filter), lambda: sharp.with_filter(filter))


def bake_texture(
    material: Material, edge: Edge, bake: Bake | None, engine: Engine, *, all_levels: bool = False
) -> Texture | None:
    """Texture of the table that a bake makes from the heights, or from all their mip levels.

    None without heights or without a bake.
    """
    height = material.height
    if height is None or bake is None:
        return None

    def make() -> Texture:
        heights = height.linear()[:, :, 0]
        return Texture([table(bake, heights, edge, engine, all_levels=all_levels)], edge)

    return _cached(height, ("baked", bake, edge, all_levels, engine.rounding), make)


def base_color(material: Material, edge: Edge) -> Texture | None:
    """Linear colour with opacity; None if the material has neither."""
    color, opacity = material.base_color, material.opacity
    if color is None and opacity is None:
        return None

    def make() -> Texture:
        shape = _largest(color, opacity)
        if color is None:
            channels = [np.full(shape, round(_DEFAULT_COLOR * _UNIT), np.uint16)] * 3
        else:
            pixels = _fractions(color)
            channels = [resized(pixels[:, :, k], shape) for k in range(3)]
        alpha = None if opacity is None else resized(_fractions(opacity)[:, :, 0], shape)
        return _texture([*channels, alpha], edge, cut_out=alpha is not None)

    return _cached(material, ("base color", edge), make)


def normal(material: Material, edge: Edge, scale: float, engine: Engine) -> Texture | None:
    """Tangent-space normals, from the normal map, or from the heights at a relief's scale.

    Both are normals of square texels. Normals from heights are cached for the latest scale only.
    """
    if material.normal is not None:
        normal_map = material.normal
        return _cached(
            normal_map, ("normal", edge), lambda: _texture([*_channels(normal_map)], edge)
        )
    height = material.height
    if height is None or scale <= 0.0:
        return None
    cache = _cache.setdefault(height, {})
    parameters = (edge, scale, engine.rounding)
    cached_parameters, texture = cache.get("normal", (None, None))
    if cached_parameters != parameters:
        texture = _texture(_normals_of(height.linear()[:, :, 0], scale, edge, engine), edge)
        cache["normal"] = parameters, texture
    return texture


def response(material: Material, edge: Edge) -> Texture | None:
    """Occlusion, roughness, metallic and layer mask in one texture; None without any of them."""
    maps = (material.occlusion, material.roughness, material.metallic, material.layer_mask)
    if all(map is None for map in maps):
        return None

    def make() -> Texture:
        shape = _largest(*maps)
        channels = []
        for map, default in zip(maps, (1.0, 0.8, 0.0, 1.0), strict=True):
            if map is None:
                channels.append(np.full(shape, round(default * _UNIT), np.uint16))
            else:
                channels.append(resized(_fractions(map)[:, :, 0], shape))
        return _texture(channels, edge)

    return _cached(material, ("response", edge), make)


def emission(material: Material, edge: Edge) -> Texture | None:
    """Emission as fractions of its `emission_scale`; None without an emission map."""
    emission_map = material.emission
    if emission_map is None:
        return None

    def make() -> Texture:
        if emission_map.pixels.dtype != np.float32:
            return _texture([*_channels(emission_map)], edge)
        fractions = np.clip(emission_map.pixels / emission_scale(material), 0.0, 1.0)
        return _texture([*_channels(Map(fractions, emission_map.srgb, emission_map.source))], edge)

    return _cached(emission_map, ("emission", edge), make)


def emission_scale(material: Material) -> float:
    """The emission that a texel of 1 represents: the largest value of a float map, otherwise 1."""
    emission_map = material.emission
    if emission_map is None or emission_map.pixels.dtype != np.float32:
        return 1.0
    return _cached(
        emission_map, "emission scale", lambda: max(float(emission_map.pixels.max()), 1e-9)
    )


@dataclass(frozen=True)
class TextureSource:
    """A surface texture: its constructor, and the channels that hold each of the material's maps.

    `light` tells whether the texture holds colours or light, not data; `of_heights` whether it can
    be computed from heights where its map is missing.
    """

    texture: Callable[[Material, Edge, float, Engine], Texture | None]
    channels: Mapping[str, tuple[int, ...]]
    light: bool = False
    of_heights: bool = False

    def has(self, material: Material, scale: float) -> bool:
        """Whether a material has the texture, at a scale of its relief; nothing is baked."""
        maps = (getattr(material, name) for name in self.channels)
        from_heights = self.of_heights and material.height is not None and scale > 0.0
        return from_heights or any(map is not None for map in maps)


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
        lambda material, edge, *_: emission(material, edge),
        {"emission": (0, 1, 2)},
        light=True,
    ),
}
"""Textures that a surface reads of its material (`shading.maps.SurfaceMaps`)."""
LAYER_TEXTURES: dict[str, TextureSource] = {
    "layer_color": MATERIAL_TEXTURES["base_color"],
    "layer_normal": MATERIAL_TEXTURES["normal"],
}
"""Textures that a surface reads of its second layer."""


def _cached(owner: Any, key: Any, make: Callable[[], Any]) -> Any:
    cached = _cache.setdefault(owner, {})
    if key not in cached:
        cached[key] = make()
    return cached[key]


# --- pixels --------------------------------------------------------------------------------------


def _fractions(map: Map) -> NDArray[np.uint16]:
    """A map's pixels as linear 16-bit fractions of 1."""
    pixels = map.pixels
    if pixels.dtype == np.float32:
        linear = np.clip(map.linear(), 0.0, 1.0)
        return np.rint(linear * np.float32(_UNIT)).astype(np.uint16)
    is_byte = pixels.dtype == np.uint8
    if not map.srgb:
        return pixels * np.uint16(257) if is_byte else pixels
    # by a table, to avoid a float copy of a large map
    codes = np.linspace(0.0, 1.0, 256 if is_byte else 65536)
    return look_up(np.rint(srgb_decode(codes) * _UNIT).astype(np.uint16), pixels)


def _largest(*maps: Map | None) -> tuple[int, int]:
    """Rows and columns of the map with the most texels."""
    shapes = [(m.height, m.width) for m in maps if m is not None]
    return max(shapes, key=lambda shape: shape[0] * shape[1])


def _channels(map: Map) -> NDArray[np.uint16]:
    """Linear 16-bit fractions of a map, channels first."""
    return _fractions(map).transpose(2, 0, 1)


def _texture(channels: list[Any], edge: Edge, *, cut_out: bool = False) -> Texture:
    """A texture with mip levels, from up to four channels; missing ones are 1.

    With `cut_out` the fourth channel is opacity, by which the colours are weighted.
    """

    def fill(first: NDArray[np.uint16]) -> None:
        first[:] = _UNIT
        for index, channel in enumerate(channels):
            if channel is not None:
                first[:, :, index] = channel

    halved = functools.partial(_next_level, cut_out=cut_out)
    return Texture.with_mips(channels[0].shape, edge, fill, halved)


def _next_level(level: NDArray[np.uint16], *, cut_out: bool) -> NDArray[np.uint16]:
    """The next mip level; colours of a cut-out are weighted by opacity."""
    if not cut_out:
        return np.rint(halved(level)).astype(np.uint16)
    # every texel has some weight, so that fully transparent areas keep their colour
    weight = level[:, :, 3:].astype(np.float32) + 1.0
    color = halved(level[:, :, :3] * weight) / halved(weight)
    return np.rint(np.concatenate([color, halved(level[:, :, 3:])], 2)).astype(np.uint16)


def _normals_of(
    heights: NDArray[np.float32], scale: float, edge: Edge, engine: Engine
) -> list[Any]:
    """Encoded normals of a height field, channels first."""
    normals = baking.normal_map(heights, edge, scale, engine)
    return [np.rint((normals[:, :, k] * 0.5 + 0.5) * _UNIT).astype(np.uint16) for k in range(3)]
