"""Heights by the filter of the GPU: against texels, in both formats, and refused on the CPU."""

from __future__ import annotations

import functools
import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from basrelief.engine import Engine, choose_device, gpu
from basrelief.engine.cpu import CpuEngine
from basrelief.errors import DeviceError
from basrelief.gallery.settings import settings_of
from basrelief.images import read_picture
from basrelief.lang import (
    Buffer,
    HeightField,
    IVec2,
    ShaderError,
    Vec2,
    corners,
    sampled,
    shader,
    struct,
)
from basrelief.lang.bindings import bindings
from basrelief.lang.frontend import analyse
from basrelief.lang.library import library_of
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge, Filter, Sampling
from basrelief.lang.targets.glsl import print_glsl
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import SURFACES, depth_program_of, program_of
from basrelief.rendering.render import render
from basrelief.scene import Object, Orbit, Scene, placed
from basrelief.shading.pixel import pixel
from basrelief.shading.surfaces.surface import surface_at
from basrelief.techniques import (
    TECHNIQUES,
    Hit,
    Nothing,
    Ray,
    at,
    displace,
    flat,
    height_at,
    hit_at,
    technique,
)
from basrelief.techniques.height import gradient_at, level_height, lod_height, sharp, surface_height
from helpers.agreement import color_difference
from helpers.command_line import done, refused, run, write_heights
from helpers.variants import random_programs

REFUSAL = "filter hardware needs a GPU: use --device gpu, or --filter texel"
EDGES: tuple[Edge, ...] = ("wrap", "clamp")
WEIGHT = 1.0 / 256.0
"""Largest error of a weight of 8 bits."""


@struct
class Place:
    """Texture coordinates and a level of detail."""

    u: float
    v: float
    lod: float


@struct
class Heights:
    """The height at a place: by the filter, and by the shaders of techniques."""

    filtered: float
    sharp: float
    level: float
    between: float


@shader
def heights_at(pixel: IVec2, field: HeightField, places: Buffer[Place]) -> Heights:
    """Read the height at a place in several ways."""
    place = places[pixel.x]
    uv = Vec2(place.u, place.v)
    return Heights(
        sampled(field, uv, place.lod),
        surface_height(field, uv, 0.0, 0.0),
        level_height(field, uv, int(place.lod)),
        lod_height(field, uv, place.lod),
    )


@struct
class Height:
    """One height."""

    height: float


@shader
def of_two(pixel: IVec2, filtered: HeightField, other: HeightField) -> Height:
    """One field by the filter of the GPU, another by its texels."""
    uv = (Vec2(float(pixel.x), float(pixel.y)) + 0.5) / 4.0
    return Height(surface_height(filtered, uv, 0.0, 0.0) + corners(other, pixel, 0).x)


@technique()
def filtered_step(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """A single step, by the filter of the GPU."""
    return hit_at(ray, sampled(field, at(ray, 0.5), 0.0) * height_at(ray, 0.5), True, 1)


@functools.cache
def engine() -> Any:
    return choose_device("gpu")


def field(edge: Edge) -> HeightField:
    """Levels that differ from one another, of odd sizes, with large differences of heights."""
    draw = np.random.default_rng(5)
    shapes = [(11, 7), (5, 3), (2, 1), (1, 1)]
    return HeightField([draw.random(shape, np.float32) for shape in shapes], edge)


def places() -> Buffer[Place]:
    """Places in the tile, at its borders, on texel centres, and outside, in all levels."""
    draw = np.random.default_rng(6)
    inside = draw.random((150, 2))
    around = draw.uniform(-2.5, 3.5, (150, 2))
    ends = [*itertools.product((0.0, 1.0, 0.5 / 7.0, -0.25, 1.75), (0.0, 1.0, 10.5 / 11.0, -1.5))]
    lods = (0.0, 0.4, 1.0, 1.75, 2.0, 3.0, -1.0, 7.0)
    uv = np.concatenate([inside, around, ends])
    return Buffer([Place(u, v, lods[n % len(lods)]) for n, (u, v) in enumerate(uv)])


def read_heights(
    heights: HeightField, sampling: Sampling, device: Engine
) -> tuple[dict[str, np.ndarray], list[Any]]:
    """The results of `heights_at` on a device, and its places."""
    read = places()
    program = Program(heights_at, edge=heights.edge, sampling=sampling)
    planes = device.run(program, {"field": heights, "places": read}, (len(read), 1))
    return {name: plane[0] for name, plane in planes.items()}, [*read.items]


def reference(heights: HeightField, place: Any) -> tuple[float, float]:
    """The filtered height in float64, and how far weights of 8 bits may move it."""
    lod = min(max(float(place.lod), 0.0), len(heights.levels) - 1.0)
    values, spans = [], []
    for level in (int(lod), min(int(lod) + 1, len(heights.levels) - 1)):
        texels = heights.levels[level].astype(np.float64)
        rows, columns = texels.shape
        x, y = float(place.u) * columns - 0.5, float(place.v) * rows - 0.5
        left, top = int(np.floor(x)), int(np.floor(y))
        total, near = 0.0, []
        for row, down in ((top, 1.0 - (y - top)), (top + 1, y - top)):
            for column, across in ((left, 1.0 - (x - left)), (left + 1, x - left)):
                if heights.edge == "wrap":
                    texel = texels[row % rows, column % columns]
                else:
                    texel = texels[min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)]
                near.append(texel)
                total += texel * down * across
        values.append(total)
        spans.append(max(near) - min(near))
    part = lod - int(lod)
    between = abs(values[1] - values[0]) if part > 0.0 else 0.0
    return values[0] * (1.0 - part) + values[1] * part, WEIGHT * (2.0 * max(spans) + between)


# --- single reads ---------------------------------------------------------------------------------


@pytest.mark.parametrize("edge", EDGES)
def test_in_python_the_weights_are_exact(edge: Edge) -> None:
    heights = field(edge)
    for place in places().items:
        read = sampled(heights, Vec2(place.u, place.v), place.lod)
        assert isinstance(read, np.float32)
        assert read == pytest.approx(reference(heights, place)[0], abs=3e-6)


@pytest.mark.parametrize("edge", EDGES)
def test_in_python_techniques_read_by_the_fields_sampling(edge: Edge) -> None:
    texels = field(edge)
    filtered = HeightField(texels.levels, edge, sampling="hardware")
    assert (texels.sampling, filtered.with_filter("mip").sampling) == ("texel", "hardware")
    for place in places().items[:40]:
        uv = Vec2(place.u, place.v)
        assert sharp(filtered, uv) == sampled(texels, uv, 0.0)
        assert sharp(filtered, uv) == pytest.approx(sharp(texels, uv), abs=3e-6)
        assert lod_height(filtered, uv, place.lod) == sampled(texels, uv, place.lod)
        # its cells are texels all the same
        assert gradient_at(filtered, uv) == gradient_at(texels, uv)


@pytest.mark.gpu
@pytest.mark.parametrize("edge", EDGES)
def test_the_filter_reads_the_bilinear_surface(edge: Edge) -> None:
    """Every level, between levels, at borders and beyond them, to weights of 8 bits."""
    heights = field(edge)
    read, where = read_heights(heights, "hardware", engine())
    for n, place in enumerate(where):
        for name, lod in (
            ("filtered", place.lod),
            ("between", place.lod),
            ("level", int(place.lod)),
            ("sharp", 0.0),
        ):
            expected, tolerance = reference(heights, replace(place, lod=lod))
            assert read[name][n] == pytest.approx(expected, abs=tolerance + 3e-6), (name, place)


@pytest.mark.gpu
@pytest.mark.parametrize("edge", EDGES)
def test_the_filter_differs_from_texels_by_its_weights_alone(edge: Edge) -> None:
    heights = field(edge)
    by_filter, where = read_heights(heights, "hardware", engine())
    by_texels, _ = read_heights(heights, "texel", engine())
    for n, place in enumerate(where):
        # mip levels below the coarsest are that level, in both
        for name, lod in (("sharp", 0.0), ("level", int(place.lod)), ("between", place.lod)):
            _, tolerance = reference(heights, replace(place, lod=lod))
            difference = abs(float(by_filter[name][n]) - float(by_texels[name][n]))
            assert difference <= tolerance + 3e-6, (name, place)


@pytest.mark.gpu
def test_without_filtering_of_32_bits_heights_have_16(monkeypatch: pytest.MonkeyPatch) -> None:
    heights = field("wrap")
    assert engine().filtered_format == "r32float"
    monkeypatch.setattr(gpu, "_FEATURES", ("timestamp-query",))
    narrow = gpu.GpuEngine()
    assert narrow.filtered_format == "r16float"
    read, where = read_heights(heights, "hardware", narrow)
    rounded = HeightField([level.astype(np.float16) for level in heights.levels])
    for n, place in enumerate(where):
        expected, tolerance = reference(rounded, place)
        assert read["filtered"][n] == pytest.approx(expected, abs=tolerance + 3e-6)
    # heights that are read as texels keep their 32 bits
    program = Program(of_two, sampling="hardware")
    single = HeightField([np.array([[1.0 / 3.0]], np.float32)])
    (plane,) = narrow.run(program, {"filtered": single, "other": single}, (1, 1)).values()
    expected_sum = np.float32(np.float16(1.0 / 3.0)) + np.float32(1.0 / 3.0)
    assert plane[0, 0] == pytest.approx(expected_sum, abs=1e-6)


# --- programs -------------------------------------------------------------------------------------


def test_only_fields_that_are_filtered_are_bound_for_it() -> None:
    entry = Program(of_two, sampling="hardware").module.entry
    bound = {b.name: (b.kind, b.access) for b in bindings(entry)}
    assert bound == {
        "run": ("run", "uniform"),
        "planes": ("planes", "storage"),
        "edge_sampler": ("sampler", "non-filtering"),
        "filter_sampler": ("sampler", "filtering"),
        "filtered": ("map", "float"),
        "other": ("map", "unfilterable-float"),
    }
    plain = {b.name: b.access for b in bindings(Program(of_two).module.entry)}
    assert "filter_sampler" not in plain
    assert plain["filtered"] == "unfilterable-float"


def test_a_program_of_texels_has_no_trace_of_the_filter() -> None:
    for _, program in random_programs(20, 12):
        text = print_wgsl(program.module, program.edge)
        assert "textureSampleLevel" not in text
        assert "filter_sampler" not in text


@pytest.mark.parametrize("edge", EDGES)
def test_the_sampler_applies_the_edge(edge: Edge) -> None:
    text = print_wgsl(Program(of_two, edge=edge, sampling="hardware").module, edge)
    assert "textureSampleLevel(field, filter_sampler, uv, 0.0).x" in text
    assert "fract" not in text
    assert "saturate" not in text


def test_glsl_reads_by_the_filter_of_the_host() -> None:
    @shader
    def read(field: HeightField, uv: Vec2) -> float:
        return sampled(field, uv, 0.0)

    assert "textureLod(field, uv, 0.0).x" in print_glsl(analyse(read), "wrap")


def scene(material: Material, filter: str = "hardware", **options: Any) -> Scene:
    of_scene = {name: options.pop(name) for name in ("shadows", "camera") if name in options}
    return Scene((Object(material, filter=filter, **options),), **of_scene)


@pytest.mark.parametrize("name", TECHNIQUES)
def test_techniques_that_solve_cells_keep_their_program(name: str) -> None:
    by_filter, by_texels = (
        scene(sample("bricks", 16), filter, technique=name, shadows="soft")
        for filter in ("hardware", "texel")
    )
    pairs = [
        (make(by_filter.resolved[0], by_filter), make(by_texels.resolved[0], by_texels))
        for make in (program_of, lambda obj, scene: depth_program_of(obj))
    ]
    reads_texels = name in ("exact", "texel", "flat")
    assert TECHNIQUES[name].solves_cells == (name in ("exact", "texel"))
    for filtered, texels in pairs:
        assert (filtered.key == texels.key) == reads_texels
        assert filtered.sampling == ("texel" if reads_texels else "hardware")


def test_the_caption_of_a_gallery_picture_names_the_filter() -> None:
    captions = [settings_of(scene(sample("bricks", 16), f)) for f in ("texel", "hardware")]
    assert ["filtered by the graphics card" in caption for caption in captions] == [False, True]


# --- pictures -------------------------------------------------------------------------------------


def drawn(drawn_scene: Scene, samples: int = 1) -> Frame:
    return render(drawn_scene, size=(120, 68), samples=samples, device=engine())


def assert_alike(one: Frame, other: Frame) -> None:
    """The same but where a march decides otherwise."""
    assert (one.hit == other.hit).mean() > 0.999
    assert np.percentile(color_difference(one, other), 99) < 0.02
    assert np.abs(one.reads - other.reads).mean() < 0.05


@pytest.mark.gpu
@pytest.mark.parametrize("heights", ["sharp", "smooth", "mip"])
@pytest.mark.parametrize("edge", ["wrap", "clamp", "clip"])
def test_pictures_of_both_filters_are_alike(edge: str, heights: Filter) -> None:
    material = sample("gravel", 64)
    options = {
        "technique": "relief", "heights": heights, "edge": edge, "scale": 0.15,
        "tiling": (3.0, 2.0), "shift": (0.2, -0.4), "shadows": "hard", "camera": Orbit(25.0, 30.0),
    }  # fmt: skip
    one, other = (drawn(scene(material, filter, **options)) for filter in ("texel", "hardware"))
    assert_alike(one, other)
    assert one.reads.max() > 4


@pytest.mark.gpu
@pytest.mark.parametrize("name", TECHNIQUES)
def test_every_technique_draws_alike(name: str) -> None:
    material = sample("bricks", 64)
    one, other = (drawn(scene(material, f, technique=name)) for f in ("texel", "hardware"))
    assert_alike(one, other)


@pytest.mark.gpu
def test_objects_of_different_filters_cast_shadows_on_each_other() -> None:
    material = sample("bricks", 32)
    frames = []
    for filters in itertools.product(("texel", "hardware"), repeat=2):
        floor = Object(material, filter=filters[0], scale=0.1)
        ball = Object(material, "sphere", filter=filters[1], transform=placed((0, 0.4, 0), 0.4))
        both = Scene((floor, ball), shadows="hard", shadow_map_size=64)
        frames.append(drawn(both, samples=2))
    for frame in frames[1:]:
        assert_alike(frames[0], frame)


# --- refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["relief", "exact", "flat"])
def test_the_cpu_refuses_the_filter(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    filtered = scene(sample("bricks", 16), technique=name)
    compiled: list[Program] = []
    monkeypatch.setattr(CpuEngine, "_load", lambda self, program: compiled.append(program))
    with pytest.raises(DeviceError) as caught:
        render(filtered, size=(8, 8), device="cpu")
    assert str(caught.value) == REFUSAL
    # where auto finds no GPU
    monkeypatch.setattr("basrelief.engine.select.has_hardware_gpu", lambda: False)
    with pytest.raises(DeviceError) as caught:
        render(filtered, size=(8, 8))
    assert str(caught.value) == REFUSAL
    # a program by itself
    with pytest.raises(DeviceError) as caught:
        CpuEngine().compile(Program(of_two, sampling="hardware"))
    assert str(caught.value) == REFUSAL
    assert compiled == []


def test_a_shader_that_samples_is_refused_on_the_cpu() -> None:
    with pytest.raises(ShaderError, match="sampled reads by the filter of a GPU"):
        CpuEngine().compile(Program(heights_at))


def test_a_page_refuses_a_technique_that_samples() -> None:
    options = {displace: [filtered_step, flat], surface_at: SURFACES.values()}
    with pytest.raises(ShaderError, match=r"filtered_step reads by the filter of the GPU"):
        library_of([pixel], options)


@pytest.mark.parametrize(
    "command",
    [
        ("render", "-o", "out.png"),
        ("render", "-o", "out.gif", "--frames", "2"),
        ("compare", "-o", "out"),
        ("tune", "--missed", "1%", "-o", "out.toml"),
    ],
)
def test_commands_refuse_the_filter_on_the_cpu(
    command: tuple[str, ...], tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = write_heights(tmp_path / "wall")
    arguments = [command[0], folder, *command[1:], "--filter", "hardware", "--device", "cpu"]
    assert refused(*arguments) == REFUSAL
    assert [file.name for file in tmp_path.iterdir()] == ["wall"]


def test_a_page_of_filtered_heights_is_refused(tmp_path: Any) -> None:
    folder = write_heights(tmp_path / "wall")
    preset = tmp_path / "mine.toml"
    preset.write_text("[object]\nfilter = 'hardware'\n")
    for options in (["--filter", "hardware"], ["--preset", preset]):
        message = refused("view", folder, *options, "-o", tmp_path / "page.html")
        assert "a page reads heights as texels" in message
        assert "use --filter texel" in message
    done("view", folder, "--preset", preset, "--filter", "texel", "-o", tmp_path / "page.html",
         "--device", "cpu")  # fmt: skip


def test_a_single_ray_is_explained_by_texels(tmp_path: Any) -> None:
    folder = write_heights(tmp_path / "wall")
    arguments = ["explain", folder, "--pixel", "60,34", "--size", "120x68", "--technique", "relief"]
    explained = run(*arguments, "--filter", "hardware")
    assert explained.out == done(*arguments)
    assert "heights are read as texels" in explained.err


@pytest.mark.gpu
def test_the_command_draws_by_the_filter(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    folder = write_heights(tmp_path / "wall")
    options = ["--size", "60x34", "--samples", "1", "--device", "gpu", "--technique", "relief"]
    sampled_with: list[Sampling] = []
    original = gpu.GpuEngine._pipeline_of

    def watching(self: Any, program: Program) -> Any:
        sampled_with.append(program.sampling)
        return original(self, program)

    monkeypatch.setattr(gpu.GpuEngine, "_pipeline_of", watching)
    for filter in ("texel", "hardware"):
        done("render", folder, *options, "--filter", filter, "-o", f"{filter}.png")
    assert {*sampled_with} == {"texel", "hardware"}
    one, other = (read_picture(f"{f}.png").pixels.astype(int) for f in ("texel", "hardware"))
    assert np.abs(one - other).mean() < 1.0
