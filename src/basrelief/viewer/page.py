"""The HTML page of a scene of one object, with its maps, programs, settings and code."""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief._version import __version__
from basrelief.baking.levels import halved
from basrelief.engine import Engine, engine_of
from basrelief.images import encode_png, srgb_encode
from basrelief.material import Map, Material
from basrelief.pages import check_overwritable, fill, write_page
from basrelief.rendering import textures
from basrelief.rendering.programs import surface_maps
from basrelief.rendering.render import render
from basrelief.scene import Object, Scene
from basrelief.scene.resolve import DUST_SIDE, dust_of
from basrelief.techniques import BAKES, BOUNDS, CONE_MAP, Nothing
from basrelief.viewer.layouts import layouts
from basrelief.viewer.maps import as_fractions, packed
from basrelief.viewer.printed import program_library
from basrelief.viewer.state import check_drawable, manifest, sources_of, techniques_of

__all__ = ["ViewerPage", "write_view"]

LARGEST = 12 * 1000**2
"""Largest size of a page in bytes; maps are scaled until it fits."""
GENERATOR = "basrelief view"
_SMALLEST = 64
"""Largest side in texels at which maps are not scaled further."""
_OTHER_BYTES = 400_000
"""Bytes of a page besides maps and pictures, mostly programs."""
Progress = Callable[[str, float], None]
_STILLS = ("flat", "offset", "parallax_occlusion", "relief")
"""Techniques of the still pictures, for browsers without WebGPU."""
_BAKED_BY_PAGES = (BOUNDS, CONE_MAP)
"""Tables that a page bakes itself; it contains the other tables. `web/bakes.js` can bake relaxed
cones too, but that takes minutes without a GPU."""
_MODULES = (
    "checks", "state", "camera", "records", "link", "maps", "png", "names", "srgb", "resize",
    "dropped", "opened", "text", "colors", "missed", "gpu", "pace", "frames", "bakes",
    "drawing", "controls", "thumbs", "mappanel", "scroll", "panel", "host", "input", "main",
)  # fmt: skip


@dataclass(frozen=True)
class ViewerPage:
    """A page of the viewer.

    Attributes
    ----------
    html : str
        Text of the page.
    scaled_to : (int, int) or None
        Width and height of its largest map in texels, if maps were scaled.
    """

    html: str
    scaled_to: tuple[int, int] | None


def write_view(
    scene: Scene,
    path: str | Path,
    *,
    texels: int = 1024,
    device: str | Engine = "auto",
    progress: Progress | None = None,
) -> ViewerPage:
    """Write an interactive HTML page of a scene of one object, atomically.

    Parameters
    ----------
    scene : Scene
        A scene of one object.
    path : path
        The HTML file.
    texels : int
        Largest side of the page's maps, in texels. Maps are scaled further until the page has
        at most 12 MB.
    device : str or Engine
        "auto", "cpu" or "gpu", or an engine, for bakes and still pictures.
    progress : callable, optional
        Called with the current task and the finished share, 0 to 1.

    Returns
    -------
    ViewerPage

    Raises
    ------
    InputError
        For another existing file, a file that cannot be written, and a scene without an object
        or with several.
    """
    file = Path(path)
    check_overwritable(file, GENERATOR, "a page of the viewer")
    check_drawable(scene)
    page = page_of(scene, texels, device, progress or (lambda what, share: None))
    write_page(file, page.html)
    return page


def page_of(scene: Scene, texels: int, device: str | Engine, progress: Progress) -> ViewerPage:
    """The page of a scene."""
    obj = scene.objects[0]
    progress("printing the programs", 0.0)
    programs = program_library(techniques_of(obj))
    engine = engine_of(device)
    stills = list(_stills(scene, engine, progress))
    largest = max((max(map.width, map.height) for map in _all_maps(obj)), default=1)
    max_side = min(largest, texels)
    while True:
        progress("packing the maps", 0.9)
        scaled_obj = _with_scaled_maps(obj, max_side)
        maps = _maps(scaled_obj, engine)
        if _bytes(maps, stills) <= LARGEST or max_side <= _SMALLEST:
            break
        max_side = max_side // 2
    maps |= _bakes(scaled_obj.material, LARGEST - _bytes(maps, stills), engine)
    scaled = largest_map_size(scaled_obj) if max_side < largest else None
    shown = replace(scaled_obj, opening=obj.opening)
    data = {
        "programs": programs.to_dict(),
        "records": layouts(programs.library.names),
        **manifest(replace(scene, objects=(shown,)), sources_of(scene), scaled),
    }
    return ViewerPage(_html(obj.material.name, data, maps, stills), scaled)


def _bytes(maps: dict[str, Any], stills: list[tuple[str, str]]) -> int:
    """Approximate size of a page in bytes."""
    texts = [map["content"] for map in maps.values()] + [text for _, text in stills]
    return sum(map(len, texts)) + _OTHER_BYTES


def largest_map_size(obj: Object) -> tuple[int, int]:
    """Width and height of an object's largest map, in texels."""
    largest = max(_all_maps(obj), key=lambda map: map.width * map.height)
    return largest.width, largest.height


def _all_maps(obj: Object) -> Iterator[Map]:
    for material in (obj.material, obj.layer and obj.layer.material):
        yield from (map for _, map in (material.maps() if material else ()))


def _with_scaled_maps(obj: Object, max_side: int) -> Object:
    """The object with its maps, and its layer's, scaled to at most `max_side` texels a side.

    It has no opening, as pages store the maps of the material and open holes themselves.
    """
    layer = obj.layer
    return replace(
        obj,
        opening=None,
        material=_scaled(obj.material, max_side),
        layer=layer and replace(layer, material=_scaled(layer.material, max_side)),
    )


def _scaled(material: Material, max_side: int) -> Material:
    """The material with maps of at most `max_side` texels a side, each halved until it fits."""
    changed: dict[str, Map] = {}
    for name, map in material.maps():
        pixels = map.linear()
        while max(pixels.shape[:2]) > max_side:
            pixels = halved(pixels)
        if pixels.shape[:2] != (map.height, map.width):
            changed[name] = _stored_as(map, pixels, name == "height")
    return replace(material, **changed) if changed else material  # type: ignore[arg-type]


def _stored_as(original: Map, pixels: NDArray[np.float32], exact: bool) -> Map:
    """A scaled map; not `exact`, in 8 bits where the original has 8, which compresses better."""
    if exact or original.pixels.dtype != np.uint8:
        return Map(np.ascontiguousarray(pixels), False, original.source)
    codes = srgb_encode(pixels) if original.srgb else pixels
    return Map(np.rint(codes * 255.0).astype(np.uint8), original.srgb, original.source)


def _maps(obj: Object, engine: Engine) -> dict[str, Any]:
    """Mip level 0 of each map that programs read, and dust for a hole in heights, packed."""
    material = obj.material
    packed_maps: dict[str, Any] = {}
    field = textures.height_field(material, "wrap")
    if field is not None:
        packed_maps["field"] = packed(as_fractions(field.levels[0]))
    if field is not None or material.dust is not None:
        packed_maps["dust"] = packed(as_fractions(_dust(material)))
    for name, source, texture_material, scale in surface_maps(obj.resolved):
        # pages derive normals from heights themselves
        is_stored = name != "normal" or material.normal is not None
        map = source.texture(texture_material, "wrap", scale, engine) if is_stored else None
        if map is not None:
            packed_maps[name] = packed(map.levels[0])
    return packed_maps


def _dust(material: Material) -> NDArray[np.float32]:
    """Dust of a page, (h, w); the default is smooth, and takes few texels."""
    dust = dust_of(material).linear()
    while material.dust is None and max(dust.shape[:2]) > DUST_SIDE:
        dust = halved(dust)
    return dust[:, :, 0]


def _bakes(material: Material, budget: int, engine: Engine) -> dict[str, Any]:
    """Tables that pages do not bake themselves, packed, as far as they fit in `budget` bytes."""
    tables: dict[str, Any] = {}
    height = material.height
    for name, bake in BAKES.items():
        if bake in _BAKED_BY_PAGES or height is None or budget <= height.width * height.height:
            continue
        baked = textures.bake_texture(material, "wrap", bake, engine)
        assert baked is not None
        packed_table = packed(baked.levels[0])
        if len(packed_table["content"]) <= budget:
            tables[name] = packed_table
            budget -= len(packed_table["content"])
    return tables


def _stills(scene: Scene, engine: Engine, progress: Progress) -> Iterator[tuple[str, str]]:
    """Techniques with still pictures in base64, for browsers without WebGPU."""
    obj = scene.objects[0]
    names = [n for n in _STILLS if n == "flat" or obj.material.height is not None]
    for number, name in enumerate(names):
        progress("drawing the still pictures", number / len(names))
        settings: Any = Nothing() if name == "flat" else {}
        shown = replace(obj, technique=name, settings=settings, heights="sharp")
        frame = render(replace(scene, objects=(shown,)), size=(400, 225), samples=4, device=engine)
        png = encode_png(frame.codes[:, :, :3])
        yield name, base64.b64encode(png).decode()


# --- the page ------------------------------------------------------------------------------------


def _html(
    name: str, data: dict[str, Any], maps: dict[str, Any], stills: list[tuple[str, str]]
) -> str:
    web = files("basrelief.viewer") / "web"
    # kept outside the JSON: base64 needs no escaping in HTML
    contents = {key: map.pop("content") for key, map in maps.items()}
    text = json.dumps({**data, "maps": maps}, separators=(",", ":"))
    return fill(
        "viewer/templates/page.html.jinja",
        generator=GENERATOR,
        title=name,
        version=__version__,
        modules={f"view/{module}.js": _module(web, module) for module in _MODULES},
        stills=stills,
        data=base64.b64encode(zlib.compress(text.encode(), 9)).decode(),
        maps=contents,
    )


def _module(web: Any, name: str) -> str:
    """A module's source as a data: URL."""
    source = (web / f"{name}.js").read_bytes()
    return f"data:text/javascript;base64,{base64.b64encode(source).decode()}"
