"""Mirrored, tiled, rotated and stretched ramps and bumps against a reference in float64.

A displaced point in world space, with M the object's transform, is

    M (corner + u · right + v · down) + (height − reference) · M out · scale ÷ |tiles along u|

so a ray is transformed to (u, v, height) by one 3 × 3 system and traced there, without tangents,
handedness or an inverse transpose. Normals are cross products of the surface's derivatives.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from basrelief.material import Map, Material
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import LookAt, Object, Scene, directional, placed, rotated
from basrelief.shading.brdf import Shading
from basrelief.shading.lights import Light
from basrelief.shading.self_shadow import Shadowing
from helpers.synthetic import matte, rays, unit

SIZE = (60, 44)
MATTE = Shading(ambient=(0.0, 0.0, 0.0))
STEPS = 256
FINE = {
    "parallax_occlusion": {"min_steps": STEPS, "max_steps": STEPS},
    "relief": {"min_steps": STEPS, "max_steps": STEPS, "search_steps": 16},
}

# --- orientations ---------------------------------------------------------------------------------

TRANSFORMS = {
    "as it is": np.eye(4),
    "turned about x": rotated("x", -75.0),
    "turned about y": rotated("y", 130.0),
    "turned about z": rotated("z", 65.0),
    "stretched": placed((0.3, -0.2, 0.5), (1.7, 0.6, 1.4)),
    "turned and stretched": rotated("y", 40.0)
    @ rotated("x", -70.0)
    @ placed(scale=(0.6, 1.5, 2.0)),
    "skewed": rotated("x", 25.0) @ placed(scale=(1.5, 0.7, 1.1)) @ rotated("y", 35.0),
    "mirrored in x": placed(scale=(-1.3, 0.9, 1.0)),
    "mirrored in y and turned": rotated("z", 30.0) @ placed(scale=(0.8, -1.1, 1.0)),
    "mirrored in z": placed(scale=(1.0, 0.8, -1.2)),
    "mirrored in all": placed((0.0, 0.4, 0.0), (-1.0, -0.7, -1.2)),
}
AT_RIGHT_ANGLES = [name for name in TRANSFORMS if name != "skewed"]
MIRRORINGS = [(1, 1), (-1, 1), (1, -1), (-1, -1)]
TILINGS = {
    (1, 1): (0.0, 0.0),
    (-1, 1): (0.0, 0.0),
    (1, -1): (0.3, -0.2),
    (-1, -1): (0.0, 0.45),
    (2, 3): (0.0, 0.0),
    (-1, 2): (0.25, 0.0),
    (2, -3): (-0.7, 0.1),
}
"""Tiles along u and v, and the shift that goes with each."""

FACES = {
    # out, right, and down in the picture
    "front": ((0, 0, 1), (1, 0, 0), (0, -1, 0)),
    "back": ((0, 0, -1), (-1, 0, 0), (0, -1, 0)),
    "right": ((1, 0, 0), (0, 0, -1), (0, -1, 0)),
    "left": ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "top": ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
    "bottom": ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
}
"""The faces of the box, with axes as seen from outside; the plane equals the front face."""


# --- height fields in closed form -----------------------------------------------------------------

Array = np.ndarray


@dataclass(frozen=True)
class Form:
    """A height map as a formula in u and v from 0 to 1, with its slopes along both."""

    height: Callable[[Array, Array], Array]
    slope: Callable[[Array, Array], tuple[Array, Array]]
    columns: int
    rows: int

    @functools.cached_property
    def texels(self) -> Array:
        u, v = [(np.arange(n) + 0.5) / n for n in (self.columns, self.rows)]
        return self.height(*np.meshgrid(u, v))


def bell(u: Array, v: Array) -> Array:
    """A Gaussian bell above and left of the middle, narrower along u than along v."""
    return np.exp(-(((u - 0.4) / 0.13) ** 2) - ((v - 0.42) / 0.17) ** 2)


RAMP = Form(
    lambda u, v: 0.5 + 0.55 * (u - 0.5) - 0.2 * (v - 0.5),
    lambda u, v: (0.55 + 0 * u, -0.2 + 0 * v),
    24,
    16,
)
BUMP = Form(
    lambda u, v: 0.15 + 0.7 * bell(u, v),
    lambda u, v: (
        0.7 * bell(u, v) * -2 * (u - 0.4) / 0.13**2,
        0.7 * bell(u, v) * -2 * (v - 0.42) / 0.17**2,
    ),
    36,
    24,
)
BLOCK = Form(
    lambda u, v: 0.1 + 0.7 * ((abs(u - 0.45) < 0.1) & (abs(v - 0.55) < 0.08)),
    lambda u, v: (0 * u, 0 * v),
    48,
    32,
)
COLORS = np.array(
    # 6 × 4 texels; no two corners or sides are alike
    [
        [
            (0.2 + 0.12 * x, 0.9 - 0.2 * y, 0.3 + 0.02 * x * y + 0.4 * (x == y == 0))
            for x in range(6)
        ]
        for y in range(4)
    ]
)


def map_of(values: Array) -> Map:
    values = np.asarray(values, np.float32)
    return Map(values if values.ndim == 3 else values[:, :, None], False, "made up")


COLORED = {
    form: Material("made up", height=map_of(form.texels), base_color=map_of(COLORS))
    for form in (RAMP, BUMP)
}
GREY = {
    BUMP: Material("made up", height=map_of(BUMP.texels)),
    BLOCK: Material(
        "made up",
        height=map_of(BLOCK.texels),
        normal=map_of(np.full((1, 1, 3), (0.5, 0.5, 1.0))),
    ),
}


def bilinear(texels: Array, uv: Array) -> Array:
    """The bilinear surface through the texel centres, repeated."""
    rows, columns = texels.shape[:2]
    x, y = uv[..., 0] * columns - 0.5, uv[..., 1] * rows - 0.5
    left, top = np.floor(x), np.floor(y)
    more = (..., *(None,) * (texels.ndim - 2))
    a, b = (x - left)[more], (y - top)[more]
    i, j = left.astype(int) % columns, top.astype(int) % rows
    # the texel to the right, the one below, and the two after the last
    wide = np.pad(texels, [(0, 1), (0, 1), *[(0, 0)] * (texels.ndim - 2)], mode="wrap")
    upper = wide[j, i] * (1 - a) + wide[j, i + 1] * a
    lower = wide[j + 1, i] * (1 - a) + wide[j + 1, i + 1] * a
    return upper * (1 - b) + lower * b


# --- rays and displaced faces, in world space -----------------------------------------------------


@dataclass(frozen=True, eq=False)
class Face:
    """A displaced face: P(u, v, s) = corner + u · right + v · down + s · rise.

    u and v are the coordinates of the shape, from 0 to 1; s is height − reference height.
    """

    corner: Array
    right: Array
    down: Array
    rise: Array
    reference_height: float
    tiles: Array
    shift: Array
    form: Form

    @classmethod
    def of(cls, obj: Object, name: str, form: Form) -> Face:
        out, right, down = (np.array(direction, np.float64) for direction in FACES[name])
        lift = 0.0 if obj.shape == "plane" else 0.5
        linear, origin = obj.resolved.transform[:3, :3], obj.resolved.transform[:3, 3]
        return cls(
            corner=origin + linear @ (lift * out - right / 2 - down / 2),
            right=linear @ right,
            down=linear @ down,
            rise=linear @ out * obj.scale / abs(obj.tiling[0]),
            reference_height=obj.reference_height,
            tiles=np.array(obj.tiling, np.float64),
            shift=np.array(obj.shift, np.float64),
            form=form,
        )

    @property
    def normal(self) -> Array:
        """The polygon's unit normal on the side to which the relief rises."""
        across = unit(np.cross(self.right, self.down))
        return across * np.sign(across @ self.rise)

    def at(self, u: float, v: float) -> Array:
        """The polygon's point at texture coordinates."""
        x, y = (np.array([u, v]) - self.shift) / self.tiles
        return self.corner + x * self.right + y * self.down

    def coordinates(self, direction: Array) -> Array:
        """A world vector as multiples of right, down and rise."""
        return direction @ np.linalg.inv(np.stack([self.right, self.down, self.rise]))

    def tiled(self, place: Array) -> Array:
        """Texture coordinates from coordinates of the shape."""
        return place[..., :2] * self.tiles + self.shift

    def above(self, place: Array) -> Array:
        """Height of a place above the surface, as a part of the height range."""
        return place[..., 2] + self.reference_height - bilinear(self.form.texels, self.tiled(place))

    def normals(self, uv: Array) -> Array:
        """Unit normals of the displaced surface, from its derivatives."""
        along_u, along_v = self.form.slope(*np.moveaxis(uv % 1.0, -1, 0))
        one = self.right + (along_u * self.tiles[0])[..., None] * self.rise
        other = self.down + (along_v * self.tiles[1])[..., None] * self.rise
        across = unit(np.cross(one, other))
        return across * np.sign(across @ self.rise)[..., None]


@dataclass(frozen=True, eq=False)
class Reference:
    """The expected picture: arrays over all pixels.

    `sure` where the object is hit, clear of the outline; `outside` where it is not. `grazing` where
    the ray almost touches the surface before the hit. `end` is the hit in coordinates of the face,
    `footprint` the part of a tile that the pixel covers along u and v, `travel` the number of tiles
    that the ray crosses while it falls through the height range.
    """

    sure: Array
    outside: Array
    grazing: Array
    uv: Array
    distance: Array
    normal: Array
    end: Array
    footprint: Array
    travel: Array


SAMPLES = 96
NEAR = 1e-3
CLOSE = 0.03


def reference(faces: list[Face], camera: LookAt) -> Reference:
    """Trace every ray to its hit on the first displaced face, entered through the polygon."""
    origins, directions = rays(camera, SIZE)
    shape = origins.shape[:2]
    found = Reference(
        sure=np.zeros(shape, bool),
        outside=np.ones(shape, bool),
        grazing=np.zeros(shape, bool),
        uv=np.zeros((*shape, 2)),
        distance=np.zeros(shape),
        normal=np.zeros((*shape, 3)),
        end=np.zeros((*shape, 3)),
        footprint=np.zeros((*shape, 2)),
        travel=np.zeros(shape),
    )
    t_exit = np.full(shape, np.inf)
    for face in faces:
        start = face.coordinates(origins - face.corner)
        direction = face.coordinates(directions)
        polygon = -start[..., 2] / direction[..., 2]
        np.minimum(t_exit, polygon, out=t_exit, where=direction[..., 2] > 0.0)
        place = start + direction * polygon[..., None]
        margin = 0.5 - np.abs(place[..., :2] - 0.5).max(axis=-1)
        ahead = (direction[..., 2] < 0.0) & (polygon > 0.0)
        found.outside[ahead & (margin > -NEAR)] = False
        meets = ahead & (margin > NEAR)
        if not meets.any():
            continue
        found.sure[meets] = True
        end, depth, found.grazing[meets] = traced(face, start[meets], direction[meets])
        found.end[meets], found.distance[meets] = end, depth
        found.uv[meets] = face.tiled(end)
        found.normal[meets] = face.normals(face.tiled(end))
        slant = np.linalg.norm(direction[..., :2] * face.tiles, axis=-1) / -direction[..., 2]
        found.travel[meets] = slant[meets]
        spread = np.gradient(face.tiled(place), axis=(0, 1))
        found.footprint[meets] = np.abs(spread).max(axis=0)[meets]
    # the hit lies inside the solid
    np.minimum(found.distance, t_exit, out=found.distance)
    return found


def traced(face: Face, start: Array, direction: Array) -> tuple[Array, Array, Array]:
    """Hits of rays in a face's coordinates, their distances, and which rays graze a crest first."""
    heights = np.linspace(1.0 - face.reference_height, 0.05 - face.reference_height, SAMPLES)
    t = (heights - start[:, 2:]) / direction[:, 2:]
    clearance = face.above(start[:, None] + direction[:, None] * t[..., None])
    first = np.argmax(clearance <= 0.0, axis=1)
    here = clearance[:, 1:-1]
    dips = (here < clearance[:, :-2]) & (here <= clearance[:, 2:]) & (here < CLOSE)
    grazing = (dips & (np.arange(1, SAMPLES - 1) < first[:, None])).any(axis=1)
    each = np.arange(len(start))
    for later in (1, 2, 3):
        # also rays that only cut a crest
        grazing |= clearance[each, np.minimum(first + later, SAMPLES - 1)] > 0.0
    low, high = t[each, np.maximum(first - 1, 0)], t[each, first]
    for _ in range(30):
        middle = (low + high) / 2
        under = face.above(start + direction * middle[:, None]) <= 0.0
        low, high = np.where(under, low, middle), np.where(under, middle, high)
    return start + direction * high[:, None], high, grazing


# --- pictures -------------------------------------------------------------------------------------


def tilted_camera(face: Face, lens: str = "perspective", slant: float = 0.6) -> LookAt:
    """A tilted camera that shows about a tile of a face, near its middle."""
    target = face.corner + 0.45 * face.right + 0.55 * face.down
    tile = (face.right / abs(face.tiles[0]), face.down / abs(face.tiles[1]))
    across = math.sqrt(math.prod(np.linalg.norm(direction) for direction in tile))
    side = slant * (unit(face.right) * 0.8 + unit(face.down) * 0.6)
    up = 0.6 * face.normal - unit(face.down) + 0.4 * unit(face.right)
    return LookAt(
        tuple(target + (side + face.normal) * across * 3.0),
        tuple(target),
        tuple(up),
        field_of_view=24.0,
        orthographic_height=1.4 * across if lens == "orthographic" else None,
    )


def light_towards(face: Face, side: Array, elevation: float = 40.0) -> Array:
    """The unit vector to a light on one side of a face."""
    along = side - face.normal * (side @ face.normal)
    angle = math.radians(elevation)
    return unit(along) * math.cos(angle) + face.normal * math.sin(angle)


def light_from(towards: Array) -> Light:
    x, y, z = towards
    return directional(math.degrees(math.atan2(x, z)), math.degrees(math.asin(y)))


def object_of(
    form: Form, materials: dict[Form, Material], transform: str, tiling, **more
) -> Object:
    technique = "parallax_occlusion" if form is RAMP else "relief"
    options = {
        "technique": technique,
        "settings": FINE[technique],
        "scale": 0.22,
        "reference_height": 1.0 if form is RAMP else 0.4,
        "tiling": tiling,
        "shift": TILINGS[tiling],
        "transform": TRANSFORMS[transform],
    }
    return Object(materials[form], **{**options, **more})


def drawn(obj: Object, camera: LookAt, towards: Array, device: str = "cpu", **more) -> Frame:
    options = {"background": None, "shading": MATTE, "shading_model": "phong"}
    scene = Scene(
        (matte(obj),), camera=camera, lights=(light_from(towards),), **{**options, **more}
    )
    return render(scene, size=SIZE, samples=1, device=device)


def assert_displaced(
    obj: Object, faces: list[Face], camera: LookAt, towards: Array, device: str = "cpu"
) -> None:
    """Assert that outline, uv, distance and light are those of the displaced surface."""
    frame, wanted = drawn(obj, camera, towards, device), reference(faces, camera)
    form = faces[0].form
    # not where a march step is longer than a fraction of a texel
    sure = wanted.sure & (wanted.travel < 1.0)
    ours = sure & ~wanted.grazing
    assert ours.sum() > 150
    assert ours.sum() > 0.95 * sure.sum()
    assert frame.hit[wanted.sure].all()
    assert not frame.hit[wanted.outside].any()
    # within the chord of a step at the ramp's cliff, within rounding elsewhere
    away = np.abs(frame.uv - wanted.uv)[ours].max(axis=-1)
    assert away.max() < 2e-3
    assert np.quantile(away, 0.95) < 5e-5
    np.testing.assert_allclose(frame.distance[ours], wanted.distance[ours], rtol=1e-3)
    cosine = np.maximum(wanted.normal @ towards, 0.0)
    shade = bilinear(COLORS, wanted.uv) * cosine[..., None]
    # coarse mip levels blend in the ramp's cliff
    size = np.array([form.columns, form.rows])
    texels = (wanted.footprint * size).max(axis=-1)
    reach = 2.0 + 3.0 * np.where(texels > 0.7, texels, 0.0)
    inner = (np.abs(wanted.uv % 1.0 - 0.5) < 0.5 - reach[..., None] / size).all(axis=-1)
    plain = ours & (texels < 2.5) & (inner | (form is not RAMP))
    assert plain.sum() > 30
    off = np.abs(frame.color[..., :3] - shade)[plain].max(axis=-1)
    if form is RAMP:
        assert off.max() < 1e-3
    else:
        # normals of the map come from central differences of the texels
        assert np.quantile(off, 0.9) < 0.02
        assert off.max() < 0.12
    assert shade[plain].max() > 0.2


# --- ramps and bumps ------------------------------------------------------------------------------


FORMS = {"a ramp, in perspective": (RAMP, "perspective"), "a bump": (BUMP, "orthographic")}


@pytest.mark.parametrize("tiling", TILINGS, ids=str)
@pytest.mark.parametrize("transform", TRANSFORMS)
@pytest.mark.parametrize("name", FORMS)
def test_on_a_plane_the_picture_is_that_of_the_displaced_surface(name, transform, tiling) -> None:
    """Outline, uv, depth, colour and light; mirrored, tiled, shifted, rotated, stretched."""
    form, lens = FORMS[name]
    obj = object_of(form, COLORED, transform, tiling)
    face = Face.of(obj, "front", form)
    towards = light_towards(face, 0.8 * unit(face.right) - 0.5 * unit(face.down))
    assert_displaced(obj, [face], tilted_camera(face, lens), towards)


@pytest.mark.parametrize("name", FACES)
@pytest.mark.parametrize("tiling", [(1, 1), (-1, 2), (2, -3)], ids=str)
@pytest.mark.parametrize("transform", ["turned and stretched", "skewed", "mirrored in all"])
def test_on_each_face_of_a_box_the_picture_is_that_of_the_displaced_surface(
    transform, tiling, name
) -> None:
    form = BUMP if name in ("front", "left", "top") else RAMP
    obj = object_of(form, COLORED, transform, tiling, shape="box")
    faces = {each: Face.of(obj, each, form) for each in FACES}
    face = faces[name]
    towards = light_towards(face, 0.8 * unit(face.right) - 0.5 * unit(face.down))
    assert_displaced(obj, list(faces.values()), tilted_camera(face), towards)


@pytest.mark.gpu
@pytest.mark.parametrize("form", [RAMP, BUMP], ids=["a ramp", "a bump"])
@pytest.mark.parametrize(
    ("transform", "tiling"),
    [("turned and stretched", (-1, 2)), ("skewed", (2, -3)), ("mirrored in all", (-1, -1))],
    ids=str,
)
def test_a_gpu_draws_the_displaced_surface(form, transform, tiling) -> None:
    obj = object_of(form, COLORED, transform, tiling)
    face = Face.of(obj, "front", form)
    towards = light_towards(face, 0.8 * unit(face.right) - 0.5 * unit(face.down))
    assert_displaced(obj, [face], tilted_camera(face), towards, "gpu")


# --- light and shadow in world space --------------------------------------------------------------

SIDES = {"u": (1, 0), "minus v": (0, -1)}


def positions(frame: Frame, camera: LookAt) -> Array:
    """The world position of each pixel, from its distance alone."""
    origins, directions = rays(camera, SIZE)
    return origins + directions * np.where(frame.hit, frame.distance, 0.0)[..., None]


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("tiling", MIRRORINGS, ids=str)
@pytest.mark.parametrize("transform", AT_RIGHT_ANGLES)
def test_the_side_of_a_bump_towards_the_light_is_bright(transform, tiling, side) -> None:
    """In world space, without texture coordinates."""
    obj = object_of(
        BUMP, GREY, transform, tiling, reference_height=0.0, shift=(0.0, 0.0), scale=0.15
    )
    face = Face.of(obj, "front", BUMP)
    a, b = SIDES[side]
    towards = light_towards(face, a * unit(face.right) + b * unit(face.down), 25.0)
    camera = tilted_camera(face, "orthographic", slant=0.2)
    frame = drawn(obj, camera, towards)
    middle = face.at(0.4 - (tiling[0] < 0), 0.42 - (tiling[1] < 0))
    away = (positions(frame, camera) - middle) @ np.linalg.inv(
        np.stack([face.right, face.down, face.normal])
    )
    # in units of the plane's sides, towards the light and across
    along, across = away[..., :2] @ (a, b), abs(away[..., :2] @ (b, a))
    band = frame.hit & (across < 0.1) & (abs(along) > 0.03) & (abs(along) < 0.25)
    shade = frame.color[..., 0]
    bright, dark = band & (along > 0.0), band & (along < 0.0)
    assert min(bright.sum(), dark.sum()) > 20
    assert shade[bright].mean() > shade[dark].mean() + 0.15


SHADOW_OFFSET = 0.004


def height_above_ray(face: Face, start: Array, direction: Array, samples: int) -> Array:
    """Maximum height of the surface above rays to a light, in a face's coordinates."""
    share = np.linspace(0.0, 1.0, samples + 1)[1:, None]
    rise = (1.0 - face.reference_height - start[:, None, 2:]) * share
    return -face.above(start[:, None] + direction / direction[2] * rise).min(axis=1)


@pytest.mark.parametrize("tiling", [(1, 1), (-1, 2), (2, -3)], ids=str)
@pytest.mark.parametrize("transform", TRANSFORMS)
def test_the_shadow_of_a_block_equals_that_of_the_ray_to_the_light(transform, tiling) -> None:
    """Dark where the ray to the light, traced in float64, passes through the block."""
    obj = replace(object_of(BLOCK, GREY, transform, tiling), technique="exact", settings={})
    face = Face.of(obj, "front", BLOCK)
    side = -0.5 * unit(face.right) + 0.9 * unit(face.down)
    towards = light_towards(face, side, 35.0)
    camera = tilted_camera(face, "orthographic", slant=0.25)
    frame = drawn(obj, camera, towards, shadows="hard")
    wanted = reference([face], camera)
    ours = wanted.sure & ~wanted.grazing
    lit = 0.6 * float(face.normal @ towards)
    shade = frame.color[..., 0][ours]
    dark = shade < 0.5 * lit
    np.testing.assert_allclose(shade, np.where(dark, 0.0, lit), atol=1e-3)
    end, direction = wanted.end[ours], face.coordinates(towards)
    above = height_above_ray(face, end, direction, SAMPLES)
    # a ray may cut a corner between two samples
    doubted = dark != (above > 0.0)
    above[doubted] = height_above_ray(face, end[doubted], direction, 48 * SAMPLES)
    # between the two limits the samples decide
    free, blocked = above < 0.0, above > NEAR
    assert (free | blocked).mean() > 0.9
    assert not dark[free].any()
    assert dark[blocked].all()
    assert 0.03 < dark.mean() < 0.6


@pytest.mark.parametrize("tiling", MIRRORINGS, ids=str)
@pytest.mark.parametrize("transform", AT_RIGHT_ANGLES)
def test_a_block_is_between_the_light_and_its_shadow(transform, tiling) -> None:
    """By the world positions of the dark pixels and of the block."""
    obj = object_of(
        BLOCK, GREY, transform, tiling, shift=(0.0, 0.0), reference_height=0.1, scale=0.2
    )
    face = Face.of(obj, "front", BLOCK)
    towards = light_towards(face, 0.7 * unit(face.right) + 0.5 * unit(face.down), 35.0)
    camera = tilted_camera(face, "orthographic", slant=0.2)
    shadowing = Shadowing(max_shadow_steps=STEPS, shadow_offset=SHADOW_OFFSET)
    frame = drawn(obj, camera, towards, shadows="hard", shadowing=shadowing)
    block = face.at(0.45 - (tiling[0] < 0), 0.55 - (tiling[1] < 0))
    away = positions(frame, camera) - block
    u, v, out = np.moveaxis(
        away @ np.linalg.inv(np.stack([face.right, face.down, face.rise])), -1, 0
    )
    # the ground around this block; other tiles have their own
    ground = frame.hit & (out < 0.1) & (abs(u) < 0.35) & (abs(v) < 0.35)
    dark = ground & (frame.color[..., 0] < 1e-3)
    along = away @ (towards - face.normal * (face.normal @ towards))
    assert dark.sum() > 20
    assert (along[dark] < 0.0).mean() > 0.9
    assert (dark & (along < 0.0)).sum() < 0.7 * (ground & (along < 0.0)).sum()


# --- clipped at the edge --------------------------------------------------------------------------


@pytest.mark.parametrize("tiling", MIRRORINGS, ids=str)
def test_a_clipped_plane_shows_the_whole_map_also_if_mirrored(tiling) -> None:
    """Mirrored tiles have negative uv, where clamping would show the border."""
    obj = object_of(RAMP, COLORED, "as it is", tiling, shift=(0.0, 0.0), scale=0.05, edge="clip")
    face = Face.of(obj, "front", RAMP)
    camera = LookAt((0.0, 0.0, 3.0), orthographic_height=0.9)
    frame, wanted = drawn(obj, camera, face.normal), reference([face], camera)
    shade = bilinear(COLORS, wanted.uv) * (wanted.normal @ face.normal)[..., None]
    inner = wanted.sure & (np.abs(wanted.uv % 1.0 - 0.5) < 0.37).all(axis=-1)
    assert inner.sum() > 500
    np.testing.assert_allclose(frame.color[..., :3][inner], shade[inner], atol=1e-3)
