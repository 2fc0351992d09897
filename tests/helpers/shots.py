"""Screenshots of the viewer's page for docs/viewer.md, taken in a headless Chromium.

Run as a program, it takes them anew: `scripts/goldens`. A test compares them with the page.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from basrelief.material import sample
from basrelief.scene import Object, Orbit, Scene
from basrelief.viewer import write_view
from helpers.browser import PATIENCE, SOFTWARE, chromium
from helpers.repository import REPOSITORY
from helpers.served import marimo

PICTURES = REPOSITORY / "docs" / "images"
EXAMPLE = REPOSITORY / "examples" / "viewer.py"


@dataclass(frozen=True)
class Shot:
    """Window size, colour scheme, and changes of the page's initial state.

    `unfolded` is the only open section of the panel, "" for the initial ones.
    """

    size: tuple[int, int]
    scheme: str
    changes: dict[str, Any]
    unfolded: str = ""


SHOTS = {
    "viewer-light": Shot((960, 600), "light", {"shadows": "soft"}),
    "viewer-divider": Shot((960, 600), "dark", {"compare": "offset", "scale": 0.08}),
    "viewer-missed": Shot(
        (960, 600), "dark", {"technique": "parallax_occlusion", "show": "missed", "scale": 0.1}
    ),
    "viewer-maps": Shot((960, 780), "light", {"technique": "exact", "scale": 0.1}, "maps"),
    "viewer-narrow": Shot((400, 720), "dark", {"shape": "sphere", "shadows": "hard"}),
}


def write_page(folder: Path) -> Path:
    """Write the page of the screenshots."""
    file = folder / "page.html"
    scene = Scene((Object(sample("cobbles", 256)),), camera=Orbit(28.0, 30.0))
    write_view(scene, file, device="cpu")
    return file


def shot(browser: Any, file: Path, name: str) -> tuple[bytes, dict[str, float]]:
    """A screenshot as PNG, and the rectangle of the canvas: x, y, width, height."""
    made = SHOTS[name]
    width, height = made.size
    page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=made.scheme)
    page.set_default_timeout(PATIENCE)
    page.goto(file.as_uri())
    page.wait_for_function("window.viewer && window.viewer.ready")
    page.evaluate("viewer.ready")
    page.evaluate(
        """async ([changes, unfolded]) => {
          if (changes.shape) viewer.state.tiling = viewer.data.shapes[changes.shape].tiling;
          Object.assign(viewer.state, changes);
          viewer.drawing.frames.limit = 2;
          viewer.changed(true);
          for (const each of document.querySelectorAll("#panel details")) {
            if (unfolded) each.open = each.id === `section-${unfolded}`;
          }
          await viewer.drawing.settled();
          viewer.drawing.frames.present();
        }""",
        [made.changes, made.unfolded],
    )
    page.wait_for_timeout(300)
    png = page.screenshot()
    box = page.locator("#canvas").bounding_box()
    page.close()
    return png, box


def main() -> None:
    """Take all screenshots."""
    file = write_page(Path(tempfile.mkdtemp()))
    with chromium(SOFTWARE) as browser:
        for name in SHOTS:
            png, _ = shot(browser, file, name)
            (PICTURES / f"{name}.png").write_bytes(png)
        notebook(browser)


def notebook(browser: Any) -> None:
    """Take the screenshot of the marimo example, after moving a slider."""
    with marimo(EXAMPLE, Path(tempfile.mkdtemp())) as address:
        page = browser.new_page(viewport={"width": 1200, "height": 1060})
        page.set_default_timeout(PATIENCE)
        page.goto(address)
        page.wait_for_selector("iframe")
        frame = next(each for each in page.frames if each.url.startswith("blob:"))
        frame.wait_for_function("window.viewer?.drawing?.frames?.done")
        frame.evaluate("viewer.drawing.frames.limit = 4")
        frame.locator("input[name=scale]").fill("0.06")
        page.get_by_text("scale 0.06").wait_for()
        frame.evaluate("viewer.drawing.settled()")
        page.keyboard.press("Tab")
        page.wait_for_timeout(3000)
        page.screenshot(path=PICTURES / "viewer-notebook.png")
        page.close()


if __name__ == "__main__":
    main()
