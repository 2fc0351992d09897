"""What lies beyond a map: the same again, or its border going on.

Texture coordinates are taken into one tile before a map is read; the texels beside the tile's own
come from the border that each map has (`lang.resources`).
"""

from __future__ import annotations

from basrelief.lang import Vec2, fract, saturate, shader, slot


@slot
def in_tile(uv: Vec2) -> Vec2:
    """Texture coordinates within the one tile that the maps hold, 0 to 1."""


@shader
def wrap(uv: Vec2) -> Vec2:
    """The tile repeats for ever."""
    return fract(uv)


@shader
def clamp(uv: Vec2) -> Vec2:
    """The border goes on for ever."""
    return saturate(uv)
