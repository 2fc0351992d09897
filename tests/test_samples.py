"""Procedural samples: seamless, seeded, the same at every size, and true to their own heights."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.errors import InputError
from basrelief.material import SAMPLES, Map, Material, sample
from basrelief.material.evidence import agreement
from basrelief.material.patterns import cells as cells_module
from basrelief.material.patterns.bricks import _Wall as Wall
from basrelief.material.patterns.canvas import Canvas, mix, smoothstep
from basrelief.material.patterns.cells import cells
from basrelief.material.samples import normals, occlusion

SIZE = 128


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


@pytest.mark.parametrize("name", SAMPLES)
def test_all_maps_are_there(name: str, drawn: dict[str, Material]) -> None:
    material = drawn[name]
    kinds = {kind for kind, _ in material.maps()}
    assert kinds >= {"base_color", "normal", "height", "occlusion", "roughness"}
    assert ("metallic" in kinds) == (name == "tiles")
    assert {(each.height, each.width) for _, each in material.maps()} == {(SIZE, SIZE)}
    assert material.height is not None
    assert material.height.bits == 16
    assert material.height_range == (0, 1)
    assert material.scale is not None
    assert 0.01 < material.scale < 0.2


@pytest.mark.parametrize("name", SAMPLES)
def test_maps_are_not_empty(name: str, drawn: dict[str, Material]) -> None:
    """Colours vary, nothing is clipped away, and roughness keeps off a perfect mirror."""
    material = drawn[name]
    assert material.base_color is not None
    assert material.roughness is not None
    color = material.base_color.pixels
    assert color.std() > 8
    assert ((color == 0) | (color == 255)).mean() < 0.02
    assert material.roughness.range()[0] > 0.03
    assert heights(material).std() > 0.05


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize("axis", [0, 1])
def test_there_is_no_seam(name: str, axis: int, drawn: dict[str, Material]) -> None:
    """The step across the edge is of the size of the steps within."""
    for kind, each in drawn[name].maps():
        values = each.linear().astype(np.float64)
        steps = np.abs(values - np.roll(values, 1, axis)).mean(axis=(1 - axis, 2))
        assert steps[0] <= 1.15 * steps[1:].max(), kind


@pytest.mark.parametrize("name", ["cobbles", "gravel", "terrain"])
@pytest.mark.parametrize("axis", [0, 1])
def test_nothing_is_cut_at_the_edge(name: str, axis: int, drawn: dict[str, Material]) -> None:
    """Of the steps across the edge, not many are among the greatest 3 % of all: stones go on."""
    for kind, each in drawn[name].maps():
        values = each.linear().astype(np.float64)
        steps = np.moveaxis(np.abs(values - np.roll(values, 1, axis)).max(axis=2), axis, 0)
        assert (steps[0] > np.quantile(steps, 0.97)).mean() < 0.25, kind


def test_a_brick_goes_on_beyond_the_edge() -> None:
    wall = Wall(Canvas(90, 90, seed=0))
    shifted = wall.row[:, 0] % 2 == 1
    assert shifted.any()
    assert (wall.column[shifted, 0] == wall.column[shifted, -1]).all()


@pytest.mark.parametrize("name", SAMPLES)
def test_the_seed_decides(name: str, drawn: dict[str, Material]) -> None:
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
    assert large.height is not None
    assert drawn[name].base_color is not None
    small = drawn[name].base_color.pixels / 255  # type: ignore[union-attr]
    same = np.corrcoef(shrunk(large.base_color.pixels / 255, 2).ravel(), small.ravel())[0, 1]
    assert same > 0.8
    relief = shrunk(large.height.linear(), 2)[:, :, 0]
    assert np.corrcoef(relief.ravel(), heights(drawn[name]).ravel())[0, 1] > 0.9


@pytest.mark.parametrize("name", SAMPLES)
def test_a_strip_keeps_the_proportions(name: str) -> None:
    """Twice as wide as high: maps of that size, still without a seam, stones as wide as high."""
    material = sample(name, (64, 128))
    assert {(each.height, each.width) for _, each in material.maps()} == {(64, 128)}
    steps = np.abs(heights(material) - np.roll(heights(material), 1, 0)).mean(axis=1)
    assert steps[0] <= 1.15 * steps[1:].max()


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize("mirror", [np.fliplr, np.flipud, np.transpose])
def test_no_mirror_leaves_it_the_same(name: str, mirror, drawn: dict[str, Material]) -> None:  # type: ignore[no-untyped-def]
    assert drawn[name].base_color is not None
    color = drawn[name].base_color.pixels.mean(axis=2)  # type: ignore[union-attr]
    assert np.corrcoef(color.ravel(), mirror(color).ravel())[0, 1] < 0.9


@pytest.mark.parametrize("name", SAMPLES)
def test_normals_fit_the_heights_and_the_scale(name: str, drawn: dict[str, Material]) -> None:
    """Slopes taken from the stored heights, here, give the stored normals."""
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
    found = agreement(material.height.pixels, material.normal.pixels)
    assert found is not None
    assert min(found.x, found.y) > 0.5


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize("size", [1, 2, (1, 5), (7, 3), (33, 50)])
def test_every_size_works(name: str, size: int | tuple[int, int]) -> None:
    material = sample(name, size)
    shape = (size, size) if isinstance(size, int) else size
    assert {(each.height, each.width) for _, each in material.maps()} == {shape}


def test_impossible_requests_are_refused() -> None:
    with pytest.raises(InputError, match="no sample 'brick'; choose one of bricks, cobbles"):
        sample("brick")
    for size in (0, -3, (4, 0), 100_000):
        with pytest.raises(InputError, match="a side has 1 to 16384 texels"):
            sample("bricks", size)
    with pytest.raises(InputError, match="seed"):
        sample("bricks", 8, seed=-1)


# --- what samples are made of


def test_a_ramp_of_heights_has_the_slope_of_its_scale() -> None:
    """Rising to the right by half the range over the width: slope scale / 2, seen in x alone."""
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


def test_names_draw_apart() -> None:
    canvas = Canvas(8, 8, 0)
    assert canvas.random("a").random() != canvas.random("b").random()
    assert canvas.random("a").random() == Canvas(9, 9, 0).random("a").random()


def test_cells_are_those_of_the_nearest_point(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nearest point and distance to the border, against all points, one by one."""
    monkeypatch.setattr(cells_module, "_RIPPLE", np.float32(0))
    across, down, roundness = 5, 4, 0.01
    cell = cells(Canvas(32, 40, seed=5), "stones", across, jitter=0.3, roundness=roundness)
    assert cell.count == (down, across)
    at = np.stack(np.meshgrid(np.arange(40) + 0.5, np.arange(32) + 0.5), 2) * (across / 40)
    offset = np.stack([cell.x, cell.y], 2)
    seen = np.unique(np.round((at - offset).reshape(-1, 2), 3), axis=0)
    tiles = [(x * across, y * down) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    points = np.unique(np.round(np.concatenate([seen + each for each in tiles]), 3), axis=0)
    ways = at[:, :, None] - points
    distances = np.linalg.norm(ways, axis=3)
    assert np.linalg.norm(offset, axis=2) == pytest.approx(distances.min(axis=2), abs=2e-3)

    nearest = np.take_along_axis(ways, distances.argmin(axis=2)[:, :, None, None], axis=2)
    between = nearest - ways
    apart = np.linalg.norm(between, axis=3)
    to_border = ((ways**2).sum(3) - (nearest**2).sum(3)) / (2 * np.where(apart > 0.01, apart, 1))
    border = np.where(apart > 0.01, to_border, np.inf).min(axis=2)
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


def test_maps_say_where_they_come_from(drawn: dict[str, Material]) -> None:
    material = drawn["tiles"]
    assert isinstance(material.metallic, Map)
    assert material.metallic.source == "sample tiles, metallic"
    assert "seed 0" in str(material.notes[0])
