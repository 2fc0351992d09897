r"""The ray in texture space and its hit: input and output of every technique.

A ray is a segment with t from 0 to 1. Over a flat surface one segment is the whole ray, from height
1 to height 0.

    height
      1  *  t = 0                     uv(t)     = uv + travel · t
          `.       ____               height(t) = height − drop · t − bend · t (1 − t)
            `.    /    \
    ____      `. /      \_____        The hit is at the first t at which the ray is not above the
        \_____  *  hit                surface.
              \_/`.
      0            * t = 1
         |- travel -|  uv

`bend` is for rays over curved surfaces: at t = ½ such a ray is `bend` ÷ 4 lower than the straight
line between its ends.
"""

from __future__ import annotations

from basrelief.lang import Vec2, shader, struct

MIN_DROP = 1e-9
"""Lower limit of a drop in divisions."""


@struct
class Ray:
    """A segment of the view ray in the texture space of the height map.

    t runs along it from 0 to 1: texture coordinates `uv + travel · t`, height
    `height − drop · t − bend · t (1 − t)`. Over a flat surface one straight segment is the whole
    ray, from height 1 to height 0.

    Attributes
    ----------
    uv : Vec2
        Texture coordinates at t = 0.
    travel : Vec2
        The change of texture coordinates over the segment.
    height : float
        Height at t = 0, 0 to 1.
    drop : float
        The height lost over the segment; negative for a rising ray.
    cosine : float
        V · N: 1 looking straight at the surface, 0 along it.
    bend : float
        Curvature of the ray: at t = ½ it is `bend` ÷ 4 lower than the straight line.
    share : float
        The segment's part of the whole ray, 0 to 1, which is also its part of the steps.
    reference_height : float
        The height that lies on the polygon, 0 to 1.
    scale : float
        The height range in tile widths.
    lod, fade : float
        The mip level and the fade of smooth heights (`techniques.height`).
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
    """The result of a technique: where the ray ends.

    Attributes
    ----------
    uv : Vec2
        The displaced texture coordinates.
    height : float
        The height of the ray there, 0 to 1.
    t : float
        The position along the segment, 0 to 1; depth and shadows follow from it.
    found : bool
        Whether the surface was hit. If not, the ray continues beyond the segment where `t` is 1,
        and ran out of steps where `t` is less.
    reads : int
        The number of heights read.
    """

    uv: Vec2
    height: float
    t: float
    found: bool
    reads: int


@shader
def at(ray: Ray, t: float) -> Vec2:
    """The texture coordinates of the ray at t: uv + travel · t.

    Parameters
    ----------
    ray : Ray
        The ray.
    t : float
        The position along the ray, 0 to 1.

    Returns
    -------
    Vec2
        Texture coordinates, not wrapped into one tile.
    """
    return ray.uv + ray.travel * t


@shader
def height_at(ray: Ray, t: float) -> float:
    """The height of the ray at t: height − drop · t − bend · t (1 − t).

    Parameters
    ----------
    ray : Ray
        The ray.
    t : float
        The position along the ray, 0 to 1.

    Returns
    -------
    float
        The height; 1 − t over a flat surface.
    """
    return ray.height - drop_at(ray, t)


@shader
def drop_at(ray: Ray, t: float) -> float:
    """The height that the ray has lost by t."""
    return t * (ray.drop + ray.bend * (1.0 - t))


@shader
def descent_at(ray: Ray, t: float) -> float:
    """The derivative of `drop_at`: the height that the ray loses per unit of t."""
    return ray.drop + ray.bend * (1.0 - 2.0 * t)


@shader
def t_at(ray: Ray, height: float) -> float:
    """The t at which a straight falling ray has a height.

    Parameters
    ----------
    ray : Ray
        A ray with `bend` 0 and `drop` above 0.
    height : float
        The height.

    Returns
    -------
    float
        t; below 0 before the ray's start, above 1 beyond its end.
    """
    return (ray.height - height) / max(ray.drop, MIN_DROP)


@shader
def hit_at(ray: Ray, t: float, found: bool, reads: int) -> Hit:
    """The hit at t, with the texture coordinates and the height of the ray there.

    Parameters
    ----------
    ray : Ray
        The ray.
    t : float
        The position along the ray, 0 to 1.
    found : bool
        Whether the surface was hit.
    reads : int
        The number of heights read.

    Returns
    -------
    Hit
        The result of a technique.
    """
    return Hit(at(ray, t), height_at(ray, t), t, found, reads)


@shader
def max_descent(ray: Ray, t: float) -> float:
    """The upper limit of `descent_at` from t to the end of the ray."""
    return max(descent_at(ray, t), descent_at(ray, 1.0))
