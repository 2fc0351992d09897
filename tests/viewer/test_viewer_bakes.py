"""Bakes and dropped pictures of the page, compared with the library."""

from __future__ import annotations

import base64
import re
import struct
from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_viewer import CAMERA, SIZE, OpenPage, expected

from basrelief import baking
from basrelief.baking.tables import table
from basrelief.engine import choose_device
from basrelief.images import encode_png, read_picture
from basrelief.material import Map, Material, sample
from basrelief.measure.errors import errors
from basrelief.measure.truth import truth
from basrelief.rendering import textures
from basrelief.rendering.render import render
from basrelief.scene import Object, Scene
from basrelief.techniques import BAKES, TECHNIQUES, Bake
from basrelief.viewer import page, write_view
from helpers.agreement import assert_agree
from helpers.browser import SOFTWARE, chromium, evaluate
from helpers.pngs import png
from helpers.repository import REPOSITORY
from helpers.stills import no_stills

TEXELS = 64
WEB = "src/basrelief/viewer/web"


@pytest.fixture(scope="module")
def material() -> Material:
    """Bricks with an emission map brighter than white."""
    glow = np.zeros((8, 8, 3), np.float32)
    glow[2, 5] = (3.0, 1.5, 0.25)
    return replace(sample("bricks", TEXELS), emission=Map(glow, False, "glow"))


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(SOFTWARE) as made:
        yield made


@pytest.fixture(scope="module")
def page_file(material: Material, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("viewer") / "page.html"
    with no_stills():
        write_view(Scene((Object(material, scale=0.08),), camera=CAMERA), file, device="cpu")
    return file


@pytest.fixture(scope="module")
def opened(browser: Any, page_file: Path) -> Iterator[OpenPage]:
    made = OpenPage(browser, page_file)
    yield made
    made.page.close()


@pytest.fixture
def seen(opened: OpenPage) -> OpenPage:
    """The page after a reset, with its own maps and no bakes.

    The page caches bakes while its heights are the same; they are cleared here, so that earlier
    tests on the same page do not matter.
    """
    opened.page.evaluate(
        """async () => {
          const { gpu } = viewer;
          gpu.limits = gpu.device.limits;
          viewer.drop = { channel: "luminance", polarity: "", green: "" };
          await viewer.reset();
          // some tests pass maps to the drawing directly; another heights object, even if equal,
          // clears the bakes
          const { field, ...others } = viewer.original;
          await viewer.drawing.setMaps({ ...others, field: { ...field } });
          await viewer.drawing.setMaps(viewer.original);
          document.getElementById("messages").replaceChildren();
          await viewer.draw(160, 90, 1);
        }"""
    )
    opened.console.clear()
    return opened


def noise(shape: tuple[int, int], seed: int = 7) -> np.ndarray:
    """16-bit heights with slopes, steps and single texels, different along both axes: (h, w)."""
    rng = np.random.default_rng(seed)
    row, column = np.mgrid[: shape[0], : shape[1]] / np.array(shape).reshape(2, 1, 1)
    waves = 0.4 + 0.2 * np.sin(2 * np.pi * (row + 2 * column)) + 0.1 * np.cos(4 * np.pi * column)
    spikes = np.where(rng.random(shape) < 0.02, rng.random(shape), 0.0)
    steps = np.where((row > 0.3) & (row < 0.6) & (column > 0.5), 0.9, 0.0)
    return np.rint(np.maximum.reduce([waves, spikes, steps]) * 65535).astype(np.uint16)


def as_heights(codes: np.ndarray) -> np.ndarray:
    return Map(codes[:, :, None], False, "dropped").linear()[:, :, 0]


# --- tables --------------------------------------------------------------------------------------

READ = """async ([texels, height, width, name, edge]) => {
  const { drawing, gpu } = viewer;
  const { [name]: unused, ...pictures } = viewer.pictures;
  await drawing.setMaps({ ...pictures, field: { width, height, texels } });
  const table = await drawing.bakesFor(edge).table(name);
  return [table.width, table.height, await gpu.readTexture(table)];
}"""


STEPS = re.findall(r'case "(\w+)":', (REPOSITORY / WEB / "bakes.js").read_text())
"""The tables that the page can bake."""


def test_the_page_bakes_the_tables_that_it_does_not_contain() -> None:
    def names(bakes: Collection[Bake]) -> set[str]:
        mips = {f"mip_{bake.name}" for bake in bakes if bake.all_levels}
        return mips | {bake.name for bake in bakes}

    assert names(page._BAKED_BY_PAGES) <= set(STEPS) <= names(BAKES.values())


def test_a_page_contains_the_tables_that_it_does_not_bake(
    material: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "_BAKED_BY_PAGES", ())
    engine = choose_device("cpu")
    made = page._bakes(material, 10**7, engine)
    assert set(made) == set(BAKES)
    # as many as fit in the size limit
    first, *_ = made
    assert set(page._bakes(material, len(made[first]["content"]), engine)) == {first}


@pytest.mark.parametrize("shape", [(64, 96), (50, 37), (5, 3), (1, 1)])
@pytest.mark.parametrize(
    ("name", "edge"),
    [
        *((name, edge) for name in STEPS for edge in ("wrap", "clamp") if name in BAKES),
        *((name, "wrap") for name in STEPS if name not in BAKES),
    ],
)
def test_tables_equal_pythons(seen: OpenPage, name: str, edge: Any, shape: tuple[int, int]) -> None:
    codes = noise(shape)
    width, height, words = evaluate(seen.page, READ, [codes, *shape, name, edge])
    found = words.reshape(height, width, 4)
    heights = as_heights(codes)
    bake, whole = BAKES[name.removeprefix("mip_")], name.startswith("mip_")
    wanted = table(bake, heights, edge, choose_device("cpu"), all_levels=whole)
    assert np.array_equal(found, wanted)
    assert shape == (1, 1) or len(np.unique(wanted)) > 3
    assert seen.console == []
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


def test_normals_equal_pythons(seen: OpenPage) -> None:
    codes = noise((50, 37))
    script = """async ([texels, height, width, rise]) => {
      await viewer.drawing.setMaps({ ...viewer.pictures, field: { width, height, texels } });
      return viewer.drawing.bakesFor("wrap").normals(rise);
    }"""
    found = evaluate(seen.page, script, [codes, *codes.shape, 0.08 * 37])
    made = baking.normal_map(as_heights(codes), "wrap", 0.08)
    wanted = np.full((50, 37, 4), 65535)
    wanted[:, :, :3] = np.rint((made * 0.5 + 0.5) * 65535)
    error = np.abs(found.reshape(wanted.shape).astype(int) - wanted)
    assert error.max() <= 1


MADE = "[...viewer.drawing.bakes.values()].flatMap((each) => [...each.tables.keys()])"


# --- dropped heights -----------------------------------------------------------------------------


def test_dropped_heights_are_drawn_with_every_bake(seen: OpenPage, material: Material) -> None:
    codes = noise((TEXELS, TEXELS))
    _drop(seen, "heights.png", png(codes[:, :, None], 0, 16))
    message = seen.page.text_content("#map-message")
    assert message == "heights.png: 64 × 64 with 16 bits per channel, used as heights"
    stored = evaluate(seen.page, "() => viewer.pictures.field.texels")
    assert np.array_equal(stored.reshape(codes.shape), codes)
    swapped = replace(material, height=Map(codes[:, :, None], False, "dropped"))
    for technique in ("exact", "cone", "relaxed_cone", "relief"):
        made = TECHNIQUES[technique]
        seen.state(
            technique=technique, reference_height=made.reference_height, projection=made.projection
        )
        assert_agree(expected(swapped, technique=technique), seen.frame(), TEXELS)
    assert seen.console == []
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


@pytest.mark.parametrize(
    ("technique", "changes"),
    [
        ("exact", {"edge": "clamp"}),
        ("exact", {"heights": "mip"}),
        ("exact", {"edge": "clamp", "heights": "mip"}),
        ("cone", {"edge": "clamp"}),
        ("relaxed_cone", {"edge": "clamp"}),
    ],
)
def test_bakes_depend_on_edge_and_levels(
    seen: OpenPage, material: Material, technique: str, changes: dict[str, Any]
) -> None:
    # more than a tile, so that the border and smaller levels are visible
    far = {"tiling": [1.5, 1.5], "shift": [-0.2, 0.3]}
    seen.state(technique=technique, **changes, **far)
    wanted = expected(
        material, technique=technique, **changes, **{k: tuple(v) for k, v in far.items()}
    )
    assert_agree(wanted, seen.frame(), TEXELS)
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


def test_only_slow_bakes_are_in_the_page(seen: OpenPage) -> None:
    made = set(seen.page.evaluate("Object.keys(viewer.data.maps)"))
    assert made & set(BAKES) == {"relaxed_cone_map"}


def test_heights_may_be_dropped_while_a_baked_technique_is_shown(
    seen: OpenPage, material: Material
) -> None:
    made = TECHNIQUES["exact"]
    seen.state(
        technique="exact",
        reference_height=made.reference_height,
        projection=made.projection,
        compare="cone",
    )
    seen.draw()
    for seed in (1, 2):
        codes = noise((TEXELS, TEXELS), seed)
        _drop(seen, "heights.png", png(codes[:, :, None], 0, 16))
    swapped = replace(material, height=Map(codes[:, :, None], False, "dropped"))
    assert_agree(expected(swapped, technique="exact"), seen.frame(), TEXELS)
    assert_agree(expected(swapped, technique="cone"), seen.frame("right"), TEXELS)
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


def test_heights_may_be_dropped_while_a_bake_runs(seen: OpenPage, material: Material) -> None:
    # heights are dropped during a bake, after its programs were compiled
    script = """async ([first, second]) => {
      const file = (text) =>
        new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], "heights.png");
      viewer.state.technique = "exact";
      await viewer.takeMaps([file(first)], "height");
      const { bakes } = viewer.drawing;
      while (!(bakes.get("wrap")?.jobs.size > 1)) await new Promise((next) => setTimeout(next));
      await viewer.takeMaps([file(second)], "height");
      await viewer.drawing.settled();
    }"""
    codes = noise((TEXELS, TEXELS), 2)
    pictures = [noise((256, 256)), codes]
    files = [base64.b64encode(png(each[:, :, None], 0, 16)).decode() for each in pictures]
    seen.page.evaluate(script, files)
    made = TECHNIQUES["exact"]
    seen.state(reference_height=made.reference_height, projection=made.projection)
    swapped = replace(material, height=Map(codes[:, :, None], False, "dropped"))
    assert_agree(expected(swapped, technique="exact"), seen.frame(), TEXELS)
    assert seen.console == []
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


def test_missed_hits_are_found_on_dropped_heights(seen: OpenPage, material: Material) -> None:
    codes = noise((TEXELS, TEXELS))
    _drop(seen, "heights.png", png(codes[:, :, None], 0, 16))
    seen.state(technique="offset", reference_height=0.5, projection="full", show="missed")
    swapped = replace(material, height=Map(codes[:, :, None], False, "dropped"))
    scene = Scene((Object(swapped, technique="offset", scale=0.08),), camera=CAMERA)
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    share = errors(frame, truth(scene, SIZE)).missed
    seen.draw()
    found = seen.page.evaluate("viewer.drawing.frames.lastFigures")
    assert found["missed"] / found["hits"] == pytest.approx(share, abs=0.005)
    assert share > 0.05


def test_a_bake_is_cached_until_the_heights_change(seen: OpenPage) -> None:
    assert seen.page.evaluate(MADE) == []
    seen.state(technique="exact")
    seen.draw()
    assert seen.page.evaluate(MADE) == ["bounds"]
    table = "window.baked = viewer.drawing.bakesFor('wrap').tables.get('bounds')"
    seen.page.evaluate(f"() => {{ {table} }}")
    _drop(seen, "rough.png", encode_png(np.full((4, 4, 3), 0.5, np.float32)), slot="roughness")
    seen.state(technique="relief", compare="exact")
    seen.draw()
    assert seen.page.evaluate("baked === viewer.drawing.bakesFor('wrap').tables.get('bounds')")
    seen.state(compare="")
    _drop(seen, "heights.png", png(noise((32, 32))[:, :, None], 0, 16))
    assert seen.page.evaluate(MADE) == []


def test_a_bake_that_is_no_longer_needed_is_cancelled(seen: OpenPage) -> None:
    codes = noise((256, 256))
    _drop(seen, "heights.png", png(codes[:, :, None], 0, 16))
    seen.state(technique="relaxed_cone")
    seen.page.evaluate("viewer.changed()")
    seen.page.wait_for_function("/baking.*[1-9] %/.test(document.getElementById('busy').innerText)")
    assert "baking relaxed cone map for relaxed cone …" in seen.text("#busy")
    seen.state(technique="relief")
    seen.draw()
    assert seen.page.evaluate(MADE) == []
    assert seen.text("#busy") == ""
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


def test_a_failed_bake_is_reported(seen: OpenPage) -> None:
    shown = seen.frame().color
    seen.page.evaluate(
        """() => {
          const { entries } = viewer.data.programs;
          window.far_record = entries.far_record;
          entries.far_record = "fn broken( {";
          for (const key of viewer.gpu.pipelines.keys()) {
            if (key.startsWith("far_record")) viewer.gpu.pipelines.delete(key);
          }
        }"""
    )
    # right of the divider and as the truth it is omitted, and the rest is drawn
    for changes in ({"compare": "exact"}, {"compare": "", "show": "missed"}):
        seen.page.evaluate("document.getElementById('messages').replaceChildren()")
        seen.state(**changes)
        assert np.array_equal(seen.frame().color, shown)
        assert "exact:" in seen.text("#messages")
    seen.state(technique="exact", show="color")
    seen.page.evaluate("viewer.changed()")
    seen.draw()
    seen.state(technique="cone")
    assert seen.frame().hit.any()
    seen.page.evaluate(
        """() => {
          viewer.data.programs.entries.far_record = far_record;
          for (const key of viewer.gpu.pipelines.keys()) {
            if (key.startsWith("far_record")) viewer.gpu.pipelines.delete(key);
          }
          for (const each of viewer.drawing.bakes.values()) each.failures.clear();
        }"""
    )


# --- dropped pictures of every kind --------------------------------------------------------------


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize(("type", "count"), [(0, 1), (2, 3), (4, 2), (6, 4)])
def test_a_png_is_read_with_all_its_bits(seen: OpenPage, bits: int, type: int, count: int) -> None:
    rng = np.random.default_rng(type + bits)
    # ramps and noise, so that every filter is used
    ramp = np.add.outer(np.arange(11), np.arange(7))[:, :, None] * 701
    codes = (ramp + rng.integers(0, 999, (11, 7, count))).astype(np.uint16)
    codes = codes if bits == 16 else (codes >> 8).astype(np.uint8)
    found = _decoded(seen, png(codes, type, bits))
    wide = codes.astype(np.uint16) * (1 if bits == 16 else 257)
    wanted = np.full((11, 7, 4), 65535, np.uint16)
    wanted[:, :, :3] = wide[:, :, :1] if count < 3 else wide[:, :, :3]
    if count in (2, 4):
        wanted[:, :, 3] = wide[:, :, -1]
    assert np.array_equal(found, wanted)


def test_a_png_written_by_the_library_is_read(seen: OpenPage, tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    pixels = rng.random((40, 31, 3)).astype(np.float32)
    content = encode_png(pixels, bits=16)
    file = tmp_path / "written.png"
    file.write_bytes(content)
    wanted = read_picture(file).pixels
    assert wanted.dtype == np.uint16
    assert np.array_equal(_decoded(seen, content)[:, :, :3], wanted)


def test_palettes_and_transparent_colours_are_read(seen: OpenPage) -> None:
    index = np.array([[0, 1, 2], [2, 1, 0]], np.uint8)[:, :, None]
    parts = {b"PLTE": bytes([9, 8, 7, 60, 50, 40, 255, 128, 0]), b"tRNS": bytes([0, 200])}
    found = _decoded(seen, png(index, 3, 8, parts))
    colors = np.array([[9, 8, 7, 0], [60, 50, 40, 200], [255, 128, 0, 255]], np.uint16) * 257
    assert np.array_equal(found, colors[index[:, :, 0]])
    grey = np.array([[[300], [40000]]], np.uint16)
    found = _decoded(seen, png(grey, 0, 16, {b"tRNS": struct.pack(">H", 300)}))
    assert found.tolist() == [[[300, 300, 300, 0], [40000, 40000, 40000, 65535]]]


def test_a_transparent_colour_besides_alpha_is_ignored(seen: OpenPage) -> None:
    grey = np.array([[[300, 7], [40000, 9]]], np.uint16)
    found = _decoded(seen, png(grey, 4, 16, {b"tRNS": struct.pack(">H", 300)}))
    assert found.tolist() == [[[300, 300, 300, 7], [40000, 40000, 40000, 9]]]
    with pytest.raises(Exception, match="this PNG is damaged: its clear colour is cut off"):
        _decoded(seen, png(np.ones((1, 2, 3), np.uint8), 2, 8, {b"tRNS": b"\0\1\0\1"}))


def test_unreadable_pngs_are_reported(seen: OpenPage) -> None:
    whole = png(noise((8, 8))[:, :, None], 0, 16)
    before = seen.frame().color
    for content, message in (
        (whole[:60] + whole[90:], "this PNG is damaged"),
        (png(np.zeros((2, 8, 1), np.uint16), 0, 16, rows=8), "rows are missing"),
        (png(np.zeros((1, 40000, 1), np.uint8), 0, 8), "40000 × 1 is larger than this GPU takes"),
    ):
        seen.page.evaluate("document.getElementById('messages').replaceChildren()")
        _drop(seen, "broken.png", content, taken=False)
        assert message in seen.text("#messages")
    assert np.array_equal(seen.frame().color, before)
    _drop(seen, "woven.png", png(np.full((1, 1, 1), 513, np.uint16), 0, 16, interlaced=1))
    assert "woven.png is interlaced: 8 of its 16 bits" in seen.text("#messages")


def test_a_map_too_large_for_the_gpu_is_reported(seen: OpenPage) -> None:
    before = seen.frame().color
    content = png(noise((50, 37))[:, :, None], 0, 16)
    seen.page.evaluate("viewer.gpu.limits = { maxTextureDimension2D: 48 }")
    _drop(seen, "large.png", content, taken=False)
    assert "large.png: 37 × 50 is larger than this GPU takes (48 a side)" in seen.text("#messages")
    assert np.array_equal(seen.frame().color, before)
    # the records of the bounds take more rows than the heights do
    seen.page.evaluate("viewer.gpu.limits = { maxTextureDimension2D: 50 }")
    _drop(seen, "large.png", content)
    seen.state(technique="exact")
    seen.draw()
    assert "exact: a map of 38 × 64 is larger than this GPU takes (50)" in seen.text("#messages")
    seen.state(technique="relief")
    assert seen.frame().hit.any()


def test_a_map_that_the_gpu_refuses_is_reported_once(seen: OpenPage) -> None:
    before = seen.frame().color
    seen.page.evaluate("viewer.gpu.limits = { maxTextureDimension2D: 1e9 }")
    _drop(seen, "long.png", png(np.zeros((1, 40000, 1), np.uint8), 0, 8), taken=False)
    assert np.array_equal(seen.frame().color, before)
    assert seen.text("#messages").count("long.png:") == 1
    assert seen.page.locator("#messages p").count() == 1
    # if the second of two textures fails, the first is destroyed
    script = """async () => {
      const { drawing, gpu } = viewer;
      const made = [];
      const texture = gpu.texture.bind(gpu);
      gpu.texture = (...args) => {
        if (made.length) throw new Error("no room");
        made.push(texture(...args));
        made[0].destroy = () => { made[0].gone = true; };
        return made[0];
      };
      const one = { width: 1, height: 1, texels: new Uint16Array(4) };
      const maps = { ...viewer.pictures, normal: one, response: { ...one } };
      const message = await drawing.setMaps(maps)
        .catch((error) => error.message);
      delete gpu.texture;
      return [message, made[0].gone];
    }"""
    assert seen.page.evaluate(script) == ["no room", True]
    assert np.array_equal(seen.frame().color, before)
    assert seen.console == []


# --- dropped maps --------------------------------------------------------------------------------


def test_an_emission_map_brighter_than_white_equals_the_cpus(
    seen: OpenPage, material: Material
) -> None:
    wanted = expected(material)
    assert wanted.color.max() > 1.0
    assert_agree(wanted, seen.frame(), TEXELS)


def test_maps_of_different_sizes_are_drawn_as_by_python(seen: OpenPage, material: Material) -> None:
    rng = np.random.default_rng(11)
    codes = {
        "base_color": rng.integers(0, 256, (128, 128, 3)).astype(np.uint8),
        "opacity": rng.integers(40000, 65536, (32, 32, 1)).astype(np.uint16),
        "emission": rng.integers(0, 90, (16, 16, 3)).astype(np.uint8),
        "packed": rng.integers(0, 65536, (96, 96, 3)).astype(np.uint16),
        "metallic": rng.integers(0, 256, (40, 40, 1)).astype(np.uint8),
    }
    for slot, pixels in codes.items():
        bits = 8 * pixels.dtype.itemsize
        _drop(seen, f"{slot}.png", png(pixels, 2 if pixels.shape[2] == 3 else 0, bits), slot=slot)
    packed = codes["packed"]
    maps = {
        "base_color": Map(codes["base_color"], True, "dropped"),
        "opacity": Map(codes["opacity"], False, "dropped"),
        "emission": Map(codes["emission"], True, "dropped"),
        "occlusion": Map(packed[:, :, :1], False, "dropped"),
        "roughness": Map(packed[:, :, 1:2], False, "dropped"),
        "metallic": Map(codes["metallic"], False, "dropped"),
    }
    swapped = replace(material, **maps)  # type: ignore[arg-type]
    assert_agree(expected(swapped, alpha="blend"), seen.frame(), TEXELS)
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


def test_removing_the_normal_map_draws_normals_of_the_heights(
    seen: OpenPage, material: Material
) -> None:
    codes = noise((TEXELS, TEXELS))
    _drop(seen, "heights.png", png(codes[:, :, None], 0, 16))
    seen.open("maps")
    seen.page.locator("#remove-normal").click()
    swapped = replace(material, height=Map(codes[:, :, None], False, "dropped"))
    assert_agree(expected(replace(swapped, normal=None)), seen.frame(), TEXELS)
    assert seen.page.locator("#remove-normal").count() == 0
    assert seen.page.text_content("#map-message") == "Drawn without normals."


def test_a_slider_does_not_wait_for_normals(seen: OpenPage, material: Material) -> None:
    seen.page.evaluate(
        "(async () => { await viewer.removeMap('normal'); await viewer.draw(160, 90, 1); })()"
    )
    seen.page.evaluate(
        """() => {
          const { drawing, gpu } = viewer;
          const read = gpu.readTexture.bind(gpu);
          const opened = new Promise((open) => { window.openReading = open; });
          gpu.readTexture = (texture) => opened.then(() => read(texture));
          window.framesBefore = drawing.frames.count;
          viewer.state.scale = 0.04;
          viewer.changed();
        }"""
    )
    seen.page.wait_for_function("viewer.drawing.frames.count > framesBefore", timeout=20000)
    assert seen.page.evaluate("viewer.drawing.state.scale") == 0.04
    seen.page.evaluate("() => { openReading(); delete viewer.gpu.readTexture; }")
    # afterwards the normals are those of the new scale
    plain = replace(material, normal=None)
    assert_agree(expected(plain, scale=0.04), seen.frame(), TEXELS)
    # changed and changed back, and changed to a scale without normals
    seen.page.evaluate("for (const n of [0.1, 0.04]) { viewer.state.scale = n; viewer.changed(); }")
    assert_agree(expected(plain, scale=0.04), seen.frame(), TEXELS)
    seen.state(scale=0)
    seen.draw()
    assert seen.page.evaluate("viewer.drawing.bakedFor") == "0.04 wrap"
    assert seen.page.locator("#messages p:not(.quiet)").count() == 0


def test_smaller_levels_of_channels_equal_pythons(seen: OpenPage) -> None:
    rng = np.random.default_rng(9)
    script = """async ([texels, height, width]) => {
      const maps = await import("view/maps.js");
      return maps.channelLevels({ width, height, texels }).map((level) => level.texels);
    }"""
    for shape in ((12, 24, 4), (6, 7, 4)):
        level = rng.integers(0, 65536, shape).astype(np.uint16)
        for texels in evaluate(seen.page, script, [level, *shape[:2]]):
            assert np.array_equal(texels.reshape(level.shape), level)
            level = np.rint(textures.halved(level.astype(np.float32))).astype(np.uint16)


def test_resources_of_at_most_ten_programs_are_cached(seen: OpenPage) -> None:
    for shadows in ("none", "hard"):
        for technique in ("flat", "offset", "steep", "relief", "parallax_occlusion"):
            seen.state(technique=technique, compare="offset", shadows=shadows)
            seen.draw()
    # two are shown
    assert seen.page.evaluate("viewer.drawing.jobs.size") == 10
    assert seen.console == []


def test_other_proportions_are_reported(seen: OpenPage) -> None:
    _drop(seen, "wide.png", png(noise((20, 60))[:, :, None], 0, 16))
    assert "wide.png has other proportions" in seen.text("#messages")
    assert seen.frame().hit.any()


# --- helpers -------------------------------------------------------------------------------------


def _drop(
    seen: OpenPage, name: str, content: bytes, *, slot: str = "height", taken: bool = True
) -> None:
    """Drop a file on a map of the page, and wait until it is taken or refused."""
    script = """async ([name, content, slot]) => {
      const bytes = Uint8Array.from(atob(content), (c) => c.charCodeAt(0));
      await viewer.takeMaps([new File([bytes], name)], slot);
      await viewer.drawing.settled();
      return viewer.mapMessage;
    }"""
    message = seen.page.evaluate(script, [name, base64.b64encode(content).decode(), slot])
    assert message.startswith(name) == taken


def _decoded(seen: OpenPage, content: bytes) -> np.ndarray:
    """The texels that the page reads from a PNG, (h, w, 4) uint16."""
    script = """async (bytes) => {
      const png = await import("view/png.js");
      const header = png.headerOf(bytes);
      if (!png.isRead(header)) return null;
      return [header.height, header.width, await png.decoded(bytes, header)];
    }"""
    array = np.frombuffer(content, np.uint8)
    height, width, texels = evaluate(seen.page, script, array)
    assert texels.dtype == np.uint16
    return texels.reshape(height, width, 4)
