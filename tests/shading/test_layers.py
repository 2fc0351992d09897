"""Maps that lie otherwise than the heights: details over a surface, and tilings of single maps.

The relief is a plane of one height, so that the place on the object where each ray ends is known in
float64; every map is read there, in its own tiling.
"""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Map, Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import program_of
from basrelief.rendering.render import render
from basrelief.scene import Layer, LookAt, Object, Orbit, Scene, Tiling, directional
from basrelief.shading.brdf import Shading
from helpers.agreement import assert_engines_agree
from helpers.synthetic import bilinear, drawn, map_of, on_plane, uniform_material, unit

HEIGHT, SCALE = 0.25, 0.3
GREY = 0.214041
"""Half of sRGB's range, linear."""
SLANTED = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), orthographic_height=0.35)
"""So near that a pixel is smaller than a texel of any map."""
BRIGHT = Shading(ambient=(1.0, 1.0, 1.0))
MATTE = Shading(ambient=(0.0, 0.0, 0.0), specular=(0.0, 0.0, 0.0))
RNG = np.random.default_rng(16)
COLORS = RNG.random((5, 7, 3)) * 0.3
UNLIT = {"lights": (), "shading": BRIGHT, "background": None}


def reliefs(material: Material, height: float = HEIGHT, **options) -> Object:
    """A plane of one height below the polygon."""
    material = Material(
        "made up", **{**dict(material.maps()), "height": map_of(np.full((1, 1), height))}
    )
    steps = {"min_steps": 8, "max_steps": 8}
    options = {"technique": "parallax_occlusion", "settings": steps, **options}
    return Object(
        material, **{"scale": SCALE, "reference_height": 1.0, "transform": np.eye(4), **options}
    )


def places(obj: Object) -> np.ndarray:
    """Where each ray ends, in the unit plane's own coordinates, before any tiling."""
    lowered = (HEIGHT - 1.0) * SCALE / abs(obj.resolved.tiling.tiles[0])
    return on_plane(SLANTED, lowered)[0]


def seen(obj: Object, **scene) -> Frame:
    frame = drawn(obj, camera=SLANTED, **{**UNLIT, **scene})
    assert frame.hit.all()
    return frame


def on(map_, tiling: Tiling, place: np.ndarray) -> np.ndarray:
    return bilinear(map_, place * tiling.tiles + tiling.shift)


# --- C10: details -----------------------------------------------------------------------------

TILINGS = [
    (Tiling((1.0, 1.0)), Tiling((2.0, 2.0))),
    (Tiling((2.0, 3.0), (0.1, 0.3)), Tiling((2.5, 1.5), (0.7, -0.2))),
    (Tiling((-1.5, 2.0), (0.4, 0.0)), Tiling((3.0, -2.0), (0.0, 0.45))),
]


@pytest.mark.parametrize(("main", "detail"), TILINGS)
def test_details_stay_glued_to_the_surface(main: Tiling, detail: Tiling) -> None:
    """C10: the offset of the details is that of the heights × detail tiling ÷ main tiling."""
    obj = reliefs(
        uniform_material(0.5),
        tiling=main.tiles,
        shift=main.shift,
        layer=Layer(Material("detail", base_color=map_of(COLORS)), detail),
    )
    frame = seen(obj)
    # the article's formula, from the displaced coordinates of the main maps
    polygon, _ = on_plane(SLANTED)
    offset = frame.uv - (polygon * main.tiles + main.shift)
    ratio = np.array(detail.tiles) / main.tiles
    wanted = bilinear(COLORS, polygon * detail.tiles + detail.shift + offset * ratio)
    found = frame.color[:, :, :3] * GREY / 0.5
    np.testing.assert_allclose(found, wanted, atol=5e-4)
    np.testing.assert_allclose(found, on(COLORS, detail, places(obj)), atol=5e-4)
    assert np.abs(found - on(COLORS, detail, polygon)).max() > 0.1


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_details_act_as_far_as_the_mask_allows(share: float) -> None:
    """C10: colour in proportion; of the normal as much of its slope."""
    base = np.array([0.3, 0.5, 0.7])
    lean = unit([0.3, -0.2, 1.0])
    tilted = map_of((unit([0.1, 0.2, 1.0]) * 0.5 + 0.5).reshape(1, 1, 3))
    detail = Material(
        "detail",
        base_color=map_of(np.full((1, 1, 3), 0.1)),
        normal=map_of((lean * 0.5 + 0.5).reshape(1, 1, 3)),
    )
    mask = map_of(np.full((1, 1), share))
    obj = reliefs(uniform_material(base, layer_mask=mask, normal=tilted), layer=Layer(detail))
    wanted = base * (1.0 - share + share * 0.1 / GREY)
    np.testing.assert_allclose(seen(obj).color[4, 4, :3], wanted, atol=2e-4)
    own, over = unit([0.1, 0.2, 1.0]), unit([*lean[:2] * share, lean[2]])
    bent = unit([*own[:2] + over[:2], own[2] * over[2]])
    np.testing.assert_allclose(normal_of(obj, wanted), bent, atol=5e-4)


def test_middle_grey_changes_nothing() -> None:
    base = uniform_material(1.0)
    noisy = Material("made up", base_color=map_of(RNG.random((5, 7, 3))))
    for material in (base, noisy):
        over = Layer(Material("grey", base_color=map_of(np.full((2, 2, 3), GREY))))
        with_, without = (
            seen(reliefs(material, layer=layer), lights=(directional(),)).color
            for layer in (over, None)
        )
        np.testing.assert_allclose(with_, without, atol=2e-4)


# three lights that together tell a normal, one in each channel of the picture
LAMPS = [
    directional(0.0, 0.0, (1.0, 0.0, 0.0)),
    directional(40.0, 0.0, (0.0, 1.0, 0.0)),
    directional(0.0, 40.0, (0.0, 0.0, 1.0)),
]
TOWARDS = np.array([[-float(c) for c in lamp.direction] for lamp in LAMPS])


def normal_of(obj: Object, color=0.6) -> np.ndarray:
    """The normal with which the middle of the picture is lit, by Lambert's law."""
    lit = seen(obj, lights=tuple(LAMPS), shading=MATTE, shading_model="phong")
    cosines = lit.color[30, 48, :3] / color
    assert cosines.min() > 0.05
    return np.linalg.solve(TOWARDS, cosines)


def leaning(x: float, y: float) -> Material:
    """A material whose normal leans the same way everywhere."""
    encoded = unit([x, y, 1.0]) * 0.5 + 0.5
    return Material("leaning", normal=map_of(np.broadcast_to(encoded, (4, 4, 3))))


@pytest.mark.parametrize(
    ("tiles", "turn"),
    [((4.0, 4.0), (1, 1)), ((-4.0, 4.0), (-1, 1)), ((4.0, -4.0), (1, -1)), ((2.0, 6.0), (1, 3))],
)
def test_normals_of_details_lean_further(tiles, turn) -> None:
    """Whiteout: slopes are added, z multiplied; mirrored where the detail is; as steep along v as
    the detail's texels are squeezed."""
    own, fine = unit([0.25, -0.1, 1.0]), np.array([0.15, 0.1, 1.0])
    material = Material("made up", normal=leaning(0.25, -0.1).normal)
    obj = reliefs(
        material, height=1.0, tiling=(1.0, 1.0), layer=Layer(leaning(0.15, 0.1), Tiling(tiles))
    )
    over = unit(unit(fine) * [*turn, 1.0])
    bent = unit([*own[:2] + over[:2], own[2] * over[2]])
    np.testing.assert_allclose(normal_of(obj), bent, atol=5e-4)


@pytest.mark.parametrize("z", [0.0, -0.5])
def test_a_stored_normal_of_details_points_out_of_the_surface(z: float) -> None:
    """Its z is at least 0.001: a map of (½, ½, ½) gives the surface's own normal."""
    stored = map_of(np.array([[[0.5, 0.5, 0.5 * z + 0.5]]]))
    obj = reliefs(uniform_material(), layer=Layer(Material("level", normal=stored)))
    # ½ is stored as 32768 ÷ 65535, which stands for 1 ÷ 65535
    wanted = unit([1.0 / 65535.0, 1.0 / 65535.0, 1e-3])
    np.testing.assert_allclose(normal_of(obj), wanted, atol=5e-4)


def test_the_layers_strengths_are_settings() -> None:
    detail = Material(
        "d", base_color=map_of(np.full((1, 1, 3), 0.1)), normal=leaning(0.3, 0).normal
    )
    with_, without = (
        reliefs(uniform_material(0.6), layer=layer, surface_parameters=surface_parameters)
        for layer, surface_parameters in (
            (Layer(detail), {"layer_color": 0.0, "layer_normal": 0.0}),
            (None, {}),
        )
    )
    scene = {"lights": tuple(LAMPS)}
    np.testing.assert_allclose(seen(with_, **scene).color, seen(without, **scene).color, atol=1e-5)


# --- W5: tilings of single maps -------------------------------------------------------------------

OWN = [
    Tiling((1.5, 2.5), (0.2, 0.6)),
    Tiling((-2.0, 1.0), (0.0, -0.3)),
    Tiling((2.0, -3.0), (0.9, 0.0)),
]
MAIN = {"tiling": (2.0, 1.5), "shift": (0.3, 0.1)}


@pytest.mark.parametrize("own", OWN)
def test_a_map_has_its_own_tiling(own: Tiling) -> None:
    """W5: colour, occlusion and emission, each alone, are read where its own tiling says; the
    others stay where the heights are."""
    occlusion = 0.3 + 0.6 * RNG.random((5, 7, 1))
    whole = uniform_material(
        base_color=map_of(COLORS), occlusion=map_of(occlusion), emission=map_of(COLORS)
    )
    dark = uniform_material(0.0, emission=map_of(COLORS))
    main = Tiling(MAIN["tiling"], MAIN["shift"])
    for name, material in (("base_color", whole), ("response", whole), ("emission", dark)):
        obj = reliefs(material, **MAIN, tilings={name: own})
        place = places(obj)
        color, shade, glow = (
            on(values, own if name == each else main, place)
            for each, values in (
                ("base_color", COLORS),
                ("response", occlusion),
                ("emission", COLORS),
            )
        )
        wanted = glow + (0.0 if material is dark else color * shade)
        np.testing.assert_allclose(seen(obj).color[:, :, :3], wanted, atol=1e-3)


@pytest.mark.parametrize(
    ("own", "turn"),
    [(Tiling((2.0, 1.5)), (1, 1)), (Tiling((-2.0, 1.5)), (-1, 1)), (Tiling((2.0, -4.5)), (1, -3))],
)
def test_a_normal_map_with_its_own_tiling_leans_its_own_way(own: Tiling, turn) -> None:
    """W5: mirrored where the heights are not; as steep along v as its texels are squeezed."""
    material = Material("made up", normal=leaning(0.2, 0.15).normal)
    obj = reliefs(material, height=1.0, tiling=(1.0, 0.75), tilings={"normal": own})
    # its texels are square on a tile of its own that is as wide as high
    squeezed = abs(own.tiles[1] / own.tiles[0])
    wanted = unit([0.2 * turn[0], 0.15 * np.sign(turn[1]) * squeezed, 1.0])
    np.testing.assert_allclose(normal_of(obj), wanted, atol=5e-4)


@pytest.mark.parametrize("what", ["tilings", "layer"])
def test_the_footprint_is_scaled_with_the_tiling(what: str) -> None:
    """Sixteen times as many tiles: a pixel covers as many texels more, and sees their mean."""
    checked = np.indices((32, 32)).sum(0) % 2
    fine = map_of(np.repeat(checked[:, :, None], 3, 2) * 2.0 * GREY)
    dense = Tiling((64.0, 64.0))
    if what == "layer":
        obj = reliefs(uniform_material(1.0), layer=Layer(Material("fine", base_color=fine), dense))
    else:
        obj = reliefs(uniform_material(base_color=fine), tilings={"base_color": dense})
    mean = 1.0 if what == "layer" else GREY
    color = seen(obj).color[:, :, 0]
    assert color.std() < 0.02 * mean
    assert color.mean() == pytest.approx(mean, rel=0.01)


# --- what is in a program, and both engines ------------------------------------------------------


def text(obj: Object) -> str:
    program = program_of(obj.resolved)
    return print_wgsl(program.module, program.edge)


def test_without_a_layer_and_tilings_there_is_no_code_for_them() -> None:
    material, detail = sample("tiles", 16), sample("grid", 16)
    bare = text(Object(material))
    layered = text(Object(material, layer=Layer(detail)))
    apart = text(Object(material, tilings={"normal": Tiling((2.0, 2.0))}))
    for word in (
        "add_detail_layer",
        "layer_color_of(map: ",
        "MapTilings",
        "retiled",
        "mirrored_normal",
    ):
        assert word not in bare
        assert word in layered
    for word in ("retiled", "mirrored_normal", "MapTilings"):
        assert word in apart
    assert "add_detail_layer" not in apart


@pytest.mark.gpu
@pytest.mark.parametrize("what", ["layer", "tilings"])
def test_cpu_and_gpu_agree(what: str) -> None:
    options = {
        "layer": {"layer": Layer(sample("grid", 64), Tiling((7.0, -5.0), (0.2, 0.1)))},
        "tilings": {
            "tilings": {
                "base_color": Tiling((3.0, 2.0)),
                "normal": Tiling((-1.0, 2.0), (0.3, 0.0)),
                "response": Tiling((2.0, 2.0)),
            }
        },
    }
    obj = Object(sample("bricks", 64), technique="relief", **options[what])
    assert_engines_agree(Scene((obj,), camera=Orbit(30.0, 40.0, 1.6)), 64)


def test_a_layer_repeats_on_a_shape_that_is_clipped() -> None:
    """The clip is at the shape's edge, not at the layer's first tile."""
    uniform_material = Material(
        "plain", base_color=Map(np.full((8, 8, 3), 0.5, np.float32), False, "plain")
    )
    left_dark = np.full((8, 8, 3), 0.214, np.float32)
    left_dark[:, :4] = 0.02
    over = Material("over", base_color=Map(left_dark, False, "over"))
    obj = Object(uniform_material, edge="clip", layer=Layer(over, Tiling((4.0, 1.0))))
    camera = Orbit(0.0, 90.0, orthographic_height=1.0)
    scene = Scene((obj,), camera, lights=(), shading={"ambient": 1.0}, background=None)
    row = render(scene, size=(64, 64), samples=1, device="cpu").color[32, :, 0]
    dark = row < 0.25
    assert (dark[1:] != dark[:-1]).sum() == 7, "four tiles, each dark on its left"


def test_a_layer_of_heights_alone_has_their_normals() -> None:
    bumps = np.random.default_rng(3).random((8, 8, 1)).astype(np.float32)
    over = Material("over", height=Map(bumps, False, "bumps"))
    uniform_material = Material(
        "plain", base_color=Map(np.full((1, 1, 3), 0.5, np.float32), False, "plain")
    )
    text = print_wgsl(
        program_of(Object(uniform_material, layer=Layer(over)).resolved).module, "wrap"
    )
    assert "layer_normal_of(map: texture_2d" in text
