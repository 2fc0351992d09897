"""The viewer in a notebook: the page of `basrelief view` as a widget, live from Python.

    viewer = Viewer("FOLDER", scale=0.08)
    viewer                              # the page
    viewer.technique = "offset"         # changes the picture
    viewer.camera                       # where the mouse has left it
    basrelief.render(viewer.scene())    # the same picture

In Jupyter and in marimo, by anywidget (the extra `notebook`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from basrelief.engine import Engine
from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.rendering import scene_of
from basrelief.scene import Object, Orbit, Scene
from basrelief.scene.checks import one_of, record_of, within
from basrelief.shaders.lighting import Shading
from basrelief.shaders.shadow import Shadowing
from basrelief.shaders.surfaces.standard import Finish
from basrelief.shaders.techniques import TECHNIQUES
from basrelief.viewer.layouts import plain
from basrelief.viewer.page import Progress, page_of
from basrelief.viewer.printed import CHOICES
from basrelief.viewer.shown import OF_OBJECT, OF_SCENE, camera_of, said_light, shown_scene
from basrelief.viewer.state import check_shown, state_of

try:
    import anywidget
    import traitlets
except ImportError:
    raise InputError(
        "the viewer in a notebook needs anywidget; pip install 'basrelief[notebook]'"
    ) from None

__all__ = ["Viewer"]

SHOWS = ("color", "reads", "missed", "depth")
"""What the page can draw."""
_RECORDS = {"finish": Finish, "shading": Shading, "shadowing": Shadowing}


class _Setting(traitlets.TraitType):
    """A setting, held to what its check makes of a value: `check(viewer, name, value)`.

    The check is run whenever a value is set, held notifications or not.
    """

    def __init__(self, check: Callable[[Any, str, Any], Any]) -> None:
        super().__init__()
        self.check = check

    def validate(self, viewer: Any, value: Any) -> Any:
        return self.check(viewer, str(self.name), value)


# --- checks: the library's own -------------------------------------------------------------------


def _choice(viewer: Viewer, name: str, value: Any) -> Any:
    one_of(name, value, CHOICES[name])
    return value


def _technique(viewer: Viewer, name: str, value: Any) -> Any:
    one_of(name, value, CHOICES["technique"])
    Object(viewer.material, technique=value)
    return value


def _other_technique(viewer: Viewer, name: str, value: Any) -> Any:
    return "" if value in (None, "") else _technique(viewer, name, value)


def _show(viewer: Viewer, name: str, value: Any) -> Any:
    one_of(name, value, SHOWS)
    if value == "missed":
        _technique(viewer, "technique", "exact")
    return value


def _number(viewer: Viewer, name: str, value: Any) -> float:
    thing = Object(viewer.material, **{name: value})
    return float(getattr(thing, name))


def _share(viewer: Viewer, name: str, value: Any) -> float:
    within(name, value, 0.0, 1.0)
    return float(value)


def _pair(viewer: Viewer, name: str, value: Any) -> Any:
    try:
        u, v = map(float, value)
    except (TypeError, ValueError):
        raise InputError(f"{name} is {value!r}: give two numbers") from None
    pair: Any = (u, v)
    return getattr(Object(viewer.material, **{name: pair}), name)


def _record(viewer: Viewer, name: str, value: Any) -> Any:
    return plain(record_of(_RECORDS[name], value, f"the {name}"))


def _settings(viewer: Viewer, name: str, value: Any) -> Any:
    return _checked_settings(viewer.technique, value)


def _settings_of(viewer: Viewer, name: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise InputError(f"{name} is {value!r}: give settings by the name of their technique")
    for technique in value:
        one_of("technique", technique, CHOICES["technique"])
    checked = {each: _checked_settings(each, settings) for each, settings in value.items()}
    return {**viewer._all_settings, **checked}


def _checked_settings(technique: str, value: Any) -> Any:
    return plain(record_of(TECHNIQUES[technique].settings, value, technique))


def _lights(viewer: Viewer, name: str, value: Any) -> list[dict[str, Any]]:
    if isinstance(value, str | Mapping) or not hasattr(value, "__iter__"):
        raise InputError(f"lights is {value!r}: give several, as (basrelief.directional(),)")
    return [said_light(each) for each in value]


def _camera(viewer: Viewer, name: str, value: Any) -> Orbit:
    return camera_of(value)


def _camera_as_plain(camera: Orbit, viewer: Any) -> dict[str, Any]:
    return asdict(camera)


def _shared(check: Callable[[Any, str, Any], Any], **how: Any) -> Any:
    """A setting that page and Python share."""
    return _Setting(check).tag(sync=True, **how)


# --- the widget ----------------------------------------------------------------------------------


class Viewer(anywidget.AnyWidget):
    """The viewer's page in a notebook, its settings both ways.

    `what` and the settings are those of `basrelief.render`: a folder, a material, an object or a
    scene; `technique`, `scale`, `camera`, `preset` and so on. Maps are scaled to at most `texels`
    a side; `height` is that of the widget, in pixels of the screen.

    Every setting of the page is an attribute, checked when it is set, that `observe` and marimo
    follow: `technique`, `shape`, `projection`, `shadows`, `shading_model` (names); `scale`,
    `level`, `bias`, `divider` (numbers); `tiling`, `shift` (two numbers); `settings` (of the
    technique), `finish`, `shading`, `shadowing` (set by a mapping of what differs from the
    defaults, read as a whole); `camera` (an `Orbit`); `lights` (set by lights, read as
    mappings); `compare` (a technique beside it, or ""), `show` ("color", "reads", "missed",
    "depth"). `settings_of` holds the settings of all techniques by name. As in the page, another
    technique brings its own level and projection, another shape its own tiling.

    Raises InputError for a value that is none of these, and for a scene that the page's programs
    do not draw.
    """

    _esm = (files("basrelief.viewer") / "web" / "widget.js").read_text("utf-8")
    _page = traitlets.Bytes().tag(sync=True)
    height = traitlets.Int(560).tag(sync=True)

    technique = _shared(_technique)
    shape = _shared(_choice)
    projection = _shared(_choice)
    shadows = _shared(_choice)
    shading_model = _shared(_choice)
    scale = _shared(_number)
    level = _shared(_number)
    bias = _shared(_number)
    tiling = _shared(_pair)
    shift = _shared(_pair)
    settings = _Setting(_settings)
    settings_of = _shared(_settings_of)
    finish = _shared(_record)
    shading = _shared(_record)
    shadowing = _shared(_record)
    lights = _shared(_lights)
    camera = _shared(_camera, to_json=_camera_as_plain)
    compare = _shared(_other_technique)
    divider = _shared(_share)
    show = _shared(_show)

    def __init__(
        self,
        what: Scene | Object | Material | str | Path,
        *,
        texels: int = 512,
        height: int = 560,
        compare: str = "",
        show: str = "color",
        engine: str | Engine = "auto",
        progress: Progress | None = None,
        **settings: Any,
    ) -> None:
        scene = scene_of(what, settings)
        check_shown(scene)
        within("texels", texels, 1, None)
        within("height", height, 100, 10_000)
        self.material = scene.objects[0].material
        self._began = scene
        self._heard: frozenset[str] = frozenset()
        state = state_of(scene, scene.objects[0])
        self._all_settings = state.pop("settings")
        state.pop("smoothing")
        source = str(what) if isinstance(what, str | Path) else "FOLDER"
        made = page_of(scene, texels, source, engine, progress or (lambda what, share: None))
        super().__init__(
            _page=made.html.encode(),
            height=height,
            compare=compare,
            show=show,
            divider=0.5,
            settings_of=self._all_settings,
            **state,
        )
        self.settings = self.settings_of[self.technique]
        self._follow()

    def scene(self) -> Scene:
        """What is shown, as a scene: `basrelief.render(viewer.scene())` draws it.

        Its material is the one that the viewer was made of, with maps as large as they are; a map
        that was dropped on the page is not in it.
        """
        names = (*OF_OBJECT, *OF_SCENE, "camera", "lights")
        state = {name: getattr(self, name) for name in names}
        return shown_scene({**state, "settings": self.settings_of}, self._began)

    def set_state(self, sync_data: Mapping[str, Any]) -> None:
        """Take what the page says."""
        self._heard = frozenset(sync_data)
        try:
            super().set_state(sync_data)
        finally:
            self._heard = frozenset()

    def _follow(self) -> None:
        """Let settings follow one another; what the page says itself it has made follow."""
        self.observe(self._follow_technique, "technique")
        self.observe(self._follow_shape, "shape")
        self.observe(self._follow_settings, "settings")
        self.observe(self._follow_settings_of, "settings_of")

    def _follow_technique(self, change: Any) -> None:
        if "technique" not in self._heard:
            made = TECHNIQUES[self.technique]
            self.level, self.projection = made.level, made.projection
        self.settings = self.settings_of[self.technique]

    def _follow_shape(self, change: Any) -> None:
        if "shape" not in self._heard:
            self.tiling = Object(self.material, shape=self.shape, technique="flat").tiles
            self.camera = replace(self.camera, distance=None, target=(0.0, 0.0, 0.0))

    def _follow_settings(self, change: Any) -> None:
        self.settings_of = {self.technique: self.settings}

    def _follow_settings_of(self, change: Any) -> None:
        self._all_settings = self.settings_of
        self.settings = self.settings_of[self.technique]
