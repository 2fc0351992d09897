"""Procedural samples: seamless, reproducible, the same at every size, with matching normals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.errors import InputError
from basrelief.images import srgb_decode, srgb_encode
from basrelief.images.resize import resized
from basrelief.material import SAMPLES, Map, Material, hole, opened, sample
from basrelief.material.evidence import slope_correlation
from basrelief.material.patterns import cells as cells_module
from basrelief.material.patterns.bricks import _Wall as Wall
from basrelief.material.patterns.canvas import Canvas, mix, smoothstep
from basrelief.material.patterns.cells import cells
from basrelief.material.samples import normals, occlusion

SIZE = 128
RELIEFS = [name for name in SAMPLES if name not in ("grid", "hole")]
"""All but the detail map, without heights, and the hole, without normals."""
METALS = {"tiles", "circuit", "grating"}


@pytest.fixture(scope="module")
def drawn() -> dict[str, Material]:
    return {name: sample(name, SIZE) for name in SAMPLES}


def heights(material: Material) -> np.ndarray:
    assert material.height is not None
    return material.height.linear()[:, :, 0].astype(np.float64)


def shrunk(values: np.ndarray, times: int) -> np.ndarray:
    """Means over blocks of `times` × `times`, for (h, w, channels)."""
    height, width, channels = values.shape
    blocks = values.reshape(height // times, times, width // times, times, channels)
    return blocks.mean(axis=(1, 3))


@pytest.mark.parametrize("name", RELIEFS)
def test_all_maps_are_there(name: str, drawn: dict[str, Material]) -> None:
    material = drawn[name]
    kinds = {kind for kind, _ in material.maps()}
    assert kinds >= {"base_color", "normal", "height", "occlusion", "roughness"}
    assert ("metallic" in kinds) == (name in METALS)
    assert ("opacity" in kinds) == (name == "grating")
    assert {(each.height, each.width) for _, each in material.maps()} == {(SIZE, SIZE)}
    assert material.height is not None
    assert material.height.bits == 16
    assert material.height_range == (0, 1)
    assert material.scale is not None
    assert 0.01 < material.scale <= 0.2


@pytest.mark.parametrize("name", SAMPLES)
def test_maps_are_not_empty(name: str, drawn: dict[str, Material]) -> None:
    """Colours vary, little is clipped, and roughness stays above a perfect mirror's."""
    material = drawn[name]
    assert material.base_color is not None
    color = material.base_color.pixels
    assert color.std() > 8
    assert ((color == 0) | (color == 255)).mean() < (0.7 if name == "dust" else 0.02)
    if material.roughness is not None:
        assert material.roughness.range()[0] > 0.03
    if material.height is not None:
        assert heights(material).std() > 0.05


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize("axis", [0, 1])
def test_samples_have_no_seam(name: str, axis: int, drawn: dict[str, Material]) -> None:
    """Steps across the edge are no larger than those inside."""
    for kind, each in drawn[name].maps():
        values = each.linear().astype(np.float64)
        steps = np.abs(values - np.roll(values, 1, axis)).mean(axis=(1 - axis, 2))
        assert steps[0] <= 1.15 * steps[1:].max(), kind


@pytest.mark.parametrize("name", ["cobbles", "gravel", "terrain"])
@pytest.mark.parametrize("axis", [0, 1])
def test_stones_continue_across_the_edge(name: str, axis: int, drawn: dict[str, Material]) -> None:
    """Few steps across the edge are among the largest 3 %, so stones continue there."""
    for kind, each in drawn[name].maps():
        values = each.linear().astype(np.float64)
        steps = np.moveaxis(np.abs(values - np.roll(values, 1, axis)).max(axis=2), axis, 0)
        assert (steps[0] > np.quantile(steps, 0.97)).mean() < 0.25, kind


def test_a_brick_continues_across_the_edge() -> None:
    wall = Wall(Canvas(90, 90, seed=0))
    shifted = wall.row[:, 0] % 2 == 1
    assert shifted.any()
    assert (wall.column[shifted, 0] == wall.column[shifted, -1]).all()


@pytest.mark.parametrize("name", SAMPLES)
def test_the_seed_determines_the_maps(name: str, drawn: dict[str, Material]) -> None:
    for (_, one), (_, same), (_, other) in zip(
        drawn[name].maps(),
        sample(name, SIZE).maps(),
        sample(name, SIZE, seed=1).maps(),
        strict=True,
    ):
        assert (one.pixels == same.pixels).all()
        assert (one.pixels != other.pixels).mean() > 0.02


@pytest.mark.parametrize("name", SAMPLES)
def test_a_larger_picture_shows_the_same(name: str, drawn: dict[str, Material]) -> None:
    large = sample(name, 2 * SIZE)
    assert large.base_color is not None
    assert drawn[name].base_color is not None
    small = drawn[name].base_color.pixels / 255  # type: ignore[union-attr]
    same = np.corrcoef(shrunk(large.base_color.pixels / 255, 2).ravel(), small.ravel())[0, 1]
    assert same > 0.8
    if large.height is None:
        return
    relief = shrunk(large.height.linear(), 2)[:, :, 0]
    alike = 0.75 if name == "grass" else 0.9  # its blades are no wider than a texel here
    assert np.corrcoef(relief.ravel(), heights(drawn[name]).ravel())[0, 1] > alike


@pytest.mark.parametrize("name", RELIEFS)
def test_a_strip_keeps_the_proportions(name: str) -> None:
    """A picture twice as wide as high is still seamless, with undistorted stones."""
    material = sample(name, (64, 128))
    assert {(each.height, each.width) for _, each in material.maps()} == {(64, 128)}
    steps = np.abs(heights(material) - np.roll(heights(material), 1, 0)).mean(axis=1)
    assert steps[0] <= 1.15 * steps[1:].max()


@pytest.mark.parametrize("name", [name for name in SAMPLES if name != "dust"])  # which is round
@pytest.mark.parametrize("mirror", [np.fliplr, np.flipud, np.transpose])
def test_samples_are_not_symmetrical(name: str, mirror, drawn: dict[str, Material]) -> None:  # type: ignore[no-untyped-def]
    assert drawn[name].base_color is not None
    color = drawn[name].base_color.pixels.mean(axis=2)  # type: ignore[union-attr]
    assert np.corrcoef(color.ravel(), mirror(color).ravel())[0, 1] < 0.9


@pytest.mark.parametrize("name", RELIEFS)
def test_normals_fit_the_heights_and_the_scale(name: str, drawn: dict[str, Material]) -> None:
    """Slopes of the stored heights give the stored normals."""
    material = drawn[name]
    assert material.normal is not None
    assert material.height is not None
    assert material.scale is not None
    metres = heights(material) * material.scale * SIZE  # in widths of a texel
    padded = np.pad(metres, 1, mode="wrap")
    right = (padded[1:-1, 2:] - padded[1:-1, :-2]) / 2
    down = (padded[2:, 1:-1] - padded[:-2, 1:-1]) / 2
    expected = np.stack([-right, down, np.ones_like(right)], 2)
    expected /= np.linalg.norm(expected, axis=2, keepdims=True)
    assert np.abs(material.normal.linear() * 2 - 1 - expected).max() < 2e-3
    found = slope_correlation(material.height.pixels, material.normal.pixels)
    assert found is not None
    assert min(found.x, found.y) > 0.5


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize("size", [1, 2, (1, 5), (7, 3), (33, 50)])
def test_every_size_works(name: str, size: int | tuple[int, int]) -> None:
    material = sample(name, size)
    shape = (size, size) if isinstance(size, int) else size
    assert {(each.height, each.width) for _, each in material.maps()} == {shape}


def test_invalid_arguments_are_refused() -> None:
    with pytest.raises(InputError, match="no sample 'brick'; choose one of bricks, cobbles"):
        sample("brick")
    for size in (0, -3, (4, 0), 100_000):
        with pytest.raises(InputError, match="a side has 1 to 16384 texels"):
            sample("bricks", size)
    with pytest.raises(InputError, match="seed"):
        sample("bricks", 8, seed=-1)


# --- special samples


def test_a_detail_grid_preserves_brightness() -> None:
    """Colour and normals only: middle grey on average, dark lines, a marked corner."""
    for size in (64, 128, (96, 48)):
        grid = sample("grid", size)
        assert {kind for kind, _ in grid.maps()} == {"base_color", "normal"}
        assert grid.scale is None
        assert grid.base_color is not None
        light = grid.base_color.linear()
        assert light.mean() == pytest.approx(0.214, abs=0.003)
    cell = sample("grid", 128).base_color.linear()[:64, :64, 0]  # type: ignore[union-attr]
    assert cell[0].max() < 0.1
    assert cell[8:20, 8:20].mean() < 0.2 < 0.22 < cell[44:56, 44:56].mean()
    assert cell[8:20, 44:56].mean() > 0.22


@pytest.mark.parametrize("size", [128, (50, 33), (64, 160)])
def test_a_grating_is_open_where_it_is_lowest(size: int | tuple[int, int]) -> None:
    grating = sample("grating", size)
    assert grating.opacity is not None
    opacity = grating.opacity.pixels[:, :, 0]
    assert set(np.unique(opacity)) == {0, 255}
    relief = heights(grating)
    assert ((opacity == 0) == (relief == 0)).all()
    assert relief[opacity > 0].min() > 0.15
    assert 0.3 < (opacity == 0).mean() < 0.6


def test_noise_is_grey_and_its_grey_is_the_height() -> None:
    noise = sample("noise", 64)
    assert noise.base_color is not None
    assert noise.base_color.pixels / 255 == pytest.approx(
        np.repeat(heights(noise)[:, :, None], 3, 2), abs=0.003
    )


@pytest.mark.parametrize("size", [64, (40, 90), (90, 40)])
def test_dust_and_cracks_leave_the_border_whole(size: int | tuple[int, int]) -> None:
    dust, cracks = heights(sample("dust", size)), heights(sample("cracks", size))
    for side in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1]):
        assert (dust[side] == 0).all()
        assert cracks[side].min() > 0.85
    middle = tuple(np.s_[n // 2 - 4 : n // 2 + 4] for n in dust.shape)
    assert dust[middle].mean() > 0.7
    assert cracks[middle].mean() < 0.7


# --- the hole


@pytest.fixture(scope="module")
def ground() -> tuple[Material, Material]:
    return sample("cracks", (48, 64)), sample("dust", (48, 64))


def test_a_closed_hole_is_a_whole_surface(ground: tuple[Material, Material]) -> None:
    closed = hole(*ground, 0)
    assert (heights(closed) == 1).all()
    assert closed.base_color is not None
    assert ground[0].base_color is not None
    assert (closed.base_color.pixels == ground[0].base_color.pixels).all()
    assert closed.normal is None
    assert closed.occlusion is None
    assert closed.roughness is ground[0].roughness


@given(one=st.floats(0, 1), other=st.floats(0, 1))
def test_heights_never_rise_as_a_hole_opens(
    ground: tuple[Material, Material], one: float, other: float
) -> None:
    less, more = (hole(*ground, opening) for opening in sorted((one, other)))
    assert less.height is not None
    assert more.height is not None
    assert (more.height.pixels <= less.height.pixels).all()
    assert less.base_color is not None
    assert more.base_color is not None
    assert (more.base_color.pixels <= less.base_color.pixels).all()


def test_a_hole_follows_its_formula() -> None:
    """Crack heights of 0, ½ and 1 under dust of 1, half open: the excess is 1.4 − h."""
    cracks = heights_only([[0, 0.5, 1]], "ground")
    sunk = heights(hole(cracks, heights_only([[1, 1, 1]], "dust"), 0.5))[0]
    assert sunk == pytest.approx(np.exp(-np.array([1.4, 0.9, 0.4]) / 0.45), abs=1e-5)
    assert (heights(hole(cracks, heights_only([[0, 0, 0]], "dust"), 1)) == 1).all()


def test_cracks_open_before_the_ground_between_them_falls(
    ground: tuple[Material, Material],
) -> None:
    cracks, dust = heights(ground[0]), heights(ground[1])
    near = dust > 0.5
    little, much = heights(hole(*ground, 0.15)), heights(hole(*ground, 1))
    assert (little[near & (cracks > 0.5)] == 1).all()
    assert (little[near & (cracks < 0.2)] < 1).any()
    assert much[dust > 0.9].max() < 0.05
    assert (much[dust < 0.2] > 0.5).mean() > 0.9


def test_invalid_holes_are_refused(ground: tuple[Material, Material]) -> None:
    cracks, dust = ground
    for opening in (-0.1, 1.1, float("nan")):
        with pytest.raises(InputError, match=r"opening is 0 \(whole\) to 1 \(open\), not"):
            hole(cracks, dust, opening)
    with pytest.raises(InputError, match="cracks has no dust map, which a hole is made from"):
        opened(cracks, 0.5)
    with pytest.raises(InputError, match="grid has no height map"):
        hole(sample("grid", 8), dust, 0.5)


def test_a_hole_in_a_surface_of_floats_without_colour_or_size() -> None:
    made = hole(heights_only([[1.0]], "ground"), heights_only([[1.0]], "dust"), 1)
    assert made.base_color is None
    assert made.scale is None
    depth = np.exp(-0.4 / 0.45) ** np.array([1.5, 2, 2.5])
    # light is darkened in sRGB, so that the file's type makes no difference
    light = srgb_decode(np.full((1, 1, 3), 0.8)).astype(np.float32)
    for color, wanted in (
        (Map(light, False, "light"), srgb_decode(0.8 * depth)),
        (Map(np.full((1, 1, 3), 0.8, np.float32), True, "codes"), 0.8 * depth),
        (Map(np.full((1, 1, 3), 204, np.uint8), True, "bytes"), np.rint(204 * depth)),
    ):
        ground = replace(heights_only([[1.0]], "ground"), base_color=color)
        shaded = hole(ground, heights_only([[1.0]], "dust"), 0.5).base_color
        assert shaded is not None
        assert shaded.pixels.dtype == color.pixels.dtype
        assert shaded.pixels[0, 0] == pytest.approx(wanted, rel=1e-4)


def test_a_hole_of_maps_of_several_sizes() -> None:
    """Dust is stretched over the cracks, and the hole over the colour."""
    ground, dust = sample("cracks", 64), sample("dust", (32, 48))
    ground = replace(ground, base_color=sample("cracks", 128).base_color)
    made = hole(ground, dust, 0.7)
    assert dust.height is not None
    stretched = resized(dust.height.pixels[:, :, 0], (64, 64))[:, :, None]
    whole = hole(ground, Material("dust", height=Map(stretched, False, "stretched")), 0.7)
    assert (heights(made) == heights(whole)).all()
    assert made.base_color is not None
    assert ground.base_color is not None
    assert made.base_color.pixels.shape == (128, 128, 3)
    # a texel of the colour between two of one height, which is darkened by just that
    deep = np.full((2, 1), 0.25)
    flat_hole = heights_only([[0.0]], "ground")
    color = Map(np.full((4, 2, 3), 1.0, np.float32), True, "white")
    opening = float(np.log(4) * 0.45 / 2.8)
    shaded = hole(replace(flat_hole, base_color=color), heights_only([[1.0]], "dust"), opening)
    assert heights(shaded) == pytest.approx(deep[:1], abs=1e-4)
    assert shaded.base_color is not None
    for channel, power in enumerate((1.5, 2.0, 2.5)):
        assert shaded.base_color.pixels[:, :, channel] == pytest.approx(0.25**power, rel=1e-3)


@pytest.mark.parametrize("cracks", [(1, 1), (4, 3)])
def test_a_hole_has_the_texels_of_the_larger_map(cracks: tuple[int, int]) -> None:
    """Dust of more texels than the heights keeps its shape, in the material's proportions."""
    ground = replace(
        heights_only(np.ones(cracks).tolist(), "ground"),
        base_color=sample("cracks", (16, 12)).base_color,
    )
    dust = sample("dust", (64, 64)).height
    made = opened(replace(ground, dust=dust), 0.8)
    assert made.height is not None
    assert (made.height.height, made.height.width) == (74, 56)
    assert heights(made)[0].min() == 1
    assert heights(made).min() == pytest.approx(np.exp(-1.24 / 0.45), abs=0.01)
    assert made.base_color is not None
    assert made.base_color.pixels.shape == (74, 56, 3)


def test_a_colour_of_one_texel_is_darkened_in_the_hole_alone() -> None:
    grey = Map(np.full((1, 1, 3), 200, np.uint8), True, "grey")
    ground = replace(sample("cracks", 32), base_color=grey)
    color = hole(ground, sample("dust", 32), 0.8).base_color
    assert color is not None
    codes = srgb_encode(color.linear()) * 255
    assert codes[0] == pytest.approx(np.full((32, 3), 200), abs=0.1)
    assert codes[16, 16].max() < 20
    # as the same colour in more texels, up to the rounding of its codes
    fine = replace(ground, base_color=Map(np.tile(grey.pixels, (32, 32, 1)), True, "grey"))
    expected = hole(fine, sample("dust", 32), 0.8).base_color
    assert expected is not None
    assert codes == pytest.approx(expected.pixels, abs=0.6)


def test_reduced_channels_are_area_averages() -> None:
    codes = np.random.default_rng(3).integers(0, 65536, (12, 10), np.uint16)
    quarters = codes.reshape(6, 2, 5, 2).mean((1, 3))
    assert np.abs(resized(codes, (6, 5)) - quarters).max() <= 1
    # fine stripes turn grey
    stripes = np.tile(np.array([65535, 0, 0], np.uint16), (4, 12))
    assert (resized(stripes, (4, 4)) == 21845).all()
    # texels that are covered in part count in part: 3 texels are brought to 2
    assert resized(np.array([[0, 600, 900]], np.uint16), (1, 2)).tolist() == [[200, 800]]
    assert resized(codes, (1, 1))[0, 0] == pytest.approx(codes.mean(), abs=1)


def test_the_sample_hole() -> None:
    material = sample("hole", 64)
    assert material.name == "hole"
    assert material.scale == pytest.approx(0.3)
    assert {kind for kind, _ in material.maps()} == {"base_color", "height", "roughness"}
    assert heights(material).min() < 0.1
    assert "opened by 0.6" in str(material.notes[-1])


def heights_only(values: list[list[float]], name: str) -> Material:
    relief = np.array(values, np.float32)[:, :, None]
    return Material(name, height=Map(relief, False, name))


# --- canvas, noise and cells


def test_a_window_wraps_and_contains_each_texel_once() -> None:
    canvas = Canvas(20, 30, 0)
    for x, y, reach in ((0.01, 0.6, 0.1), (0.98, 0.02, 0.2), (0.5, 0.3, 0.9)):
        window = canvas.around(x, y, reach)
        rows, columns = (each.ravel() for each in window.texels)
        assert len(set(rows)) == len(rows) <= 20
        assert len(set(columns)) == len(columns) <= 30
        off = canvas.x[0, columns] - window.x.ravel() - x
        assert off == pytest.approx(np.round(off), abs=1e-5)
        assert window.x.max() >= min(reach - 1 / 30, 0.45)
        assert window.x.min() <= -min(reach - 1 / 30, 0.45)


def test_distances_in_a_window() -> None:
    window = Canvas(100, 100, 0).around(0.505, 0.505, 0.1)
    column, row = np.argmin(np.abs(window.x)), np.argmin(np.abs(window.y))
    to_line = window.to_segment(0.05, 0)
    assert to_line[row, column + 5] == pytest.approx(0, abs=1e-6)
    assert to_line[row + 3, column + 2] == pytest.approx(0.03, abs=1e-6)
    assert to_line[row, column - 4] == pytest.approx(0.04, abs=1e-6)
    to_box = window.to_box(0.05, 0.02)
    assert to_box[row, column] == pytest.approx(-0.02, abs=1e-6)
    assert to_box[row + 6, column + 8] == pytest.approx(0.05, abs=1e-6)


def test_a_ramp_of_heights_has_the_slope_of_its_scale() -> None:
    """Heights that rise by half the range over the width have the slope scale ÷ 2, in x only."""
    rise = np.tile(np.linspace(0, 0.5, 8, endpoint=False), (4, 1))
    normal = normals(rise, scale=0.4)[1, 3]
    assert normal == pytest.approx([-0.2 / 1.04**0.5, 0, 1 / 1.04**0.5], abs=1e-6)
    upwards = normals(rise[:, ::-1].T, scale=0.4)[3, 1]  # rows count down, so this rises up
    assert upwards[0] == pytest.approx(0)
    assert upwards[1] == pytest.approx(-0.1 / 1.01**0.5)  # the width is now 4 texels, not 8


def test_a_plane_is_open_and_a_pit_is_not() -> None:
    plane = np.zeros((32, 48))
    assert occlusion(plane, 0.1) == pytest.approx(1)
    plane[10:, :] = 1
    plane[20, 30] = 0
    shut = occlusion(plane, 0.1)
    assert shut[20, 30] == shut.min()
    assert shut[30, 10] == pytest.approx(1, abs=1e-6)


def test_noise_is_of_unit_deviation_and_periodic() -> None:
    canvas = Canvas(96, 160, seed=3)
    many = np.stack([canvas.noise(f"{number}", 6, octaves=3) for number in range(40)])
    assert abs(many.mean()) < 0.2
    assert many.std() == pytest.approx(1, abs=0.05)
    steps = np.abs(many - np.roll(many, 1, axis=2)).mean(axis=(0, 1))
    assert steps[0] < 1.3 * steps[1:].mean()


def test_noise_does_not_depend_on_the_size() -> None:
    coarse, fine = Canvas(32, 32, 0).noise("a", 3), Canvas(64, 64, 0).noise("a", 3)
    assert shrunk(fine[:, :, None], 2)[:, :, 0] == pytest.approx(coarse, abs=0.02)


def test_random_generators_are_independent() -> None:
    canvas = Canvas(8, 8, 0)
    assert canvas.random("a").random() != canvas.random("b").random()
    assert canvas.random("a").random() == Canvas(9, 9, 0).random("a").random()


def test_cells_are_those_of_the_nearest_point(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nearest point and distance to the border, against a search over all points."""
    monkeypatch.setattr(cells_module, "_RIPPLE", np.float32(0))
    across, down, roundness = 5, 4, 0.01
    cell = cells(Canvas(32, 40, seed=5), "stones", across, jitter=0.3, roundness=roundness)
    assert cell.count == (down, across)
    at = np.stack(np.meshgrid(np.arange(40) + 0.5, np.arange(32) + 0.5), 2) * (across / 40)
    offset = np.stack([cell.x, cell.y], 2)
    seen = np.unique(np.round((at - offset).reshape(-1, 2), 3), axis=0)
    tiles = [(x * across, y * down) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    points = np.unique(np.round(np.concatenate([seen + each for each in tiles]), 3), axis=0)
    offsets = at[:, :, None] - points
    distances = np.linalg.norm(offsets, axis=3)
    assert np.linalg.norm(offset, axis=2) == pytest.approx(distances.min(axis=2), abs=2e-3)

    nearest = np.take_along_axis(offsets, distances.argmin(axis=2)[:, :, None, None], axis=2)
    between = nearest - offsets
    separation = np.linalg.norm(between, axis=3)
    to_border = ((offsets**2).sum(3) - (nearest**2).sum(3)) / (
        2 * np.where(separation > 0.01, separation, 1)
    )
    border = np.where(separation > 0.01, to_border, np.inf).min(axis=2)
    assert (cell.border <= border + 2e-3).all()
    assert (cell.border >= border - roundness * np.log(20) - 2e-3).all()


def test_every_second_row_of_cells_is_shifted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cells_module, "_RIPPLE", np.float32(0))
    cell = cells(Canvas(40, 40, seed=0), "stones", 4, jitter=0)
    at = (np.arange(40) + 0.5) / 10
    middles = (at - cell.x) % 1
    assert middles[cell.row % 2 == 0] == pytest.approx(0.5, abs=1e-5)
    shifted = middles[cell.row % 2 == 1]
    assert np.minimum(shifted, 1 - shifted) == pytest.approx(0, abs=1e-5)


def test_blending() -> None:
    assert smoothstep(0, 1, np.array([-1, 0, 0.5, 1, 2])).tolist() == [0, 0, 0.5, 1, 1]
    assert smoothstep(1, 0, np.array([0.25]))[0] == pytest.approx(1 - smoothstep(0, 1, [0.25])[0])
    share = np.array([[0.0, 1.0]])
    assert mix((0, 0, 0), (1, 2, 3), share)[0].tolist() == [[0, 0, 0], [1, 2, 3]]


def test_maps_have_sources(drawn: dict[str, Material]) -> None:
    material = drawn["tiles"]
    assert isinstance(material.metallic, Map)
    assert material.metallic.source == "sample tiles, metallic"
    assert "seed 0" in str(material.notes[0])
