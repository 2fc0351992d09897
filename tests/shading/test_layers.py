"""Maps with tilings of their own: second layers, and single maps.

The relief is a plane of constant height, so that the hit of each ray is known in float64; every map
is read there, in its own tiling.
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
from helpers.synthetic import bilinear, drawn, map_of, matte, on_plane, uniform_material, unit

HEIGHT, SCALE = 0.25, 0.3
GREY = 0.214041
"""sRGB 0.5 as a linear value."""
SLANTED = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), orthographic_height=0.35)
"""Close enough that a pixel is smaller than a texel of any map."""
BRIGHT = Shading(ambient=(1.0, 1.0, 1.0))
MATTE = Shading(ambient=(0.0, 0.0, 0.0))
RNG = np.random.default_rng(16)
COLORS = RNG.random((5, 7, 3)) * 0.3
UNLIT = {"lights": (), "shading": BRIGHT, "background": None}


def flat_relief(material: Material, height: float = HEIGHT, **options) -> Object:
    """A plane of constant height below the polygon."""
    material = Material(
        "made up", **{**dict(material.maps()), "height": map_of(np.full((1, 1), height))}
    )
    steps = {"min_steps": 8, "max_steps": 8}
    options = {"technique": "parallax_occlusion", "settings": steps, **options}
    return Object(
        material, **{"scale": SCALE, "reference_height": 1.0, "transform": np.eye(4), **options}
    )


def hits(obj: Object) -> np.ndarray:
    """The hit of each ray in texture coordinates of the plane, before any tiling."""
    lowered = (HEIGHT - 1.0) * SCALE / abs(obj.resolved.tiling.tiles[0])
    return on_plane(SLANTED, lowered)[0]


def rendered(obj: Object, **scene) -> Frame:
    frame = drawn(obj, camera=SLANTED, **{**UNLIT, **scene})
    assert frame.hit.all()
    return frame


def sampled(values: np.ndarray, tiling: Tiling, uv: np.ndarray) -> np.ndarray:
    """Values of a map in its tiling, at texture coordinates of the plane."""
    return bilinear(values, uv * tiling.tiles + tiling.shift)


# --- C10: second layers -----------------------------------------------------------------------

TILINGS = [
    (Tiling((1.0, 1.0)), Tiling((2.0, 2.0))),
    (Tiling((2.0, 3.0), (0.1, 0.3)), Tiling((2.5, 1.5), (0.7, -0.2))),
    (Tiling((-1.5, 2.0), (0.4, 0.0)), Tiling((3.0, -2.0), (0.0, 0.45))),
]


@pytest.mark.parametrize(("main", "detail"), TILINGS)
def test_a_layer_stays_fixed_to_the_surface(main: Tiling, detail: Tiling) -> None:
    """C10: the offset of the layer is that of the heights × layer tiling ÷ main tiling."""
    obj = flat_relief(
        uniform_material(0.5),
        tiling=main.tiles,
        shift=main.shift,
        layer=Layer(Material("detail", base_color=map_of(COLORS)), detail),
    )
    frame = rendered(obj)
    # the article's formula, from the displaced coordinates of the main maps
    polygon, _ = on_plane(SLANTED)
    offset = frame.uv - (polygon * main.tiles + main.shift)
    ratio = np.array(detail.tiles) / main.tiles
    wanted = bilinear(COLORS, polygon * detail.tiles + detail.shift + offset * ratio)
    found = frame.color[:, :, :3] * GREY / 0.5
    np.testing.assert_allclose(found, wanted, atol=5e-4)
    np.testing.assert_allclose(found, sampled(COLORS, detail, hits(obj)), atol=5e-4)
    assert np.abs(found - sampled(COLORS, detail, polygon)).max() > 0.1


@pytest.mark.parametrize("layer_offset", ["unscaled", "none"])
@pytest.mark.parametrize(("main", "detail"), TILINGS)
def test_a_layer_with_another_offset_floats(main: Tiling, detail: Tiling, layer_offset) -> None:
    """C10: the article's comparisons, by the offset of the heights as it is, and by none."""
    obj = flat_relief(
        uniform_material(0.5),
        tiling=main.tiles,
        shift=main.shift,
        layer=Layer(Material("detail", base_color=map_of(COLORS)), detail),
        layer_offset=layer_offset,
    )
    frame = rendered(obj)
    polygon, _ = on_plane(SLANTED)
    offset = frame.uv - (polygon * main.tiles + main.shift)
    there = polygon * detail.tiles + detail.shift + offset * (layer_offset == "unscaled")
    found = frame.color[:, :, :3] * GREY / 0.5
    np.testing.assert_allclose(found, bilinear(COLORS, there), atol=5e-4)


@pytest.mark.parametrize("weight", [0.0, 0.5, 1.0])
def test_the_mask_weights_the_layer(weight: float) -> None:
    """C10: its colour is blended by the mask, the slope of its normal multiplied by it."""
    base = np.array([0.3, 0.5, 0.7])
    lean = unit([0.3, -0.2, 1.0])
    tilted = map_of((unit([0.1, 0.2, 1.0]) * 0.5 + 0.5).reshape(1, 1, 3))
    detail = Material(
        "detail",
        base_color=map_of(np.full((1, 1, 3), 0.1)),
        normal=map_of((lean * 0.5 + 0.5).reshape(1, 1, 3)),
    )
    mask = map_of(np.full((1, 1), weight))
    obj = flat_relief(uniform_material(base, layer_mask=mask, normal=tilted), layer=Layer(detail))
    wanted = base * (1.0 - weight + weight * 0.1 / GREY)
    np.testing.assert_allclose(rendered(obj).color[4, 4, :3], wanted, atol=2e-4)
    own, over = unit([0.1, 0.2, 1.0]), unit([*lean[:2] * weight, lean[2]])
    blended = unit([*own[:2] + over[:2], own[2] * over[2]])
    np.testing.assert_allclose(normal_of(obj, wanted), blended, atol=5e-4)


def test_middle_grey_changes_nothing() -> None:
    base = uniform_material(1.0)
    noisy = Material("made up", base_color=map_of(RNG.random((5, 7, 3))))
    for material in (base, noisy):
        grey = Layer(Material("grey", base_color=map_of(np.full((2, 2, 3), GREY))))
        layered, unlayered = (
            rendered(flat_relief(material, layer=layer), lights=(directional(),)).color
            for layer in (grey, None)
        )
        np.testing.assert_allclose(layered, unlayered, atol=2e-4)


LAMPS = [
    directional(0.0, 0.0, (1.0, 0.0, 0.0)),
    directional(40.0, 0.0, (0.0, 1.0, 0.0)),
    directional(0.0, 40.0, (0.0, 0.0, 1.0)),
]
"""Three lights, one in each channel, from which the normal can be solved."""
TOWARDS = np.array([[-float(c) for c in lamp.direction] for lamp in LAMPS])


def normal_of(obj: Object, color=0.6) -> np.ndarray:
    """The shading normal at the middle of the picture, solved from Lambert's law."""
    lit = rendered(matte(obj), lights=tuple(LAMPS), shading=MATTE, shading_model="phong")
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
def test_normals_of_layers_add_their_slope(tiles, turn) -> None:
    """Whiteout blending: slopes added, z multiplied; mirrored with the layer; steeper along v where
    the layer's texels are squeezed."""
    own, fine = unit([0.25, -0.1, 1.0]), np.array([0.15, 0.1, 1.0])
    material = Material("made up", normal=leaning(0.25, -0.1).normal)
    obj = flat_relief(
        material, height=1.0, tiling=(1.0, 1.0), layer=Layer(leaning(0.15, 0.1), Tiling(tiles))
    )
    over = unit(unit(fine) * [*turn, 1.0])
    blended = unit([*own[:2] + over[:2], own[2] * over[2]])
    np.testing.assert_allclose(normal_of(obj), blended, atol=5e-4)


@pytest.mark.parametrize("z", [0.0, -0.5])
def test_a_stored_normal_of_a_layer_points_out_of_the_surface(z: float) -> None:
    """Its z is at least 0.001: a map of (½, ½, ½) gives the surface's own normal."""
    stored = map_of(np.array([[[0.5, 0.5, 0.5 * z + 0.5]]]))
    obj = flat_relief(uniform_material(), layer=Layer(Material("level", normal=stored)))
    # ½ is stored as 32768 ÷ 65535, which stands for 1 ÷ 65535
    wanted = unit([1.0 / 65535.0, 1.0 / 65535.0, 1e-3])
    np.testing.assert_allclose(normal_of(obj), wanted, atol=5e-4)


def test_the_layers_strengths_are_settings() -> None:
    detail = Material(
        "d", base_color=map_of(np.full((1, 1, 3), 0.1)), normal=leaning(0.3, 0).normal
    )
    invisible, unlayered = (
        flat_relief(uniform_material(0.6), layer=layer, surface_parameters=surface_parameters)
        for layer, surface_parameters in (
            (Layer(detail), {"layer_color": 0.0, "layer_normal": 0.0}),
            (None, {}),
        )
    )
    scene = {"lights": tuple(LAMPS)}
    np.testing.assert_allclose(
        rendered(invisible, **scene).color, rendered(unlayered, **scene).color, atol=1e-5
    )


# --- W5: tilings of single maps -------------------------------------------------------------------

OWN = [
    Tiling((1.5, 2.5), (0.2, 0.6)),
    Tiling((-2.0, 1.0), (0.0, -0.3)),
    Tiling((2.0, -3.0), (0.9, 0.0)),
]
MAIN = {"tiling": (2.0, 1.5), "shift": (0.3, 0.1)}


@pytest.mark.parametrize("own", OWN)
def test_a_map_has_its_own_tiling(own: Tiling) -> None:
    """W5: colour, occlusion and emission, each alone, are read in their own tiling; the other maps
    in the tiling of the heights."""
    occlusion = 0.3 + 0.6 * RNG.random((5, 7, 1))
    whole = uniform_material(
        base_color=map_of(COLORS), occlusion=map_of(occlusion), emission=map_of(COLORS)
    )
    dark = uniform_material(0.0, emission=map_of(COLORS))
    main = Tiling(MAIN["tiling"], MAIN["shift"])
    for name, material in (("base_color", whole), ("response", whole), ("emission", dark)):
        obj = flat_relief(material, **MAIN, tilings={name: own})
        uv = hits(obj)
        color, shade, glow = (
            sampled(values, own if name == map_name else main, uv)
            for map_name, values in (
                ("base_color", COLORS),
                ("response", occlusion),
                ("emission", COLORS),
            )
        )
        wanted = glow + (0.0 if material is dark else color * shade)
        np.testing.assert_allclose(rendered(obj).color[:, :, :3], wanted, atol=1e-3)


@pytest.mark.parametrize(
    ("own", "turn"),
    [(Tiling((2.0, 1.5)), (1, 1)), (Tiling((-2.0, 1.5)), (-1, 1)), (Tiling((2.0, -4.5)), (1, -3))],
)
def test_a_normal_map_is_mirrored_and_scaled_by_its_own_tiling(own: Tiling, turn) -> None:
    """W5: mirrored where the heights are not; steeper along v where its texels are squeezed."""
    material = Material("made up", normal=leaning(0.2, 0.15).normal)
    obj = flat_relief(material, height=1.0, tiling=(1.0, 0.75), tilings={"normal": own})
    # a tile of equal sides has square texels
    squeezed = abs(own.tiles[1] / own.tiles[0])
    wanted = unit([0.2 * turn[0], 0.15 * np.sign(turn[1]) * squeezed, 1.0])
    np.testing.assert_allclose(normal_of(obj), wanted, atol=5e-4)


@pytest.mark.parametrize("layered", [False, True], ids=["tilings", "layer"])
def test_the_footprint_is_scaled_with_the_tiling(layered: bool) -> None:
    """With many tiles a pixel covers many texels and shows their mean."""
    checked = np.indices((32, 32)).sum(0) % 2
    fine = map_of(np.repeat(checked[:, :, None], 3, 2) * 2.0 * GREY)
    dense = Tiling((64.0, 64.0))
    if layered:
        obj = flat_relief(
            uniform_material(1.0), layer=Layer(Material("fine", base_color=fine), dense)
        )
    else:
        obj = flat_relief(uniform_material(base_color=fine), tilings={"base_color": dense})
    mean = 1.0 if layered else GREY
    color = rendered(obj).color[:, :, 0]
    assert color.std() < 0.02 * mean
    assert color.mean() == pytest.approx(mean, rel=0.01)


# --- what is in a program, and both engines ------------------------------------------------------


def text(obj: Object) -> str:
    """The WGSL of an object's program."""
    program = program_of(obj.resolved)
    return print_wgsl(program.module, program.edge)


def test_a_program_without_layers_and_tilings_has_no_code_for_them() -> None:
    material, detail = sample("tiles", 16), sample("grid", 16)
    without_maps = text(Object(material))
    layered = text(Object(material, layer=Layer(detail)))
    own_tilings = text(Object(material, tilings={"normal": Tiling((2.0, 2.0))}))
    for word in (
        "add_detail_layer",
        "layer_color_of(map: ",
        "MapTilings",
        "retiled",
        "mirrored_normal",
    ):
        assert word not in without_maps
        assert word in layered
    for word in ("retiled", "mirrored_normal", "MapTilings"):
        assert word in own_tilings
    assert "add_detail_layer" not in own_tilings


@pytest.mark.gpu
@pytest.mark.parametrize("option", ["layer", "tilings"])
def test_cpu_and_gpu_agree(option: str) -> None:
    values = {
        "layer": Layer(sample("grid", 64), Tiling((7.0, -5.0), (0.2, 0.1))),
        "tilings": {
            "base_color": Tiling((3.0, 2.0)),
            "normal": Tiling((-1.0, 2.0), (0.3, 0.0)),
            "response": Tiling((2.0, 2.0)),
        },
    }
    obj = Object(sample("bricks", 64), technique="relief", **{option: values[option]})
    assert_engines_agree(Scene((obj,), camera=Orbit(30.0, 40.0, 1.6)), 64)


def test_a_layer_repeats_on_a_shape_that_is_clipped() -> None:
    """The shape's edge clips, not the edge of the layer's first tile."""
    grey = Material("grey", base_color=Map(np.full((8, 8, 3), 0.5, np.float32), False, "grey"))
    left_dark = np.full((8, 8, 3), 0.214, np.float32)
    left_dark[:, :4] = 0.02
    over = Material("over", base_color=Map(left_dark, False, "over"))
    obj = Object(grey, edge="clip", layer=Layer(over, Tiling((4.0, 1.0))))
    camera = Orbit(0.0, 90.0, orthographic_height=1.0)
    scene = Scene((obj,), camera, lights=(), shading={"ambient": 1.0}, background=None)
    row = render(scene, size=(64, 64), samples=1, device="cpu").color[32, :, 0]
    dark = row < 0.25
    assert (dark[1:] != dark[:-1]).sum() == 7, "four tiles, each dark on its left"


def test_a_layer_with_only_heights_has_normals_from_them() -> None:
    bumps = np.random.default_rng(3).random((8, 8, 1)).astype(np.float32)
    over = Material("over", height=Map(bumps, False, "bumps"))
    grey = Material("grey", base_color=Map(np.full((1, 1, 3), 0.5, np.float32), False, "grey"))
    assert "layer_normal_of(map: texture_2d" in text(Object(grey, layer=Layer(over)))
