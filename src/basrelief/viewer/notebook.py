"""The viewer in a notebook: the page of `basrelief view` as a widget, live from Python.

    viewer = Viewer("FOLDER", scale=0.08)
    viewer                              # the page
    viewer.technique = "offset"         # changes the picture
    viewer.camera                       # the camera, as moved by the mouse
    basrelief.render(viewer.scene())    # the same picture

In Jupyter and in marimo, by anywidget (the extra `notebook`).
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from basrelief.engine import Engine
from basrelief.errors import InputError, suggestion
from basrelief.material import Material
from basrelief.rendering.render import scene_of
from basrelief.scene import SURFACES, Object, Orbit, Scene
from basrelief.scene.checks import check_range, check_setting
from basrelief.scene.motion import Scrolling
from basrelief.scene.recipe import Recipe
from basrelief.scene.records import settings_record
from basrelief.scene.resolve import check_opening, default_tiles
from basrelief.settings import check_choice
from basrelief.settings import settings_of as declarations
from basrelief.shading.brdf import Shading
from basrelief.shading.fog import Fog
from basrelief.shading.lights import Light
from basrelief.shading.self_shadow import Shadowing
from basrelief.techniques.height import Smoothing
from basrelief.viewer.layouts import json_value
from basrelief.viewer.page import Progress, page_of
from basrelief.viewer.printed import MENUS
from basrelief.viewer.shown import as_light_dict, camera_of, scene_from_state, tiling_of
from basrelief.viewer.state import (
    SHOWS,
    check_drawable,
    state_of,
    techniques_of,
    tiling_to_dict,
)

try:
    import anywidget
    import traitlets
except ImportError:
    raise InputError(
        "the viewer in a notebook needs anywidget; pip install 'basrelief[notebook]'"
    ) from None

__all__ = ["Viewer"]

_RECORDS = {"shading": Shading, "shadowing": Shadowing, "smoothing": Smoothing}


class _Setting(traitlets.TraitType):
    """A trait whose values pass through its check: `check(viewer, name, value)`.

    The check runs whenever a value is set, also while notifications are held.
    """

    def __init__(self, check: Callable[[Any, str, Any], Any]) -> None:
        super().__init__()
        self.check = check

    def validate(self, viewer: Any, value: Any) -> Any:
        return self.check(viewer, str(self.name), value)

    def get(self, viewer: Any, cls: Any = None) -> Any:
        """A copy, since changes in place would have no effect."""
        return copy.deepcopy(super().get(viewer, cls))


# --- checks: the library's own -------------------------------------------------------------------


def _choice(viewer: Viewer, name: str, value: Any) -> Any:
    check_choice(name, value, MENUS[name])
    return value


def _technique(viewer: Viewer, name: str, value: Any) -> Any:
    check_choice(name, value, tuple(viewer._techniques))
    Object(viewer._material, technique=viewer._techniques[value])
    return value


def _other_technique(viewer: Viewer, name: str, value: Any) -> Any:
    return "" if value in (None, "") else _technique(viewer, name, value)


def _scroll(viewer: Viewer, name: str, value: Any) -> Any:
    speed = Scrolling(*_two_numbers(name, value))
    return speed.u, speed.v


def _show(viewer: Viewer, name: str, value: Any) -> Any:
    check_choice(name, value, SHOWS)
    if value == "missed":
        _technique(viewer, "technique", "exact")
    return value


def _number(viewer: Viewer, name: str, value: Any) -> float:
    check_setting(replace(declarations(Object)[name], optional=False), value)
    return float(value)


def _opening(viewer: Viewer, name: str, value: Any) -> float | None:
    check_setting(declarations(Object)[name], value)
    check_opening(viewer._material, value)
    return None if value is None else float(value)


def _share(viewer: Viewer, name: str, value: Any) -> float:
    check_range(name, value, 0.0, 1.0)
    return float(value)


def _pixels(viewer: Viewer, name: str, value: Any) -> int:
    return _whole(name, value, 100, 10_000)


def _whole(name: str, value: Any, low: int, high: int | None) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise InputError(f"{name} is {value!r}: give a whole number")
    check_range(name, int(value), low, high)
    return int(value)


def _pair(viewer: Viewer, name: str, value: Any) -> Any:
    pair = _two_numbers(name, value)
    return getattr(Object(viewer._material, **{name: pair}), name)


def _two_numbers(name: str, value: Any) -> Any:
    try:
        u, v = map(float, value)
    except (TypeError, ValueError):
        raise InputError(f"{name} is {value!r}: give two numbers") from None
    return u, v


def _record(viewer: Viewer, name: str, value: Any) -> Any:
    return json_value(settings_record(_RECORDS[name], value, f"the {name}"))


def _fog(viewer: Viewer, name: str, value: Any) -> Any:
    fog = settings_record(Fog, value, "the fog")
    if fog.fog_start > fog.fog_end:
        raise InputError(
            f"fog from {fog.fog_start:g} to {fog.fog_end:g}: "
            "give a fog_end no nearer than fog_start"
        )
    return json_value(fog)


def _settings(viewer: Viewer, name: str, value: Any) -> Any:
    return viewer._settings_checked(viewer.technique, value)


def _settings_of(viewer: Viewer, name: str, value: Any) -> dict[str, Any]:
    return _checked_records(
        name, value, viewer._all_settings, viewer._settings_checked, "technique"
    )


def _surface_parameters(viewer: Viewer, name: str, value: Any) -> Any:
    return _surface_parameters_checked(viewer.surface, value)


def _all_surface_parameters(viewer: Viewer, name: str, value: Any) -> dict[str, Any]:
    return _checked_records(
        name, value, viewer._all_surface_parameters_sent, _surface_parameters_checked, "surface"
    )


def _surface_parameters_checked(surface: str, value: Any) -> Any:
    return json_value(settings_record(SURFACES[surface], value, f"the {surface} surface"))


def _checked_records(
    name: str, value: Any, current: Mapping[str, Any], check: Callable[[str, Any], Any], what: str
) -> dict[str, Any]:
    """Checked records by name; names that are missing keep their current records."""
    if not isinstance(value, Mapping):
        raise InputError(f"{name} is {value!r}: give numbers by the name of their {what}")
    for key in value:
        check_choice(what, key, tuple(current))
    return {**current, **{key: check(key, numbers) for key, numbers in value.items()}}


def _flag(viewer: Viewer, name: str, value: Any) -> bool:
    check_choice(name, value, (True, False))
    return bool(value)


def _layer(viewer: Viewer, name: str, value: Any) -> bool:
    if _flag(viewer, name, value) and viewer._original.objects[0].layer is None:
        raise InputError("layer is True: there is none; make the viewer of a scene with a layer")
    return bool(value)


def _background(viewer: Viewer, name: str, value: Any) -> Any:
    try:
        color: Any = tuple(map(float, value))
    except (TypeError, ValueError):
        raise InputError(f"{name} is {value!r}: give three numbers") from None
    return Scene((), background=color).background


def _tiling(viewer: Viewer, name: str, value: Any) -> dict[str, Any]:
    return tiling_to_dict(tiling_of(value))


def _tilings(viewer: Viewer, name: str, value: Any) -> dict[str, Any]:
    return _checked_records(
        name, value, viewer._all_tilings, lambda _, tiling: _tiling(viewer, "", tiling), "map"
    )


def _lights(viewer: Viewer, name: str, value: Any) -> list[dict[str, Any]]:
    if isinstance(value, Light):
        value = (value,)
    if isinstance(value, str | Mapping) or not hasattr(value, "__iter__"):
        raise InputError(f"lights is {value!r}: give several, as (basrelief.directional(),)")
    return [as_light_dict(light) for light in value]


def _camera(viewer: Viewer, name: str, value: Any) -> Orbit:
    return camera_of(value)


def _shared(check: Callable[[Any, str, Any], Any], **metadata: Any) -> Any:
    """A setting that the page and Python share."""
    return _Setting(check).tag(sync=True, **metadata)


# --- the widget ----------------------------------------------------------------------------------

_CHECKS = {"choice": _choice, "number": _number, "pair": _pair, "numbers": _record}
_Declared: Any = type(
    "_Declared",
    (anywidget.AnyWidget,),
    {
        name: _shared(_CHECKS[declared.kind])
        for record in (Object, Scene)
        for name, declared in declarations(record).items()
        if declared.kind in _CHECKS and (declared.kind != "choice" or name in MENUS)
    },
)
"""The base of the viewer, with the settings of `Object` and `Scene` by their kinds."""


class Viewer(_Declared):
    """The viewer's page as a widget in a notebook.

    Page and Python share all settings. Every setting is an attribute that is checked when it is
    set, and that `observe` and marimo follow. As in the page, a change of the technique sets its
    own reference height and projection, a change of the shape its own tiling.

    Parameters
    ----------
    what : Scene, Object, Material or path
        The scene, or what to make it of, as in `basrelief.render`.
    texels : int
        Largest side of the page's maps, in texels.
    height : int
        Height of the widget in pixels of the screen, 100 to 10000.
    compare : str
        A second technique, right of the divider, or "".
    show : {"color", "reads", "missed", "depth"}
        The picture to show.
    device : str or Engine
        "auto", "cpu" or "gpu", or an engine, for bakes and still pictures.
    progress : callable, optional
        Called with the current task and the finished share, 0 to 1.
    **settings
        Options of `basrelief.render` that describe the scene.

    Attributes
    ----------
    technique, shape, projection, heights, edge, mapping, alpha, surface, layer_offset : str
        Choices of the object.
    shadows, shading_model, occlusion_kind, fog_mode : str
        Choices of the scene.
    scale, reference_height, bias, divider : float
        Numbers of the relief, and the position of the divider, 0 to 1.
    tiling, shift, fade : (float, float)
        Tiles, shift in tiles, and distances of the fade, which applies where `fades` is True.
    opening : float or None
        Opening of a hole, 0 to 1; None for none.
    settings, surface_parameters, smoothing, shading, shadowing, fog : mapping
        Records; set by a mapping of values that differ from the defaults, read as a whole.
    settings_of, all_surface_parameters : mapping
        Settings of all techniques, and surface parameters of all surfaces, by name.
    tilings, layer_tiling : mapping
        Tilings of single maps, which apply where `apart` is True, and of the layer, which is shown
        where `layer` is True; set by `Tiling`s, read as mappings.
    background : (float, float, float)
        A linear colour.
    camera : Orbit
        The camera.
    lights : list
        Lights; set by lights, read as mappings.
    compare, show : str
        As above.
    scroll : (float, float)
        Speed at which the page scrolls all maps, as for `Scrolling`; (0, 0) for a still picture.

    Raises
    ------
    InputError
        For a value that a setting cannot have, and a scene that the page cannot draw.
    """

    _esm = (files("basrelief.viewer") / "web" / "widget.js").read_text("utf-8")
    _page = traitlets.Bytes().tag(sync=True)
    height = _shared(_pixels)

    technique = _shared(_technique)
    settings = _Setting(_settings)
    settings_of = _shared(_settings_of)
    surface_parameters = _Setting(_surface_parameters)
    all_surface_parameters = _shared(_all_surface_parameters)
    opening = _shared(_opening)
    fog = _shared(_fog)
    fades = _shared(_flag)
    apart = _shared(_flag)
    tilings = _shared(_tilings)
    layer = _shared(_layer)
    layer_tiling = _shared(_tiling)
    background = _shared(_background)
    lights = _shared(_lights)
    camera = _shared(_camera, to_json=lambda camera, viewer: asdict(camera))
    compare = _shared(_other_technique)
    divider = _shared(_share)
    show = _shared(_show)
    scroll = _shared(_scroll)

    def __init__(
        self,
        what: Scene | Object | Material | str | Path,
        *,
        texels: int = 512,
        height: int = 560,
        compare: str = "",
        show: str = "color",
        device: str | Engine = "auto",
        progress: Progress | None = None,
        **settings: Any,
    ) -> None:
        scene = scene_of(what, settings)
        check_drawable(scene)
        texels = _whole("texels", texels, 1, None)
        height = _whole("height", height, 100, 10_000)
        obj = scene.objects[0]
        self._material = obj.material
        self._original = scene
        self._techniques = techniques_of(obj)
        self._received: frozenset[str] = frozenset()
        state = state_of(scene, obj)
        self._all_settings = state.pop("settings")
        self._all_surface_parameters_sent = state.pop("surface_parameters")
        self._all_tilings = state["tilings"]
        page = page_of(scene, texels, device, progress or (lambda what, share: None))
        super().__init__(
            _page=page.html.encode(),
            height=height,
            compare=compare,
            show=show,
            divider=0.5,
            scroll=(0.0, 0.0),
            settings_of=self._all_settings,
            all_surface_parameters=self._all_surface_parameters_sent,
            **state,
        )
        self.settings = self.settings_of[self.technique]
        self.surface_parameters = self.all_surface_parameters[self.surface]
        self._follow()

    def __setattr__(self, name: str, value: Any) -> None:
        # the base class may replace its own methods
        method = name == "observe" or callable(vars(Viewer).get(name))
        if not name.startswith("_") and (method or not hasattr(type(self), name)):
            names = sorted(n for n, trait in self.traits().items() if isinstance(trait, _Setting))
            hint = suggestion(name, names, "it has")
            raise InputError(f"a viewer has no setting {name!r}; {hint}")
        super().__setattr__(name, value)

    def scene(self) -> Scene:
        """The scene that the page shows, for example for `basrelief.render(viewer.scene())`.

        Its material is that of the viewer with its maps at full size, without maps that were
        dropped on the page.

        Returns
        -------
        Scene
        """
        names = state_of(self._original, self._original.objects[0])
        state = {name: getattr(self, name) for name in names}
        both = {"settings": self.settings_of, "surface_parameters": self.all_surface_parameters}
        return scene_from_state({**state, **both}, self._original)

    @property
    def command(self) -> str:
        """The command line that draws the picture of the page again."""
        return Recipe(self.scene()).command

    @property
    def python(self) -> str:
        """The line of Python that draws the picture of the page again."""
        return Recipe(self.scene()).python

    def _settings_checked(self, technique: str, value: Any) -> Any:
        return json_value(settings_record(self._techniques[technique].settings, value, technique))

    def set_state(self, sync_data: Mapping[str, Any]) -> None:
        """Apply settings of the page; invalid ones are sent back with their current values."""
        self._received = frozenset(sync_data)
        refused: dict[str, InputError] = {}
        try:
            for name, value in sync_data.items():
                try:
                    super().set_state({name: value})
                except InputError as error:
                    refused[name] = error
        finally:
            self._received = frozenset()
        if refused:
            self.send_state([*refused])
            raise next(iter(refused.values()))

    def _follow(self) -> None:
        """Keep dependent settings consistent; the page has done so for settings that it sends."""
        for name in (
            "technique", "shape", "settings", "settings_of", "surface", "surface_parameters",
            "all_surface_parameters", "tilings",
        ):  # fmt: skip
            self.observe(getattr(self, f"_follow_{name}"), name)

    def _follow_technique(self, change: Any) -> None:
        if "technique" not in self._received:
            technique = self._techniques[self.technique]
            self.reference_height, self.projection = (
                technique.reference_height,
                technique.projection,
            )
        self.settings = self.settings_of[self.technique]

    def _follow_shape(self, change: Any) -> None:
        if "shape" not in self._received:
            self.tiling = default_tiles(self.shape, self._material)
            self.camera = replace(self.camera, distance=None, target=(0.0, 0.0, 0.0))

    def _follow_settings(self, change: Any) -> None:
        self.settings_of = {self.technique: self.settings}

    def _follow_settings_of(self, change: Any) -> None:
        self._all_settings = self.settings_of
        self.settings = self.settings_of[self.technique]

    def _follow_surface(self, change: Any) -> None:
        self.surface_parameters = self.all_surface_parameters[self.surface]

    def _follow_surface_parameters(self, change: Any) -> None:
        self.all_surface_parameters = {self.surface: self.surface_parameters}

    def _follow_all_surface_parameters(self, change: Any) -> None:
        self._all_surface_parameters_sent = self.all_surface_parameters
        self.surface_parameters = self.all_surface_parameters[self.surface]

    def _follow_tilings(self, change: Any) -> None:
        self._all_tilings = self.tilings
