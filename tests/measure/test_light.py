"""Light on a relief: the true share against closed forms, and self-shadows against the true one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from basrelief.engine import Engine, choose_device
from basrelief.errors import InputError
from basrelief.material import Map, Material, sample
from basrelief.measure import light as light_module
from basrelief.measure.compare import compare
from basrelief.measure.debug import debug_picture
from basrelief.measure.errors import errors, light_error, wrong_light
from basrelief.measure.light import shown_light
from basrelief.measure.truth import truth
from basrelief.measure.tune import tune
from basrelief.measure.views import at_angle
from basrelief.rendering.render import render
from basrelief.scene import LYING, Object, Orbit, Scene, directional, point, rotated
from basrelief.techniques import TECHNIQUES

SIZE = (96, 64)
FLAT = Map(np.full((1, 1, 3), (128, 128, 255), np.uint8), False, "flat")


@pytest.fixture(scope="module")
def cpu() -> Engine:
    return choose_device("cpu")


def material_of(heights: np.ndarray) -> Material:
    return Material(
        "made", height=Map(heights[:, :, None].astype(np.float32), False, "made"), normal=FLAT
    )


def noise(columns: int, rows: int, seed: int = 4) -> Material:
    """Rough ground with thin posts and long walls, without symmetry."""
    rng = np.random.default_rng(seed)
    heights = 0.35 * rng.random((rows, columns))
    heights[rng.random((rows, columns)) < 0.01] = 1.0
    heights[:, columns // 3] = np.linspace(0.2, 0.9, rows)
    heights[rows // 4, : columns // 2] = 0.8
    return material_of(heights)


def view(material: Material, angle: float = 40.0, **options: object) -> Scene:
    shown = {"technique": "exact", "scale": 0.1, "shadows": "hard",
             "lights": (directional(40.0, 30.0),)}  # fmt: skip
    return at_angle(material, angle, SIZE, {**shown, **options})


# --- the truth ------------------------------------------------------------------------------------


@pytest.mark.parametrize("azimuth", [90.0, -90.0, 0.0, 180.0])
@pytest.mark.parametrize("turn", [0.0, 70.0])
def test_the_true_shadow_of_a_wall(cpu: Engine, azimuth: float, turn: float) -> None:
    """It is cot 30° of the wall's height long, on the side away from the light."""
    heights = np.zeros((128, 128))
    across = azimuth in (90.0, -90.0)
    heights[(slice(None), slice(60, 68)) if across else (slice(60, 68), slice(None))] = 1.0
    obj = Object(
        material_of(heights), scale=0.1, technique="exact", edge="clamp",
        transform=LYING @ rotated("z", turn),
    )  # fmt: skip
    camera = Orbit(0.0, 90.0, 2.0, orthographic_height=0.6)
    lamp = directional(azimuth, 30.0)
    towards = -np.array([*lamp.direction])
    scene = Scene((obj,), camera, (lamp,), shadows="hard")
    found = truth(scene, (192, 192), device=cpu)
    assert found.light is not None
    # in the plane's own space
    local = np.linalg.inv(obj.transform[:3, :3]) @ towards
    length = 0.1 * np.linalg.norm(local[:2]) / local[2]
    along = np.array([local[0], -local[1]]) / np.linalg.norm(local[:2])
    ground = found.there & (found.height < 0.01)
    # distance to the wall's near top edge towards the light
    centre, normal = 0.5, (np.array([1.0, 0.0]) if across else np.array([0.0, 1.0]))
    beside = (found.uv - centre) @ normal
    step = along @ normal
    if abs(step) < 0.2:
        return
    distance = (-np.sign(step) * beside - 3.5 / 128) / abs(step)
    behind = ground & (np.sign(beside) == -np.sign(step))
    dark = found.light[0] == 0.0
    assert dark[behind & (distance > 0.01) & (distance < length - 0.012)].all()
    assert not dark[behind & (distance > length + 0.012)].any()
    assert not dark[ground & ~behind & (abs(beside) > 6 / 128) & (abs(beside) < 0.2)].any()
    assert 0.02 < dark.mean() < 0.6


def test_the_true_light_of_a_point_light_spreads_from_it(cpu: Engine) -> None:
    """Shadows of a grid of posts point away from a light over the middle."""
    heights = np.zeros((128, 128))
    for x in (32, 96):
        for y in (32, 96):
            heights[y - 2 : y + 3, x - 2 : x + 3] = 1.0
    obj = Object(material_of(heights), scale=0.1, technique="exact", edge="clamp")
    camera = Orbit(0.0, 90.0, 2.0, orthographic_height=1.0)
    scene = Scene((obj,), camera, (point((0.0, 0.25, 0.0)),), shadows="hard")
    found = truth(scene, (128, 128), device=cpu)
    assert found.light is not None
    ground = found.there & (found.height < 1e-6)
    uv, dark = found.uv[ground], found.light[0][ground] == 0.0
    # the light is 0.35 above the ground, and rays are below the tops of posts for 0.1 of that
    covered = np.linspace(0.0, 0.1 / 0.35, 200)
    along = uv[:, None] + (0.5 - uv)[:, None] * covered[:, None]
    from_posts = np.abs(np.abs(along - 0.5) - 0.25 - 0.5 / 128 * np.sign(along - 0.5)).max(-1)
    nearest = from_posts.min(1) * 128
    # posts are five texels wide, with slopes of one texel around them
    assert dark[nearest < 2.0].all()
    assert not dark[nearest > 4.0].any()
    assert 0.02 < dark.mean() < 0.5


def test_a_truth_without_shadows_has_no_light(cpu: Engine) -> None:
    scene = view(sample("bricks", 32), shadows="none")
    found = truth(scene, SIZE, device=cpu)
    assert found.light is None
    with pytest.raises(InputError, match="without shadows"):
        wrong_light(np.zeros((1, SIZE[1], SIZE[0])), found)


# --- pictures -------------------------------------------------------------------------------------

LAMPS = {"sun": directional(40.0, 25.0), "low sun": directional(-70.0, 8.0),
         "lamp": point((0.4, 0.5, 0.3))}  # fmt: skip


@pytest.mark.parametrize("lamp", LAMPS)
@pytest.mark.parametrize("texels", [(61, 37), (96, 96), (251, 173)])
def test_exact_shadows_are_right(cpu: Engine, monkeypatch, texels, lamp: str) -> None:
    """No light is blocked wrongly, and none leaks but where it grazes the surface."""
    scene = view(noise(*texels), lights=(LAMPS[lamp],))
    shown = shown_light(scene, SIZE, cpu)
    error = light_error(shown, truth(scene, SIZE, device=cpu))
    assert error.min() > -0.5
    assert (error > 0.5).mean() < 2e-3
    # seen from a little above, all of them are lit
    monkeypatch.setattr(light_module, "LIFT", 2e-4)
    assert light_error(shown, truth(scene, SIZE, device=cpu)).max() < 0.5
    assert 0.02 < (shown == 0.0).mean() < 0.95


@pytest.mark.parametrize("lamp", LAMPS)
def test_exact_shadows_leave_the_highest_ground_lit(cpu: Engine, lamp: str) -> None:
    """Nothing is above a plateau of height 1, which ends at the top of the relief."""
    heights = np.full((37, 61), 1.0)
    heights[8:20, 10:30] = 0.2
    scene = view(material_of(heights), lights=(LAMPS[lamp],))
    found = truth(scene, SIZE, device=cpu)
    top = found.there & (found.height > 1.0 - 1e-6)
    shown = shown_light(scene, SIZE, cpu)
    assert 0.2 < top.mean() < 0.95
    assert (shown[0][top] == 1.0).all()
    assert found.light is not None
    assert (found.light[0][top] == 1.0).all()
    assert wrong_light(shown, found).sum() <= 2e-3 * found.there.sum()
    assert (shown == 0.0).any()


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_exact_shadows_on_tiles(cpu: Engine, edge: str) -> None:
    """Far from the origin of the texture, where rounding is largest."""
    obj = Object(
        sample("gravel", 64), scale=0.08, technique="exact", tiling=(7.0, 5.0), edge=edge
    )  # fmt: skip
    scene = Scene((obj,), Orbit(20.0, 50.0), (directional(40.0, 25.0),), shadows="hard")
    shown = shown_light(scene, SIZE, cpu)
    found = truth(scene, SIZE, device=cpu)
    assert wrong_light(shown, found).sum() <= 2e-3 * found.there.sum()


@pytest.mark.parametrize("angle", [5.0, 10.0, 20.0])
@pytest.mark.parametrize("name", ["bricks", "gravel"])
def test_soft_shadows_are_near_those_of_a_disc(cpu: Engine, name: str, angle: float) -> None:
    """The bounds that docs/compare.md states."""
    scene = view(sample(name, 128), shadows="soft", shadowing={"light_angle": angle})
    shown = shown_light(scene, SIZE, cpu)
    found = truth(scene, SIZE, device=cpu)
    error = light_error(shown, found)[0][found.there]
    assert np.abs(error).mean() < 0.045
    assert wrong_light(shown, found).sum() < 0.025 * found.there.sum()
    assert ((shown > 0.05) & (shown < 0.95)).mean() > 0.03


@pytest.mark.parametrize("shadows", ["hard", "soft"])
def test_a_march_with_the_defaults_is_in_little_wrong_light(cpu: Engine, shadows: str) -> None:
    scene = view(sample("gravel", 128), shadows=shadows, technique="relief")
    found = truth(scene, SIZE, device=cpu)
    frame = render(scene, size=SIZE, samples=1, device=cpu)
    few = replace(scene, shadowing={"max_shadow_steps": 4})
    shares = [
        errors(frame, found, shown_light(each, SIZE, cpu)).wrong_light for each in (scene, few)
    ]
    assert shares[0] < 0.03
    assert shares[1] > 1.5 * shares[0]


# --- what is reported -----------------------------------------------------------------------------


def test_a_picture_of_the_error(cpu: Engine) -> None:
    scene = view(sample("bricks", 64), technique="offset")
    frame, found = render(scene, size=SIZE, samples=1, device=cpu), truth(scene, SIZE, device=cpu)
    shown = shown_light(scene, SIZE, cpu)
    drawn = debug_picture("shadow-error", frame, found, shown)
    share = errors(frame, found, shown).wrong_light
    assert share is not None
    assert f"{share:.2%}" in drawn.meaning
    error = light_error(shown, found)[0]
    row = slice(0, SIZE[1] - 6)
    red, blue = drawn.image.pixels[row, :, 0], drawn.image.pixels[row, :, 2]
    assert (red > blue)[(error > 0.6)[row]].all()
    assert (red < blue)[(error < -0.6)[row]].all()
    with pytest.raises(InputError, match="light="):
        debug_picture("shadow-error", frame, found)
    with pytest.raises(InputError, match="the scene has none; add --light"):
        debug_picture("shadow-error", frame, found, shown[:0])


def test_compare_and_tune_measure_light(cpu: Engine, tmp_path) -> None:
    material = sample("bricks", 64)
    made = compare(
        material, ["offset", "relief"], angles=(30.0,), size=(64, 36), samples=1, runs=1,
        device=cpu, shadows="hard", lights=(directional(40.0, 25.0),),
    )  # fmt: skip
    shares = {r.technique: r.errors.wrong_light for r in made.results}
    assert shares["exact"] < 0.01 < shares["offset"]
    assert {r["technique"]: r["wrong_light"] for r in made.to_dict()["results"]} == shares
    page = made.save(tmp_path / "out").read_text(encoding="utf-8")
    assert page.count("in wrong light") == 3
    without = tune(material, missed=0.02, angles=(0.0, 30.0), techniques=["relief"], size=(64, 36),
                   device=cpu)  # fmt: skip
    with_ = tune(material, missed=0.02, angles=(0.0, 30.0), techniques=["exact"], size=(64, 36),
                 device=cpu, shadows="hard", lights=(directional(40.0, 25.0),))  # fmt: skip
    assert "in wrong light" not in without.report()
    assert "missed hits or pixels in wrong light" in with_.report()


def test_each_light_has_its_own_share(cpu: Engine) -> None:
    """Each light's share is its own, whatever the others add."""
    lamps = (directional(40.0, 25.0), directional(-120.0, 35.0))
    both = shown_light(view(sample("bricks", 64), lights=lamps), SIZE, cpu)
    for k, lamp in enumerate(lamps):
        alone = shown_light(view(sample("bricks", 64), lights=(lamp,)), SIZE, cpu)
        np.testing.assert_allclose(both[k], alone[0], atol=1e-6)
    assert (np.abs(both[0] - both[1]) > 0.5).mean() > 0.05


def test_exact_alone_promises_exact_shadows() -> None:
    assert [name for name, technique in TECHNIQUES.items() if technique.exact] == ["exact"]
