"""Command-line options that describe materials and scenes, grouped by the panels of the help.

Most are the settings of `Object`, `Scene`, `Lengths` and `ReadOptions`, whose declarations give
names, types, help and completion; options that are no field of these are written here. An option
that is omitted is None, so that the preset's value or the library's default applies.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from basrelief.baking.files import FileOptions
from basrelief.material.options import MAPS, Lengths, ReadOptions
from basrelief.scene.objects import Object
from basrelief.scene.scene import Scene
from basrelief.settings import Setting, settings_of

__all__ = [
    "BAKE",
    "CAMERA",
    "FOG",
    "FURTHER",
    "LIGHT",
    "MAPS_OPTIONS",
    "RELIEF",
    "SURFACE",
    "with_options",
]

Options = Mapping[str, Any]
"""Annotated types of options, by the name of their keyword."""
Text = str | None
Texts = list[str] | None
_SOURCES = {1: "FILE|FOLDER|sample:NAME|NUMBER", 3: "FILE|FOLDER|sample:NAME"}
_TYPES: dict[str, Any] = {
    "choice": Text, "text": Text, "pair": Text, "triple": Text, "flag": bool | None,
    "integer": int | None, "number": float | None,
}  # fmt: skip
"""Types of options by the kind of the setting; options of other kinds are written here."""


def known_techniques() -> list[str]:
    """Names of the library's techniques, for completion."""
    from basrelief.techniques import TECHNIQUES

    return list(TECHNIQUES)


def known_presets() -> list[str]:
    """Names of the library's presets, for completion."""
    from basrelief.scene.presets import PRESETS

    return list(PRESETS)


def option_of(declared: Setting) -> Any:
    """The option of a setting, as an annotated type."""
    help = declared.doc.replace("`", "")
    if declared.choices:
        help += f": {', '.join(map(str, declared.choices))}"
    choices = [str(choice) for choice in declared.choices]
    # a choice of numbers is a number
    type_ = int | None if isinstance(next(iter(declared.choices), ""), int) else None
    names = (declared.option,) if declared.kind == "flag" else ()
    completion = (lambda: list(choices)) if choices else None
    return Annotated[
        type_ or _TYPES[declared.kind],
        typer.Option(
            *names,
            help=f"{help}.",
            metavar=declared.spelling or None,
            autocompletion=known_techniques if declared.name == "technique" else completion,
        ),
    ]


def _options_of(*records: type, group: str) -> dict[str, Any]:
    """The options of the settings of records in a group."""
    return {
        name: option_of(declared)
        for record in records
        for name, declared in settings_of(record).items()
        if declared.group == group and declared.kind in _TYPES
    }


def _text(help: str, metavar: str) -> Any:
    return Annotated[Text, typer.Option(help=help, metavar=metavar)]


def _texts(
    help: str, metavar: str, *names: str, completion: Callable[[], list[str]] | None = None
) -> Any:
    option = typer.Option(*names, help=help, metavar=metavar, autocompletion=completion)
    return Annotated[Texts, option]


def _light_kinds() -> list[str]:
    # imported here, since help does not need it
    from basrelief.scene.lights import LIGHTS

    return [*LIGHTS]


RELIEF: Options = {
    "preset": Annotated[
        Text,
        typer.Option(
            help="Settings of an article, or of your own file.",
            metavar="NAME|FILE.toml",
            autocompletion=known_presets,
        ),
    ],
    **_options_of(Object, group="Relief"),
    "settings": _texts("Set a number that `techniques` lists; repeatable.", "NAME=VALUE", "--set"),
    "stretch": _text("Scale the shape along the world's axes.", "X,Y,Z"),
    "turn": _text("Rotate the shape; x/90 makes a plane a wall.", "AXIS/DEGREES"),
}
SURFACE: Options = {
    **_options_of(Object, group="Surface"),
    "map_tiling": _texts("Tiles of one map: base_color, normal, response, emission.", "MAP=UxV"),
    "map_shift": _texts("Shift of one map, in its tiles.", "MAP=U,V"),
    "layer": _text("Second material over the first.", "FOLDER|sample:NAME"),
    "layer_tiling": _text("Tiles of the layer (10x10).", "UxV"),
    "layer_shift": _text("Shift of the layer, in its tiles.", "U,V"),
}
LIGHT: Options = {
    "lights": _texts(
        "Light: directional, azimuth=-50, elevation=35 · point, position=1/1/1, falloff=1 · "
        "spot, position=1/2/1, angle=30; all also color=1/1/1, intensity=2; repeatable; or none.",
        "KIND,NAME=VALUE…",
        "--light",
        completion=_light_kinds,
    ),
    **_options_of(Object, Scene, group="Light"),
}
FOG: Options = _options_of(Scene, group="Fog")
CAMERA: Options = {
    "camera": _text(
        "Camera: azimuth=30, elevation=35, distance=2, field_of_view=30 · position=1/1/1, "
        "target=0/0/0 · orthographic_height=1.",
        "NAME=VALUE,…",
    ),
}
MAPS_OPTIONS: Options = {
    **_options_of(Lengths, ReadOptions, group="Maps"),
    **{
        name: Annotated[
            Path | None,
            typer.Option(help=f"{kind.doc.capitalize()}.", metavar=_SOURCES[kind.channels]),
        ]
        for name, kind in MAPS.items()
    },
}
FURTHER: Options = {
    "add": _texts(
        "Add an object: sphere, position=0/0.1/0, size=0.3, turn=x/30, material=sample:tiles, "
        "color=1/0.5/0.2, technique=relief, max_steps=32, layer=sample:grid, layer_tiling=10x10, "
        "normal_tiling=2x3; repeatable.",
        "SHAPE,NAME=VALUE…",
    ),
}
BAKE: Options = {
    **{name: RELIEF[name] for name in ("preset", "scale", "edge", "opening")},
    **_options_of(FileOptions, group="Bake"),
}
_PANELS = (
    ("Relief", RELIEF), ("Bake", BAKE), ("Surface", SURFACE), ("Light", LIGHT),
    ("Fog and background", FOG),
    ("Camera", CAMERA), ("Maps", MAPS_OPTIONS), ("Further objects", FURTHER),
)  # fmt: skip


def with_options(
    *groups: Any, omit: tuple[str, ...] = ()
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Decorator that adds the options of groups to a command, which gets them as keywords.

    `...` is the place of the command's own options. Options of a group that have the name of one of
    these are omitted, and so are those in `omit`.
    """

    def wrap(command: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(command, eval_str=True)
        declared = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        own = {p.name for p in declared}
        parameters = [p for p in declared if p.default is p.empty]
        for group in groups:
            if group is ...:
                parameters += [p for p in declared if p.default is not p.empty]
            else:
                parameters += [p for p in _parameters(group) if p.name not in {*own, *omit}]

        @functools.wraps(command)
        def wrapped(**values: Any) -> None:
            command(**values)

        wrapped.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [p.replace(kind=p.KEYWORD_ONLY) for p in parameters]
        )
        wrapped.__annotations__ = {p.name: p.annotation for p in parameters}
        return wrapped

    return wrap


def _parameters(group: Options) -> list[inspect.Parameter]:
    """Options of a group as parameters."""
    panel = next(title for title, options in _PANELS if options is group)
    parameters = []
    for name, annotation in group.items():
        annotation.__metadata__[0].rich_help_panel = panel
        kind = inspect.Parameter.KEYWORD_ONLY
        parameters.append(inspect.Parameter(name, kind, default=None, annotation=annotation))
    return parameters
