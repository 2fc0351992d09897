"""Command-line options that describe materials and scenes, grouped by the panels of the help.

Each class is a panel whose fields are options with their types and help. An option that is not
given is None, so that the preset's value or the library's default applies.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, get_args, get_type_hints

import typer

from basrelief.baking.files import OPTIONS
from basrelief.shading import kinds

__all__ = [
    "Bakes",
    "Camera",
    "Further",
    "Light",
    "Maps",
    "Relief",
    "Sources",
    "Surface",
    "names_of",
    "with_options",
]

Text = str | None
Number = float | None
Texts = list[str] | None
_FILE = "FILE|sample:NAME"


def _option(help: str, metavar: str | None = None, name: str | None = None) -> Any:
    names = () if name is None else (name,)
    return typer.Option(*names, help=help, metavar=metavar)


def _choice(kind: Any, lead: str = "") -> Any:
    return _option(f"{lead}{kinds.either(get_args(kind))}.")


class Relief:
    """Options of the relief."""

    preset: Annotated[
        Text, _option("Settings of an article, or of your own file.", "NAME|FILE.toml")
    ]
    technique: Annotated[
        Text, _option("Technique of the library, or your own.", "NAME|FILE.py:NAME")
    ]
    settings: Annotated[
        Texts, _option("Set a number that `techniques` lists; repeatable.", "NAME=VALUE", "--set")
    ]
    scale: Annotated[Number, _option("Height range as a fraction of a tile's width.")]
    reference_height: Annotated[
        Number, _option("Height that lies on the polygon; 1 pushes the relief in.")
    ]
    projection: Annotated[Text, _option("Projection of the view ray: full, biased or limited.")]
    heights: Annotated[Text, _choice(kinds.HeightsKind, "Filter of the heights: ")]
    fade: Annotated[
        Text, _option("Distances at which the relief starts to fade and is gone.", "NEAR,FAR")
    ]
    edge: Annotated[Text, _choice(kinds.EdgeKind, "Beyond the edge of a map: ")]
    shape: Annotated[Text, _choice(kinds.ShapeKind, "Shape of the object: ")]
    stretch: Annotated[Text, _option("Scale the shape along the world's axes.", "X,Y,Z")]


class Surface:
    """Options of the surface."""

    surface: Annotated[Text, _choice(kinds.SurfaceKind, "Surface model: ")]
    tiling: Annotated[Text, _option("Tiles along u and v.", "UxV")]
    shift: Annotated[Text, _option("Offset of all maps, in tiles.", "U,V")]
    map_tiling: Annotated[
        Texts, _option("Tiles of one map: base_color, normal, response or emission.", "MAP=UxV")
    ]
    map_shift: Annotated[Texts, _option("Offset of one map, in its tiles.", "MAP=U,V")]
    mapping: Annotated[Text, _option("Mapping of the colour: planar or triplanar.")]
    alpha: Annotated[Text, _choice(kinds.AlphaKind, "Use of the opacity: ")]
    layer: Annotated[Text, _option("Second material over the first.", "FOLDER|sample:NAME")]
    layer_tiling: Annotated[Text, _option("Tiles of the layer (10x10).", "UxV")]
    layer_shift: Annotated[Text, _option("Offset of the layer, in its tiles.", "U,V")]


class Light:
    """Lights, shadows and fog."""

    lights: Annotated[
        Texts,
        _option(
            "Light: directional, azimuth=-50, elevation=35 · point, position=1/1/1, falloff=1 · "
            "spot, position=1/2/1, angle=30; all also color=1/1/1, intensity=2; repeatable; or "
            "none.",
            "KIND,NAME=VALUE…",
            "--light",
        ),
    ]
    shading_model: Annotated[Text, _choice(kinds.ShadingModel, "Shading model: ")]
    shadows: Annotated[Text, _choice(kinds.ShadowsKind, "Shadows: ")]
    shadows_on: Annotated[
        Text, _choice(kinds.ShadowsOnKind, "Where shadows of other objects land: ")
    ]
    casts: Annotated[Text, _choice(kinds.CastsKind, "Shadow caster: ")]
    occlusion_kind: Annotated[
        Text, _option("Light that occlusion darkens: ambient, or directional.")
    ]
    fog_mode: Annotated[Text, _choice(kinds.FogKind, "Fog: ")]
    background: Annotated[Text, _option("Background: a linear colour, or none.", "R,G,B")]


class Camera:
    """Options of the camera."""

    camera: Annotated[
        Text,
        _option(
            "Camera: azimuth=30, elevation=35, distance=2, field_of_view=30 · position=1/1/1, "
            "target=0/0/0 · orthographic_height=1.",
            "NAME=VALUE,…",
        ),
    ]


class Maps:
    """Files of a material's maps, and how to read them."""

    depth: Annotated[Number, _option("Height range, in metres.")]
    tile: Annotated[Number, _option("Width of a tile, in metres.")]
    normal_convention: Annotated[Text, _option("Green of normal maps: auto, gl (up) or dx (down).")]
    normal_packing: Annotated[Text, _option("Channels of normals: rgb, ag, rg or ag_or_rgb.")]
    height_polarity: Annotated[Text, _option("White of height maps: auto, height or depth.")]
    height_channel: Annotated[Text, _option("Channel: auto, r, g, b, a, a_or_r or luminance.")]
    stretch_height: Annotated[
        bool | None, typer.Option("--stretch-height", help="Stretch the heights to 0 to 1.")
    ]
    base_color: Annotated[
        Path | None, _option("Base colour map, with opacity in its alpha.", _FILE)
    ]
    normal: Annotated[Path | None, _option("Normal map.", _FILE)]
    height: Annotated[Path | None, _option("Height map.", _FILE)]
    occlusion: Annotated[Path | None, _option("Ambient occlusion map.", _FILE)]
    roughness: Annotated[Path | None, _option("Roughness map.", _FILE)]
    metallic: Annotated[Path | None, _option("Metallic map.", _FILE)]
    emission: Annotated[Path | None, _option("Emission map.", _FILE)]
    opacity: Annotated[Path | None, _option("Opacity map.", _FILE)]
    layer_mask: Annotated[Path | None, _option("Mask of the second layer.", _FILE)]


class Further:
    """Further objects in the picture."""

    add: Annotated[
        Texts,
        _option(
            "Add an object: sphere, position=0/0.1/0, size=0.3, turn=x/30, material=sample:tiles, "
            "color=1/0.5/0.2, technique=relief, scale=0.05; repeatable.",
            "SHAPE,NAME=VALUE…",
        ),
    ]


def _flag(name: str, help: str) -> Any:
    return Annotated[bool | None, typer.Option(f"--{name.replace('_', '-')}", help=help)]


class Bakes:
    """The bakes to make."""

    __annotations__ = {name: _flag(name, option.help) for name, option in OPTIONS.items()}


class Sources:
    """Files of the maps to bake from, and how to read them."""

    depth: Annotated[Number, _option("Height range, in metres.")]
    tile: Annotated[Number, _option("Width of a tile, in metres.")]
    height_map: Annotated[Path | None, _option("Height map.", _FILE)]
    normal_map: Annotated[Path | None, _option("Normal map.", _FILE)]
    normal_convention: Annotated[Text, _option("Green of normal maps: auto, gl (up) or dx (down).")]
    normal_packing: Annotated[Text, _option("Channels of normals: rgb, ag, rg or ag_or_rgb.")]
    height_polarity: Annotated[Text, _option("White of height maps: auto, height or depth.")]
    height_channel: Annotated[Text, _option("Channel: auto, r, g, b, a, a_or_r or luminance.")]
    stretch_height: Annotated[
        bool | None, typer.Option("--stretch-height", help="Stretch the heights to 0 to 1.")
    ]


_PANELS: dict[type[Any], str] = {Maps: "Maps", Further: "Further objects"}


def names_of(group: type[Any]) -> tuple[str, ...]:
    """Names of a group's options."""
    return tuple(inspect.get_annotations(group))


def with_options(*groups: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of groups, passed as keywords; `...` stands for its own."""

    def wrap(command: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(command, eval_str=True)
        declared = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        arguments = [p for p in declared if p.default is p.empty]
        own_options = [p for p in declared if p.default is not p.empty]
        parameters = [*arguments]
        for group in groups:
            parameters += own_options if group is ... else _parameters(group)

        @functools.wraps(command)
        def wrapped(**values: Any) -> None:
            command(**values)

        wrapped.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [p.replace(kind=p.KEYWORD_ONLY) for p in parameters]
        )
        wrapped.__annotations__ = {p.name: p.annotation for p in parameters}
        return wrapped

    return wrap


def _parameters(group: type[Any]) -> list[inspect.Parameter]:
    """Options of a group as parameters."""
    parameters = []
    for name, annotation in get_type_hints(group, include_extras=True).items():
        annotation.__metadata__[0].rich_help_panel = _PANELS.get(group, group.__name__)
        parameters.append(
            inspect.Parameter(
                name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation
            )
        )
    return parameters
