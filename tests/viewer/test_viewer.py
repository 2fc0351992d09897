"""The viewer's page in a browser: its pictures equal the CPU engine's, and its controls work."""

from __future__ import annotations

import base64
import re
import shlex
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest

import basrelief
from basrelief.cli import arguments
from basrelief.errors import InputError
from basrelief.images import encode_png, read_picture, srgb_encode, write_data
from basrelief.material import Map, Material, sample
from basrelief.material.conventions import parse_name
from basrelief.measure.debug import debug_picture
from basrelief.measure.errors import errors, missed, overshoot
from basrelief.measure.truth import truth
from basrelief.rendering import textures
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import (
    LYING,
    SHAPES,
    Layer,
    Object,
    Orbit,
    Scene,
    Tiling,
    placed,
    point,
    rotated,
    spot,
)
from basrelief.scene.motion import Moment, Scrolling
from basrelief.scene.presets import preset
from basrelief.scene.views import FRAME_FILL
from basrelief.shading.lights import DIRECTIONAL, SPOT
from basrelief.techniques import TECHNIQUES
from basrelief.viewer import write_view
from basrelief.viewer.layouts import json_value
from basrelief.viewer.names import place_of
from basrelief.viewer.page import LARGEST
from basrelief.viewer.shown import scene_from_state
from basrelief.viewer.state import state_of
from helpers.agreement import assert_agree
from helpers.browser import PATIENCE, SOFTWARE, WORDS, chromium, evaluate, planes
from helpers.stills import no_stills

SIZE = (160, 90)
TEXELS = 64
CAMERA = Orbit(azimuth=24.0, elevation=32.0)


@pytest.fixture(scope="module")
def material() -> Material:
    return sample("bricks", TEXELS)


@pytest.fixture(scope="module")
def page_file(material: Material, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("viewer") / "page.html"
    scene = Scene((Object(material, scale=0.08),), camera=CAMERA)
    write_view(scene, file, device="cpu")
    return file


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(SOFTWARE) as made:
        yield made


class OpenPage:
    """An open page with its console messages and network requests."""

    def __init__(
        self, browser: Any, file: Path, hash: str = "", *, before: str = "", **options: Any
    ) -> None:
        """Open `file`; `before` runs before the page's own code."""
        options.setdefault("viewport", {"width": 760, "height": 400})
        self.page = browser.new_page(**options)
        self.page.set_default_timeout(PATIENCE)
        self.console: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda m: self.console.append(f"{m.type}: {m.text}"))
        self.page.on("pageerror", lambda error: self.console.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        if before:
            self.page.add_init_script(before)
        self.page.goto(file.as_uri() + hash)
        self.page.wait_for_function("window.viewer && window.viewer.ready")
        self.page.evaluate("viewer.ready")
        # one sample unless a test requests more
        self.page.evaluate("if (viewer.drawing) viewer.drawing.frames.limit = 1")

    def state(self, **changes: Any) -> None:
        """Change the state, as the panel does."""
        self.page.evaluate("changes => { Object.assign(viewer.state, changes) }", changes)

    def draw(self, samples: int = 1, size: tuple[int, int] = SIZE) -> None:
        self.page.evaluate("([w, h, n]) => viewer.draw(w, h, n)", [*size, samples])

    def frame(self, side: str = "left") -> Frame:
        """The last drawn planes as a `Frame`."""
        self.draw()
        words = evaluate(self.page, WORDS, side)
        return planes(words, SIZE, self.page.evaluate("viewer.state.background"))

    def open(self, section: str) -> None:
        """Unfold a section of the panel."""
        self.page.evaluate(
            "id => { document.getElementById(id).open = true }", f"section-{section}"
        )

    def text(self, selector: str) -> str:
        return str(self.page.inner_text(selector))


@pytest.fixture(scope="module")
def seen(browser: Any, page_file: Path) -> Iterator[OpenPage]:
    made = OpenPage(browser, page_file)
    yield made
    made.page.close()


@pytest.fixture
def fresh(seen: OpenPage) -> Iterator[OpenPage]:
    """The page after a reset, its panel folded; it must leave the console empty."""
    seen.page.evaluate(
        """() => {
          document.getElementById("panel").replaceChildren();
          viewer.drop = { channel: "luminance", polarity: "", green: "" };
          window.isReset = false;
          viewer.reset().then(() => { window.isReset = true; });
        }"""
    )
    # not awaited by the evaluation, as the browser's protocol does not keep such a promise alive
    seen.page.wait_for_function("window.isReset")
    seen.console.clear()
    yield seen
    assert seen.console == []


def expected(material: Material, **options: Any) -> Frame:
    of_scene = {k: options.pop(k) for k in list(options) if k in Scene.__dataclass_fields__}
    obj = Object(material, **{"scale": 0.08, **options})
    scene = Scene((obj,), **{"camera": CAMERA, **of_scene})
    return render(scene, size=SIZE, samples=1, device="cpu")


def test_the_adapter_is_the_software_one(seen: OpenPage) -> None:
    info = seen.page.evaluate(
        "[viewer.gpu.adapter.info.vendor, viewer.gpu.adapter.info.architecture]"
    )
    assert info == ["google", "swiftshader"]


def test_the_page_loads_without_messages_and_requests(browser: Any, page_file: Path) -> None:
    seen = OpenPage(browser, page_file)
    seen.draw()
    assert seen.console == []
    assert seen.requests == [page_file.as_uri()]
    assert seen.text("#messages") == ""
    seen.page.close()


@pytest.mark.parametrize(
    ("attempt", "directive"),
    [
        ("fetch(elsewhere).catch(() => {})", "connect-src"),
        ("document.body.append(Object.assign(new Image(), { src: elsewhere }))", "img-src"),
        ("import(elsewhere).catch(() => {})", "script-src-elem"),
    ],
)
def test_the_content_policy_refuses_requests(seen: OpenPage, attempt: str, directive: str) -> None:
    refused = seen.page.evaluate(
        """(attempt) => new Promise((refused) => {
          const hear = (event) => refused([event.violatedDirective, event.blockedURI]);
          addEventListener("securitypolicyviolation", hear, { once: true });
          setTimeout(() => refused("nothing was refused"), 5000);
          const script = document.createElement("script");
          script.textContent = `{ const elsewhere = "http://127.0.0.1:9/a"; ${attempt} }`;
          document.body.append(script);
        })""",
        attempt,
    )
    assert refused == [directive, "http://127.0.0.1:9/a"]


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_a_technique_draws_the_cpus_picture(
    fresh: OpenPage, material: Material, technique: str
) -> None:
    made = TECHNIQUES[technique]
    fresh.state(
        technique=technique, reference_height=made.reference_height, projection=made.projection
    )
    assert_agree(expected(material, technique=technique), fresh.frame(), TEXELS)
    assert fresh.console == []


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("shadows", ["hard", "soft"])
def test_shapes_and_shadows_equal_the_cpus(
    fresh: OpenPage, material: Material, shape: str, shadows: str
) -> None:
    obj = Object(material, shape=shape)
    fresh.state(shape=shape, shadows=shadows, tiling=list(obj.resolved.tiling.tiles))
    assert_agree(expected(material, shape=shape, shadows=shadows), fresh.frame(), TEXELS)


@pytest.mark.parametrize("projection", ["biased", "limited"])
def test_projections_equal_the_cpus(fresh: OpenPage, material: Material, projection: str) -> None:
    fresh.state(projection=projection, bias=0.3, shading_model="phong", technique="steep")
    options = {"projection": projection, "bias": 0.3, "shading_model": "phong"}
    assert_agree(expected(material, technique="steep", **options), fresh.frame(), TEXELS)


def test_the_canvas_shows_the_encoded_picture(fresh: OpenPage, material: Material) -> None:
    fresh.draw(samples=4)
    url = fresh.page.evaluate(
        "(viewer.drawing.frames.present(), viewer.canvas.toDataURL('image/png'))"
    )
    file = base64.b64decode(url.split(",")[1])
    shown = read_picture(_saved(file, "canvas.png")).pixels[:, :, :3].astype(int)
    obj = Object(material, scale=0.08)
    frame = render(Scene((obj,), camera=CAMERA), size=SIZE, samples=4, device="cpu")
    wanted = read_picture(_saved(encode_png(frame.color[:, :, :3]), "cpu.png")).pixels.astype(int)
    error = np.abs(shown - wanted).max(axis=-1)
    assert (error <= 2).mean() >= 0.995
    assert shown.std() > 10.0


def test_missed_hits_equal_the_measured_errors(fresh: OpenPage, material: Material) -> None:
    fresh.state(technique="offset", reference_height=0.5, projection="full", show="missed")
    scene = Scene((Object(material, technique="offset", scale=0.08),), camera=CAMERA)
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    share = errors(frame, truth(scene, SIZE)).missed
    fresh.draw()
    found = fresh.page.evaluate("viewer.drawing.frames.lastFigures")
    assert found["missed"] / found["hits"] == pytest.approx(share, abs=0.005)
    assert share > 0.05


@pytest.mark.parametrize(
    ("technique", "projection", "edge"),
    [("offset", "limited", "wrap"), ("steep", "full", "clamp"), ("steep", "biased", "clip")],
)
def test_colours_of_missed_hits_equal_those_of_render_show(
    fresh: OpenPage, material: Material, technique: Any, projection: Any, edge: Any
) -> None:
    """A hit has passed by its overshoot along the true ray; only repeated tiles wrap."""
    choices = {"technique": technique, "projection": projection, "edge": edge}
    choices["reference_height"] = 1.0
    fresh.state(**choices, show="missed")
    fresh.draw()
    words = evaluate(
        fresh.page,
        "async () => new Uint32Array("
        "await viewer.gpu.read(viewer.drawing.frames.sides.left.missed))",
    )
    width, height = SIZE
    lost, passed = words[: 2 * width * height].reshape(2, height, width) != 0
    scene = Scene((Object(material, scale=0.08, **choices),), camera=CAMERA)
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    true = truth(scene, SIZE)
    wanted, behind = missed(frame, true), overshoot(frame, true) > 0.0
    assert wanted.sum() > 150
    if projection == "limited":
        assert 0.1 < behind[wanted].mean() < 0.9
    assert (lost != wanted).mean() < 0.003
    assert (passed != behind)[wanted & lost].mean() < 0.003
    # the canvas has the colours of `render --show missed`
    url = fresh.page.evaluate(
        "(viewer.drawing.frames.present(), viewer.canvas.toDataURL('image/png'))"
    )
    shown = read_picture(_saved(base64.b64decode(url.split(",")[1]), "canvas.png")).pixels
    picture = debug_picture("missed", frame, true).image.pixels[:, :, :3]
    codes = np.rint(srgb_encode(picture) * 255)
    agree = (np.abs(shown[:, :, :3] - codes) <= 2).all(-1)
    assert agree[wanted & lost].mean() > 0.99


@pytest.mark.parametrize("heights", ["smooth", "mip"])
def test_missed_hits_compare_with_the_finest_level(
    fresh: OpenPage, material: Material, heights: Any
) -> None:
    changes = {"technique": "parallax_occlusion", "heights": heights, "show": "missed"}
    fresh.state(**changes, tiling=[10, 10])
    fresh.draw()
    figures = fresh.page.evaluate("viewer.drawing.frames.lastFigures")
    obj = Object(
        material,
        scale=0.08,
        technique="parallax_occlusion",
        heights=heights,
        tiling=(10.0, 10.0),
    )
    scene = Scene((obj,), camera=CAMERA)
    drawn = render(scene, size=SIZE, samples=1, device="cpu")
    wanted = errors(drawn, truth(scene, SIZE)).missed
    assert wanted > 0.05
    assert figures["missed"] / figures["hits"] == pytest.approx(wanted, abs=0.01)


def test_cameras_equal_pythons(seen: OpenPage) -> None:
    for camera in (
        Orbit(24.0, 32.0, 2.5, (0.1, -0.2, 0.3), 40.0),
        Orbit(-130.0, 89.0, 0.7),
        Orbit(10.0, 20.0, 3.0, orthographic_height=1.5),
    ):
        made = json_value(camera.camera(SIZE))
        fields = {name: getattr(camera, name) for name in camera.__dataclass_fields__}
        script = "async ([c, s]) => (await import('view/camera.js')).orbit(c, s)"
        found = seen.page.evaluate(script, [fields, SIZE])
        for name, value in made.items():
            np.testing.assert_allclose(found[name], value, rtol=2e-6, atol=1e-7, err_msg=name)


def test_framing_equals_pythons(seen: OpenPage, material: Material) -> None:
    for shape in SHAPES:
        points = Object(material, shape=shape).resolved.bounding_points()
        camera = Orbit(24.0, 32.0)
        fields = {name: getattr(camera, name) for name in camera.__dataclass_fields__}
        script = "async ([c, p, s, f]) => (await import('view/camera.js')).framing(c, p, s, f)"
        found = seen.page.evaluate(script, [fields, points.tolist(), SIZE, FRAME_FILL])
        assert found == pytest.approx(camera.framing(points, SIZE).distance, rel=1e-6)


def test_smaller_levels_equal_pythons(seen: OpenPage) -> None:
    rng = np.random.default_rng(5)
    heights = rng.integers(0, 65536, (13, 22)).astype(np.uint16)
    script = """async ([texels, height, width]) => {
      const maps = await import("view/maps.js");
      return maps.heightLevels({ width, height, texels }).map((l) => l.texels);
    }"""
    found = evaluate(seen.page, script, [heights, *heights.shape])
    level = (heights / 65535.0).astype(np.float32)
    for texels in found:
        assert np.array_equal(texels.astype(np.float32).reshape(level.shape), level)
        level = textures.halved(level)


VARIATIONS: dict[str, dict[str, Any]] = {
    "clamped": {"edge": "clamp", "shift": (0.4, 0.3), "shape": "box"},
    "clipped": {"edge": "clip", "technique": "parallax_occlusion"},
    "smooth": {"heights": "smooth", "tiling": (8.0, 8.0)},
    "mips": {"heights": "mip", "tiling": (8.0, 8.0), "technique": "steep"},
    "landscape": {"surface": "landscape", "technique": "fixed_length", "scale": 0.2},
    "land with holes": {
        "surface": "landscape",
        "alpha": "mask",
        "mapping": "triplanar",
        "scale": 0.2,
        "layer": Layer(sample("gravel", TEXELS), Tiling((5.0, 4.0), (0.25, 0.1))),
        "surface_parameters": {"cutoff": 0.3, "roughness": 0.6, "water_level": 0.2},
    },
    "faded": {"fade": (1.5, 2.5), "shadows": "hard"},
    "three sides": {"mapping": "triplanar", "scale": 0.2},
    "noise": {"mapping": "noise", "scale": 0.2, "surface_parameters": {"shininess": 40.0}},
    "a floating layer": {
        "layer": Layer(sample("gravel", TEXELS), Tiling((5.0, 4.0), (0.25, 0.1))),
        "layer_offset": "none",
    },
    "apart": {
        "tilings": {
            "base_color": Tiling((-3.0, 2.0), (0.1, 0.2)),
            "normal": Tiling((-2.0, 3.0)),
        }
    },
    "a layer": {"layer": Layer(sample("gravel", TEXELS), Tiling((5.0, 4.0), (0.25, 0.1)))},
    "a hole": {"opening": 0.8, "scale": 0.3, "shadows": "hard", "technique": "secant"},
    "a closed hole": {"opening": 0.0, "scale": 0.3},
    "fog": {"fog_mode": "linear", "fog": {"fog_start": 1.0, "fog_end": 3.0}},
    "thick fog": {"fog_mode": "exponential_squared", "fog": {"fog_density": 0.5}},
    "occluded": {"occlusion_kind": "directional", "shadows": "soft"},
    "lamps": {
        "lights": (
            point((0.5, 0.8, 0.2), (1.0, 0.5, 0.2), 2.0, 1.0),
            spot((-0.4, 0.9, 0.3), (0.1, 0.0, 0.1), angle=50.0, softness=0.5),
        ),
        "shadows": "hard",
        "background": (0.2, 0.0, 0.1),
    },
}


LEANING = placed((0.1, 0.0, 0.05), scale=(1.2, 0.8, 0.9)) @ rotated("x", -70.0)


@pytest.fixture(scope="module")
def rich(
    browser: Any, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[OpenPage, Material]]:
    """A page of a material that has every map, and a second layer."""
    material = _rich_material()
    file = tmp_path_factory.mktemp("rich") / "page.html"
    obj = Object(material, layer=VARIATIONS["a layer"]["layer"], transform=LEANING)
    with no_stills():
        write_view(Scene((obj,), camera=CAMERA), file, device="cpu")
    made = OpenPage(browser, file)
    yield made, material
    made.page.close()


def _rich_material() -> Material:
    """Gravel with holes, metal and emission."""
    v, u = np.mgrid[0:TEXELS, 0:TEXELS] / TEXELS
    hole = np.where((u - 0.3) ** 2 + (v - 0.6) ** 2 < 0.02, 0.2, 1.0)
    glow = np.stack([3.0 * (u > 0.75), 0.5 * v, np.zeros_like(u)], -1)

    def map_of(pixels: Any) -> Map:
        return Map(
            np.ascontiguousarray(pixels, np.float32).reshape(TEXELS, TEXELS, -1), False, "made"
        )

    return replace(
        sample("gravel", TEXELS),
        opacity=map_of(hole),
        metallic=map_of((v < 0.4) * 0.9),
        roughness=map_of(0.3 + 0.5 * u),
        emission=map_of(glow),
        layer_mask=map_of(u * v),
        dust=sample("dust", TEXELS // 2, seed=3).height,
    )


@pytest.mark.parametrize("variation", VARIATIONS)
def test_every_option_draws_the_cpus_picture(
    rich: tuple[OpenPage, Material], variation: str
) -> None:
    seen, material = rich
    scene = _varied_scene(material, variation)
    _shown_as(seen, scene)
    drawn = render(scene, size=SIZE, samples=1, device="cpu")
    assert drawn.hit.mean() > 0.1
    assert_agree(drawn, seen.frame(), TEXELS)


def _varied_scene(material: Material, variation: str) -> Scene:
    options = dict(VARIATIONS[variation])
    of_scene = {k: options.pop(k) for k in list(options) if k in Scene.__dataclass_fields__}
    standing = None if "shape" in options else LEANING
    obj = Object(material, **{"scale": 0.08, "transform": standing, **options})
    return Scene((obj,), **{"camera": CAMERA, **of_scene})


@pytest.mark.parametrize("variation", VARIATIONS)
def test_copied_texts_draw_every_option(
    rich: tuple[OpenPage, Material], variation: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen, material = rich
    scene = _varied_scene(material, variation)
    _shown_as(seen, scene)
    seen.frame()
    layer = VARIATIONS["a layer"]["layer"].material
    copied: dict[str, Any] = {}
    with monkeypatch.context() as patch:
        patch.setattr(basrelief, "render", lambda what, **options: copied.update(options))
        patch.setattr(basrelief, "load", lambda path: layer)
        exec(seen.page.evaluate("viewer.text('python')"), {"basrelief": basrelief})
        patch.setattr(arguments, "load", lambda path: layer)
        command = seen.page.evaluate("viewer.text('command')")
        by_command = _scene_of_command(material, command)
    assert copied.pop("size") == SIZE
    wanted = render(scene, size=SIZE, samples=1, device="cpu").color
    by_python = render(material, size=SIZE, samples=1, device="cpu", **copied).color
    assert (np.abs(by_python - wanted) > 1e-3).mean() < 0.002
    # a command has no such transform, and says so
    omitted = scene.objects[0].transform is not None
    assert ("the transform of the object" in command) == omitted
    plain = replace(scene, objects=(replace(scene.objects[0], transform=None),))
    wanted = render(plain, size=SIZE, samples=1, device="cpu").color
    picture = render(by_command, size=SIZE, samples=1, device="cpu").color
    assert (np.abs(picture - wanted) > 1e-3).mean() < 0.002


def test_what_a_text_leaves_out_is_named(fresh: OpenPage) -> None:
    fresh.state(show="depth", compare="steep")
    fresh.page.evaluate("viewer.changed(true)")
    command, line = (fresh.page.evaluate(f"viewer.text('{k}')") for k in ("command", "python"))
    for text in (command, line):
        comment = text.partition("  # ")[2]
        assert "the picture of depth" in comment
        assert "steep right of the divider" in comment
    fresh.state(show="missed", compare="")
    assert "--show missed" in fresh.page.evaluate("viewer.text('command')")
    assert "the picture of missed" in fresh.page.evaluate("viewer.text('python')")


def _shown_as(seen: OpenPage, scene: Scene) -> None:
    """Show a scene in the page of another, with all settings that a page can change."""
    state = state_of(scene, scene.objects[0])
    seen.page.evaluate("viewer.reset()")
    seen.state(**state)
    seen.page.evaluate("viewer.changed(true)")


# --- interaction ------------------------------------------------------------------------------


def test_a_slider_redraws_without_compiling(fresh: OpenPage) -> None:
    before = fresh.frame().color
    compiled = fresh.page.evaluate("viewer.gpu.compiled")
    for name in ("settings.relief.max_steps", "scale", "lights.0.azimuth", "tiling.0"):
        field = fresh.page.locator(f"input[name='{name}']")
        field.locator("xpath=../input[@type='range']").focus()
        fresh.page.keyboard.press("ArrowRight")
        fresh.page.keyboard.press("ArrowRight")
    assert fresh.page.evaluate("viewer.state.lights[0].azimuth") == -48
    assert fresh.page.evaluate("viewer.state.scale") == pytest.approx(0.082)
    assert fresh.page.evaluate("viewer.state.settings.relief.max_steps") > 32
    assert (fresh.frame().color != before).any()
    assert fresh.page.evaluate("viewer.gpu.compiled") == compiled


# --- scrolling --------------------------------------------------------------------------------


def test_maps_scroll_while_you_look_and_rest_at_speed_0(
    fresh: OpenPage, material: Material
) -> None:
    """A moving picture is drawn at one sample; at rest it is refined, and equals the library's."""
    fresh.draw()
    fresh.page.evaluate("viewer.drawing.frames.limit = 3")
    before = fresh.page.evaluate("viewer.drawing.frames.count")
    fresh.page.locator("input[name='scroll.0']").fill("0.5")
    fresh.page.locator("input[name='scroll.1']").fill("-0.25")
    # beyond 1 the shift starts anew, as maps repeat
    for condition in ("viewer.state.shift[0] > 0.3", f"viewer.drawing.frames.count > {before + 2}"):
        fresh.page.wait_for_function(condition)
    u, v = fresh.page.evaluate("viewer.state.shift")
    assert 0.0 < u < 1.0
    assert -1.0 < v < 0.0
    done = fresh.page.evaluate("viewer.drawing.frames.done")
    assert done <= 1
    command = fresh.page.evaluate("viewer.text('command')")
    assert "--shift=" in command.partition("  # ")[0]
    assert "the scrolling" in command.partition("  # ")[2]
    compiled = fresh.page.evaluate("viewer.gpu.compiled")
    for axis in (0, 1):
        fresh.page.locator(f"input[name='scroll.{axis}']").fill("0")
    fresh.page.wait_for_function("!viewer.drawing.frames.busy")
    assert fresh.page.evaluate("viewer.drawing.frames.done") == 3
    assert fresh.page.evaluate("viewer.gpu.compiled") == compiled
    shift = tuple(fresh.page.evaluate("viewer.state.shift"))
    fresh.page.wait_for_timeout(100)
    assert tuple(fresh.page.evaluate("viewer.state.shift")) == shift
    # the controls have followed
    shown = float(fresh.page.locator("input[name='shift.0']").input_value())
    assert shown == pytest.approx(shift[0], abs=1e-3)
    fresh.page.evaluate("viewer.drawing.frames.limit = 1")
    assert_agree(expected(material, shift=shift), fresh.frame(), TEXELS)
    assert "the scrolling" not in fresh.page.evaluate("viewer.text('command')")


SCROLLED = """async ([state, seconds]) => {
  const { scrolled } = await import("view/scroll.js");
  scrolled(state, seconds);
  return state;
}"""


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_scrolling_is_that_of_a_film(seen: OpenPage, material: Material, edge: str) -> None:
    obj = Object(
        material, edge=edge, tiling=(2.0, -3.0), shift=(0.1, 0.2),
        tilings={"normal": Tiling((4.0, 1.0), (0.5, 0.0))},
        layer=Layer(material, Tiling((5.0, 4.0), (0.25, 0.1))),
    )  # fmt: skip
    start = Scene((obj,), camera=CAMERA)
    state = {**state_of(start, obj), "scroll": [0.25, -0.5]}
    again = seen.page.evaluate(SCROLLED, [state, 0.75])
    drawn = scene_from_state(again, start).objects[0]
    film = Scrolling(0.25, -0.5)(start, Moment(0.5, 0.75, SIZE)).objects[0]
    assert film.layer is not None
    assert drawn.layer is not None
    assert drawn.shift == pytest.approx(film.shift)
    for found, wanted in (
        (drawn.tilings["normal"], film.tilings["normal"]),
        (drawn.layer.tiling, film.layer.tiling),
    ):
        whole = [a - b for a, b in zip(found.shift, wanted.shift, strict=True)]
        # where maps repeat, whole tiles are dropped
        assert whole == pytest.approx([round(n) for n in whole] if edge == "wrap" else [0, 0])


def test_a_link_scrolls_unless_motion_is_reduced(browser: Any, page_file: Path) -> None:
    for motion in ("no-preference", "reduce"):
        hash = "#" + quote('{"scroll":[0.5,0]}')
        moving = OpenPage(browser, page_file, hash, reduced_motion=motion)
        if motion == "reduce":
            assert moving.page.evaluate("viewer.state.scroll") == [0, 0]
            # what you start yourself moves
            moving.page.locator("input[name='scroll.0']").fill("0.5")
        moving.page.wait_for_function("viewer.state.shift[0] > 0")
        moving.page.close()


def test_a_typed_number_is_clamped_to_its_range(fresh: OpenPage) -> None:
    field = fresh.page.locator("input[name='settings.relief.search_steps']")
    field.fill("99")
    field.press("Tab")
    assert fresh.page.evaluate("viewer.state.settings.relief.search_steps") == 24
    assert field.input_value() == "24"


def test_every_control_has_a_label(fresh: OpenPage) -> None:
    script = """() => [...document.querySelectorAll("#panel :is(input, select)")]
      .filter((c) => !c.labels.length && !c.getAttribute("aria-label")).map((c) => c.outerHTML)"""
    assert fresh.page.evaluate(script) == []


def test_keys_rotate_zoom_move_and_frame(fresh: OpenPage) -> None:
    fresh.page.locator("#canvas").focus()
    camera = "JSON.parse(JSON.stringify(viewer.state.camera))"
    fresh.page.keyboard.press("ArrowRight")
    fresh.page.keyboard.press("ArrowUp")
    rotated = fresh.page.evaluate(camera)
    assert (rotated["azimuth"], rotated["elevation"]) == (28, 36)
    fresh.page.keyboard.press("+")
    near = fresh.page.evaluate(camera)["distance"]
    fresh.page.keyboard.press("-")
    assert fresh.page.evaluate(camera)["distance"] > near
    fresh.page.keyboard.press("Shift+ArrowRight")
    assert fresh.page.evaluate(camera)["target"] != [0, 0, 0]
    fresh.page.keyboard.press("0")
    framed = fresh.page.evaluate(camera)
    assert (framed["target"], framed["distance"]) == ([0, 0, 0], None)


def test_the_mouse_rotates_and_the_wheel_zooms(fresh: OpenPage) -> None:
    box = fresh.page.locator("#canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    fresh.page.mouse.move(x, y)
    fresh.page.mouse.down()
    fresh.page.mouse.move(x - 50, y + 25)
    fresh.page.mouse.up()
    camera = fresh.page.evaluate("viewer.state.camera")
    assert camera["azimuth"] == pytest.approx(44.0)
    assert camera["elevation"] == pytest.approx(42.0)
    fresh.page.mouse.wheel(0, -100)
    fresh.page.wait_for_function("viewer.state.camera.distance !== null")


def test_the_mouse_with_alt_rotates_the_light(fresh: OpenPage) -> None:
    box = fresh.page.locator("#canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = fresh.page.evaluate("structuredClone(viewer.state)")
    fresh.page.mouse.move(x, y)
    fresh.page.keyboard.down("Alt")
    fresh.page.mouse.down()
    fresh.page.mouse.move(x + 50, y - 25)
    fresh.page.mouse.up()
    fresh.page.keyboard.up("Alt")
    state = fresh.page.evaluate("viewer.state")
    assert state["camera"] == before["camera"]
    light, usual = state["lights"][0], before["lights"][0]
    assert light["azimuth"] == pytest.approx(usual["azimuth"] + 20.0)
    assert light["elevation"] == pytest.approx(usual["elevation"] + 10.0)
    assert state["lights"][1:] == before["lights"][1:]


def test_the_camera_is_in_the_panel(fresh: OpenPage, material: Material) -> None:
    page = fresh.page
    fresh.draw()
    fresh.open("camera")
    distance = page.get_by_label("distance", exact=True)
    framed = CAMERA.framing(Object(material).resolved.bounding_points(), SIZE).distance
    assert float(distance.input_value()) == pytest.approx(framed, rel=1e-3)
    page.get_by_label("camera azimuth", exact=True).fill("-40")
    page.get_by_label("field of view").last.fill("50")
    distance.fill("1.5")
    wanted = Orbit(-40.0, 32.0, 1.5, field_of_view=50.0)
    assert_agree(expected(material, camera=wanted), fresh.frame(), TEXELS)
    # switching the projection keeps the view height
    page.get_by_label("Orthographic").check()
    assert page.evaluate("document.activeElement.name") == "orthographic"
    page.wait_for_function("viewer.drawing.state?.camera.orthographic_height !== null")
    seen_height = float(page.get_by_label("view height", exact=True).input_value())
    assert seen_height == pytest.approx(3.0 * np.tan(np.radians(25.0)), rel=1e-3)
    page.get_by_label("view height", exact=True).fill("0.75")
    wanted = replace(wanted, orthographic_height=0.75)
    assert_agree(expected(material, camera=wanted), fresh.frame(), TEXELS)
    # a plane is not seen from behind
    page.get_by_label("camera elevation", exact=True).fill("-30")
    assert page.evaluate("viewer.state.camera.elevation") == 2
    page.get_by_label("Orthographic").uncheck()
    assert page.evaluate("viewer.state.camera.orthographic_height") is None
    assert page.get_by_label("field of view").last.is_visible()
    # framing shows the whole shape, and a close camera does not clip it
    page.get_by_label("camera elevation", exact=True).fill("40")
    page.get_by_label("Orthographic").check()
    page.locator("#frame").click()
    framed = page.evaluate(
        "[viewer.state.camera.orthographic_height, viewer.wholeCamera().distance]"
    )
    wanted = Orbit(-40.0, 40.0, framed[1], orthographic_height=framed[0])
    whole = expected(material, camera=wanted)
    rows, columns = np.nonzero(whole.hit)
    assert rows.min() > 0
    assert columns.min() > 0
    filled = max(np.ptp(columns) / SIZE[0], np.ptp(rows) / SIZE[1])
    assert filled == pytest.approx(FRAME_FILL, abs=0.03)
    distance.fill("0.2")
    assert page.evaluate("viewer.state.camera.distance") > 0.5
    shown = fresh.frame()
    shown.distance = whole.distance
    assert_agree(whole, shown, TEXELS)
    page.get_by_label("Orthographic").uncheck()
    # zooming from far away is gradual
    distance.fill("100")
    page.locator("#canvas").focus()
    page.keyboard.press("+")
    assert page.evaluate("viewer.state.camera.distance") == pytest.approx(100.0 / 1.12)


def test_one_finger_rotates_and_two_move_and_zoom(fresh: OpenPage) -> None:
    box = fresh.page.locator("#canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    wire = fresh.page.context.new_cdp_session(fresh.page)

    def touch(kind: str, *points: tuple[float, float]) -> dict[str, Any]:
        before = fresh.page.evaluate("viewer.state.camera")
        fingers = [{"x": x + dx, "y": y + dy, "id": k} for k, (dx, dy) in enumerate(points)]
        wire.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})
        if kind == "touchMove":
            changed = "before => JSON.stringify(viewer.state.camera) !== JSON.stringify(before)"
            fresh.page.wait_for_function(changed, arg=before)
        # events of further fingers arrive with the next frames
        camera: dict[str, Any] = fresh.page.evaluate(
            """async () => {
              for (let k = 0; k < 3; k++) await new Promise(requestAnimationFrame);
              return structuredClone(viewer.state.camera);
            }"""
        )
        return camera

    touch("touchStart", (0.0, 0.0))
    rotated = touch("touchMove", (-50.0, 25.0))
    assert rotated["azimuth"] == pytest.approx(44.0, abs=0.5)
    assert rotated["elevation"] == pytest.approx(42.0, abs=0.5)
    touch("touchEnd")
    touch("touchStart", (-20.0, 0.0), (20.0, 0.0))
    near = touch("touchMove", (-21.0, 0.0), (21.0, 0.0))["distance"]
    error = touch("touchMove", (-60.0, 0.0), (60.0, 0.0))
    assert error["distance"] < 0.5 * near
    # both move left: the picture follows, so the camera moves right
    moved = touch("touchMove", (-100.0, 0.0), (20.0, 0.0))
    touch("touchEnd")
    assert moved["distance"] == pytest.approx(error["distance"], rel=0.02)
    assert moved["azimuth"] == rotated["azimuth"]
    across = np.array([np.cos(np.radians(44.0)), 0.0, -np.sin(np.radians(44.0))])
    assert np.dot(np.subtract(moved["target"], error["target"]), across) > 0.01


def _type(page: Any, text: str) -> None:
    """Type into a menu at 20 keys a second by the events' timestamps.

    With real timestamps a slow machine would pause within a name, which starts a new one.
    """
    page.evaluate("() => { viewer.writing = 60_000; }")
    wire = page.context.new_cdp_session(page)
    start = time.time()
    for k, letter in enumerate(text):
        when = {"timestamp": start + 0.05 * k}
        wire.send(
            "Input.dispatchKeyEvent", {"type": "keyDown", "text": letter, "key": letter} | when
        )
        wire.send("Input.dispatchKeyEvent", {"type": "keyUp", "key": letter} | when)
    wire.detach()
    page.evaluate("() => { viewer.writing = 800; }")


def test_all_controls_are_reachable_by_keyboard(fresh: OpenPage) -> None:
    page = fresh.page
    page.locator("#canvas").focus()
    reached: list[str] = []
    for _ in range(200):
        page.keyboard.press("Tab")
        reached.append(
            page.evaluate("document.activeElement.name || document.activeElement.id || ''")
        )
        if reached[-1] == "reset":
            break
    # controls of folded sections are skipped; a key opens a section
    wanted = {"technique", "preset", "scale", "shape", "lights.0.azimuth", "add-light", "save"}
    assert wanted <= set(reached)
    assert "surface_parameters.standard.roughness" not in reached
    page.locator("#section-surface summary").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.name") == "surface"
    # after a rebuild the focus is near the pressed button
    for id, wanted_id in (("add-light", "add-light"), ("remove-light-3", ""), ("reset", "reset")):
        page.locator(f"#{id}").focus()
        page.keyboard.press("Enter")
        at = page.evaluate("[document.activeElement.id, document.activeElement.tagName]")
        assert at == ([wanted_id, "BUTTON"] if wanted_id else ["", "SUMMARY"])
    page.locator("#section-surface select").first.focus()
    # a name can be typed in full, and the controls follow
    page.locator("select[name=technique]").focus()
    _type(page, "offset limited")
    assert page.evaluate("viewer.state.technique") == "offset_limited"
    page.keyboard.press("Tab")
    after = page.evaluate("document.activeElement.getAttribute('aria-label')")
    assert after == "max offset, slider"
    page.locator("#section-surface select").first.focus()
    # a menu keeps the focus when the panel is rebuilt
    _type(page, "landscape")
    page.evaluate("() => viewer.rebuildNow()")
    assert page.evaluate("[viewer.state.surface, document.activeElement.name]") == [
        "landscape",
        "surface",
    ]


def test_lights_are_added_changed_and_removed(fresh: OpenPage, material: Material) -> None:
    page = fresh.page
    page.get_by_role("button", name="Add light").click()
    page.get_by_label("Light 3", exact=True).select_option("spot")
    for label, value in (("x", "0.4"), ("y", "0.9"), ("cone", "50"), ("intensity", "4")):
        page.get_by_label(f"light 3 {label}", exact=True).fill(value)
    page.get_by_label("light 3 color").fill("#ff8000")
    page.get_by_role("button", name="Remove light 1").click()
    scene = scene_from_state(page.evaluate("viewer.state"), Scene((Object(material),)))
    assert [int(each.kind) for each in scene.lights] == [DIRECTIONAL, SPOT]
    assert [*scene.lights[1].color] == pytest.approx([4.0, 0.8632, 0.0], abs=1e-3)
    assert_agree(render(scene, size=SIZE, samples=1, device="cpu"), fresh.frame(), TEXELS)


def test_the_divider_separates_two_techniques(fresh: OpenPage, material: Material) -> None:
    fresh.page.get_by_label("Compare with").select_option("offset")
    left, right = fresh.frame("left"), fresh.frame("right")
    assert_agree(expected(material), left, TEXELS)
    assert_agree(expected(material, technique="offset"), right, TEXELS)
    divider = fresh.page.get_by_label("Divider")
    divider.focus()
    shown = []
    for key in ("Home", "End"):
        fresh.page.keyboard.press(key)
        url = fresh.page.evaluate("(viewer.drawing.frames.present(), viewer.canvas.toDataURL())")
        shown.append(url)
    assert fresh.page.evaluate("viewer.state.divider") == 1
    assert shown[0] != shown[1]
    fresh.page.get_by_label("Compare with").select_option("")
    fresh.draw()
    alone = fresh.page.evaluate("(viewer.drawing.frames.present(), viewer.canvas.toDataURL())")
    assert alone == shown[1]


def _changed(fresh: OpenPage) -> None:
    fresh.state(
        technique="parallax_occlusion", shape="cylinder", shadows="soft", scale=0.06,
        reference_height=0.75, tiling=[2, 1.5], shift=[-0.25, 0.5], projection="biased", bias=0.2,
        shading_model="phong",
    )  # fmt: skip
    fresh.page.evaluate(
        """() => {
          viewer.state.settings.parallax_occlusion.max_steps = 20;
          viewer.state.lights[1].elevation = 50;
          viewer.state.shading.ambient = [0.2, 0.1, 0.3];
          viewer.state.camera = { ...viewer.state.camera, distance: 3, target: [0.1, -0.1, 0] };
          viewer.changed(true);
        }"""
    )


def test_copied_settings_draw_the_same_picture(
    fresh: OpenPage, material: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    _changed(fresh)
    shown = fresh.frame()
    line = fresh.page.evaluate("viewer.text('python')")
    copied: dict[str, Any] = {}
    monkeypatch.setattr(basrelief, "render", lambda what, **options: copied.update(options))
    exec(line, {"basrelief": basrelief})
    assert copied.pop("size") == SIZE
    drawn = render(material, size=SIZE, samples=1, device="cpu", **copied)
    assert_agree(drawn, shown, TEXELS)
    command = fresh.page.evaluate("viewer.text('command')")
    assert command.startswith("basrelief render sample:bricks ")
    assert command.endswith(
        f" --size {SIZE[0]}x{SIZE[1]}  # without the size and seed of the sample"
    )
    scene = _scene_of_command(material, command)
    assert_agree(render(scene, size=SIZE, samples=1, device="cpu"), shown, TEXELS)


def _scene_of_command(material: Material, command: str) -> Scene:
    """The scene that a copied command would draw."""
    words = shlex.split(command.partition("  # ")[0])[3:]
    several = {
        "set": "settings", "light": "lights", "map_tiling": "map_tiling", "map_shift": "map_shift"
    }  # fmt: skip
    options: dict[str, Any] = {}
    rest = iter([part for word in words for part in _parts(word)])
    for word in rest:
        name = word.removeprefix("--").replace("-", "_")
        value = next(rest)
        if name in several:
            options.setdefault(several[name], []).append(value)
        else:
            number = name in ("scale", "reference_height", "bias", "opening")
            options[name] = float(value) if number else value
    assert re.fullmatch(r"\d+x\d+", options.pop("size"))
    return arguments.scene(material, **options)


def _parts(word: str) -> list[str]:
    return word.split("=", 1) if word.startswith("--") and "=" in word else [word]


def test_a_copied_command_turns_the_object(
    browser: Any, tmp_path: Path, material: Material
) -> None:
    transform = rotated("x", 90.0) @ placed(scale=(1.0, 1.0, 0.5)) @ LYING
    with no_stills():
        write_view(Scene((Object(material, transform=transform),)), tmp_path / "wall.html")
    seen = OpenPage(browser, tmp_path / "wall.html")
    seen.frame()
    command = seen.page.evaluate("viewer.text('command')")
    assert "--turn=x/90" in command
    assert "the transform of the object" not in command
    scene = _scene_of_command(material, command)
    assert scene.objects[0].resolved.transform == pytest.approx(transform)
    assert_agree(render(scene, size=SIZE, samples=1, device="cpu"), seen.frame(), TEXELS)
    seen.page.close()


def test_a_copied_command_without_lights_draws_without_lights(
    fresh: OpenPage, material: Material
) -> None:
    for _ in range(2):
        fresh.page.get_by_role("button", name="Remove light 1").click()
    fresh.page.locator("#add-light").wait_for()
    assert fresh.page.evaluate("viewer.state.lights") == []
    scene = _scene_of_command(material, fresh.page.evaluate("viewer.text('command')"))
    assert scene.lights == ()
    assert_agree(render(scene, size=SIZE, samples=1, device="cpu"), fresh.frame(), TEXELS)


def test_controls_are_described_to_screen_readers(fresh: OpenPage) -> None:
    """Each control of a declared setting has the meaning that its declaration has."""
    controls = fresh.page.evaluate("viewer.data.controls.scene")
    described = 0
    for name, control in controls.items():
        for field in fresh.page.locator(f"#panel [name='{name}'], #panel [name^='{name}.']").all():
            (about,) = (field.get_attribute("aria-describedby") or "missing").split()
            assert fresh.page.locator(f"[id='{about}']").text_content() == control["doc"]
            described += 1
    assert described >= 12
    shape = fresh.page.get_by_label("Shape", exact=True)
    api = pytest.importorskip("playwright.sync_api")
    api.expect(shape).to_have_accessible_description(controls["shape"]["doc"])


def test_a_slider_extends_to_its_value(fresh: OpenPage) -> None:
    fresh.state(scale=2.0, tiling=[50.0, -1.0])
    fresh.page.evaluate("viewer.changed(true)")
    slider = fresh.page.get_by_label("scale, slider", exact=True)
    assert (slider.get_attribute("max"), slider.input_value()) == ("2", "2")
    slider.focus()
    fresh.page.keyboard.press("ArrowLeft")
    assert fresh.page.evaluate("viewer.state.scale") == pytest.approx(2.0, abs=0.05)
    # a number may exceed the slider, up to the library's limit
    fresh.page.get_by_label("scale", exact=True).fill("3.5")
    assert fresh.page.evaluate("viewer.state.scale") == 3.5
    fresh.page.get_by_label("scale", exact=True).fill("30")
    assert fresh.page.evaluate("viewer.state.scale") == 10.0
    assert fresh.page.evaluate("viewer.state.tiling") == [50, -1]


def test_the_divider_is_in_the_link(fresh: OpenPage) -> None:
    fresh.state(compare="offset")
    fresh.page.evaluate("viewer.changed(true)")
    fresh.page.get_by_label("Divider").fill("0.25")
    fresh.page.wait_for_function("decodeURIComponent(location.hash).includes('divider')")
    assert '"divider":0.25' in fresh.page.evaluate("decodeURIComponent(location.hash)")


def test_a_link_restores_the_state(fresh: OpenPage, browser: Any, page_file: Path) -> None:
    _changed(fresh)
    link = fresh.page.evaluate("viewer.text('link')")
    other = OpenPage(browser, page_file, "#" + link.split("#")[1])
    assert other.page.evaluate("viewer.state") == fresh.page.evaluate("viewer.state")
    other.page.close()


def test_an_unreadable_link_is_reported(browser: Any, page_file: Path) -> None:
    for hash in ("#{", "#%7B%22technique%22%3A%22warp%22%2C%22scale%22%3A%22x%22%7D"):
        seen = OpenPage(browser, page_file, hash)
        assert seen.page.evaluate("viewer.state.technique") == "relief"
        assert seen.page.evaluate("viewer.state.scale") == pytest.approx(0.08)
        assert ("cannot be read" in seen.text("#messages")) == (hash == "#{")
        seen.page.close()


ODD: list[Any] = [
    {"scale": None},
    {"scale": 1e9, "reference_height": -3},
    {"settings": {"relief": {"max_steps": 1e7, "min_steps": 2.6}}},
    {"lights": [{}]},
    {"lights": [1, None, {"kind": "spot", "angle": 400, "color": [1]}]},
    {"lights": [{"kind": "point(),));__import__('os').system('id')#", "intensity": 0}]},
    {"lights": [{"kind": "$(id)", "azimuth": "left"}]},
    {"tiling": [], "shift": [1], "tilings": {"normal": {"tiles": [0, 2]}}},
    {"settings": {"relief": {"max_steps": None}, "warp": {}}},
    {"camera": {"elevation": -60, "distance": "x", "target": 3, "field_of_view": 1e3}},
    {"camera": {"azimuth": 1e30, "target": [1e30, -1e30, 0], "orthographic_height": -1}},
    {"show": "xyz", "compare": "warp", "preset": "nothing", "surface": "sea", "fades": "yes"},
    {"fades": True, "fade": [5, 4], "fog_mode": "linear", "fog": {"fog_start": 50, "fog_end": 1}},
    {"constructor": 1, "__proto__": {"scale": 1}, "layer": True},
    [1, 2],
    None,
]


@pytest.mark.parametrize("odd", ODD, ids=range(len(ODD)))
def test_an_invalid_link_is_clamped(
    fresh: OpenPage, material: Material, monkeypatch: pytest.MonkeyPatch, odd: Any
) -> None:
    fresh.page.evaluate("odd => { location.hash = encodeURIComponent(JSON.stringify(odd)) }", odd)
    fresh.page.wait_for_function("viewer.hashesRead > 0")
    fresh.page.evaluate("viewer.hashesRead = 0")
    state = fresh.page.evaluate("viewer.state")
    # the state is valid in Python
    scene = scene_from_state(state, Scene((Object(material),)))
    assert scene.objects[0].resolved.scale <= 10.0
    assert -1.0 < scene.resolved[0].settings.max_steps <= 4096
    scene.shader_camera((16, 9))
    line = fresh.page.evaluate("viewer.text('python')")
    copied: dict[str, Any] = {}
    monkeypatch.setattr(basrelief, "render", lambda what, **options: copied.update(options))
    monkeypatch.setattr("os.system", lambda line: pytest.fail(line))
    exec(line, {"basrelief": basrelief})
    assert len(copied["lights"]) == len(state["lights"]) if "lights" in copied else True
    command = fresh.page.evaluate("viewer.text('command')")
    assert "$(id)" not in command
    _scene_of_command(material, command)
    assert fresh.page.locator("#panel select[name=technique]").count() == 1
    assert fresh.console == []
    fresh.page.evaluate("history.replaceState(null, '', location.pathname)")


def test_the_buttons_copy(fresh: OpenPage) -> None:
    fresh.page.locator("#copy-python").click()
    fresh.page.wait_for_function("document.getElementById('copied').textContent !== ''")
    assert "basrelief.render(" in fresh.text("#copied")


def test_a_picture_that_cannot_be_saved_is_reported(fresh: OpenPage) -> None:
    fresh.page.evaluate("() => { viewer.canvas.toBlob = (then) => then(null) }")
    fresh.page.locator("#save").click()
    fresh.page.get_by_text("The browser makes no picture of the canvas").wait_for()
    fresh.page.evaluate("() => { delete viewer.canvas.toBlob }")
    fresh.page.evaluate("document.getElementById('messages').replaceChildren()")


def test_missed_hits_are_reported_only_where_measured(fresh: OpenPage) -> None:
    fresh.state(technique="offset", show="missed", compare="exact", reference_height=0.5)
    fresh.draw()
    shares = re.search(r" missed ([0-9.]+) \| ([0-9.]+) %", fresh.text("#figures"))
    assert shares is not None
    assert float(shares[1]) > 5.0
    assert float(shares[2]) < 0.1
    fresh.state(compare="")
    fresh.draw()
    assert f" missed {shares[1]} %" in fresh.text("#figures")
    # the truth's program fails, and colours are shown
    fresh.page.evaluate(
        "() => { const { drawing } = viewer; const side = drawing.side.bind(drawing);"
        " drawing.side = async (name, state) => {"
        " if (name === 'truth') throw new Error('none'); return side(name, state); } }"
    )
    fresh.draw()
    assert "exact: none" in fresh.text("#messages")
    assert "missed" not in fresh.text("#figures")
    fresh.page.evaluate("() => { delete viewer.drawing.side }")
    fresh.page.evaluate("document.getElementById('messages').replaceChildren()")


def test_the_picture_is_saved(fresh: OpenPage) -> None:
    fresh.draw()
    with fresh.page.expect_download() as waiting:
        fresh.page.locator("#save").click()
    assert waiting.value.suggested_filename == "bricks-relief.png"
    assert read_picture(waiting.value.path().rename(_place("saved.png"))).pixels.shape[:2] == (
        SIZE[1],
        SIZE[0],
    )


@pytest.mark.parametrize("name", ["gamedev", "habrador-bricks", "halliwell", "wikibooks"])
def test_presets_equal_the_librarys(fresh: OpenPage, material: Material, name: str) -> None:
    fresh.page.get_by_label("Preset").select_option(name)
    scene = preset(name).scene(material, camera=CAMERA, shape="plane")
    drawn = render(scene, size=SIZE, samples=1, device="cpu")
    assert_agree(drawn, fresh.frame(), TEXELS)
    # a changed setting clears the preset's name
    assert fresh.page.get_by_label("Preset").input_value() == name
    assert fresh.text("#about-preset") != ""
    fresh.page.get_by_label("reference height", exact=True).fill("0.3")
    assert fresh.page.get_by_label("Preset").input_value() == ""
    assert fresh.text("#about-preset") == ""


def test_a_preset_keeps_its_lengths_on_another_shape(fresh: OpenPage, material: Material) -> None:
    """A scale in widths of the shape is four times as much in those of a sphere's tiles."""
    fresh.page.get_by_label("Preset").select_option("wikibooks")
    for shape in ("sphere", "plane", "cylinder"):
        fresh.page.get_by_label("Shape").select_option(shape)
        (obj,) = preset("wikibooks").scene(material, shape=shape).resolved
        assert fresh.page.evaluate("viewer.state.scale") == pytest.approx(obj.scale)
        settings = fresh.page.evaluate("viewer.state.settings.offset")
        assert settings == pytest.approx(json_value(obj.settings))
        assert fresh.page.get_by_label("Preset").input_value() == "wikibooks"
    fresh.page.get_by_label("Preset").select_option("catlike")
    fresh.page.get_by_label("Shape").select_option("sphere")
    assert fresh.page.evaluate("viewer.state.scale") == pytest.approx(0.03)


def test_a_preset_with_a_layer_is_disabled_on_a_page_without_one(
    seen: OpenPage, browser: Any, tmp_path: Path
) -> None:
    def disabled(seen: OpenPage) -> list[str]:
        found: list[str] = seen.page.evaluate(
            "Object.entries(viewer.data.presets).flatMap(([name, { state }]) => state ? [] : name)"
        )
        return found

    assert disabled(seen) == ["habrador"]
    why = seen.page.evaluate("viewer.data.presets.habrador.why")
    assert why == "it has a layer of stone; make a page with --preset habrador"
    # a landscape with grass, stone and water
    noise = sample("noise", TEXELS)
    scene = preset("habrador").scene(noise, camera=CAMERA)
    with no_stills():
        write_view(scene, tmp_path / "page.html", device="cpu")
    other = OpenPage(browser, tmp_path / "page.html")
    assert disabled(other) == []
    assert_agree(render(scene, size=SIZE, samples=1, device="cpu"), other.frame(), TEXELS)
    other.page.close()


OWN = """
from basrelief.lang import HeightField, setting, shader, struct
from basrelief.techniques import Hit, Ray, height_under, hit_at, t_at, technique

@struct
class Halving:
    share: float = setting(default=0.5, doc="where the height is read", low=0.0, high=1.0)

@technique()
def steep(field: HeightField, ray: Ray, settings: Halving) -> Hit:
    height = height_under(field, ray, settings.share)
    return hit_at(ray, t_at(ray, height), True, 1)
"""


def test_a_user_defined_technique_is_in_the_menu(
    browser: Any, tmp_path: Path, material: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    own = Object(material, technique="own.py:steep", settings={"share": 0.7}, scale=0.08)
    scene = Scene((own,), camera=CAMERA)
    with no_stills():
        write_view(scene, tmp_path / "page.html", device="cpu")
    seen = OpenPage(browser, tmp_path / "page.html")
    drawn = render(scene, size=SIZE, samples=1, device="cpu")
    assert_agree(drawn, seen.frame(), TEXELS)
    # next to the library's technique of that name
    assert seen.page.locator("select[name=technique]").input_value() == "steep_"
    assert "--technique own.py:steep " in seen.page.evaluate("viewer.text('command')")
    # a preset is named on such a page too
    seen.page.get_by_label("Preset").select_option("gamedev")
    assert seen.page.evaluate("viewer.state.preset") == "gamedev"
    seen.page.close()


# --- dropped maps --------------------------------------------------------------------------------


def test_a_dropped_height_map_is_drawn(browser: Any, page_file: Path, material: Material) -> None:
    seen = OpenPage(browser, page_file)
    rng = np.random.default_rng(3)
    coarse = rng.integers(40, 216, (8, 8)).astype(np.uint8)
    codes = np.kron(coarse, np.ones((8, 8), np.uint8))
    pixels = np.stack([codes, codes[::-1], codes], -1)
    file = write_data(_place("other_heights.png"), pixels)
    seen.open("maps")
    seen.page.get_by_label("Channel").select_option("g")
    seen.page.get_by_label("White").select_option("depth")
    _drop(seen, file)
    seen.page.wait_for_function("viewer.mapMessage !== ''")
    assert "other_heights.png: 64 × 64" in seen.text("#map-message")
    heights = (1.0 - codes[::-1] / np.float32(255.0)).astype(np.float32)[:, :, None]
    swapped = replace(material, height=Map(heights, False, "dropped"))
    assert_agree(expected(swapped), seen.frame(), TEXELS)
    assert seen.page.locator("#panel option[disabled]", has_text="needs").count() == 0
    seen.page.close()


def test_a_hole_opens_as_its_slider_moves(fresh: OpenPage, material: Material) -> None:
    """The page opens it by itself, without compiling, and by the same maps as the library."""

    def expected(opening: float | None) -> Frame:
        obj = Object(material, scale=0.08, opening=opening)
        return render(Scene((obj,), camera=CAMERA), size=SIZE, samples=1, device="cpu")

    whole = fresh.frame()
    assert fresh.page.locator("input[name=opening]").count() == 0
    fresh.page.locator("#hole").click()
    assert fresh.page.evaluate("viewer.state.opening") == 0.6
    assert_agree(expected(0.6), fresh.frame(), TEXELS)
    compiled = fresh.page.evaluate("viewer.gpu.compiled")
    fresh.page.locator("#opening-slider").focus()
    for _ in range(3):
        fresh.page.keyboard.press("ArrowRight")
    assert fresh.page.evaluate("viewer.state.opening") == 0.63
    assert_agree(expected(0.63), fresh.frame(), TEXELS)
    assert fresh.page.evaluate("viewer.gpu.compiled") == compiled
    # the copies have it, and the maps of the panel are those of the material
    assert "--opening 0.63" in fresh.page.evaluate("viewer.text('command')")
    assert "opening=0.63" in fresh.page.evaluate("viewer.text('python')")
    assert fresh.page.evaluate("viewer.pictures === viewer.original")
    # a table that the hole needs is baked of its heights
    fresh.state(technique="exact")
    fresh.page.evaluate("viewer.changed(true)")
    exact = Object(material, scale=0.08, opening=0.63, technique="exact")
    drawn = render(Scene((exact,), camera=CAMERA), size=SIZE, samples=1, device="cpu")
    assert_agree(drawn, fresh.frame(), TEXELS)
    fresh.state(technique="relief")
    fresh.page.evaluate("viewer.changed(true)")
    fresh.page.locator("#hole").click()
    assert fresh.page.evaluate("viewer.state.opening") is None
    assert (fresh.frame().color == whole.color).all()


def test_the_default_scale_becomes_that_of_a_hole(fresh: OpenPage) -> None:
    default = fresh.page.evaluate("viewer.data.defaults.options.scale")
    assert default != 0.3
    fresh.state(scale=default)
    fresh.page.evaluate("viewer.changed(true)")
    fresh.page.locator("#hole").click()
    assert fresh.page.evaluate("viewer.state.scale") == 0.3
    command = fresh.page.evaluate("viewer.text('command')")
    assert "--opening 0.6" in command
    assert "--scale" not in command
    fresh.page.locator("#hole").click()
    assert fresh.page.evaluate("viewer.state.scale") == default
    # a scale that the user has chosen stays
    fresh.page.locator("#hole").click()
    fresh.state(scale=0.2)
    fresh.page.locator("#hole").click()
    assert fresh.page.evaluate("viewer.state.scale") == 0.2
    fresh.page.locator("#hole").click()
    assert fresh.page.evaluate("viewer.state.scale") == 0.2


def test_dust_that_comes_before_heights_opens_a_hole(fresh: OpenPage) -> None:
    fresh.open("maps")
    fresh.page.locator("#remove-height").click()
    fresh.page.wait_for_function("!viewer.hasHeights")
    files = [
        write_data(_place(f"wall_{name}.png"), np.full((4, 4, 1), 200, np.uint8))
        for name in ("dust_map", "height")
    ]
    _drop(fresh, files[0])
    fresh.page.wait_for_function("viewer.mapMessage.includes('dust')")
    assert fresh.page.evaluate("viewer.state.opening") is None
    assert fresh.page.evaluate("viewer.state.scale") == 0.08
    _drop(fresh, *files)
    fresh.page.wait_for_function("viewer.mapMessage.includes('height')")
    assert fresh.page.evaluate("viewer.state.opening") == 0.6


def test_pages_without_heights_store_no_dust(tmp_path: Path) -> None:
    for name, stored in (("grid", False), ("cracks", True)):
        file = tmp_path / f"{name}.html"
        with no_stills():
            write_view(Scene((Object(sample(name, 8)),)), file, device="cpu")
        assert ("map-dust" in file.read_text("utf-8")) == stored


def test_dropped_dust_opens_a_hole(fresh: OpenPage, material: Material) -> None:
    codes = (sample("noise", 32).height.linear() * 255).astype(np.uint8)  # type: ignore[union-attr]
    _drop(fresh, write_data(_place("thick.png"), codes), on="dust")
    fresh.page.wait_for_function("viewer.mapMessage.startsWith('thick.png')")
    assert fresh.page.evaluate("viewer.state.opening") == 0.6
    swapped = replace(material, dust=Map(codes, False, "dropped"))
    hole = Scene((Object(swapped, scale=0.08, opening=0.6),), camera=CAMERA)
    drawn = render(hole, size=SIZE, samples=1, device="cpu")
    assert_agree(drawn, fresh.frame(), TEXELS)
    fresh.open("maps")
    fresh.page.locator("#remove-dust").click()
    fresh.page.wait_for_function("viewer.mapMessage.startsWith('Drawn without')")
    assert fresh.page.evaluate("viewer.state.opening") is None
    assert fresh.page.locator("#hole").count() == 0
    # an opening without dust has no effect, and no copy has it
    fresh.state(opening=0.5)
    fresh.page.evaluate("viewer.changed(true)")
    assert "--opening" not in fresh.page.evaluate("viewer.text('command')")
    assert_agree(
        render(Scene((Object(material, scale=0.08),), camera=CAMERA), size=SIZE, samples=1,
               device="cpu"),
        fresh.frame(), TEXELS,
    )  # fmt: skip


def test_a_dropped_file_that_is_not_a_picture_is_reported(fresh: OpenPage) -> None:
    before = fresh.frame().color
    file = _place("notes.txt")
    file.write_text("no picture")
    _drop(fresh, file)
    fresh.page.wait_for_function("document.getElementById('messages').textContent !== ''")
    assert "notes.txt: its name matches no map of the page; drop it on" in fresh.text("#messages")
    _drop(fresh, file, on="roughness")
    fresh.page.get_by_text("notes.txt: this is no picture").wait_for()
    assert np.array_equal(fresh.frame().color, before)


def test_a_picture_dropped_on_a_map_replaces_it(fresh: OpenPage, material: Material) -> None:
    rng = np.random.default_rng(8)
    codes = np.kron(rng.integers(20, 235, (8, 8, 1)), np.ones((8, 8, 1), int)).astype(np.uint8)
    # by its name it is inverted as roughness, and as any other map unchanged
    file = write_data(_place("wall_gloss.png"), codes)
    row = fresh.page.locator(".map[data-slot=roughness]")
    _drop(fresh, file, on="roughness", event="dragover")
    assert row.get_attribute("class") == "map over"
    _drop(fresh, file, on="roughness")
    fresh.page.wait_for_function("viewer.mapMessage.endsWith('used as roughness, inverted')")
    assert fresh.page.locator(".map.over, .dropping").count() == 0
    assert "64 × 64" in row.text_content()
    assert "wall_gloss.png" in row.text_content()
    swapped = replace(material, roughness=Map(255 - codes, False, "dropped"))
    assert_agree(expected(swapped), fresh.frame(), TEXELS)
    _drop(fresh, file, on="height")
    fresh.page.wait_for_function("viewer.mapMessage.endsWith('used as heights')")
    swapped = replace(swapped, height=Map(codes, False, "dropped"))
    assert_agree(expected(swapped), fresh.frame(), TEXELS)
    # choices of the panel override the name
    fresh.open("maps")
    fresh.page.get_by_label("White").select_option("height")
    with fresh.page.expect_file_chooser() as waiting:
        fresh.page.get_by_role("button", name="Choose a picture for roughness").click()
    waiting.value.set_files(file)
    fresh.page.wait_for_function("viewer.mapMessage.endsWith('used as roughness')")
    swapped = replace(swapped, roughness=Map(codes, False, "dropped"))
    assert_agree(expected(swapped), fresh.frame(), TEXELS)


GONE: dict[str, dict[str, Any]] = {
    "base_color": {"base_color": None},
    "opacity": {"opacity": None},
    "normal": {"normal": None},
    "occlusion": {"occlusion": None},
    "roughness": {"roughness": None},
    "metallic": {"metallic": None},
    "emission": {"emission": None},
    "height": {"height": None},
}


@pytest.mark.parametrize("slot", GONE)
def test_a_map_can_be_removed(rich: tuple[OpenPage, Material], slot: str) -> None:
    seen, material = rich
    _shown_as(seen, Scene((Object(material, scale=0.08, transform=LEANING),), camera=CAMERA))
    with_all = seen.frame().color
    seen.open("maps")
    row = seen.page.locator(f".map[data-slot={slot}]")
    gone = seen.page.locator(f"#remove-{slot}")
    if not gone.count():
        # add a missing map first
        assert getattr(material, slot) is None
        pixels = np.full((TEXELS, TEXELS, 3), (128, 128, 255), np.uint8)
        pixels[:, ::2] = (200, 128, 230)
        _drop(seen, write_data(_place("made.png"), pixels), on=slot)
        gone.wait_for()
    gone.focus()
    seen.page.keyboard.press("Enter")
    seen.page.wait_for_function("viewer.mapMessage.startsWith('Drawn without')")
    assert seen.page.evaluate("document.activeElement.id") == f"choose-{slot}"
    assert gone.count() == 0
    assert row.locator("canvas").count() == 0
    flat = {"technique": "flat"} if slot == "height" else {}
    less = Object(replace(material, **GONE[slot]), scale=0.08, transform=LEANING, **flat)
    drawn = render(Scene((less,), camera=CAMERA), size=SIZE, samples=1, device="cpu")
    found = seen.frame()
    assert_agree(drawn, found, TEXELS)
    if getattr(material, slot) is not None:
        assert (found.color != with_all).any()
    seen.page.evaluate("viewer.reset()")


def test_opacity_is_read_as_by_the_library(fresh: OpenPage, material: Material) -> None:
    v, u = np.mgrid[0:TEXELS, 0:TEXELS]
    pixels = np.stack([3 * u, 3 * v, 0 * u + 90, 0 * u], -1).astype(np.uint8)
    # uniform alpha is ignored
    _drop(fresh, write_data(_place("x_color.png"), pixels))
    fresh.page.wait_for_function("viewer.mapMessage.includes('x_color')")
    color = Map(np.ascontiguousarray(pixels[:, :, :3]), True, "dropped")
    swapped = replace(material, base_color=color)
    assert_agree(expected(swapped), fresh.frame(), TEXELS)
    assert "none" in fresh.page.locator(".map[data-slot=opacity]").text_content()
    # a cut-out in the alpha of a picture, by its name
    pixels[:, :, 3] = np.where((u // 8 + v // 8) % 2 == 0, 255, 60)
    _drop(fresh, write_data(_place("x_opacity.png"), pixels))
    fresh.page.wait_for_function("viewer.mapMessage.includes('x_opacity')")
    alpha = Map(np.ascontiguousarray(pixels[:, :, 3:]), False, "dropped")
    assert_agree(expected(replace(swapped, opacity=alpha)), fresh.frame(), TEXELS)


def test_errors_stay(fresh: OpenPage) -> None:
    files = []
    for k in range(5):
        files.append(_place(f"text{k}.txt"))
        files[-1].write_text("no picture")
    wide = write_data(_place("wide_color.png"), np.full((8, 24, 3), 90, np.uint8))
    _drop(fresh, *files, wide)
    fresh.page.wait_for_function("viewer.mapMessage.includes('wide_color')")
    messages = fresh.text("#messages")
    for file in files:
        assert f"{file.name}: its name matches no map" in messages
    assert "wide_color.png has other proportions" in messages
    fresh.page.evaluate("document.getElementById('messages').replaceChildren()")


def test_a_rebuild_waits_for_the_release_of_a_button(fresh: OpenPage) -> None:
    page = fresh.page
    page.locator("select[name=technique]").focus()
    _type(page, "par")
    assert page.evaluate("viewer.rebuilding !== null")
    assert page.evaluate("viewer.state.technique") == "parallax_occlusion"
    box = page.locator("#section-technique summary").bounding_box()
    page.mouse.move(box["x"] + 20, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.wait_for_timeout(80)
    page.mouse.up()
    page.wait_for_function("!document.getElementById('section-technique').open")
    # the panel shows the settings of the technique
    own = page.locator("input[name='settings.parallax_occlusion.steps_per_texel']")
    own.wait_for(state="attached")
    fresh.open("technique")
    assert own.is_visible()


def test_the_focused_control_is_not_behind_the_picture(browser: Any, page_file: Path) -> None:
    seen = OpenPage(browser, page_file, viewport={"width": 390, "height": 700})
    page = seen.page
    page.evaluate(
        "document.querySelectorAll('#panel details').forEach((each) => { each.open = true; })"
    )
    page.locator("#reset").focus()
    hidden = """() => {
      const { bottom } = document.activeElement.getBoundingClientRect();
      return bottom < document.getElementById("stage").getBoundingClientRect().bottom;
    }"""
    names = []
    for _ in range(40):
        page.keyboard.press("Shift+Tab")
        names.append(page.evaluate("document.activeElement.id"))
        assert not page.evaluate(hidden), names[-1]
    assert len(set(names)) > 30
    seen.page.close()


def test_dropped_text_is_left_to_the_browser(fresh: OpenPage) -> None:
    script = """() => {
      const dataTransfer = new DataTransfer();
      dataTransfer.setData("text/plain", "0.25");
      const target = document.querySelector("input[name=scale]");
      const how = { dataTransfer, bubbles: true, cancelable: true };
      const untouched = (name) => target.dispatchEvent(new DragEvent(name, how));
      return [untouched("dragover"), untouched("drop"), document.body.className];
    }"""
    assert fresh.page.evaluate(script) == [True, True, "with"]


def test_the_panel_shows_the_maps(rich: tuple[OpenPage, Material], fresh: OpenPage) -> None:
    seen, material = rich
    seen.page.evaluate("viewer.reset()")
    seen.open("maps")
    script = """slot => {
      const row = document.querySelector(`.map[data-slot=${slot}]`);
      const canvas = row.querySelector("canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return [canvas.width, canvas.height, data, row.querySelector(".about").innerText];
    }"""
    for slot, name in (
        ("base_color", "base_color"), ("height", "height"), ("opacity", "opacity"),
        ("roughness", "roughness"), ("metallic", "metallic"), ("emission", "emission"),
    ):  # fmt: skip
        map = getattr(material, name)
        width, height, codes, about = evaluate(seen.page, script, slot)
        found = codes.reshape(height, width, 4)[:, :, :3].astype(int)
        assert (width, height) == (88, 88)
        assert f"{map.width} × {map.height}" in about
        assert about.endswith(map.source)
        light = np.minimum(map.linear(), 1.0) if slot != "emission" else map.linear() / 3.0
        wanted = srgb_encode(light) if slot in ("base_color", "emission") else light
        # each pixel of the thumbnail is one texel of the map
        at = (2 * np.arange(88) + 1) * TEXELS // 176
        error = np.abs(found - 255.0 * wanted[at][:, at])
        assert error.max() <= 1.0, slot
    assert seen.page.locator(".map[data-slot=normal]").text_content().startswith("normals")
    # a material without this map
    script = "slot => document.querySelector(`.map[data-slot=${slot}]`).textContent"
    assert "none" in fresh.page.evaluate(script, "emission")
    assert fresh.page.locator(".map[data-slot=emission] canvas").count() == 0


def test_pictures_dropped_together_are_assigned_by_name(
    fresh: OpenPage, material: Material
) -> None:
    rng = np.random.default_rng(5)
    folder = _place("wall").parent
    noise = np.kron(rng.integers(60, 200, (8, 8, 3)), np.ones((8, 8, 1), int)).astype(np.uint8)
    names = ("Wall_Color.png", "wall_depth_1k.png", "wall_gloss.png", "notes.txt")
    for name, pixels in zip(names, (noise, noise[::-1, :, :1], noise[:, ::-1, 1:2]), strict=False):
        write_data(folder / name, np.ascontiguousarray(pixels))
    (folder / "notes.txt").write_text("no picture")
    fresh.open("maps")
    fresh.page.get_by_label("Pictures").set_input_files([folder / name for name in names])
    fresh.page.get_by_text("notes.txt: its name matches no map").wait_for()
    fresh.page.wait_for_function("viewer.mapMessage.includes('gloss')")
    assert fresh.text("#map-message").count("inverted") == 2

    def map_of(pixels: np.ndarray, srgb: bool = False) -> Map:
        return Map(np.ascontiguousarray(pixels), srgb, "dropped")

    swapped = replace(
        material,
        base_color=map_of(noise, srgb=True),
        height=map_of(255 - noise[::-1, :, :1]),
        roughness=map_of(255 - noise[:, ::-1, 1:2]),
    )
    assert_agree(expected(swapped), fresh.frame(), TEXELS)
    # copied text cannot include them and says so
    fresh.page.get_by_role("button", name="Copy as command").click()
    assert "Changed maps are not included." in fresh.text("#copied")
    # reset restores the maps
    fresh.page.get_by_role("button", name="Reset").click()
    assert_agree(expected(material), fresh.frame(), TEXELS)


def test_heights_dropped_on_a_page_without_heights_are_drawn(browser: Any, tmp_path: Path) -> None:
    plain = Material("plain", base_color=sample("bricks", 32).base_color)
    with no_stills():
        write_view(Scene((Object(plain),)), tmp_path / "page.html", device="cpu")
    seen = OpenPage(browser, tmp_path / "page.html")
    assert seen.page.evaluate("viewer.state.technique") == "flat"
    ramp = np.linspace(0, 255, 32).astype(np.uint8)[None, :, None].repeat(32, 0)
    _drop(seen, write_data(_place("plain_height.png"), ramp))
    seen.page.wait_for_function("viewer.mapMessage !== ''")
    assert seen.page.evaluate("viewer.state.technique") == "relief"
    assert seen.frame().reads.max() > 8
    seen.page.close()


NAMES = [
    "Rock058_1K-JPG_Color.jpg", "Rock058_1K-JPG_NormalDX.jpg", "rough_wood_diff_1k.png",
    "T_Wall_N.tga", "T_Wall_R.png", "brick_ao_2k.jpg", "wall_arm_4k.png", "Wall_Gloss.png",
    "wall_height_inv.png", "depth.png", "Wall_DispGL.png", "parallax_mapping_d3d_normal.png",
    "normal_opengl.png", "metal_roughness.png", "wall_orm.png", "wall_rma.png", "preview.png",
    "wall_specular.png", "Wall Bump 16bit.tif", "wall_nh.png", "wall.png", "4096x4096.png",
    "wall_emissiveColor.png", "albedoTransparency.png", "WallOpacityMap.png", "layerMask.png",
    "height_constructor.png", "wall_normal_valueOf.png", "T_Wall_toString.png",
]  # fmt: skip


def test_names_are_parsed_as_by_the_library(seen: OpenPage) -> None:
    script = """async (names) => {
      const { meaningOf } = await import("view/names.js");
      return names.map((name) => meaningOf(name, viewer.data.names));
    }"""
    for name, found in zip(NAMES, seen.page.evaluate(script, NAMES), strict=True):
        meaning = parse_name(name.rsplit(".", 1)[0]).meaning
        place, over = ("", False) if meaning is None else place_of(meaning)
        if not place:
            assert found is None, name
            continue
        assert meaning is not None
        polarity = "depth" if over else "height"
        wanted = {"slot": place, "polarity": polarity, "green": meaning.green or "gl"}
        assert found == wanted, name


def _drop(seen: OpenPage, *files: Path, on: str = "", event: str = "drop") -> None:
    """Drop files on the page or on a map of its panel, or drag them over it."""
    contents = [[each.name, base64.b64encode(each.read_bytes()).decode()] for each in files]
    script = """([contents, on, event]) => {
      const dataTransfer = new DataTransfer();
      for (const [name, content] of contents) {
        const bytes = Uint8Array.from(atob(content), (c) => c.charCodeAt(0));
        dataTransfer.items.add(new File([bytes], name));
      }
      const target = on ? document.querySelector(`.map[data-slot=${on}]`) : document.body;
      target.dispatchEvent(new DragEvent(event, { dataTransfer, bubbles: true, cancelable: true }));
    }"""
    seen.page.evaluate(script, [contents, on, event])


# --- pacing ---------------------------------------------------------------------------------

PACE = """async () => {
  const { Pace } = await import("view/pace.js");
  const found = { at_once: [], sizes: [], rows: [] };
  let pace = new Pace(true);
  const look = () => {
    let most = 0;
    for (pace.flying = 0; pace.free; pace.flying += 1) most += 1;
    pace.flying = 0;
    found.at_once.push(most);
    found.sizes.push(pace.moving([1000, 500]));
    found.rows.push(pace.rows(1000, 4));
  };
  look();
  // one that is slow, one that is slower than can be helped, one that is quick, and more of them
  for (const milliseconds of [132, 33000, 1]) {
    pace.note(milliseconds, 500000);
    look();
  }
  for (let k = 0; k < 8; k++) pace.note(1, 500000);
  look();
  // the first answer is to what was asked before
  const answers = [300, 101, 110, 102];
  const wait = () => new Promise((next) => setTimeout(next, answers.shift()));
  await pace.measureLatency({ submit() {}, onSubmittedWorkDone: wait });
  found.latency = pace.latency;
  pace.latency = 100;
  look();
  pace.note(50, 500000);
  look();
  found.work = [pace.work(140), pace.work(60)];
  // without the GPU's clock nobody knows what one of several took
  pace = new Pace(false);
  pace.latency = 100;
  look();
  return found;
}"""


def test_slow_frames_are_smaller_and_latency_does_not_count(fresh: OpenPage) -> None:
    found = fresh.page.evaluate(PACE)
    whole, half, eighth = [1000, 500], [500, 250], [125, 63]
    assert found["sizes"] == [whole, half, eighth, eighth, whole, whole, [812, 406], whole]
    # rows drawn in 33 ms, a multiple of 4, at least 4; growing at most fourfold
    rows = [3300, 124, 4, 4, 16500, 16500, 328, 3300]
    assert found["rows"] == pytest.approx(rows, abs=4)
    assert found["at_once"] == [1, 1, 1, 1, 1, 7, 3, 1]
    assert 99 <= found["latency"] < 300
    assert found["work"] == [40, 0]


SLOW_ANSWERS = """
const late = (made, name) => {
  const method = made.prototype[name];
  made.prototype[name] = async function (...args) {
    await method.apply(this, args);
    await new Promise((next) => setTimeout(next, 150));
  };
};
late(GPUQueue, "onSubmittedWorkDone");
late(GPUBuffer, "mapAsync");
"""
NO_CLOCK = """
const { requestDevice } = GPUAdapter.prototype;
GPUAdapter.prototype.requestDevice = function (wanted) {
  return requestDevice.call(this, { ...wanted, requiredFeatures: [] });
};
"""
MOVING = """async ([width, height]) => {
  const { frames } = viewer.drawing;
  let parts = 0;
  const sample = frames.sample.bind(frames);
  frames.sample = (...args) => { parts += 1; return sample(...args); };
  await viewer.draw(width, height, 8);
  const atRest = parts;
  let [most, sent] = [0, frames.count];
  for (let k = 0; k < 30; k++) {
    // the machines that test draw slowly
    frames.pace.cost = Math.min(frames.pace.cost, 40);
    viewer.state.scale = 0.05 + 0.001 * k;
    viewer.changed();
    await new Promise(requestAnimationFrame);
    most = Math.max(most, frames.pace.flying);
  }
  sent = frames.count - sent;
  await viewer.drawing.settled();
  return [frames.pace.latency, atRest, most, sent, frames.done, Boolean(viewer.gpu.stamps)];
}"""


@pytest.mark.parametrize("clock", [True, False])
def test_a_browser_with_latency_draws_no_less(browser: Any, page_file: Path, clock: bool) -> None:
    seen = OpenPage(browser, page_file, before=SLOW_ANSWERS + ("" if clock else NO_CLOCK))
    latency, at_rest, most, sent, samples, clocked = seen.page.evaluate(MOVING, SIZE)
    assert clocked == clock
    assert latency >= 149
    # a sample is not cut into ever smaller parts; row by row there would be 720
    assert at_rest <= 60
    # frames of known cost do not wait for each other
    assert (most > 1) == clock
    assert sent > (6 if clock else 1)
    assert samples == 8
    assert seen.console == []
    seen.page.close()


def test_figures_belong_to_the_picture_above_them(fresh: OpenPage) -> None:
    # a second technique is added while the timing of the previous frame is read
    script = """async () => {
      const { frames } = viewer.drawing;
      await viewer.drawing.settled();
      // a slow page draws a smaller frame first, and the picture by rows, which would then be those
      // of two states
      frames.pace.speed = 1e-5;
      const reports = [];
      const report = viewer.report.bind(viewer);
      viewer.report = (news) => { if (news.figures) reports.push(news.figures); report(news); };
      const stamped = frames.stamped.bind(frames);
      let once = true;
      frames.stamped = async () => {
        const clock = await stamped();
        if (once) {
          once = false;
          // the new state is not drawn yet
          frames.touched = () => {};
          viewer.state.compare = "offset";
          viewer.changed(true);
          while (!viewer.drawing.shown.right) await new Promise((next) => setTimeout(next));
          setTimeout(() => { delete frames.touched; frames.touched(); }, 100);
        }
        return clock;
      };
      await viewer.draw(160, 90, 1);
      await new Promise((next) => setTimeout(next, 200));
      await viewer.draw(160, 90, 1);
      delete frames.stamped;
      delete viewer.report;
      return reports;
    }"""
    reports = fresh.page.evaluate(script)
    assert reports[-1]["right"]["hits"] > 1000
    # frames drawn while the machine is busy are smaller
    pairs = [(each["left"]["hits"], each["right"]["hits"]) for each in reports if each["right"]]
    assert all(right > 0.5 * left > 0 for left, right in pairs)


def test_a_state_that_is_replaced_while_it_compiles_is_not_drawn(fresh: OpenPage) -> None:
    """Its samples would be added to those of the previous picture."""
    script = """async () => {
      const { drawing } = viewer;
      const wait = (ms) => new Promise((next) => setTimeout(next, ms));
      const side = drawing.side.bind(drawing);
      drawing.side = async (...args) => {
        const made = await side(...args);
        await wait(300);
        return made;
      };
      let taken = drawing.shown;
      const shapes = [];
      Object.defineProperty(drawing, "shown", {
        configurable: true,
        get: () => taken,
        set: (shown) => { taken = shown; shapes.push(shown.left.state.shape); },
      });
      for (const shape of ["sphere", "cylinder"]) {
        viewer.state.shape = shape;
        viewer.changed(true);
        await wait(30);
      }
      while (drawing.compiling) await wait(10);
      delete drawing.shown;
      drawing.shown = taken;
      delete drawing.side;
      return shapes;
    }"""
    assert fresh.page.evaluate(script) == ["cylinder"]


# --- failures ---------------------------------------------------------------------------------


def test_a_program_that_does_not_compile_is_reported(browser: Any, page_file: Path) -> None:
    seen = OpenPage(browser, page_file)
    before = seen.frame().color
    seen.page.evaluate("""() => { viewer.data.programs.slots.displace.steep += "fn broken( {"; }""")
    seen.page.get_by_label("Technique", exact=True).select_option("steep")
    seen.page.wait_for_function("document.getElementById('messages').textContent !== ''")
    assert "steep:" in seen.text("#messages")
    seen.draw()
    assert "relief is still shown" in seen.text("#figures")
    # it is neither compiled nor reported again
    compiled = seen.page.evaluate("viewer.gpu.compiled")
    seen.state(scale=0.05)
    seen.draw()
    seen.state(scale=0.08)
    seen.draw()
    assert seen.page.evaluate("viewer.gpu.compiled") == compiled
    assert seen.page.locator("#messages p").count() == 1
    seen.page.get_by_label("Technique", exact=True).select_option("relief")
    assert np.array_equal(seen.frame().color, before)
    assert "still shown" not in seen.text("#figures")
    # without a second picture there is no divider
    seen.page.get_by_label("Compare with").select_option("offset")
    seen.draw()
    assert seen.page.locator("#line").is_visible()
    assert " | " in seen.text("#figures")
    seen.page.get_by_label("Compare with").select_option("steep")
    seen.draw()
    assert seen.page.locator("#messages p").count() == 2
    assert not seen.page.locator("#line").is_visible()
    assert " | " not in seen.text("#figures")
    seen.page.get_by_label("Compare with").select_option("")
    assert np.array_equal(seen.frame().color, before)
    seen.page.close()


REFUSING = """
const { requestAdapter } = GPU.prototype;
window.requests = 0;
GPU.prototype.requestAdapter = function (...args) {
  window.requests += 1;
  if (window.requests <= TIMES) return Promise.reject(new DOMException("starting", "AbortError"));
  return requestAdapter.apply(this, args);
};
"""


def test_a_late_device_is_awaited(browser: Any, page_file: Path) -> None:
    seen = OpenPage(browser, page_file, before=REFUSING.replace("TIMES", "2"))
    assert seen.page.evaluate("requests") == 3
    assert seen.frame().hit.any()
    assert seen.text("#messages") == ""
    seen.page.close()


def test_without_an_adapter_the_stills_are_shown(browser: Any, page_file: Path) -> None:
    seen = OpenPage(browser, page_file, before=REFUSING.replace("TIMES", "1e9"))
    assert "does not have or has not enabled" in seen.text("#without")
    assert "(starting)" in seen.text("#without")
    assert seen.page.locator("#stills img").first.is_visible()
    assert seen.page.locator("#panel").is_hidden()
    seen.page.close()


def test_a_lost_device_is_reopened(browser: Any, page_file: Path) -> None:
    seen = OpenPage(browser, page_file)
    before = seen.frame().color
    seen.page.evaluate("(window.lost = viewer.gpu).device.destroy()")
    seen.page.get_by_text("device was lost").wait_for()
    seen.page.wait_for_function("viewer.gpu !== lost && viewer.drawing.gpu === viewer.gpu")
    assert np.array_equal(seen.frame().color, before)
    seen.page.close()
    # also before the first picture
    page = browser.new_page(viewport={"width": 760, "height": 400})
    page.set_default_timeout(PATIENCE)
    page.add_init_script(
        """const ask = GPUAdapter.prototype.requestDevice;
        GPUAdapter.prototype.requestDevice = async function (...args) {
          const device = await ask.call(this, ...args);
          if (!window.lost) (window.lost = device).destroy();
          return device;
        };"""
    )
    seen = OpenPage(SimpleNamespace(new_page=lambda **_: page), page_file)
    assert "device was lost" in seen.text("#messages")
    assert np.array_equal(seen.frame().color, before)
    assert seen.page.evaluate("viewer.gpu.device !== lost")
    page.close()


def test_without_webgpu_the_page_shows_stills_and_a_message(browser: Any, page_file: Path) -> None:
    context = browser.new_context()
    context.add_init_script("delete Navigator.prototype.gpu")
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    page.goto(page_file.as_uri())
    page.wait_for_function("document.body.classList.contains('without')")
    assert "draws with WebGPU, which this browser does not have" in page.inner_text("#without")
    widths = page.evaluate(
        "[...document.querySelectorAll('#stills img')].map((i) => i.naturalWidth)"
    )
    assert widths == [400] * 4
    assert not page.locator("#panel").is_visible()
    context.close()


# --- the file ------------------------------------------------------------------------------------


def test_a_large_material_makes_a_page_of_12_mb(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    noise = rng.integers(0, 65536, (1024, 1024, 3)).astype(np.uint16)
    rough = Material("noise", base_color=Map(noise, False, "noise"), normal=Map(noise, False, "n"))
    made = write_view(Scene((Object(rough),)), tmp_path / "page.html", device="cpu")
    assert made.scaled_to == (512, 512)
    assert (tmp_path / "page.html").stat().st_size <= LARGEST


def test_a_file_that_is_not_a_page_is_not_overwritten(tmp_path: Path, material: Material) -> None:
    file = tmp_path / "page.html"
    file.write_text("mine")
    with pytest.raises(InputError, match="not a page of the viewer"):
        write_view(Scene((Object(material),)), file, device="cpu")
    assert file.read_text() == "mine"


def test_scenes_that_the_page_cannot_draw_are_refused(tmp_path: Path, material: Material) -> None:
    two = Scene((Object(material), Object(material, shape="sphere")))
    with pytest.raises(InputError, match="has further objects, which the page does not draw"):
        write_view(two, tmp_path / "page.html", device="cpu")
    with pytest.raises(InputError, match="the scene has no object"):
        write_view(Scene(()), tmp_path / "page.html", device="cpu")


def _place(name: str) -> Path:
    return Path(tempfile.mkdtemp("-viewer")) / name


def _saved(content: bytes, name: str) -> Path:
    file = _place(name)
    file.write_bytes(content)
    return file
