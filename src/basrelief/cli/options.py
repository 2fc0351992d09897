"""The options of the command line that describe materials and scenes, by the panels of its help.

Each class is a panel: a name, its type, what it means. None is what stays where an option is not
given, so that a preset can say it, and where it does not, the library's default holds.
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
    "taking",
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
    """How the relief is drawn."""

    preset: Annotated[Text, _option("An article's settings, or your own file.", "NAME|FILE.toml")]
    technique: Annotated[Text, _option("The technique, or one of your own.", "NAME|FILE.py:NAME")]
    settings: Annotated[
        Texts, _option("A number that `techniques` lists; repeat.", "NAME=VALUE", "--set")
    ]
    scale: Annotated[Number, _option("Depth as a fraction of a tile's width.")]
    reference_height: Annotated[
        Number, _option("The height on the polygon: 1 pushes the relief in.")
    ]
    projection: Annotated[Text, _option("full, biased or limited.")]
    heights: Annotated[Text, _choice(kinds.HeightsKind, "How they are read: ")]
    fade: Annotated[Text, _option("Whole up to a distance, gone from another.", "NEAR,FAR")]
    edge: Annotated[Text, _choice(kinds.EdgeKind, "Beyond the map: ")]
    shape: Annotated[Text, _choice(kinds.ShapeKind)]
    stretch: Annotated[Text, _option("Stretch the shape along the world's axes.", "X,Y,Z")]


class Surface:
    """What the relief is covered with."""

    surface: Annotated[Text, _choice(kinds.SurfaceKind)]
    tiling: Annotated[Text, _option("Tiles along u and v.", "UxV")]
    shift: Annotated[Text, _option("Move all maps, in tiles.", "U,V")]
    map_tiling: Annotated[
        Texts, _option("One map's own: base_color, normal, response, emission.", "MAP=UxV")
    ]
    map_shift: Annotated[Texts, _option("Move one map, in its tiles.", "MAP=U,V")]
    mapping: Annotated[Text, _option("Colour laid on: planar, triplanar.")]
    alpha: Annotated[Text, _choice(kinds.AlphaKind, "What opacity means: ")]
    layer: Annotated[Text, _option("A second material over it.", "FOLDER|sample:NAME")]
    layer_tiling: Annotated[Text, _option("Its tiles (10x10).", "UxV")]
    layer_shift: Annotated[Text, _option("Move it, in its tiles.", "U,V")]


class Light:
    """Lights, shadows and fog."""

    lights: Annotated[
        Texts,
        _option(
            "directional, azimuth=-50, elevation=35 · point, position=1/1/1, falloff=1 · spot, "
            "position=1/2/1, angle=30; each also color=1/1/1, intensity=2; repeat; or none.",
            "KIND,NAME=VALUE…",
            "--light",
        ),
    ]
    shading_model: Annotated[Text, _choice(kinds.ShadingModel)]
    shadows: Annotated[Text, _choice(kinds.ShadowsKind)]
    shadows_on: Annotated[Text, _choice(kinds.ShadowsOnKind, "Shadows of other objects land on: ")]
    casts: Annotated[Text, _choice(kinds.CastsKind, "What throws a shadow: ")]
    occlusion_kind: Annotated[Text, _option("It acts on: ambient light, or every (directional).")]
    fog_mode: Annotated[Text, _choice(kinds.FogKind)]
    background: Annotated[Text, _option("A linear colour, or none.", "R,G,B")]


class Camera:
    """Where the picture is taken from."""

    camera: Annotated[
        Text,
        _option(
            "azimuth=30, elevation=35, distance=2, field_of_view=30 · position=1/1/1, "
            "target=0/0/0 · orthographic_height=1.",
            "NAME=VALUE,…",
        ),
    ]


class Maps:
    """Where a material's maps are, and how they are read."""

    depth: Annotated[Number, _option("How deep the heights reach, in metres.")]
    tile: Annotated[Number, _option("How wide a tile is, in metres.")]
    normal_convention: Annotated[Text, _option("Green is: auto, gl (up) or dx.")]
    normal_packing: Annotated[Text, _option("Stored in: rgb, ag, rg or ag_or_rgb.")]
    height_polarity: Annotated[Text, _option("White is: auto, height (high) or depth.")]
    height_channel: Annotated[Text, _option("auto, r, g, b, a, a_or_r or luminance.")]
    stretch_height: Annotated[
        bool | None, typer.Option("--stretch-height", help="Spread the heights over 0 to 1.")
    ]
    base_color: Annotated[Path | None, _option("Colour, and opacity in its alpha.", _FILE)]
    normal: Annotated[Path | None, _option("Normals.", _FILE)]
    height: Annotated[Path | None, _option("Heights.", _FILE)]
    occlusion: Annotated[Path | None, _option("Occlusion.", _FILE)]
    roughness: Annotated[Path | None, _option("Roughness.", _FILE)]
    metallic: Annotated[Path | None, _option("Metal or not.", _FILE)]
    emission: Annotated[Path | None, _option("Light sent out.", _FILE)]
    opacity: Annotated[Path | None, _option("Opacity.", _FILE)]
    layer_mask: Annotated[Path | None, _option("Where the second layer is.", _FILE)]


class Further:
    """What else stands in the picture."""

    add: Annotated[
        Texts,
        _option(
            "sphere, position=0/0.1/0, size=0.3, turn=x/30, material=sample:tiles, "
            "color=1/0.5/0.2, technique=relief, scale=0.05; repeat.",
            "SHAPE,NAME=VALUE…",
        ),
    ]


def _flag(name: str, help: str) -> Any:
    return Annotated[bool | None, typer.Option(f"--{name.replace('_', '-')}", help=help)]


class Bakes:
    """What is baked."""

    __annotations__ = {name: _flag(name, each.help) for name, each in OPTIONS.items()}


class Sources:
    """Where the maps are that are baked from, and how they are read."""

    depth: Annotated[Number, _option("How deep the heights reach, in metres.")]
    tile: Annotated[Number, _option("How wide a tile is, in metres.")]
    height_map: Annotated[Path | None, _option("Heights.", _FILE)]
    normal_map: Annotated[Path | None, _option("Normals.", _FILE)]
    normal_convention: Annotated[Text, _option("Their green is: auto, gl (up) or dx.")]
    normal_packing: Annotated[Text, _option("Stored in: rgb, ag, rg or ag_or_rgb.")]
    height_polarity: Annotated[Text, _option("White is: auto, height (high) or depth.")]
    height_channel: Annotated[Text, _option("auto, r, g, b, a, a_or_r or luminance.")]
    stretch_height: Annotated[
        bool | None, typer.Option("--stretch-height", help="Spread the heights over 0 to 1.")
    ]


_PANELS: dict[type[Any], str] = {Maps: "Maps", Further: "Further objects"}


def names_of(group: type[Any]) -> tuple[str, ...]:
    """The names of a group's options."""
    return tuple(inspect.get_annotations(group))


def taking(*groups: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command that takes `**given` the options of groups; `...` stands for its own."""

    def wrap(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command, eval_str=True)
        plain = [p for p in own.parameters.values() if p.kind is not p.VAR_KEYWORD]
        arguments = [p for p in plain if p.default is p.empty]
        options = [p for p in plain if p.default is not p.empty]
        made = [*arguments]
        for group in groups:
            made += options if group is ... else _parameters(group)

        @functools.wraps(command)
        def called(**given: Any) -> None:
            command(**given)

        called.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [p.replace(kind=p.KEYWORD_ONLY) for p in made]
        )
        called.__annotations__ = {p.name: p.annotation for p in made}
        return called

    return wrap


def _parameters(group: type[Any]) -> list[inspect.Parameter]:
    """A group's options as parameters; each class is imported whole, so its types are known."""
    made = []
    for name, annotation in get_type_hints(group, include_extras=True).items():
        annotation.__metadata__[0].rich_help_panel = _PANELS.get(group, group.__name__)
        made.append(
            inspect.Parameter(
                name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation
            )
        )
    return made
