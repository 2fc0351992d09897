"""The shader's missed hits against the errors that the library measures, pixel by pixel."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from basrelief.engine import choose_device
from basrelief.lang import Buffer, Vec2
from basrelief.material import Material
from basrelief.measure.errors import missed, overshoot, uv_error
from basrelief.measure.truth import Truth, truth
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import values_of, view_ray_program_of
from basrelief.rendering.render import render
from basrelief.scene import Object, Orbit, Scene
from basrelief.shading.missed_hit import DrawnHit, PictureSize, TrueHit, missed_hit
from helpers.synthetic import map_of

SIZE = (40, 26)
HEIGHTS = np.random.default_rng(4).random((12, 20))


def noise_scene(**options: Any) -> Scene:
    """A scene with a plane of noise at a grazing angle."""
    obj = Object(Material("noise_scene", height=map_of(HEIGHTS)), scale=0.3, **options)
    return Scene((obj,), Orbit(azimuth=25.0, elevation=24.0))


def hits_of(record: Any, uv: np.ndarray, hit: np.ndarray) -> Buffer[Any]:
    """A buffer of the hits of a picture, row by row."""
    pixels = zip(uv.reshape(-1, 2).tolist(), hit.ravel().tolist(), strict=True)
    return Buffer([record(Vec2(*each), int(there)) for each, there in pixels], record)


def missed_by_shader(
    scene: Scene, frame: Frame, true: Truth, device: str
) -> tuple[np.ndarray, np.ndarray]:
    """Missed and passed, computed by the viewer's shader."""
    obj = scene.objects[0]
    program = replace(view_ray_program_of(obj.resolved), entry=missed_hit)
    values = values_of(obj.resolved, scene, SIZE, choose_device(device))
    found = choose_device(device).run(
        program,
        {
            **{name: values[name] for name in ("sample", "placement", "relief")},
            "picture": PictureSize(SIZE[0], Vec2(*true.texels)),
            "drawn": hits_of(DrawnHit, frame.uv, frame.hit),
            "truth": hits_of(TrueHit, true.uv, true.there),
        },
        SIZE,
    )
    return found["missed"] != 0, found["passed"] != 0


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("projection", ["full", "biased", "limited"])
@pytest.mark.parametrize("technique", ["offset", "parallax_occlusion"])
def test_missed_hits_equal_those_of_the_measures(technique, projection, edge, device) -> None:
    # few steps, so that enough hits are missed
    steps = {"max_steps": 12} if technique == "parallax_occlusion" else {}
    scene = noise_scene(technique=technique, settings=steps, projection=projection, edge=edge)
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    true = truth(scene, SIZE, device="cpu")
    lost, passed = missed_by_shader(scene, frame, true, device)
    # without the pixels within rounding of the limit of one texel
    sure = ~(np.abs(np.nan_to_num(uv_error(frame, true)) - 1.0) < 1e-3)
    np.testing.assert_array_equal(lost[sure], missed(frame, true)[sure])
    along = np.nan_to_num(overshoot(frame, true))
    clear = np.abs(along) > 1e-3
    assert clear.sum() > 100
    np.testing.assert_array_equal(passed[clear], along[clear] > 0.0)
    assert 20 < lost.sum() < true.there.sum()


def test_a_pixel_without_a_hit_is_missed_but_has_not_passed() -> None:
    scene = noise_scene(technique="exact")
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    true = truth(scene, SIZE, device="cpu")
    frame.hit[3:9, 5:30] = False
    lost, passed = missed_by_shader(scene, frame, true, "cpu")
    np.testing.assert_array_equal(lost, ~frame.hit & true.there)
    assert not (lost & passed).any()


def test_an_error_of_a_whole_tile_is_missed_only_where_tiles_do_not_repeat() -> None:
    """With `wrap` the next tile shows the same texel; with `clamp` it does not."""
    for edge in ("wrap", "clamp"):
        scene = noise_scene(technique="exact", edge=edge)
        frame = render(scene, size=SIZE, samples=1, device="cpu")
        true = truth(scene, SIZE, device="cpu")
        frame.uv[:, :, 0] += 1.0
        lost, _ = missed_by_shader(scene, frame, true, "cpu")
        assert lost.any() == (edge == "clamp")
