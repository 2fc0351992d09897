"""The viewer in a notebook: page and Python share settings."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import basrelief
from basrelief.errors import InputError
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import Layer, LookAt, Object, Orbit, Scene, Tiling, placed
from basrelief.scene.recipe import Recipe
from basrelief.shading.surfaces.landscape import Landscape
from basrelief.viewer.notebook import Viewer
from basrelief.viewer.state import state_of
from helpers.agreement import assert_agree
from helpers.browser import PATIENCE, SOFTWARE, WORDS, chromium, evaluate, planes
from helpers.repository import REPOSITORY
from helpers.served import marimo
from helpers.stills import no_stills

EXAMPLES = REPOSITORY / "examples"
SIZE = (160, 90)
TEXELS = 64
PLACE = "http://localhost:8000/"

NOTEBOOK = """<!doctype html><body style="background: #fff"><div id="one"></div><div id="two"></div>
<script type="module">
  import widget from "/widget.js";
  const page = new DataView(await (await fetch("/page")).arrayBuffer());
  class Model {
    constructor(state) {
      Object.assign(this, { state, heard: new Map(), changed: {}, saved: [] });
    }
    get(name) { return this.state[name]; }
    set(name, value) { this.changed[name] = value; this.receive({ [name]: value }); }
    save_changes() {
      if (Object.keys(this.changed).length) this.saved.push(this.changed);
      this.changed = {};
    }
    on(name, act) { this.heard.set(name, [...(this.heard.get(name) ?? []), act]); }
    off(name, act) { this.heard.set(name, this.heard.get(name).filter((each) => each !== act)); }
    receive(news) {
      Object.assign(this.state, news);
      const acts = Object.keys(news).flatMap((name) => this.heard.get(`change:${name}`) ?? []);
      for (const act of acts) act();
    }
  }
  window.model = new Model({ ...(await (await fetch("/state")).json()), _page: page });
  window.show = (id) => widget.render({ model, el: document.getElementById(id) });
  window.close = show("one");
</script>"""


@pytest.fixture(scope="module")
def material() -> Material:
    return sample("bricks", TEXELS)


@pytest.fixture(scope="module")
def made(material: Material) -> Viewer:
    scene = Scene((Object(material, scale=0.08),), camera=Orbit(24.0, 32.0))
    with no_stills():
        return Viewer(scene, device="cpu")


@pytest.fixture
def viewer(made: Viewer) -> Iterator[Viewer]:
    """The viewer; its settings are restored afterwards."""
    before = {name: getattr(made, name) for name in SHARED}
    yield made
    made.unobserve_all()
    made._follow()
    for name in ("settings_of", "all_surface_parameters"):
        made.set_state({name: {each: {} for each in getattr(made, name)}})
    made.set_state(_as_json(before | {"camera": vars(before["camera"])}))


SHARED = (
    "technique", "shape", "projection", "shadows", "shading_model", "scale", "reference_height",
    "bias", "heights", "smoothing", "edge", "fades", "fade", "tiling", "shift", "opening",
    "apart", "tilings", "mapping", "alpha", "surface", "layer", "layer_tiling", "layer_offset",
    "shading", "shadowing", "occlusion_kind", "fog_mode", "fog", "background", "lights", "camera",
    "compare", "divider", "show", "scroll",
)  # fmt: skip


def test_the_page_and_python_share_all_settings(viewer: Viewer) -> None:
    state = state_of(viewer.scene(), viewer.scene().objects[0])
    assert {*state} - {"settings", "surface_parameters"} == {*SHARED} - {
        "compare",
        "divider",
        "show",
        "scroll",
    }


def _as_json(value: Any) -> Any:
    """A value after transfer as JSON."""
    return json.loads(json.dumps(value))


def _sent_state(viewer: Viewer) -> dict[str, Any]:
    """The state that is sent to the page."""
    state = viewer.get_state()
    names = (*SHARED, "settings_of", "all_surface_parameters", "height")
    return _as_json({name: state[name] for name in names})


def _drawn(what: Any) -> Frame:
    return render(what, size=SIZE, samples=1, device="cpu")


# --- in Python -----------------------------------------------------------------------------------


def test_a_viewer_starts_with_the_settings_of_its_scene(viewer: Viewer, material: Material) -> None:
    scene = Scene((Object(material, scale=0.08),), camera=Orbit(24.0, 32.0))
    assert (viewer.technique, viewer.scale, viewer.camera) == ("relief", 0.08, Orbit(24.0, 32.0))
    assert viewer.settings == {"min_steps": 8, "max_steps": 32, "search_steps": 5}
    assert np.array_equal(_drawn(viewer.scene()).color, _drawn(scene).color)


def test_settings_are_in_the_scene(viewer: Viewer, material: Material) -> None:
    viewer.technique = "parallax_occlusion"
    viewer.settings = {"max_steps": 20}
    viewer.shape, viewer.shadows, viewer.shading_model = "cylinder", "soft", "phong"
    viewer.scale, viewer.reference_height, viewer.projection, viewer.bias = (
        0.06,
        0.75,
        "biased",
        0.2,
    )
    viewer.tiling, viewer.shift = (2, 1.5), (-0.25, 0.5)
    viewer.shading, viewer.shadowing = {"ambient": (0.2, 0.1, 0.3)}, {"max_shadow_steps": 12}
    viewer.surface_parameters = {"roughness": 0.4}
    viewer.camera = Orbit(10.0, 20.0, 3.0, (0.1, -0.1, 0.0))
    lights = (
        basrelief.directional(-30.0, 50.0, intensity=2.0),
        basrelief.spot((1.0, 1.0, 1.0), (0.1, 0.2, 0.0), intensity=3.0, angle=50.0),
        basrelief.point((-1.0, 0.5, 1.0), (1.0, 0.5, 0.5)),
    )
    viewer.lights = lights
    obj = Object(
        material, "cylinder", "parallax_occlusion", {"max_steps": 20}, 0.06, 0.75, "biased", 0.2,
        tiling=(2.0, 1.5), shift=(-0.25, 0.5), surface_parameters={"roughness": 0.4},
    )  # fmt: skip
    scene = Scene(
        (obj,), viewer.camera, lights, {"ambient": (0.2, 0.1, 0.3)}, "phong", "soft",
        shadowing={"max_shadow_steps": 12},
    )  # fmt: skip
    assert_agree(_drawn(scene), _drawn(viewer.scene()), TEXELS)


def test_all_other_settings_are_in_the_scene(material: Material) -> None:
    over = Layer(sample("gravel", TEXELS), Tiling((5.0, 4.0)))
    obj = Object(material, layer=over, transform=placed(scale=(0.7, 1.0, 0.9)), scale=0.08)
    with no_stills():
        viewer = Viewer(Scene((obj,), camera=Orbit(24.0, 32.0)), texels=TEXELS, device="cpu")
    viewer.heights, viewer.smoothing = "smooth", {"mip_bias": 1.0}
    viewer.fades, viewer.fade = True, (1.0, 3.0)
    viewer.apart, viewer.tilings = True, {"base_color": Tiling((2.0, 3.0), (0.1, 0.0))}
    viewer.layer_tiling = Tiling((3.0, 2.0), (0.0, 0.5))
    viewer.fog_mode, viewer.fog, viewer.background = "linear", {"fog_end": 3.0}, (0.1, 0.0, 0.2)
    viewer.edge, viewer.occlusion_kind, viewer.alpha = "clip", "directional", "mask"
    wanted = replace(
        obj,
        heights="smooth",
        smoothing={"mip_bias": 1.0},
        fade=(1.0, 3.0),
        tilings={"base_color": Tiling((2.0, 3.0), (0.1, 0.0))},
        layer=replace(over, tiling=Tiling((3.0, 2.0), (0.0, 0.5))),
        edge="clip",
        alpha="mask",
    )
    scene = Scene(
        (wanted,),
        Orbit(24.0, 32.0),
        fog_mode="linear",
        fog={"fog_end": 3.0},
        background=(0.1, 0.0, 0.2),
        occlusion_kind="directional",
    )
    assert_agree(_drawn(scene), _drawn(viewer.scene()), TEXELS)
    recipe = Recipe(viewer.scene())
    assert (viewer.command, viewer.python) == (recipe.command, recipe.python)
    assert "--edge clip" in viewer.command
    assert 'fog_mode="linear"' in viewer.python
    viewer.surface, viewer.surface_parameters = "landscape", {"water_level": 0.6}
    assert viewer.scene().resolved[0].surface_parameters == Landscape(water_level=0.6)
    viewer.surface = "standard"
    assert viewer.surface_parameters["roughness"] == 1.0
    assert viewer.all_surface_parameters["landscape"]["water_level"] == pytest.approx(0.6)
    # another shape has its default transform; tilings and layer are switched off
    viewer.shape, viewer.apart, viewer.layer = "box", False, False
    box = viewer.scene().objects[0]
    assert (box.transform, box.tilings, box.layer) == (None, {}, None)


def test_a_technique_and_a_shape_set_their_defaults(viewer: Viewer) -> None:
    viewer.settings = {"max_steps": 64}
    viewer.camera = Orbit(24.0, 32.0, 3.0, (0.1, 0.2, 0.0))
    viewer.technique = "offset"
    assert (viewer.reference_height, viewer.settings) == (
        0.5,
        {"max_offset": 1.0, "max_offset_ratio": 1.0},
    )
    viewer.technique = "relief"
    assert (viewer.reference_height, viewer.settings["max_steps"]) == (1.0, 64)
    viewer.shape = "sphere"
    assert (viewer.tiling, viewer.camera) == ((4.0, 2.0), Orbit(24.0, 32.0))
    # the page sends all settings in one message
    viewer.set_state(
        {"technique": "offset", "reference_height": 0.75, "shape": "box", "tiling": [3, 2]}
    )
    assert (viewer.reference_height, viewer.tiling) == (0.75, (3.0, 2.0))


def test_a_light_of_intensity_0_keeps_its_colour(viewer: Viewer) -> None:
    first, second = viewer.lights
    viewer.set_state({"lights": [{**first, "intensity": 0}, second]})
    assert viewer.lights[0]["color"] == [1.0, 0.96, 0.9]
    assert [*viewer.scene().lights[0].color] == [0.0, 0.0, 0.0]


def test_lights_may_be_one_light(viewer: Viewer) -> None:
    viewer.lights = basrelief.directional(20.0, 50.0)
    assert [each["azimuth"] for each in viewer.lights] == [20.0]


def test_settings_are_returned_as_copies(viewer: Viewer) -> None:
    viewer.settings["max_steps"] = 99
    viewer.lights[0]["azimuth"] = 77.0
    viewer.surface_parameters["roughness"] = 0.1
    assert viewer.settings["max_steps"] == 32
    assert viewer.lights[0]["azimuth"] == -50.0
    assert viewer.surface_parameters["roughness"] == 1.0


def test_invalid_settings_of_the_page_are_sent_back(
    viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[Any] = []
    monkeypatch.setattr(viewer, "send_state", lambda names: sent.append(names))
    with pytest.raises(InputError, match="fade 5 to 1"):
        viewer.set_state({"fades": True, "fade": [5, 1], "scale": 0.03})
    assert (viewer.fades, viewer.fade, viewer.scale) == (True, (2.0, 4.0), 0.03)
    assert sent[-1] == ["fade"]


def test_a_background_of_none_is_kept(material: Material) -> None:
    scene = Scene((Object(material),), background=None)
    with no_stills():
        viewer = Viewer(scene, texels=TEXELS, device="cpu")
    assert viewer.scene().background is None
    viewer.background = (0.2, 0.0, 0.0)
    assert viewer.scene().background == (0.2, 0.0, 0.0)


def test_changes_are_observed(viewer: Viewer) -> None:
    seen: list[tuple[str, Any]] = []
    viewer.observe(lambda change: seen.append((change.name, change.new)), ["scale", "settings"])
    viewer.set_state(
        {"scale": 0.03, "settings_of": {"relief": {"max_steps": 40}, "offset": {"max_offset": 0.5}}}
    )
    viewer.set_state({"scale": 0.03})
    wanted = {"min_steps": 8, "max_steps": 40, "search_steps": 5}
    assert sorted(seen) == [("scale", 0.03), ("settings", wanted)]


@pytest.mark.parametrize(
    ("name", "value", "line"),
    [
        ("technique", "warp", r"technique is one of flat, offset, .*, not 'warp'"),
        ("shape", "cube", r"shape is one of plane, box, sphere, cylinder, not 'cube'"),
        ("scale", -1.0, r"scale is -1: give a number from 0 to 10"),
        ("reference_height", "half", r"reference_height is 'half': give a number"),
        ("scale", None, r"scale is None: give a number"),
        ("height", -5, r"height is -5: give a number from 100 to 10000"),
        ("height", "tall", r"height is 'tall': give a whole number"),
        (
            "scene",
            5,
            r"a viewer has no setting 'scene'; it has all_surface_parameters, .* fog, .* settings",
        ),
        ("observe", 3, r"a viewer has no setting 'observe'"),
        ("camera", LookAt((0.0, 0.0, 0.0)), r"position and target are the same point"),
        ("lights", [{"intensity": -4}], r"intensity is -4: give a number from 0"),
        ("tiling", "ab", r"tiling is 'ab': give two numbers"),
        ("tiling", (0.0, 1.0), r"give finite numbers other than 0"),
        ("settings", {"steps": 3}, r"relief has no setting 'steps'; it has min_steps, max_steps"),
        ("settings", {"max_steps": 0}, r"max_steps is 0: give a number from 1 to"),
        ("settings", 3, r"relief takes settings of type Relief"),
        ("settings_of", {"warp": {}}, r"technique is one of flat"),
        ("settings_of", [], r"give numbers by the name of their technique"),
        ("shading", {"ambient": -1}, r"ambient is -1: give a number from 0"),
        ("camera", "near", r"camera is 'near': give an Orbit or a LookAt"),
        ("camera", {"azimut": 3.0}, r"give an Orbit or a LookAt"),
        ("camera", Orbit(24.0, 32.0, "far"), r"give it finite numbers"),  # type: ignore[arg-type]
        ("lights", 3, r"lights is 3: give several"),
        ("lights", [{"kind": "sun"}], r"the kind of a light is one of directional, point, spot"),
        ("lights", [{"colour": 1}], r"a light's number is one of kind, .*, not 'colour'"),
        ("lights", [{"azimuth": "left"}], r"give it finite numbers"),
        ("compare", "warp", r"compare is one of flat"),
        ("scroll", 0.5, r"scroll is 0.5: give two numbers"),
        ("scroll", (2000.0, 0.0), r"u is 2000: give a number from -1000 to 1000"),
        ("divider", 2, r"divider is 2: give a number from 0 to 1"),
        ("heights", "soft", r"heights is one of sharp, smooth, mip, not 'soft'"),
        ("fade", 3, r"fade is 3: give two numbers"),
        ("opening", 2, r"opening is 2: give a number from 0 to 1"),
        ("opening", "wide", r"opening is 'wide': give a number"),
        ("fade", (3.0, 1.0), r"fade 3 to 1: give two distances"),
        ("fades", "yes", r"fades is one of True, False, not 'yes'"),
        ("tilings", {"height": Tiling()}, r"map is one of base_color, normal"),
        ("tilings", {"normal": 3}, r"a tiling is 3: give a Tiling"),
        ("layer", True, r"there is none; make the viewer of a scene with a layer"),
        ("background", "red", r"background is 'red': give three numbers"),
        ("fog", {"fog_start": 9, "fog_end": 2}, r"fog from 9 to 2: give a fog_end no nearer"),
        ("fog", {"fog_density": -1}, r"fog_density is -1: give a number from 0"),
        (
            "surface_parameters",
            {"water_level": 0.3},
            r"the standard surface has no setting 'water_level'",
        ),
        ("nosuch", 3, r"a viewer has no setting 'nosuch'; it has all_surface_parameters, alpha,"),
        ("preset", "gamedev", r"a viewer has no setting 'preset'"),
        ("show", "normals", r"show is one of color, reads, missed, depth, not 'normals'"),
    ],
)
def test_invalid_settings_are_refused(viewer: Viewer, name: str, value: Any, line: str) -> None:
    before = _sent_state(viewer)
    with pytest.raises(InputError, match=line):
        setattr(viewer, name, value)
    assert _sent_state(viewer) == before


def test_an_opening_is_checked_without_making_the_hole(
    viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("basrelief.scene.resolve._opened", None)
    viewer.opening = 0.123
    assert viewer.opening == 0.123
    viewer.opening = None
    with monkeypatch.context() as patch:
        patch.setattr(viewer, "_material", sample("grid", 8))
        with pytest.raises(InputError, match="grid has no height map, in which a hole opens"):
            viewer.opening = 0.5
    assert viewer.opening is None


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"height": "tall"}, r"height is 'tall': give a whole number"),
        ({"texels": 64.5}, r"texels is 64.5: give a whole number"),
        ({"texels": 0}, r"texels is 0: give a number from 1"),
        ({"camera": LookAt((0.0, 0.0, 0.0))}, r"position and target are the same point"),
    ],
)
def test_invalid_options_of_a_viewer_are_refused(options: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError, match=line):
        Viewer("sample:bricks", **options)


def test_a_material_without_heights_allows_only_flat(material: Material) -> None:
    with no_stills():
        bare = Viewer(Material("bare", base_color=material.base_color), device="cpu")
    assert bare.technique == "flat"
    for name, value in (("technique", "relief"), ("compare", "relief"), ("show", "missed")):
        with pytest.raises(InputError, match="bare has no height map"):
            setattr(bare, name, value)


def test_scenes_that_the_page_cannot_draw_are_refused(material: Material) -> None:
    two = Scene((Object(material), Object(material, shape="sphere")))
    with pytest.raises(InputError, match="has further objects, which the page does not draw"):
        Viewer(two)
    with pytest.raises(InputError, match="height is 20: give a number from 100"):
        Viewer(material, height=20)


def test_without_anywidget_the_error_names_what_to_install() -> None:
    code = "import sys; sys.modules['anywidget'] = None; import basrelief.viewer.notebook"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert result.stderr.splitlines()[-1].endswith("pip install 'basrelief[notebook]'")


# --- page and Python -----------------------------------------------------------------------------


class NotebookPage:
    """A viewer in a page that imitates a notebook, with its messages."""

    def __init__(self, browser: Any, viewer: Viewer) -> None:
        self.viewer = viewer
        options = {"viewport": {"width": 760, "height": 400}, "color_scheme": "no-override"}
        self.page = browser.new_page(**options)
        self.page.set_default_timeout(PATIENCE)
        self.console: list[str] = []
        self.page.on("console", lambda m: self.console.append(f"{m.type}: {m.text}"))
        self.page.on("pageerror", lambda error: self.console.append(str(error)))
        parts = {
            "": ("text/html", NOTEBOOK),
            "widget.js": ("text/javascript", viewer._esm),
            "state": ("application/json", json.dumps(_sent_state(viewer))),
            "page": ("application/octet-stream", viewer._page),
            "favicon.ico": ("image/png", b""),
        }

        def serve(route: Any) -> None:
            kind, body = parts[route.request.url.removeprefix(PLACE)]
            route.fulfill(content_type=kind, body=body)

        self.page.route(PLACE + "**", serve)
        self.page.goto(PLACE)
        self.ready(1)

    def ready(self, count: int) -> None:
        """Wait until `count` views have drawn."""
        self.page.wait_for_function(
            """n => frames.length === n &&
              [...Array(n).keys()].every((k) => frames[k].viewer?.drawing?.frames?.done)""",
            arg=count,
        )
        # one sample suffices and leaves time for other tests
        for number in range(count):
            self.frame(number).evaluate("viewer.drawing.frames.limit = 1")

    def frame(self, number: int = 0) -> Any:
        return self.page.frames[1 + number]

    def state(self, name: str, number: int = 0) -> Any:
        """A setting of the page."""
        return self.frame(number).evaluate(f"viewer.state.{name}")

    def python(self, **settings: Any) -> None:
        """Set attributes and send the changes to the page."""
        before = _sent_state(self.viewer)
        for name, value in settings.items():
            setattr(self.viewer, name, value)
        news = {k: v for k, v in _sent_state(self.viewer).items() if v != before[k]}
        self.page.evaluate("news => model.receive(news)", news)

    def wait(self, condition: str, number: int = 0) -> None:
        self.frame(number).wait_for_function(condition)

    def saved(self, condition: str) -> None:
        """Wait for a condition and pass the page's messages to Python."""
        self.page.wait_for_function(condition)
        for news in self.page.evaluate("model.saved.splice(0)"):
            self.viewer.set_state(news)

    def drawn(self) -> Frame:
        """The planes of the page's picture."""
        frame = self.frame()
        frame.evaluate("([w, h]) => viewer.draw(w, h, 1)", list(SIZE))
        words = evaluate(frame, WORDS, "left")
        frame.evaluate("viewer.fixedSize = null")
        return planes(words, SIZE, self.state("background"))


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(SOFTWARE) as found:
        yield found


@pytest.fixture(scope="module")
def opened(browser: Any, made: Viewer) -> Iterator[NotebookPage]:
    shown = NotebookPage(browser, made)
    yield shown
    shown.page.close()


@pytest.fixture
def shown(opened: NotebookPage, viewer: Viewer) -> Iterator[NotebookPage]:
    """The page with the viewer's initial settings, and without keyboard focus."""
    opened.frame().evaluate("document.activeElement.blur()")
    opened.page.evaluate("news => model.receive(news)", _sent_state(viewer))
    opened.wait("viewer.state.scale === 0.08 && viewer.state.technique === 'relief'")
    opened.page.evaluate("model.saved.splice(0)")
    yield opened
    assert opened.console == []


def test_settings_go_both_ways(shown: NotebookPage, viewer: Viewer) -> None:
    assert shown.page.evaluate("model.saved") == []

    shown.python(technique="steep", scale=0.03, settings={"steps": 17}, camera=Orbit(40.0, 25.0))
    shown.wait("viewer.state.settings.steep.steps === 17")
    assert (shown.state("technique"), shown.state("scale")) == ("steep", 0.03)
    assert shown.state("camera.azimuth") == 40
    assert shown.frame().get_by_label("Technique", exact=True).input_value() == "steep"
    assert_agree(_drawn(viewer.scene()), shown.drawn(), TEXELS)
    # the page sends nothing back
    shown.page.wait_for_timeout(150)
    assert shown.page.evaluate("model.saved") == []

    slider = shown.frame().get_by_label("scale, slider")
    slider.focus()
    for _ in range(4):
        shown.page.keyboard.press("ArrowRight")
    shown.saved("model.saved.some((news) => news.scale > 0.0335)")
    assert viewer.scale == pytest.approx(0.034)
    shown.frame().get_by_label("Technique", exact=True).select_option("offset")
    shown.saved("model.saved.length")
    assert (viewer.technique, viewer.reference_height) == ("offset", 0.5)
    shown.frame().get_by_label("max offset", exact=True).fill("0.25")
    shown.frame().locator("#canvas").focus()
    shown.page.keyboard.press("ArrowRight")
    shown.saved("model.get('camera').azimuth === 44 && model.saved.length")
    assert viewer.settings == {"max_offset": 0.25, "max_offset_ratio": 1.0}
    assert viewer.camera == Orbit(44.0, 25.0)
    assert_agree(_drawn(viewer.scene()), shown.drawn(), TEXELS)

    # each lens has its own number
    field = shown.frame().locator("input[name='camera.field_of_view']")
    seen_height = shown.frame().locator("input[name='camera.orthographic_height']")
    for lens, there in (
        ({"orthographic_height": 0.8}, seen_height),
        ({"field_of_view": 35.0}, field),
    ):
        shown.python(camera=Orbit(44.0, 25.0, **lens))
        shown.wait(
            f"viewer.drawing.state.camera.{next(iter(lens))} === {next(iter(lens.values()))}"
        )
        assert there.count() == 1
        assert field.count() + seen_height.count() == 1
        assert_agree(_drawn(viewer.scene()), shown.drawn(), TEXELS)

    # a value that the page clamps is clamped in Python too
    shown.python(camera=Orbit(44.0, -20.0))
    shown.saved("model.saved.length")
    assert viewer.camera == Orbit(44.0, 2.0)


def test_the_page_scrolls_as_python_says(shown: NotebookPage, viewer: Viewer) -> None:
    shown.python(scroll=(0.5, 0.0))
    shown.wait("viewer.state.shift[0] > 0.05")
    shown.python(scroll=(0.0, 0.0))
    shown.wait("viewer.state.scroll[0] === 0")
    shown.saved("model.saved.length")
    # where it stopped is in Python
    assert viewer.shift == pytest.approx(tuple(shown.frame().evaluate("viewer.state.shift")))
    assert viewer.shift[0] > 0.0


def test_two_views_show_the_same(shown: NotebookPage, viewer: Viewer) -> None:
    shown.python(compare="offset", divider=0.25)
    shown.page.evaluate("void (window.closeSecond = show('two'))")
    shown.ready(2)
    shown.wait("viewer.state.compare === 'offset'", 1)
    shown.frame(1).get_by_label("Divider").fill("0.75")
    shown.wait("viewer.state.divider === 0.75", 0)
    shown.saved("model.saved.length")
    assert viewer.divider == 0.75
    shown.page.wait_for_timeout(150)
    assert shown.page.evaluate("model.saved") == []
    shown.page.evaluate("closeSecond()")
    shown.python(scale=0.02)
    shown.wait("viewer.state.scale === 0.02")
    assert len(shown.page.frames) == 2


def test_the_page_adapts_to_the_notebook(shown: NotebookPage) -> None:
    frame = shown.page.locator("iframe").first
    assert frame.bounding_box()["height"] == 560
    shown.python(height=480)
    shown.page.wait_for_function("document.querySelector('iframe').offsetHeight === 480")
    # the colour scheme follows the background, in any notation of colours
    for color, dark in (("#111", True), ("color(srgb 1 1 1)", False), ("oklch(20% 0 0)", True)):
        shown.page.evaluate("color => { document.body.style.background = color }", color)
        query = "matchMedia('(prefers-color-scheme: dark)').matches"
        shown.wait(query if dark else f"!{query}")
    # there is no link to copy
    assert shown.frame().locator("#copy-link").count() == 0
    # scrolling over the page without focus does not zoom
    box = frame.bounding_box()
    shown.page.mouse.move(box["x"] + 50, box["y"] + 100)
    shown.page.mouse.wheel(0, 300)
    shown.page.wait_for_timeout(100)
    assert shown.state("camera.distance") is None
    shown.frame().locator("#canvas").click()
    shown.page.mouse.wheel(0, -100)
    shown.wait("viewer.state.camera.distance !== null")


# --- in notebooks --------------------------------------------------------------------------------


def with_smaller_numbers(text: str, *numbers: tuple[str, str]) -> str:
    """An example with fewer texels and pixels."""
    for number, less in numbers:
        assert number in text
        text = text.replace(number, less)
    return text


def test_the_example_runs_in_marimo(browser: Any, tmp_path: Path) -> None:
    text = (EXAMPLES / "viewer.py").read_text("utf-8")
    example = tmp_path / "viewer.py"
    example.write_text(
        with_smaller_numbers(text, ("256)", "64)"), ("(480, 270)", "(48, 27)")), "utf-8"
    )
    with marimo(example, tmp_path) as address:
        page = browser.new_page(viewport={"width": 800, "height": 600})
        page.set_default_timeout(PATIENCE)
        page.goto(address)
        page.wait_for_selector("iframe[title='basrelief viewer']")
        frame = next(each for each in page.frames if each.url.startswith("blob:"))
        frame.wait_for_function("window.viewer?.drawing?.frames?.done")
        frame.evaluate("viewer.drawing.frames.limit = 1")
        assert frame.evaluate("[viewer.state.technique, viewer.state.scale]") == ["relief", 0.08]
        # changes of the page, in Python
        frame.locator("input[name=scale]").fill("0.031")
        page.get_by_text("scale 0.031").wait_for()
        frame.get_by_label("Technique", exact=True).select_option("steep")
        page.get_by_text("steep, scale 0.031").wait_for()
        # changes of Python, in the page
        page.get_by_label("The technique, from Python:").select_option("offset")
        frame.wait_for_function(
            "viewer.state.technique === 'offset' && viewer.state.reference_height === 0.5"
        )
        assert frame.evaluate("viewer.state.scale") == 0.031
        page.close()


def test_the_jupyter_example_runs() -> None:
    """The code of its cells, without a notebook server."""
    notebook = json.loads((EXAMPLES / "viewer.ipynb").read_text("utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] for cell in cells)
    code = "\n".join("".join(cell["source"]) for cell in cells)
    known: dict[str, Any] = {}
    fewer = ('"sample:cobbles", ', '"sample:cobbles", texels=64, ')
    exec(with_smaller_numbers(code, fewer, ("(960, 540)", "(48, 27)")), known)
    known["viewer"].set_state({"scale": 0.02})
    assert known["label"].value == "scale 0.02"
