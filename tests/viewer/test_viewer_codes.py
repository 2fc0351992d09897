"""Integer codes of the viewer's page: PNGs decoded exactly, and values rounded as by the library.

Rounding is tested at values near halves, where another rule gives another code.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_viewer import OpenPage

from basrelief.engine.cpu import CpuEngine
from basrelief.images import read_picture, srgb_decode, srgb_encode, write_data
from basrelief.images.resize import resized
from basrelief.material import Map, Material, opened
from basrelief.measure.colors import COUNT, heat
from basrelief.rendering import textures
from basrelief.scene import Object, Scene
from basrelief.viewer import write_view
from helpers.browser import SOFTWARE, chromium, evaluate
from helpers.pngs import FILTERS, filters_of, png
from helpers.stills import no_stills

COLOR_TYPES = {"grey": (0, 1), "rgb": (2, 3), "grey and alpha": (4, 2), "rgb and alpha": (6, 4)}
"""The colour types of PNG by name: number, and samples a pixel."""
RNG = np.random.default_rng(23)


@pytest.fixture(scope="module")
def material() -> Material:
    """Small maps of different sizes, with an emission map brighter than white."""
    rng = np.random.default_rng(6)

    def codes(*shape: int, kind: Any = np.uint16) -> np.ndarray:
        return rng.integers(0, np.iinfo(kind).max, shape, dtype=kind, endpoint=True)

    return Material(
        "codes",
        height=Map(codes(28, 21, 1), False, "heights"),
        base_color=Map(codes(20, 15, 3, kind=np.uint8), True, "colour"),
        opacity=Map(codes(12, 9, 1), False, "opacity"),
        normal=Map(codes(8, 6, 3), False, "normals"),
        occlusion=Map(codes(16, 12, 1, kind=np.uint8), False, "occlusion"),
        roughness=Map(codes(20, 15, 1), False, "roughness"),
        emission=Map(rng.random((8, 6, 3), np.float32) * np.float32(3.0), False, "glow"),
    )


@pytest.fixture(scope="module")
def seen(material: Material, tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpenPage]:
    """An open page, whose state the tests here do not change."""
    file = tmp_path_factory.mktemp("viewer") / "page.html"
    with no_stills():
        write_view(Scene((Object(material, scale=0.08),)), file, device="cpu")
    with chromium(SOFTWARE) as browser:
        made = OpenPage(browser, file)
        yield made
        assert made.console == []
        made.page.close()


# --- PNG: predictors ------------------------------------------------------------------------------


def decoded(seen: OpenPage, content: bytes, *, whole: bool = False) -> np.ndarray:
    """The texels that the page reads, (h, w, 4) uint16: by its own decoder, or as a dropped file,
    for which it may use the browser's."""
    script = """async ([bytes, whole]) => {
      if (whole) {
        const { pictureOf } = await import("view/dropped.js");
        const made = await pictureOf(new File([bytes], "a.png"), 4096);
        return [made.height, made.width, made.texels];
      }
      const png = await import("view/png.js");
      const header = png.headerOf(bytes);
      if (!png.isRead(header)) return null;
      return [header.height, header.width, await png.decoded(bytes, header)];
    }"""
    argument = [np.frombuffer(content, np.uint8), whole]
    height, width, texels = evaluate(seen.page, script, argument)
    assert texels.dtype == np.uint16
    return texels.reshape(height, width, 4)


def as_texels(codes: np.ndarray) -> np.ndarray:
    """Samples of 8 or 16 bits as four 16-bit channels."""
    count = codes.shape[2]
    wide = codes.astype(np.uint16) * (1 if codes.dtype == np.uint16 else 257)
    made = np.full((*codes.shape[:2], 4), 65535, np.uint16)
    made[:, :, :3] = wide[:, :, :1] if count < 3 else wide[:, :, :3]
    if count in (2, 4):
        made[:, :, 3] = wide[:, :, -1]
    return made


def pictures(bits: int, count: int) -> dict[str, np.ndarray]:
    """Samples that exercise all branches, ties and overflows of the predictors."""
    kind = np.uint8 if bits == 8 else np.uint16
    most = 2**bits - 1
    ramp = np.add.outer(3 * np.arange(7), 2 * np.arange(5))[:, :, None] * (most // 40)
    return {
        "noise": RNG.integers(0, most + 1, (7, 5, count)).astype(kind),
        "slopes": (ramp + RNG.integers(0, most // 50, (7, 5, count))).astype(kind),
        # few values, so that left, above and upper left are often equal or equally near
        "ties": (RNG.integers(0, 4, (16, 9, count)) * (most // 255)).astype(kind),
        # sums above 255
        "bright": (most - RNG.integers(0, most // 5, (7, 5, count))).astype(kind),
        "one column": RNG.integers(0, most + 1, (6, 1, count)).astype(kind),
        "one row": RNG.integers(0, most + 1, (1, 6, count)).astype(kind),
        "one pixel": RNG.integers(0, most + 1, (1, 1, count)).astype(kind),
    }


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("type", COLOR_TYPES)
def test_every_predictor_is_decoded(
    seen: OpenPage, filter: str, bits: int, type: str, tmp_path: Path
) -> None:
    """Also in the first row and column, which have no neighbours above or to the left."""
    number, count = COLOR_TYPES[type]
    for name, codes in pictures(bits, count).items():
        content = png(codes, number, bits, filters=[FILTERS.index(filter)])
        # the result of another decoder
        file = tmp_path / "made.png"
        file.write_bytes(content)
        np.testing.assert_array_equal(read_picture(file).pixels, codes, err_msg=name)
        np.testing.assert_array_equal(decoded(seen, content), as_texels(codes), err_msg=name)


@pytest.mark.parametrize("filter", FILTERS)
def test_every_predictor_of_indices_is_decoded(seen: OpenPage, filter: str) -> None:
    index = RNG.integers(0, 5, (8, 7, 1)).astype(np.uint8)
    palette = RNG.integers(0, 256, (5, 3)).astype(np.uint8)
    clear = RNG.integers(0, 256, 3).astype(np.uint8)
    parts = {b"PLTE": palette.tobytes(), b"tRNS": clear.tobytes()}
    found = decoded(seen, png(index, 3, 8, parts, filters=[FILTERS.index(filter)]))
    colors = np.full((5, 4), 255, np.uint16)
    colors[:, :3], colors[:3, 3] = palette, clear
    np.testing.assert_array_equal(found, colors[index[:, :, 0]] * 257)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_files_of_another_writer_are_decoded(
    seen: OpenPage, kind: Any, count: int, tmp_path: Path
) -> None:
    """Files of OpenImageIO, which chooses the filter of each row."""
    column, row = np.meshgrid(np.arange(37), np.arange(64))
    most = np.iinfo(kind).max
    # rows of noise, of slopes along each axis, and of one value
    waves = np.select(
        [row < 16, row < 32, row < 48],
        [RNG.integers(0, most, row.shape), column * (most // 40), row * (most // 70)],
        most // 3,
    )
    codes = (waves[:, :, None] + np.arange(count) * (most // 9)).clip(0, most).astype(kind)
    file = write_data(tmp_path / "written.png", codes)
    content = file.read_bytes()
    assert len(set(filters_of(content, 37 * count * np.dtype(kind).itemsize))) > 1
    np.testing.assert_array_equal(decoded(seen, content), as_texels(codes))


@pytest.mark.parametrize("pieces", [2, 5])
def test_rows_may_be_packed_in_several_chunks(seen: OpenPage, pieces: int) -> None:
    codes = RNG.integers(0, 65536, (9, 6, 3)).astype(np.uint16)
    content = png(codes, 2, 16, pieces=pieces)
    assert content.count(b"IDAT") == pieces
    np.testing.assert_array_equal(decoded(seen, content), as_texels(codes))


def test_a_row_of_an_unknown_filter_is_reported(seen: OpenPage) -> None:
    codes = RNG.integers(0, 256, (3, 2, 1)).astype(np.uint8)
    with pytest.raises(Exception, match="this PNG is damaged: a row has an unknown filter"):
        decoded(seen, png(codes, 0, 8, filters=[0, 0, 5]))


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("bits", [1, 2, 4])
def test_few_bits_are_read_by_the_browser(seen: OpenPage, bits: int, filter: str) -> None:
    codes = RNG.integers(0, 2**bits, (5, 7, 1)).astype(np.uint8)
    content = png(codes, 0, bits, filters=[FILTERS.index(filter)])
    wanted = as_texels((codes * (255 // (2**bits - 1))).astype(np.uint8))
    np.testing.assert_array_equal(decoded(seen, content, whole=True), wanted)


# --- rounding: maps -------------------------------------------------------------------------------


def test_halves_are_rounded_to_even(seen: OpenPage) -> None:
    whole = np.array([0.0, 1.0, 2.0, 7.0, 254.0, 255.0, 65534.0])
    values = np.concatenate(
        [whole, whole + 0.5, np.nextafter(whole + 0.5, 0.0), np.nextafter(whole + 0.5, 1e9)]
    )
    script = "async (values) => values.map((await import('view/maps.js')).roundEven)"
    assert seen.page.evaluate(script, values.tolist()) == np.rint(values).tolist()


def test_the_maps_of_a_page_equal_the_librarys(seen: OpenPage, material: Material) -> None:
    """Equal to the last bit, with channels of different sizes resized to the largest."""
    script = """() => Object.entries(viewer.pictures).map(
      ([name, { width, height, texels }]) => [name, [height, width, texels]])"""
    found = dict(evaluate(seen.page, script))
    wanted = {
        "base_color": textures.base_color(material, "wrap"),
        "normal": textures.normal(material, "wrap", 0.08, CpuEngine()),
        "response": textures.response(material, "wrap"),
        "emission": textures.emission(material, "wrap"),
    }
    for name, texture in wanted.items():
        assert texture is not None
        height, width, texels = found[name]
        level = texture.levels[0]
        np.testing.assert_array_equal(texels.reshape(height, width, 4), level, name)
    heights = textures.height_field(material, "wrap")
    assert heights is not None
    height, width, texels = found["field"]
    codes = texels.reshape(height, width)
    np.testing.assert_array_equal((codes / 65535.0).astype(np.float32), heights.levels[0])


LEVELS = """async ([texels, height, width, cutOut]) => {
  const { channelLevels } = await import("view/maps.js");
  const levels = channelLevels({ width, height, texels }, cutOut);
  return levels.map((level) => [level.height, level.width, level.texels]);
}"""


@pytest.mark.parametrize("shape", [(96, 128), (13, 22), (9, 7), (1, 6), (5, 1)])
@pytest.mark.parametrize("cut_out", [False, True])
def test_smaller_levels_are_rounded_as_by_the_library(
    seen: OpenPage, shape: Any, cut_out: bool
) -> None:
    """Also for a cut-out, whose colours are weighted by opacity."""
    color = RNG.integers(0, 65536, (*shape, 3)).astype(np.uint16)
    opacity = RNG.integers(0, 65536, (*shape, 1)).astype(np.uint16)
    opacity[: shape[0] // 2] = RNG.choice([0, 1, 65535], (shape[0] // 2, shape[1], 1))
    maps = {"base_color": Map(color, False, "made up")}
    if cut_out:
        maps["opacity"] = Map(opacity, False, "made up")
    texture = textures.base_color(Material("made up", **maps), "wrap")
    assert texture is not None
    found = evaluate(seen.page, LEVELS, [texture.levels[0], *shape, cut_out])
    assert len(found) == len(texture.levels)
    for (height, width, texels), level in zip(found, texture.levels, strict=True):
        np.testing.assert_array_equal(texels.reshape(height, width, 4), level)


def test_quarters_are_rounded_to_even(seen: OpenPage) -> None:
    """Sums of four texels that are 1, 2 or 3 more than a multiple of 4, dark and bright."""
    sums = np.array([*range(13), *range(4 * 65535 - 12, 4 * 65535 + 1)])
    # each sum as four different codes
    parts = np.stack([sums // 4 + (sums % 4 > k) for k in (2, 0, 1, 3)], -1).clip(0, 65535)
    assert np.array_equal(parts.sum(-1), sums)
    level = np.repeat(parts.reshape(-1, 2, 2).transpose(1, 0, 2).reshape(2, -1)[:, :, None], 4, 2)
    found = evaluate(seen.page, LEVELS, [level.astype(np.uint16), *level.shape[:2], False])
    assert found[1][2][::4].tolist() == np.rint(sums / 4).tolist()


REPLACED = """async ([texels, height, width, slot, choices]) => {
  const { replaced } = await import("view/dropped.js");
  const picture = { width, height, bits: 16, texels };
  const made = replaced({}, viewer.data.slots, slot, picture, { channel: "luminance", ...choices });
  const [{ width: w, height: h, count, texels: found }] = Object.values(made);
  return [h, w, count, found];
}"""


def replaced(seen: OpenPage, pixels: np.ndarray, slot: str, **choices: str) -> np.ndarray:
    """The map that the page makes of a dropped picture of (h, w, 4) 16-bit codes."""
    argument = [pixels, *pixels.shape[:2], slot, choices]
    height, width, count, texels = evaluate(seen.page, REPLACED, argument)
    return texels.reshape(height, width, count)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("slot", ["base_color", "emission"])
def test_every_srgb_code_is_decoded_as_by_the_library(seen: OpenPage, kind: Any, slot: str) -> None:
    """All codes of 8 and 16 bits, in a different order for each channel."""
    codes = np.arange(np.iinfo(kind).max + 1).astype(kind)
    side = 16 if kind == np.uint8 else 256
    pixels = np.stack([codes, codes[::-1], np.roll(codes, 77)], -1).reshape(side, side, 3)
    found = replaced(seen, as_texels(pixels), slot)
    texture = textures.base_color(Material("x", base_color=Map(pixels, True, "made up")), "wrap")
    assert texture is not None
    np.testing.assert_array_equal(found, texture.levels[0])


def beside_halves(values: np.ndarray, least: float = 0.02, most: float = 0.1) -> np.ndarray:
    """Mask of the values close to a half, but not on it."""
    away = np.abs(values - np.floor(values) - 0.5)
    return (away > least) & (away < most)


@pytest.mark.parametrize("polarity", ["height", "depth"])
def test_luminance_is_rounded_to_the_nearest_code(seen: OpenPage, polarity: str) -> None:
    """0.2126 r + 0.7152 g + 0.0722 b, for colours with a value near a half."""
    colors = RNG.integers(0, 65536, (4000, 3))
    luminance = colors @ np.array([0.2126, 0.7152, 0.0722])
    near = beside_halves(luminance)
    colors, luminance = colors[near][:120], luminance[near][:120]
    rounded_up = luminance - np.floor(luminance) > 0.5
    assert 30 < rounded_up.sum() < 90
    pixels = as_texels(colors.reshape(10, 12, 3).astype(np.uint16))
    found = replaced(seen, pixels, "height", polarity=polarity)[:, :, 0]
    wanted = np.rint(luminance).reshape(10, 12)
    np.testing.assert_array_equal(found, wanted if polarity == "height" else 65535 - wanted)


def test_channels_are_copied_unchanged_and_the_green_of_dx_is_inverted(seen: OpenPage) -> None:
    pixels = RNG.integers(0, 65536, (4, 5, 4)).astype(np.uint16)
    for k, channel in enumerate("rgba"):
        found = replaced(seen, pixels, "height", channel=channel, polarity="height")
        np.testing.assert_array_equal(found[:, :, 0], pixels[:, :, k])
    flipped = replaced(seen, pixels, "normal", green="dx")
    wanted = np.stack([pixels[:, :, 0], 65535 - pixels[:, :, 1], pixels[:, :, 2]], -1)
    np.testing.assert_array_equal(flipped[:, :, :3], wanted)
    assert (flipped[:, :, 3] == 65535).all()


@pytest.mark.parametrize(
    ("small", "large"), [((4, 6), (6, 9)), ((3, 5), (9, 15)), ((12, 8), (9, 6))]
)
def test_maps_of_different_sizes_are_rounded_as_by_the_library(
    seen: OpenPage, small: Any, large: Any
) -> None:
    """Bilinear, rows first; resizing 4 texels to 6 gives halves."""
    size = np.maximum(small, large)
    picture = RNG.integers(0, 65536, (*small, 4)).astype(np.uint16)
    other = RNG.integers(0, 65536, (*large, 4)).astype(np.uint16)
    script = """async ([small, [h, w], large, [height, width]]) => {
      const { replaced } = await import("view/dropped.js");
      const of = (texels, height, width) => ({ width, height, bits: 16, texels });
      const choices = { channel: "g", polarity: "height" };
      const { slots } = viewer.data;
      const first = replaced({}, slots, "occlusion", of(small, h, w), choices);
      const second = of(large, height, width);
      const { response } = replaced(first, slots, "roughness", second, choices);
      return [response.height, response.width, response.texels];
    }"""
    height, width, texels = evaluate(seen.page, script, [picture, small, other, large])
    assert (height, width) == tuple(size)
    found = texels.reshape(height, width, 4)
    for channel, pixels in ((0, picture), (1, other)):
        # a map of the library of the same size, without resizing
        whole = Map(np.zeros((*size, 1), np.uint16), False, "made up")
        maps = {"occlusion": Map(pixels[:, :, 1:2], False, "made up"), "roughness": whole}
        texture = textures.response(Material("made up", **maps), "wrap")
        assert texture is not None
        np.testing.assert_array_equal(found[:, :, channel], texture.levels[0][:, :, 0])


# --- rounding: on the screen ----------------------------------------------------------------------

PRESENT = """async ([width, height, sums, words, view]) => {
  await viewer.draw(width, height, 1);
  const { gpu, drawing, canvas } = viewer;
  const { STORAGE } = GPUBufferUsage;
  const sum = gpu.buffer(sums.buffer, STORAGE);
  const planes = gpu.buffer(words.buffer, STORAGE);
  const all = {
    size: [width, height], canvas: [width, height], texels: [64, 64], background: [0, 0, 0, 1],
    divider: width + 1, show: "color", samples: 1, ...view,
  };
  const missed = gpu.planes(2, width, height);
  drawing.frames.colors.present({ planes, sum, missed }, { planes, sum, missed }, all);
  const url = canvas.toDataURL("image/png");
  for (const each of [sum, planes, missed]) each.destroy();
  return url;
}"""


def presented(
    seen: OpenPage,
    tmp_path: Path,
    sums: np.ndarray,
    planes: np.ndarray | None = None,
    **view: Any,
) -> np.ndarray:
    """The 8-bit codes, (h, w, 3), of a picture from its summed colours, (h, w, 4), and planes,
    (9, h, w) words."""
    height, width = sums.shape[:2]
    words = np.zeros((9, height, width), np.uint32) if planes is None else planes
    url = evaluate(seen.page, PRESENT, [width, height, sums.astype(np.float32), words, view])
    file = tmp_path / "canvas.png"
    file.write_bytes(base64.b64decode(url.split(",")[1]))
    return read_picture(file).pixels[:, :, :3].astype(int)


@pytest.mark.parametrize("samples", [1, 4])
def test_light_on_the_canvas_is_the_nearest_code_of_srgb(
    seen: OpenPage, tmp_path: Path, samples: int
) -> None:
    """On both sides of every half, from the linear part of the curve to beyond white."""
    codes = RNG.permutation(np.stack([np.roll(np.arange(255), k) for k in (0, 80, 171)], -1))
    below = np.stack([codes + 0.46, codes + 0.54], 0).reshape(30, 17, 3)
    light = srgb_decode(below / 255.0)
    light[0, 0], light[0, 1] = (-0.5, 1.02, 3.0), (0.0, 1.0, 0.0031308)
    wanted = np.rint(below)
    wanted[0, 0], wanted[0, 1] = (0, 255, 255), (0, 255, 10)
    sums = np.concatenate([light * samples, np.full((30, 17, 1), samples)], -1)
    found = presented(seen, tmp_path, sums, samples=samples)
    np.testing.assert_array_equal(found, wanted)


def heated(index: np.ndarray) -> np.ndarray:
    """The sRGB codes of the heat map's colours at indices, not rounded."""
    return 255.0 * srgb_encode(heat(index / (COUNT - 1.0)).astype(np.float64))


def assert_heated(found: np.ndarray, place: np.ndarray) -> None:
    """Assert the colours of the entries of the heat map nearest to fractional indices.

    Only where the second nearest entry has another colour.
    """
    nearest = np.rint(place)
    second = np.where(place > nearest, nearest + 1, nearest - 1)
    differ = np.abs(heated(nearest) - heated(second)).max(-1) > 1.5
    assert differ.sum() > 40
    assert np.abs(found - heated(nearest))[differ].max() < 0.6


def test_reads_have_the_nearest_colour_of_the_heat_map(seen: OpenPage, tmp_path: Path) -> None:
    """The fraction of the most reads, 0 to 1, as 0 to 255, clamped; the background is dark grey."""
    most = 1000
    reads = np.arange(most + 1)
    place = reads * 255.0 / most
    reads, place = reads[beside_halves(place)][:126], place[beside_halves(place)][:126]
    planes = np.zeros((9, 8, 16), np.uint32)
    planes[7] = 1
    planes[8].ravel()[:126] = reads
    planes[8].ravel()[126] = 3 * most
    planes[7].ravel()[127] = 0
    sums = np.zeros((8, 16, 4))
    figures = {"most": most, "nearest": 0, "furthest": 1}
    found = presented(seen, tmp_path, sums, planes, show="reads", figures=figures).reshape(-1, 3)
    assert_heated(found[:126], place)
    assert np.abs(found[126] - heated(np.array(255.0))).max() < 0.6
    assert found[127].tolist() == [round(255.0 * float(srgb_encode(np.array(0.03))))] * 3


def test_depths_have_the_nearest_colour_of_the_heat_map(seen: OpenPage, tmp_path: Path) -> None:
    """The nearest depth is pale, the furthest dark."""
    place = np.concatenate([np.arange(0, 254, 4) + 0.44, np.arange(0, 254, 4) + 0.56])
    nearest, furthest = 2.0, 4.5
    depth = (nearest + (1.0 - place / 255.0) * (furthest - nearest)).astype(np.float32)
    planes = np.zeros((9, 8, 16), np.uint32)
    planes[7] = 1
    planes[4] = depth.view(np.uint32).reshape(8, 16)
    figures = {"most": 1, "nearest": nearest, "furthest": furthest}
    sums = np.zeros((8, 16, 4))
    found = presented(seen, tmp_path, sums, planes, show="depth", figures=figures)
    assert_heated(found.reshape(-1, 3), place)


def test_figures_are_those_of_all_rows(seen: OpenPage) -> None:
    """With more rows than a workgroup has; only pixels of the object count."""
    height, width = 70, 5
    hit = RNG.random((height, width)) < 0.6
    reads = RNG.integers(1, 100, (height, width))
    depth = RNG.uniform(2.0, 5.0, (height, width)).astype(np.float32)
    reads[~hit], depth[~hit] = 1000, 0.5
    planes = np.zeros((9, height, width), np.uint32)
    planes[4], planes[7], planes[8] = depth.view(np.uint32), hit, reads
    script = """async ([width, height, words]) => {
      const { gpu, drawing } = viewer;
      const planes = gpu.buffer(words.buffer, GPUBufferUsage.STORAGE);
      const view = {
        size: [width, height], canvas: [width, height], texels: [64, 64], background: [0, 0, 0, 1],
        divider: width + 1, show: "color", samples: 1,
      };
      const missed = gpu.planes(2, width, height);
      return drawing.frames.colors.figures({ planes, missed }, view);
    }"""
    found = evaluate(seen.page, script, [width, height, planes])
    assert found["hits"] == hit.sum()
    assert found["reads"] == reads[hit].sum()
    assert found["most"] == reads[hit].max()
    assert found["nearest"] == depth[hit].min()
    assert found["furthest"] == depth[hit].max()


# --- rounding: normals that the page makes --------------------------------------------------------


def test_normals_of_heights_are_rounded_to_the_nearest_code(seen: OpenPage) -> None:
    """With slopes s and t along u and v: (−s, t, 1) ÷ √(1 + s² + t²), as (x ÷ 2 + ½) · 65535."""
    script = """async ([texels, height, width, rise]) => {
      const { drawing } = viewer;
      const { normal, ...pictures } = viewer.pictures;
      await drawing.setMaps({ ...pictures, field: { width, height, texels } });
      const found = await drawing.bakesFor("clamp").normals(rise);
      await drawing.setMaps(viewer.original);
      return found;
    }"""
    codes, rise = RNG.integers(20000, 45000, (24, 11)), 9.0
    made = evaluate(seen.page, script, [codes.astype(np.uint16), *codes.shape, rise])
    found = made.reshape(*codes.shape, 4)[1:-1, 1:-1]
    heights = codes / 65535.0 * rise
    s = (heights[1:-1, 2:] - heights[1:-1, :-2]) / 2.0
    t = (heights[2:, 1:-1] - heights[:-2, 1:-1]) / 2.0
    normals = np.stack([-s, t, np.ones_like(s)], -1) / np.sqrt(1.0 + s**2 + t**2)[..., None]
    exact = (normals * 0.5 + 0.5) * 65535.0
    # float32 computes a code to within a hundredth
    known = np.abs(exact - np.floor(exact) - 0.5) > 0.05
    assert beside_halves(exact, 0.05, 0.2).sum() > 100
    np.testing.assert_array_equal(found[:, :, :3][known], np.rint(exact)[known])
    assert (found[:, :, 3] == 65535).all()


# --- rounding: the panel --------------------------------------------------------------------------

THUMBNAIL = """async ([texels, height, width, count, channels, light]) => {
  const { thumbnail } = await import("view/thumbs.js");
  const picture = { width, height, count, texels };
  const canvas = thumbnail(picture, channels, light);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return [canvas.height, canvas.width, data];
}"""


def thumbnail(
    seen: OpenPage, texels: np.ndarray, channels: list[int], light: bool = False
) -> np.ndarray:
    """The pixels, (h, w, 4), of a map's thumbnail; `light`: its values are linear light."""
    argument = [texels.astype(np.uint16), *texels.shape, channels, light]
    height, width, data = evaluate(seen.page, THUMBNAIL, argument)
    return data.reshape(height, width, 4)


def test_a_thumbnail_shows_the_nearest_codes(seen: OpenPage) -> None:
    """16-bit codes of data unchanged, linear colours as sRGB; 88 texels a side, one a pixel."""
    column, row = np.meshgrid(np.arange(88), np.arange(3))
    low = 257 * (2 * column + row) + 128
    # 128 ÷ 257 is below a half, 129 ÷ 257 above
    data = np.stack([low, low + 1, low[::-1]], -1)
    found = thumbnail(seen, data, [0, 1, 2])
    assert found.shape == (3, 88, 4)
    np.testing.assert_array_equal(found[:, :, :3], np.rint(data / 257.0))
    assert (found[:, :, 3] == 255).all()
    grey = thumbnail(seen, data, [1])
    np.testing.assert_array_equal(grey[:, :, :3], np.repeat(np.rint(data[:, :, 1:2] / 257.0), 3, 2))
    # from the middle on, linear codes are dense enough to lie near halves
    codes = np.stack([60 + 2 * column + k * row for k in (0, 3, 7)], -1)
    light = np.stack([srgb_decode((codes + part) / 255.0) for part in (0.47, 0.53)]) * 65535.0
    for texels, wanted in ((np.floor(light[0]), codes), (np.ceil(light[1]), codes + 1)):
        np.testing.assert_array_equal(thumbnail(seen, texels, [0, 1, 2], True)[:, :, :3], wanted)


@pytest.mark.parametrize(
    ("size", "shown"),
    [((200, 100), (88, 44)), ((100, 51), (88, 45)), ((51, 100), (45, 88)), ((1000, 3), (88, 1)),
     ((44, 11), (88, 22)), ((176, 3), (88, 2)), ((176, 5), (88, 3))],
)  # fmt: skip
def test_a_thumbnail_keeps_its_proportions(seen: OpenPage, size: Any, shown: Any) -> None:
    """88 pixels the longer side, the other rounded, halves up, and at least 1."""
    width, height = size
    found = thumbnail(seen, np.full((height, width, 1), 1000), [0])
    assert found.shape[1::-1] == shown


def test_a_thumbnail_averages_texels(seen: OpenPage) -> None:
    """2 × 2 texels a pixel, for a map of twice the size."""
    texels = RNG.integers(0, 65536, (64, 176, 1))
    found = thumbnail(seen, texels, [0])
    means = texels[:, :, 0].reshape(32, 2, 88, 2).mean((1, 3)) / 257.0
    known = np.abs(means - np.floor(means) - 0.5) > 1e-3
    np.testing.assert_array_equal(found[:, :, 0][known], np.rint(means)[known])


COLOR = """async ([light, code]) => {
  const { color } = await import("view/controls.js");
  const view = { state: { it: light }, shows: [], changed() {} };
  const field = color(view, ["it"], "it").querySelector("input");
  const shown = field.value;
  field.value = code;
  field.dispatchEvent(new Event("input"));
  return [shown, view.state.it];
}"""


def test_a_colour_is_chosen_as_srgb_and_stored_linear(seen: OpenPage) -> None:
    """Shown as the nearest code; a chosen code is stored as its linear value to four digits."""
    for codes in ([0, 5, 9], [10, 11, 50], [127, 200, 254]):
        for part, wanted in ((0.48, codes), (0.52, [code + 1 for code in codes])):
            light = srgb_decode((np.array(codes) + part) / 255.0).tolist()
            shown, state = seen.page.evaluate(COLOR, [light, "#0a80ff"])
            assert shown == "#" + "".join(f"{code:02x}" for code in wanted)
            exact = srgb_decode(np.array([10, 128, 255]) / 255.0)
            assert state == [float(f"{each:.3e}") for each in exact]
    shown, _ = seen.page.evaluate(COLOR, [[0.0, 1.0, 7.5], "#000000"])
    assert shown == "#00ffff"


def test_integer_settings_are_rounded_to_the_nearest(seen: OpenPage) -> None:
    script = """async (value) => {
      const { validated, copyOf } = await import("view/checks.js");
      const state = copyOf(viewer.state);
      state.settings.relief.max_steps = value;
      state.shadowing.max_shadow_steps = value;
      const { relief } = validated(state, viewer.start, viewer.data).settings;
      return [relief.max_steps, state.shadowing.max_shadow_steps];
    }"""
    for value, wanted in ((8.49, 8), (8.5, 9), (8.51, 9), (9.5, 10), (0.2, 1), (1e9, 4096)):
        assert seen.page.evaluate(script, value) == [wanted, wanted]


# --- holes ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new"), [((12, 10), (6, 5)), ((7, 9), (3, 4)), ((9, 4), (5, 7)), ((4, 6), (1, 1))]
)
def test_channels_are_reduced_as_by_the_library(seen: OpenPage, old: Any, new: Any) -> None:
    codes = RNG.integers(0, 65536, old).astype(np.uint16)
    script = """async ([texels, height, width, rows, columns]) => {
      const { resized } = await import("view/resize.js");
      return resized(texels, { width, height }, { width: columns, height: rows });
    }"""
    found = evaluate(seen.page, script, [codes.ravel(), *old, *new])
    np.testing.assert_array_equal(found.reshape(new), resized(codes, new))


@pytest.mark.parametrize("dust", [(1, 1), (9, 9), (56, 84)])
@pytest.mark.parametrize("color", [(1, 1), (14, 11), (56, 42)])
@pytest.mark.parametrize("height", [(1, 1), (28, 21)])
def test_holes_have_the_sizes_of_the_librarys(
    seen: OpenPage, height: Any, color: Any, dust: Any
) -> None:
    """Maps of one texel, and dust coarser and finer than the heights."""
    maps = [
        Map(RNG.integers(0, 65536, (*size, count), np.uint16), False, "made up")
        for size, count in ((height, 1), (color, 3), (dust, 1))
    ]
    material = Material("x", height=maps[0], base_color=maps[1], dust=maps[2])
    hole = opened(material, 0.7)
    script = """async ([proportion, ...maps]) => {
      const { opened } = await import("view/opened.js");
      const pictures = {};
      for (const name of ["field", "base_color", "dust"]) {
        const [height, width, texels] = maps.splice(0, 3);
        pictures[name] = { width, height, texels };
      }
      const { data } = viewer;
      const constants = { ...data.constants, proportion };
      const { field, base_color } = opened(pictures, 0.7, { ...data, constants });
      return [field, base_color].map(({ width, height, texels }) => [height, width, texels]);
    }"""
    texture = textures.base_color(material, "wrap")
    assert texture is not None
    page = (maps[0].pixels, texture.levels[0], maps[2].pixels)
    parts = [part for pixels in page for part in (*pixels.shape[:2], pixels)]
    found = evaluate(seen.page, script, [material.proportion, *parts])
    made = textures.base_color(hole, "wrap")
    assert hole.height is not None
    assert made is not None
    for (rows, columns, texels), wanted, count in zip(
        found, (hole.height.pixels, made.levels[0]), (1, 4), strict=True
    ):
        assert wanted.shape[:2] == (rows, columns)
        difference = texels.reshape(rows, columns, count) - wanted.astype(int)
        assert np.abs(difference).max() <= (1 if count == 1 else 4)
