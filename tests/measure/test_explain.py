"""The explained ray: its reads, its hit and the true hit, against closed forms and the CPU.

The drawing needs matplotlib (the extra `plots`).
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import basrelief
from basrelief.errors import InputError
from basrelief.material import Material, sample
from basrelief.measure.explain import Explanation, explain
from basrelief.rendering.render import render
from basrelief.scene import LookAt, Object, Orbit, Scene
from basrelief.techniques import TECHNIQUES
from helpers.command_line import done, refused, write_heights
from helpers.synthetic import map_of, noise

SIZE = (96, 60)
CAMERA = Orbit(35.0, 24.0, 1.2)
GRAVEL = sample("gravel", 64)


def obj(technique: Any, **options: Any) -> Object:
    return Object(GRAVEL, technique=technique, **{"scale": 0.2, **options})


def explained(technique: Any, pixel=(50, 35), camera=CAMERA, **options: Any) -> Explanation:
    scene = Scene((obj(technique, **options),), camera=camera)
    return explain(scene, pixel=pixel, size=SIZE)


# --- the same ray as in the picture ---------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in TECHNIQUES if name != "flat"])
@pytest.mark.parametrize(
    "options", [{}, {"reference_height": 0.5, "edge": "clamp", "tiling": (2.0, 1.5)}]
)
def test_the_hit_is_the_cpus_and_each_read_is_recorded(name: str, options: dict) -> None:
    scene = Scene((obj(name, **options),), camera=CAMERA)
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    for x, y in [(50, 35), (20, 40), (71, 26)]:
        explanation = explain(scene, pixel=(x, y), size=SIZE)
        assert frame.hit[y, x]
        assert [*explanation.hit.uv] == [*frame.uv[y, x]]
        assert len(explanation.reads) == explanation.hit.reads == frame.reads[y, x]


@pytest.mark.parametrize("shape", ["sphere", "box", "cylinder"])
def test_the_hit_on_other_shapes_is_the_cpus(shape: str) -> None:
    explanation = explained("relief", (48, 30), shape=shape, heights="smooth", projection="biased")
    scene = Scene(
        (obj("relief", shape=shape, heights="smooth", projection="biased"),), camera=CAMERA
    )
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    assert [*explanation.hit.uv] == [*frame.uv[30, 48]]
    assert len(explanation.reads) == explanation.hit.reads


def test_the_nearest_object_is_explained() -> None:
    """A small ball before the plane: its own map, not the plane's."""
    scene = Scene(
        (
            obj("steep"),
            Object(
                sample("bricks", 64),
                shape="sphere",
                technique="offset",
                transform=basrelief.placed((0.0, 0.2, 0.0), 0.2),
            ),
        ),
        camera=CAMERA,
    )
    frame = render(scene, size=SIZE, samples=1, device="cpu")
    for pixel in [(48, 12), (75, 45)]:
        explanation = explain(scene, pixel=pixel, size=SIZE)
        assert [*explanation.hit.uv] == [*frame.uv[pixel[1], pixel[0]]]
    assert explain(scene, pixel=(48, 12), size=SIZE).technique == "offset"
    assert explain(scene, pixel=(75, 45), size=SIZE).technique == "steep"


# --- closed forms ---------------------------------------------------------------------------------

RAMP = LookAt((0.4, -0.9, 1.1), (0.05, 0.0, 0.0), (0.0, 0.0, 1.0), field_of_view=20.0)


def ramp(technique: str, **settings: float) -> tuple[Explanation, np.ndarray, np.ndarray, float]:
    """h = 0.2 + 0.5 u on the unit plane; the ray's uv on it, its travel, and t of the true hit."""
    columns = 64
    u = (np.arange(columns) + 0.5) / columns
    heights = np.broadcast_to(0.2 + 0.5 * u, (32, columns))
    plane = Object(
        Material("ramp", height=map_of(heights)),
        technique=technique,
        settings=settings,
        scale=0.2,
        edge="clamp",
        transform=np.eye(4),
    )
    explanation = explain(Scene((plane,), camera=RAMP), pixel=(48, 30), size=(97, 61))
    # the middle of the picture looks from the camera to its target
    direction = np.subtract(RAMP.target, RAMP.position)
    uv = np.array([0.55, 0.5])
    travel = direction[:2] * [1, -1] / -direction[2] * 0.2
    t = (1.0 - 0.2 - 0.5 * uv[0]) / (1.0 + 0.5 * travel[0])
    return explanation, uv, travel, t


def test_reads_and_hits_on_a_ramp_equal_the_closed_form() -> None:
    explanation, uv, travel, t = ramp("steep", steps=8)
    np.testing.assert_allclose(explanation.uv, uv, atol=1e-6)
    np.testing.assert_allclose(explanation.travel, travel, atol=1e-6)
    layers = [1 - k / 8 for k in range(8)]
    last = next(k for k, layer in enumerate(layers) if layer <= 1 - t)
    assert len(explanation.reads) == last + 1
    for read, layer in zip(explanation.reads, layers, strict=False):
        place = uv + travel * (1 - layer)
        np.testing.assert_allclose(read.uv, place, atol=2e-6)
        assert read.ray == pytest.approx(layer, abs=1e-6)
        assert read.surface == pytest.approx(0.2 + 0.5 * place[0], abs=1e-5)
        assert read.above == (layer > 0.2 + 0.5 * place[0])
    np.testing.assert_allclose(explanation.true_uv, uv + travel * t, atol=1e-6)
    assert explanation.true_height == pytest.approx(1 - t, abs=1e-6)
    late = (1 - t) - layers[last]
    assert explanation.error == pytest.approx(late * np.hypot(*(travel * [64, 32])), abs=1e-3)
    assert explanation.length == pytest.approx(np.hypot(*(travel * [64, 32])), abs=1e-4)


def test_a_chord_on_a_ramp_has_no_error() -> None:
    explanation, *_ = ramp("parallax_occlusion", min_steps=10, max_steps=10)
    assert explanation.error < 1e-3


def test_the_true_hit_on_columns() -> None:
    explanation = explained("texel")
    assert explanation.columns
    assert explanation.error < 0.03
    surface = explanation.surface(np.array([read.uv for read in explanation.reads]))
    assert set(surface) <= set(explanation.heights.ravel())


def test_reads_of_a_vertical_ray_have_their_heights() -> None:
    """Without travel, heights do not follow from texture coordinates, and are recorded anyway."""
    camera = LookAt((0.0, 0.0, 2.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    flat_on = Object(GRAVEL, technique="steep", settings={"steps": 5}, transform=np.eye(4))
    explanation = explain(Scene((flat_on,), camera=camera), pixel=(48, 30), size=(97, 61))
    assert explanation.length < 1e-3
    wanted = [1 - k / 5 for k in range(len(explanation.reads))]
    assert [read.ray for read in explanation.reads] == pytest.approx(wanted, abs=1e-6)


# --- a user's technique ---------------------------------------------------------------------------

OWN = '''\
from basrelief.lang import HeightField, setting, struct
from basrelief.techniques.height import sharp
from basrelief.techniques import Hit, Ray, at, hit_at, t_at, technique


@struct
class Twice:
    """Settings."""

    first: float = setting(default=0.75, doc="the first height", low=0.0, high=1.0)


@technique()
def twice(field: HeightField, ray: Ray, settings: Twice) -> Hit:
    """Read at two heights, by `sharp` itself."""
    high = sharp(field, at(ray, t_at(ray, settings.first)))
    low = sharp(field, at(ray, t_at(ray, 0.25)))
    return hit_at(ray, t_at(ray, high), low > 0.0, 2)
'''


def test_a_user_defined_technique_is_explained(tmp_path: Path) -> None:
    file = tmp_path / "own.py"
    file.write_text(OWN)
    explanation = explained(f"{file}:twice", settings={"first": 0.5})
    assert [read.ray for read in explanation.reads] == pytest.approx([0.5, 0.25])
    assert explanation.hit.height == pytest.approx(explanation.reads[0].surface, abs=1e-6)
    assert "first 0.5" in explanation.summary


# --- files, tables, refusals ----------------------------------------------------------------------


def test_the_table_has_every_read_and_both_ends() -> None:
    explanation = explained("contact")
    lines = explanation.table().splitlines()
    assert len(lines) == 1 + len(explanation.reads) + 2
    for n, (read, line) in enumerate(zip(explanation.reads, lines[1:], strict=False), 1):
        cells = line.split()
        assert cells[:2] == [str(n), "height"]
        assert [float(c) for c in cells[2:6]] == pytest.approx(
            [*read.uv, read.ray, read.surface], abs=1e-5
        )
    assert lines[-1].split()[0] == "true"


@pytest.mark.parametrize("name", ["offset", "relief", "exact", "texel"])
def test_a_cross_section_is_drawn(name: str, tmp_path: Path) -> None:
    """SVG with its words as text, each number once; the same ray makes the same file."""
    pytest.importorskip("matplotlib")
    explanation = explained(name)
    first = explanation.save(tmp_path / "one.svg").read_text()
    assert first == explanation.save(tmp_path / "two.svg").read_text()
    texts = re.findall(r"<text[^>]*>([^<]*)</text>", first)
    assert explanation.verdict in texts
    assert "view ray" in texts
    assert "polygon" in texts
    for n in range(1, len(explanation.reads) + 1):
        assert str(n) in texts
    assert sorted(file.name for file in tmp_path.iterdir()) == ["one.svg", "two.svg"]


def test_a_cross_section_can_be_a_png(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from basrelief.images import read_picture

    pixels = read_picture(explained("relief").save(tmp_path / "ray.png")).pixels
    assert pixels.shape[:2] == (840, 1500)
    assert pixels[:, :, :3].std() > 20


def test_invalid_requests_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="pixel 2,2 shows no object"):
        explained("relief", (2, 2))
    with pytest.raises(InputError, match="pixel 96,0: outside a picture of 96 × 60"):
        explained("relief", (96, 0))
    with pytest.raises(InputError, match="has no depth here"):
        explained("relief", scale=0.0)
    with pytest.raises(InputError, match=r"written as \.svg, \.png, \.pdf"):
        explained("offset").save(tmp_path / "ray.jpg")
    bare = Material("bare", base_color=map_of(noise(1)))
    with pytest.raises(InputError, match="shows a plane without relief"):
        explain(Scene((Object(bare),), camera=CAMERA), pixel=(50, 35), size=SIZE)


# --- the command line -----------------------------------------------------------------------------


def test_the_command_prints_the_table(tmp_path: Path) -> None:
    write_heights(tmp_path / "bumps")
    place = (str(tmp_path / "bumps"), "--pixel", "32,20", "--size", "64x36")
    out = done("explain", *place, "--technique", "steep", "--set", "steps=6")
    first, *rest = out.splitlines()
    assert re.match(r"bumps, pixel 32,20: steep: \d reads.* texels from the true hit", first)
    assert rest[1].split()[:2] == ["1", "height"]
    pytest.importorskip("matplotlib")
    drawing = tmp_path / "ray.svg"
    out = done("explain", *place, "-o", drawing)
    assert out.splitlines()[1:] == [str(drawing)]
    assert drawing.is_file()
    both = done("explain", *place, "-o", drawing, "--table").splitlines()
    assert len(both) > 4


def test_the_command_refuses_pixels_without_an_object(tmp_path: Path) -> None:
    write_heights(tmp_path / "bumps")
    folder = str(tmp_path / "bumps")
    assert "write x,y" in refused("explain", folder, "--pixel", "middle")
    assert "shows no object" in refused("explain", folder, "--pixel", "0,0", "--size", "64x36")
    assert "--pixel" in refused("explain", folder)
