"""Draws the pictures of the viewer in docs/viewer.md, in a headless Chromium and in marimo.

PYTHONPATH=src:tests python docs/images/viewer.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from basrelief.material import sample
from basrelief.scene import Object, Orbit, Scene
from basrelief.viewer import write_view
from browser import SOFTWARE, chromium
from served import marimo

HERE = Path(__file__).parent
SHOTS = {
    "viewer-light": ((1200, 720), "light", {"shadows": "soft"}),
    "viewer-divider": ((1200, 720), "dark", {"compare": "offset", "scale": 0.08}),
    "viewer-missed": (
        (1200, 720), "dark", {"technique": "parallax_occlusion", "show": "missed", "scale": 0.1},
    ),
    "viewer-narrow": ((420, 780), "dark", {"shape": "sphere", "shadows": "hard"}),
}  # fmt: skip
"""The window's size, the scheme, and what is changed of the page's start."""


def main() -> None:
    file = Path(tempfile.mkdtemp()) / "page.html"
    thing = Object(sample("cobbles", 512))
    write_view(Scene((thing,), camera=Orbit(28.0, 30.0)), file, source="sample:cobbles")
    with chromium(SOFTWARE) as browser:
        for name, ((width, height), scheme, changes) in SHOTS.items():
            viewport = {"width": width, "height": height}
            page = browser.new_page(viewport=viewport, color_scheme=scheme)
            page.goto(file.as_uri())
            page.wait_for_function("window.viewer && window.viewer.ready")
            page.evaluate("viewer.ready")
            page.evaluate(
                """async (changes) => {
                  if (changes.shape) viewer.state.tiling = viewer.data.shapes[changes.shape].tiling;
                  Object.assign(viewer.state, changes);
                  viewer.drawing.limit = 8;
                  viewer.changed(true);
                  await viewer.drawing.settled();
                  viewer.drawing.present();
                }""",
                changes,
            )
            page.wait_for_timeout(300)
            page.screenshot(path=HERE / f"{name}.png")
            page.close()
        notebook(browser)


def notebook(browser: Any) -> None:
    """The example in marimo, after a slider was moved."""
    example = HERE.parent.parent / "examples" / "viewer.py"
    with marimo(example, Path(tempfile.mkdtemp())) as address:
        page = browser.new_page(viewport={"width": 1200, "height": 1060})
        page.goto(address)
        page.wait_for_selector("iframe")
        frame = next(each for each in page.frames if each.url.startswith("blob:"))
        frame.wait_for_function("window.viewer?.drawing?.done")
        frame.evaluate("viewer.drawing.limit = 8")
        frame.locator("input[name=scale]").fill("0.06")
        page.get_by_text("scale 0.06").wait_for()
        frame.evaluate("viewer.drawing.settled()")
        page.keyboard.press("Tab")
        page.wait_for_timeout(3000)
        page.screenshot(path=HERE / "viewer-notebook.png")
        page.close()


if __name__ == "__main__":
    main()
