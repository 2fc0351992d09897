"""The truth of a picture: first hits of its view rays by the oracle, pixel by pixel.

Only the rays come from the shaders: their points on the polygon and their travel. The oracle uses
the heights of the same field that techniques read, in 32 bits. What is cut out at the true hit
comes from a picture drawn by `exact`, and so does which lights a true hit faces.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError
from basrelief.measure.light import Points, shown_light, visible_share
from basrelief.measure.oracle import intersect_height_field
from basrelief.rendering import textures
from basrelief.rendering.programs import map_edge, values_of, view_ray_program_of
from basrelief.rendering.render import check_picture, render
from basrelief.scene import Object, ResolvedObject, Scene

__all__ = ["Truth", "truth"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Truth:
    """True first hits of the view rays of a picture.

    Arrays start with the picture's (height, width); row 0 is the top row.

    Attributes
    ----------
    uv : ndarray of float64, shape (h, w, 2)
        Texture coordinates of the hit, not wrapped into one tile.
    height : ndarray of float64, shape (h, w)
        Height of the surface at the hit, 0 to 1.
    distance : ndarray of float64, shape (h, w)
        Distance to the hit along the ray, in world units.
    there : ndarray of bool, shape (h, w)
        Whether the pixel shows the object, which it does not where the true hit is cut out.
    travel : ndarray of float64, shape (h, w, 2)
        Change of the texture coordinates while the ray falls from height 1 to 0.
    texels : (int, int)
        Size of the height map along u and along v.
    wraps : bool
        Whether the map repeats.
    light : ndarray of float64, shape (lights, h, w), or None
        Share of each light that reaches the hit, 0 to 1; None for a scene without shadows.
    """

    uv: Floats
    height: Floats
    distance: Floats
    there: NDArray[np.bool_]
    travel: Floats
    texels: tuple[int, int]
    wraps: bool
    light: Floats | None = None

    @functools.cached_property
    def direction(self) -> Floats:
        """Unit vectors of `travel` in texels, (h, w, 2); 0 for a ray along the normal."""
        travel = self.travel * self.texels
        length = length_of(travel)[:, :, None]
        direction: Floats = travel / np.where(length > 0.0, length, 1.0)
        return direction


def length_of(vectors: Floats) -> Floats:
    """Lengths of vectors, (…, 2); `np.linalg.norm` takes three times as long."""
    x, y = vectors[..., 0], vectors[..., 1]
    length: Floats = np.sqrt(x * x + y * y)
    return length


def truth(what: Scene | Object, size: tuple[int, int], *, device: str | Engine = "auto") -> Truth:
    """Compute the true first hits of a scene of one plane with a relief.

    The relief has the object's reference height and fades as the object does. Whatever the
    object's `projection` and `heights`, the true ray is straight and the true surface is the
    bilinear surface of mip level 0.

    Parameters
    ----------
    what : Scene or Object
        A scene of one plane, or that plane.
    size : (int, int)
        Width and height of the picture, in pixels.
    device : str or Engine
        Device that computes the rays: "auto", "cpu" or "gpu", or an engine.

    Returns
    -------
    Truth

    Raises
    ------
    InputError
        For a scene of anything but one plane, and for a material without heights.
    """
    size = check_picture(size)
    scene = what if isinstance(what, Scene) else Scene((what,))
    obj = measurable(scene)
    engine = engine_of(device)
    values = values_of(obj, scene, size, engine)
    rays = engine.run(view_ray_program_of(obj), values, size)
    meets = rays["found"] != 0
    start, travel = (
        np.stack([rays[f"{name}.x"], rays[f"{name}.y"]], -1).astype(np.float64)
        for name in ("uv", "travel")
    )
    heights = _heights(obj)
    uv, height = np.zeros_like(start), np.zeros(meets.shape)
    hits = intersect_height_field(heights, start[meets], travel[meets], map_edge(obj))
    uv[meets], height[meets] = hits.uv, hits.height
    distance = rays["distance"] + (1.0 - height) * rays["length"].astype(float)
    there = meets & (distance > 0.0)
    if obj.edge == "clip":
        tile_uv = (uv - obj.tiling.shift) / obj.tiling.tiles
        there &= ((tile_uv >= 0.0) & (tile_uv <= 1.0)).all(-1)
    if obj.material.opacity is not None and obj.alpha != "opaque":
        there &= _covered(scene, obj, size, engine)
    light = None
    if scene.shadows != "none":
        points = Points(uv[there], height[there], rays["scale"][there].astype(float))
        angle = scene.shadowing.light_angle if scene.shadows == "soft" else 0.0
        light = shown_light(replace(_by_exact(scene, obj), shadows="none"), size, engine)
        for share, source in zip(light, scene.lights, strict=True):
            share[there] *= visible_share(heights, obj, points, source, angle)
    return Truth(
        uv, height, np.where(there, distance, 0.0), there, travel, heights.shape[::-1],
        map_edge(obj) == "wrap", light,
    )  # fmt: skip


def _covered(
    scene: Scene, obj: ResolvedObject, size: tuple[int, int], engine: Engine
) -> NDArray[np.bool_]:
    """Whether a pixel is covered at its true hit, drawn by `exact` with the picture's filter."""
    drawn = replace(_by_exact(scene, obj), lights=(), shadows="none", fog_mode="none")
    return render(drawn, size=size, samples=1, device=engine).hit


def _by_exact(scene: Scene, obj: ResolvedObject) -> Scene:
    """The scene drawn by `exact`, with straight rays."""
    exact = replace(
        scene.objects[0],
        technique="exact",
        settings={},
        projection="full",
        heights="sharp",
        scale=obj.scale,
        reference_height=obj.reference_height,
    )
    return replace(scene, objects=(exact,))


def measurable(scene: Scene) -> ResolvedObject:
    """The object of a scene whose truth can be computed; raises InputError where there is none."""
    if len(scene.objects) != 1 or scene.objects[0].shape != "plane":
        raise InputError("errors are measured on one plane; give a scene with one object, a plane")
    obj = scene.resolved[0]
    if obj.material.height is None:
        raise InputError(
            f"{obj.material.name} has no height map, so there is nothing to measure; add one"
        )
    return obj


def _heights(obj: ResolvedObject) -> NDArray[np.float32]:
    """Mip level 0 of the height field that programs read."""
    field = textures.height_field(obj.material, map_edge(obj))
    assert field is not None
    heights: NDArray[np.float32] = field.levels[0]
    return heights
