"""The view ray within the height map, and where it ends: what every technique takes and gives."""

from __future__ import annotations

from basrelief.lang import Vec2, shader, struct

SLOWEST = 1e-9
"""The least drop that is divided by."""


@struct
class Ray:
    """A segment of the view ray in the texture space of the height map; t runs along it, 0 to 1.

    It begins at texture coordinates `uv`, at `height`. By its end it has moved by `travel` and lost
    `drop` of height, less than nothing where it rises; in the middle it hangs lower than a straight
    line by a quarter of `bend`. Over a flat surface one straight segment is the whole ray, from
    height 1 to height 0.

    `cosine` is V · N, 1 head-on and 0 along the surface. `reference_height` is that of the
    polygon; `scale` the range of heights in tile widths; `share` the segment's part of the whole
    ray, by which steps are divided among segments. `lod` and `fade` say how smooth the heights
    are read (`techniques.height`), where they are read smooth.
    """

    uv: Vec2
    travel: Vec2
    height: float
    drop: float
    cosine: float
    bend: float = 0.0
    share: float = 1.0
    reference_height: float = 1.0
    scale: float = 1.0
    lod: float = 0.0
    fade: float = 0.0


@struct
class Hit:
    """Where a technique says that the ray ends.

    `uv` are the displaced texture coordinates; `height` (0 to 1) that of the ray there; `t` how far
    along the segment that is, which gives the depth. `found` says whether the surface was met: if
    not, the ray goes on where `t` is 1, and ran out of steps where `t` is less. `reads` counts how
    many times a height was read.
    """

    uv: Vec2
    height: float
    t: float
    found: bool
    reads: int


@shader
def at(ray: Ray, t: float) -> Vec2:
    """The texture coordinates of the ray at t."""
    return ray.uv + ray.travel * t


@shader
def height_at(ray: Ray, t: float) -> float:
    """The height of the ray at t."""
    return ray.height - lost_at(ray, t)


@shader
def lost_at(ray: Ray, t: float) -> float:
    """The height that the ray has lost by t."""
    return t * (ray.drop + ray.bend * (1.0 - t))


@shader
def fall_at(ray: Ray, t: float) -> float:
    """How fast the ray loses height at t."""
    return ray.drop + ray.bend * (1.0 - 2.0 * t)


@shader
def t_at(ray: Ray, height: float) -> float:
    """Where a straight ray that falls is at a height: below 0 before its start, above 1 beyond."""
    return (ray.height - height) / max(ray.drop, SLOWEST)


@shader
def hit_at(ray: Ray, t: float, found: bool, reads: int) -> Hit:
    """The ray ends at t."""
    return Hit(at(ray, t), height_at(ray, t), t, found, reads)


@shader
def fastest_fall(ray: Ray, t: float) -> float:
    """The most height that the ray loses per t anywhere from t on."""
    return max(fall_at(ray, t), fall_at(ray, 1.0))
