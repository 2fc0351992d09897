"""The view ray within the height map, and where it ends: what every technique takes and gives."""

from __future__ import annotations

from basrelief.lang import Vec2, shader, struct


@struct
class Ray:
    """The view ray in the texture space of the height map.

    `uv` is where it meets the polygon, at height `level`. While it falls through the whole range
    of heights, from 1 to 0, its texture coordinates move by `fall`. `cosine` is V · N, 1 head-on
    and 0 along the surface; `scale` is the range of heights in tile widths. `lod` and `fade` say
    how smooth the heights are read (`techniques.height`), where they are read smooth.
    """

    uv: Vec2
    fall: Vec2
    level: float
    cosine: float
    scale: float = 1.0
    lod: float = 0.0
    fade: float = 0.0


@struct
class Hit:
    """Where a technique says that the ray ends.

    `uv` are the displaced texture coordinates, `height` (0 to 1) that of the ray there, which
    gives the depth; `found` whether the surface was met and not merely run out of steps; `reads`
    how many times a height was read.
    """

    uv: Vec2
    height: float
    found: bool
    reads: int


@shader
def at(ray: Ray, height: float) -> Vec2:
    """The texture coordinates of the ray at a height."""
    return ray.uv + ray.fall * (ray.level - height)
