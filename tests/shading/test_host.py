"""Entries for hosts, printed as GLSL and run by OpenGL, compared with the CPU engine."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basrelief.baking.tables import table
from basrelief.engine import choose_device
from basrelief.lang import HeightField, IVec2, Texture, Vec2, Vec3, normalize, shader, struct
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge
from basrelief.lang.targets.glsl import print_glsl
from basrelief.lang.types import leaves
from basrelief.material import sample
from basrelief.shading.host import host_hit, host_self_shadow
from basrelief.shading.relief import ReliefParameters
from basrelief.shading.self_shadow import Shadowing
from basrelief.shading.variant import Variant
from basrelief.techniques import TECHNIQUES, displace
from basrelief.techniques.technique import Settings
from helpers.glsl import assert_compiles

SIZE = (96, 72)
TEXELS = (40, 64)
"""Rows and columns of the map: neither square nor a power of two."""
RELIEF = ReliefParameters(scale=0.08, reference_height=0.7, bias=0.0)


@struct
class MapLayout:
    """Tiles of the map over the picture, size of the picture and direction of the light."""

    tiles: Vec2
    size: Vec2
    light: Vec3


@struct
class HostPixel:
    """Displaced coordinates, height and visibility of the light."""

    uv: Vec2
    height: float
    visibility: float
    found: bool


@shader
def host_pixel(
    at: IVec2,
    map_layout: MapLayout,
    relief: ReliefParameters,
    settings: Settings,
    shadowing: Shadowing,
    field: HeightField,
    baked: Texture,
    variant: Variant,
) -> HostPixel:
    """A pixel of a host: the view tilts over the picture, as from a camera nearby."""
    place = (Vec2(float(at.x), float(at.y)) + 0.5) / map_layout.size
    view = normalize(Vec3(place.x * 2.4 - 0.9, place.y * 1.8 - 1.1, 0.7))
    aspect = map_layout.tiles.y / map_layout.tiles.x
    hit = host_hit(field, baked, place * map_layout.tiles, view, aspect, relief, settings, variant)
    light = normalize(map_layout.light)
    visible = host_self_shadow(
        field, baked, hit.uv, light, aspect, relief, settings, shadowing, variant
    )
    return HostPixel(hit.uv, hit.height, visible, hit.found)


def program_and_values(
    technique: str, edge: Edge, tiles: tuple[float, float], shadows: str
) -> tuple[Program, dict[str, Any]]:
    chosen, engine = TECHNIQUES[technique], choose_device("cpu")
    heights = sample("gravel", TEXELS).height.linear()[:, :, 0]
    variant = Variant(displaced=True, shadows=shadows, columns=chosen.columns)
    filter = "columns" if chosen.columns else "sharp"
    program = Program(host_pixel, {displace: chosen}, edge, filter, variant)
    values = {
        "map_layout": MapLayout(Vec2(*tiles), Vec2(*SIZE), Vec3(0.6, -0.3, 0.5)),
        "relief": RELIEF,
        "settings": chosen.settings(),
        "shadowing": Shadowing(),
        "field": HeightField([heights], edge).with_filter(filter),
    }
    if chosen.bake is not None:
        values["baked"] = Texture([table(chosen.bake, heights, edge, engine)], edge)
    return program, values


def fragment_shader(program: Program) -> str:
    """The printed functions and a `main` as a host would write it."""
    entry = program.module.entry
    types = {HeightField: "sampler2D", Texture: "usampler2D"}
    parameters = list(entry.parameters.items())[1:]
    uniforms = "".join(f"uniform {types.get(t) or t.__name__} u_{n};\n" for n, t in parameters)
    arguments = ", ".join(["ivec2(gl_FragCoord.xy)", *(f"u_{n}" for n, _ in parameters)])
    return (
        f"#version 330\n{print_glsl(program.module, program.edge)}\n{uniforms}"
        "layout(location = 0) out vec4 a;\nlayout(location = 1) out vec4 b;\n"
        f"void main() {{\n  HostPixel seen = {entry.name}({arguments});\n"
        "  a = vec4(seen.uv, seen.height, seen.visibility);\n"
        "  b = vec4(float(seen.found));\n}\n"
    )


def drawn_by_opengl(program: Program, values: dict[str, Any]) -> dict[str, np.ndarray]:
    """The planes of a program, drawn by a fragment shader over the picture, without mips or
    filters."""
    moderngl = pytest.importorskip("moderngl")
    with moderngl.create_context(standalone=True, backend="egl", require=330) as context:
        corners = "vec2[](vec2(-1, -1), vec2(3, -1), vec2(-1, 3))[gl_VertexID]"
        linked = context.program(
            vertex_shader=f"#version 330\nvoid main() {{ gl_Position = vec4({corners}, 0, 1); }}",
            fragment_shader=fragment_shader(program),
        )
        for unit, (name, t) in enumerate(list(program.module.entry.parameters.items())[1:]):
            value = values[name]
            if t in (HeightField, Texture):
                level = np.ascontiguousarray(value.levels[0])
                rows, columns = level.shape[:2]
                channels, kind = (1, "f4") if t is HeightField else (4, "u2")
                texture = context.texture((columns, rows), channels, level.tobytes(), dtype=kind)
                texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
                texture.use(unit)
                linked[f"u_{name}"].value = unit
                continue
            for path, number in uniforms_of(f"u_{name}", value).items():
                if path in linked:
                    linked[path].value = number
        targets = [context.texture(SIZE, 4, dtype="f4") for _ in range(2)]
        context.framebuffer(targets).use()
        context.vertex_array(linked, []).render(vertices=3)
        a, b = (np.frombuffer(t.read(), np.float32).reshape(SIZE[1], SIZE[0], 4) for t in targets)
    return {"uv": a[..., :2], "height": a[..., 2], "visibility": a[..., 3], "found": b[..., 0]}


def uniforms_of(name: str, record: Any) -> dict[str, Any]:
    """The uniforms of a record: a number or a vector for each field."""
    numbers: dict[str, list[Any]] = {}
    for path, t in leaves(type(record)):
        field, *component = path.split(".")
        value = getattr(record, field)
        number = getattr(value, component[0]) if component else value
        numbers.setdefault(f"{name}.{field}", []).append(int(number) if t is int else float(number))
    return {path: n[0] if len(n) == 1 else tuple(n) for path, n in numbers.items()}


@pytest.mark.parametrize("technique", sorted(set(TECHNIQUES) - {"flat"}))
@pytest.mark.parametrize(
    ("edge", "tiles", "shadows"),
    [("wrap", (2.0, 3.0), "soft"), ("wrap", (-1.5, 1.0), "hard"), ("clamp", (1.0, 1.0), "none")],
)
def test_glsl_draws_what_the_cpu_does(technique, edge, tiles, shadows) -> None:
    """uv within 0.05 texel for 99.9 % of the pixels, on mirrored and unequal tilings."""
    program, values = program_and_values(technique, edge, tiles, shadows)
    planes = choose_device("cpu").run(program, values, SIZE)
    expected_uv = np.stack([planes["uv.x"], planes["uv.y"]], -1)
    found = drawn_by_opengl(program, values)
    off = np.abs(found["uv"] - expected_uv) * TEXELS[::-1]
    assert (off.max(-1) <= 0.05).mean() >= 0.999
    assert (np.abs(found["height"] - planes["height"]) <= 1e-3).mean() >= 0.999
    assert (np.abs(found["visibility"] - planes["visibility"]) <= 0.02).mean() >= 0.995
    assert ((found["found"] != 0) == (planes["found"] != 0)).mean() >= 0.995
    # the relief moves most of what is seen
    assert (np.abs(found["uv"] - undisplaced(tiles)) * TEXELS[::-1]).max(-1).mean() > 0.2


def undisplaced(tiles: tuple[float, float]) -> np.ndarray:
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]] + 0.5
    return np.stack([x / SIZE[0] * tiles[0], y / SIZE[1] * tiles[1]], -1)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_glsl_compiles_by_the_reference_compiler(technique: str, tmp_path: Path) -> None:
    program, _ = program_and_values(technique, "wrap", (1.0, 1.0), "soft")
    assert_compiles(fragment_shader(program), tmp_path)
