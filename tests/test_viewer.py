"""The viewer's page in a browser: what it draws is what the CPU engine draws, and it obeys."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agreement import assert_agree
from basrelief.material import Material, sample
from basrelief.rendering import Frame, render
from basrelief.scene import SHAPES, Object, Orbit, Scene
from basrelief.shaders.techniques import TECHNIQUES
from basrelief.viewer import write_view
from browser import SOFTWARE, chromium

SIZE = (160, 90)
TEXELS = 64
CAMERA = Orbit(azimuth=24.0, elevation=32.0)


@pytest.fixture(scope="module")
def material() -> Material:
    return sample("bricks", TEXELS)


@pytest.fixture(scope="module")
def page_file(material: Material, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("viewer") / "page.html"
    scene = Scene((Object(material, scale=0.08),), camera=CAMERA)
    write_view(scene, file, source="sample:bricks", engine="cpu")
    return file


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(SOFTWARE) as made:
        yield made


class Seen:
    """A page that is open, and what it said and asked for."""

    def __init__(self, browser: Any, file: Path, hash: str = "", **options: Any) -> None:
        options.setdefault("viewport", {"width": 1000, "height": 640})
        self.page = browser.new_page(**options)
        self.said: list[str] = []
        self.asked: list[str] = []
        self.page.on("console", lambda m: self.said.append(f"{m.type}: {m.text}"))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(file.as_uri() + hash)
        self.page.wait_for_function("window.viewer && window.viewer.ready")
        self.page.evaluate("viewer.ready")

    def state(self, **changes: Any) -> None:
        """Change what the page shows, as its panel does."""
        self.page.evaluate("changes => { Object.assign(viewer.state, changes) }", changes)

    def draw(self, samples: int = 1, size: tuple[int, int] = SIZE) -> None:
        self.page.evaluate("([w, h, n]) => viewer.draw(w, h, n)", [*size, samples])

    def frame(self, side: str = "left") -> Frame:
        """The planes that were drawn last, as the library's frame."""
        self.draw()
        words = self.page.evaluate(
            "async side => [...new Uint32Array(await viewer.drawing.words(side))]", side
        )
        width, height = SIZE
        planes = np.array(words, np.uint32).reshape(9, height, width)
        real = planes.view(np.float32)
        hit = planes[7] != 0
        color = np.zeros((height, width, 4), np.float32)
        share = np.where(hit, real[3], 0.0)[:, :, None]
        background = np.array(Scene(()).background, np.float32)
        color[:, :, :3] = background * (1.0 - share) + real[:3].transpose(1, 2, 0) * share
        color[:, :, 3] = 1.0
        depth = np.where(hit, real[4], np.inf).astype(np.float32)
        uv = real[5:7].transpose(1, 2, 0)
        return Frame(color, depth, uv, hit, planes[8].astype(np.int32), "browser")

    def text(self, selector: str) -> str:
        return str(self.page.inner_text(selector))


@pytest.fixture(scope="module")
def seen(browser: Any, page_file: Path) -> Iterator[Seen]:
    made = Seen(browser, page_file)
    yield made
    made.page.close()


@pytest.fixture
def fresh(seen: Seen) -> Seen:
    """The page as at its start."""
    seen.page.evaluate("viewer.reset()")
    seen.said.clear()
    return seen


def expected(material: Material, **options: Any) -> Frame:
    of_scene = {k: options.pop(k) for k in list(options) if k in Scene.__dataclass_fields__}
    thing = Object(material, **{"scale": 0.08, **options})
    scene = Scene((thing,), **{"camera": CAMERA, **of_scene})
    return render(scene, size=SIZE, samples=1, engine="cpu")


def test_the_adapter_is_the_software_one(seen: Seen) -> None:
    info = seen.page.evaluate(
        "[viewer.gpu.adapter.info.vendor, viewer.gpu.adapter.info.architecture]"
    )
    assert info == ["google", "swiftshader"]


def test_it_loads_without_a_word_and_without_the_network(browser: Any, page_file: Path) -> None:
    seen = Seen(browser, page_file)
    seen.draw()
    assert seen.said == []
    assert seen.asked == [page_file.as_uri()]
    assert seen.text("#messages") == ""
    seen.page.close()


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_a_technique_is_the_cpus_picture(fresh: Seen, material: Material, technique: str) -> None:
    made = TECHNIQUES[technique]
    fresh.state(technique=technique, level=made.level, projection=made.projection)
    assert_agree(expected(material, technique=technique), fresh.frame(), TEXELS)
    assert fresh.said == []


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("shadows", ["hard", "soft"])
def test_shapes_and_shadows_are_the_cpus(
    fresh: Seen, material: Material, shape: str, shadows: str
) -> None:
    thing = Object(material, shape=shape)
    fresh.state(shape=shape, shadows=shadows, tiling=list(thing.tiles))
    assert_agree(expected(material, shape=shape, shadows=shadows), fresh.frame(), TEXELS)
