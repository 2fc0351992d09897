"""The page's missed hits against the library's ruler, pixel by pixel."""

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


def noise(**options: Any) -> Scene:
    """A plane of noise, seen at a flat angle and from a corner."""
    obj = Object(Material("noise", height=map_of(HEIGHTS)), scale=0.3, **options)
    return Scene((obj,), Orbit(azimuth=25.0, elevation=24.0))


def listed(record: Any, uv: np.ndarray, hit: np.ndarray) -> Buffer[Any]:
    """The pixels of a picture, row by row."""
    pixels = zip(uv.reshape(-1, 2).tolist(), hit.ravel().tolist(), strict=True)
    return Buffer([record(Vec2(*each), int(there)) for each, there in pixels], record)


def by_shader(
    scene: Scene, frame: Frame, true: Truth, device: str
) -> tuple[np.ndarray, np.ndarray]:
    """Missed and passed, as a page finds them."""
    obj = scene.objects[0]
    program = replace(view_ray_program_of(obj.resolved), entry=missed_hit)
    values = values_of(obj.resolved, scene, SIZE, choose_device(device))
    found = choose_device(device).run(
        program,
        {
            **{name: values[name] for name in ("sample", "placement", "relief")},
            "picture": PictureSize(SIZE[0], Vec2(*true.texels)),
            "drawn": listed(DrawnHit, frame.uv, frame.hit),
            "truth": listed(TrueHit, true.uv, true.there),
        },
        SIZE,
    )
    return found["missed"] != 0, found["passed"] != 0


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("projection", ["full", "biased", "limited"])
@pytest.mark.parametrize("technique", ["offset", "parallax_occlusion"])
def test_they_are_those_of_the_ruler(technique, projection, edge, device) -> None:
    scene = noise(technique=technique, projection=projection, edge=edge)
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    true = truth(scene, SIZE, device="cpu")
    lost, passed = by_shader(scene, frame, true, device)
    # all but the pixels where 32 bits cannot tell one side of a limit from the other
    sure = ~(np.abs(np.nan_to_num(uv_error(frame, true)) - 1.0) < 1e-3)
    np.testing.assert_array_equal(lost[sure], missed(frame, true)[sure])
    along = np.nan_to_num(overshoot(frame, true))
    clear = np.abs(along) > 1e-3
    assert clear.sum() > 100
    np.testing.assert_array_equal(passed[clear], along[clear] > 0.0)
    assert 20 < lost.sum() < true.there.sum()


def test_what_is_not_drawn_is_missed_and_has_not_passed() -> None:
    scene = noise(technique="exact")
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    true = truth(scene, SIZE, device="cpu")
    frame.hit[3:9, 5:30] = False
    lost, passed = by_shader(scene, frame, true, "cpu")
    np.testing.assert_array_equal(lost, ~frame.hit & true.there)
    assert not (lost & passed).any()


def test_further_than_half_a_tile_is_off_where_nothing_repeats() -> None:
    """A whole tile off is right where tiles repeat, and missed where they do not."""
    for edge in ("wrap", "clamp"):
        scene = noise(technique="exact", edge=edge)
        frame = render(scene, size=SIZE, samples=1, device="cpu")
        true = truth(scene, SIZE, device="cpu")
        frame.uv[:, :, 0] += 1.0
        lost, _ = by_shader(scene, frame, true, "cpu")
        assert lost.any() == (edge == "clamp")
