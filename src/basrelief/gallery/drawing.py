"""Drawing the panels of a page, and finding out what each costs."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from basrelief.engine import Engine
from basrelief.gallery.page import Page, Panel
from basrelief.measure.debug import DebugPicture, debug_picture
from basrelief.measure.truth import truth
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import Scene

FRAMES = 5
"""How many frames a time is the median of."""
TEXELS = 512
"""Texels a side of the samples that pages show."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A panel with its picture, the frame that it is made of, and its cost.

    `reads` is how many heights each covered pixel reads, on average; `seconds` the median time of
    frames of one sample at the picture's size, `headline_seconds` at that of the page's headline.
    """

    panel: Panel
    frame: Frame
    picture: DebugPicture
    reads: float
    seconds: float
    headline_seconds: float | None


def drawn(
    page: Page,
    size: tuple[int, int],
    samples: int,
    engine: Engine,
    progress: Callable[[float], None] = lambda share: None,
) -> Iterator[Drawn]:
    """The panels of a page, one after the other; `progress` hears the share of those drawn."""
    panels = [*page.panels(TEXELS)]
    for number, panel in enumerate(panels):
        frame = render(panel.scene, size=size, samples=samples, device=engine)
        picture = picture_of(panel, frame, engine)
        headline = _headline_seconds(page, panel.scene, engine)
        seconds = seconds_of(panel.scene, size, engine)
        yield Drawn(panel, frame, picture, frame.mean_reads, seconds, headline)
        progress((number + 1) / len(panels))


def picture_of(panel: Panel, frame: Frame, engine: Engine) -> DebugPicture:
    """What a page shows of a panel that is drawn; what colours mean is said of debug pictures."""
    if panel.shown == "color":
        return DebugPicture(frame.image, "")
    height, width = frame.distance.shape
    needed = panel.shown != "reads"
    true = truth(panel.scene, (width, height), device=engine) if needed else None
    return debug_picture(panel.shown, frame, true)


def _headline_seconds(page: Page, scene: Scene, engine: Engine) -> float | None:
    return None if page.headline is None else seconds_of(scene, page.headline.size, engine)


def seconds_of(scene: Scene, size: tuple[int, int], engine: Engine) -> float:
    """The median time of some frames of one sample, as `render` takes it, after one to warm up."""
    times = []
    for _ in range(FRAMES + 1):
        before = time.perf_counter()
        render(scene, size=size, samples=1, device=engine)
        times.append(time.perf_counter() - before)
    return statistics.median(times[1:])
