"""A scene of one object → one HTML page with its maps, programs, settings and code."""

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
from basrelief.techniques import BAKES, BOUNDS, CONE_MAP, Nothing
from basrelief.viewer.layouts import layouts
from basrelief.viewer.maps import as_fractions, packed
from basrelief.viewer.printed import printed
from basrelief.viewer.state import Sources, check_shown, manifest, techniques_of

__all__ = ["View", "write_view"]

LARGEST = 12 * 1000**2
"""Bytes of a page at most, its maps scaled until it fits."""
GENERATOR = "basrelief view"
_SMALLEST = 64
"""Texels a side below which maps are not scaled."""
_REST = 400_000
"""Bytes of a page beside maps and pictures, programs the most of them."""
Progress = Callable[[str, float], None]
_STILLS = ("flat", "offset", "parallax_occlusion", "relief")
"""The techniques of the still pictures, for browsers that cannot draw."""
_BAKED_BY_PAGES = (BOUNDS, CONE_MAP)
"""What pages soon bake themselves; other tables come with them. `web/bakes.js` bakes relaxed cones
too, but without a GPU that takes it minutes."""
_MODULES = (
    "checks", "state", "camera", "records", "link", "maps", "png", "names", "srgb", "dropped",
    "text", "colors", "missed", "gpu", "pace", "frames", "bakes", "drawing", "controls", "thumbs",
    "mappanel", "panel", "host", "input", "main",
)  # fmt: skip


@dataclass(frozen=True)
class View:
    """A page: its `html`, and the size, (width, height), that its maps were scaled to, or None."""

    html: str
    scaled_to: tuple[int, int] | None


def write_view(
    scene: Scene,
    path: str | Path,
    *,
    texels: int = 1024,
    sources: Sources | None = None,
    device: str | Engine = "auto",
    progress: Progress | None = None,
) -> View:
    """Write a page that shows the first object of a scene, whole or not at all.

    Maps are scaled to at most `texels` a side, and further until the page has at most 12 MB.
    `sources` say what the lines of Python and the commands that the page makes are to name. Raises
    InputError for a file that is there and no such page, for one that cannot be written, and for a
    scene without an object, or with more than one.
    """
    file = Path(path)
    check_overwritable(file, GENERATOR, "a page of the viewer")
    check_shown(scene)
    made = page_of(
        scene, texels, sources or Sources(), device, progress or (lambda what, share: None)
    )
    write_page(file, made.html)
    return made


def page_of(
    scene: Scene, texels: int, sources: Sources, device: str | Engine, progress: Progress
) -> View:
    """The page of a scene."""
    obj = scene.objects[0]
    progress("printing the programs", 0.0)
    programs = printed(techniques_of(obj))
    engine = engine_of(device)
    stills = list(_stills(scene, engine, progress))
    whole = max((max(one.width, one.height) for one in _all_maps(obj)), default=1)
    most = min(whole, texels)
    while True:
        progress("packing the maps", 0.9)
        shown = _shrunk(obj, most)
        maps = _maps(shown, engine)
        if _bytes(maps, stills) <= LARGEST or most <= _SMALLEST:
            break
        most = most // 2
    maps |= _bakes(shown.material, LARGEST - _bytes(maps, stills), engine)
    scaled = shown_size(shown) if most < whole else None
    data = {
        "programs": programs.told(),
        "records": layouts(programs.library.names),
        **manifest(replace(scene, objects=(shown,)), sources, scaled),
    }
    return View(_html(obj.material.name, data, maps, stills), scaled)


def _bytes(maps: dict[str, Any], stills: list[tuple[str, str]]) -> int:
    """About how large a page is with these."""
    texts = [each["content"] for each in maps.values()] + [text for _, text in stills]
    return sum(map(len, texts)) + _REST


def shown_size(obj: Object) -> tuple[int, int]:
    """Width and height of an object's largest map."""
    largest = max(_all_maps(obj), key=lambda one: one.width * one.height)
    return largest.width, largest.height


def _all_maps(obj: Object) -> Iterator[Map]:
    for material in (obj.material, obj.layer and obj.layer.material):
        yield from (one for _, one in (material.maps() if material else ()))


def _shrunk(obj: Object, most: int) -> Object:
    """The object with maps of at most so many texels a side, its layer's too."""
    over = obj.layer
    return replace(
        obj,
        material=_scaled(obj.material, most),
        layer=over and replace(over, material=_scaled(over.material, most)),
    )


def _scaled(material: Material, most: int) -> Material:
    """The material with maps of at most so many texels a side, each halved until it fits."""
    changed: dict[str, Map] = {}
    for name, one in material.maps():
        pixels = one.linear()
        while max(pixels.shape[:2]) > most:
            pixels = halved(pixels)
        if pixels.shape[:2] != (one.height, one.width):
            changed[name] = _stored_as(one, pixels, name == "height")
    return replace(material, **changed) if changed else material  # type: ignore[arg-type]


def _stored_as(one: Map, pixels: NDArray[np.float32], exact: bool) -> Map:
    """A scaled map with as many bits as it had, which packs better; heights keep all of theirs."""
    if exact or one.pixels.dtype != np.uint8:
        return Map(np.ascontiguousarray(pixels), False, one.source)
    codes = srgb_encode(pixels) if one.srgb else pixels
    return Map(np.rint(codes * 255.0).astype(np.uint8), one.srgb, one.source)


def _maps(obj: Object, engine: Engine) -> dict[str, Any]:
    """The finest level of each map that programs read."""
    material = obj.material
    found: dict[str, Any] = {}
    field = textures.height_field(material, "wrap")
    if field is not None:
        found["field"] = packed(as_fractions(field.levels[0]))
    for name, source, made_of, scale in surface_maps(obj):
        # a page makes the normals of heights itself
        own = name != "normal" or material.normal is not None
        map = source.texture(made_of, "wrap", scale, engine) if own else None
        if map is not None:
            found[name] = packed(map.levels[0])
    return found


def _bakes(material: Material, room: int, engine: Engine) -> dict[str, Any]:
    """What pages do not bake themselves, where it fits in so many bytes."""
    found: dict[str, Any] = {}
    height = material.height
    for name, bake in BAKES.items():
        if bake in _BAKED_BY_PAGES or height is None or room <= height.width * height.height:
            continue
        baked = textures.bake_texture(material, "wrap", bake, engine)
        assert baked is not None
        made = packed(baked.levels[0])
        if len(made["content"]) <= room:
            found[name] = made
            room -= len(made["content"])
    return found


def _stills(scene: Scene, engine: Engine, progress: Progress) -> Iterator[tuple[str, str]]:
    """Techniques and their pictures as text, for browsers without WebGPU."""
    obj = scene.objects[0]
    names = [n for n in _STILLS if n == "flat" or obj.material.height is not None]
    for number, name in enumerate(names):
        progress("drawing the still pictures", number / len(names))
        settings: Any = Nothing() if name == "flat" else {}
        shown = replace(obj, technique=name, settings=settings, heights="sharp")
        frame = render(replace(scene, objects=(shown,)), size=(400, 225), samples=4, device=engine)
        png = encode_png(frame.color[:, :, :3])
        yield name, base64.b64encode(png).decode()


# --- the page ------------------------------------------------------------------------------------


def _html(
    name: str, data: dict[str, Any], maps: dict[str, Any], stills: list[tuple[str, str]]
) -> str:
    web = files("basrelief.viewer") / "web"
    # base64 has no character that escaping would change: it is as large as before
    contents = {key: each.pop("content") for key, each in maps.items()}
    told = json.dumps({**data, "maps": maps}, separators=(",", ":"))
    return fill(
        "viewer/templates/page.html.jinja",
        generator=GENERATOR,
        title=name,
        version=__version__,
        modules={f"view/{module}.js": _module(web, module) for module in _MODULES},
        stills=stills,
        data=base64.b64encode(zlib.compress(told.encode(), 9)).decode(),
        maps=contents,
    )


def _module(web: Any, name: str) -> str:
    """A module's source as an address that holds it whole."""
    source = (web / f"{name}.js").read_bytes()
    return f"data:text/javascript;base64,{base64.b64encode(source).decode()}"
