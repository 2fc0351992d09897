"""Drawing the panels of a page, and measuring their costs."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from basrelief.engine import Engine
from basrelief.gallery.page import Page, Panel
from basrelief.measure.debug import DebugPicture, debug_picture
from basrelief.measure.light import shown_light
from basrelief.measure.truth import truth
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import Scene
from basrelief.scene.recipe import Recipe, omitted_by_command
from basrelief.techniques import TECHNIQUES

FRAMES = 5
"""Number of frames of which a time is the median."""
TEXELS = 512
"""Size of the procedural samples, in texels."""


@dataclass(frozen=True, eq=False)
class DrawnPanel:
    """A panel with its frame, its picture and its cost.

    `reads` is the mean number of heights read in a covered pixel. `seconds` is the median time of
    frames with one sample at the picture's size, `headline_seconds` at the headline's size.
    `command` is the command line that draws it, or "" where none can say all of it.
    """

    panel: Panel
    frame: Frame
    picture: DebugPicture
    reads: float
    seconds: float
    headline_seconds: float | None
    command: str


def draw_panels(
    page: Page,
    size: tuple[int, int],
    samples: int,
    engine: Engine,
    progress: Callable[[float], None] = lambda share: None,
) -> Iterator[DrawnPanel]:
    """Draw the panels of a page one by one; `progress` is called with the finished share."""
    panels = [*page.panels(TEXELS)]
    for number, panel in enumerate(panels):
        frame = render(panel.scene, size=size, samples=samples, device=engine)
        picture = picture_of(panel, frame, engine)
        headline = _headline_seconds(page, panel.scene, engine)
        seconds = seconds_of(panel.scene, size, engine)
        command = command_of(panel, size, samples)
        yield DrawnPanel(panel, frame, picture, frame.mean_reads, seconds, headline, command)
        progress((number + 1) / len(panels))


def command_of(panel: Panel, size: tuple[int, int], samples: int) -> str:
    """The command line that draws a panel, or "" where none can say all of it."""
    own = any(obj.technique not in TECHNIQUES.values() for obj in panel.scene.resolved)
    if own or any(omitted_by_command(panel.scene)):
        return ""
    shown = {"show": panel.shown} if panel.shown != "color" else {}
    return Recipe(panel.scene, {"size": size, "samples": samples, **shown}).command


def picture_of(panel: Panel, frame: Frame, engine: Engine) -> DebugPicture:
    """The picture that a page shows of a drawn panel; debug pictures explain their colours."""
    if panel.shown == "color":
        return DebugPicture(frame.image, "")
    height, width = frame.distance.shape
    size, light = (width, height), None
    reference = None if panel.shown == "reads" else truth(panel.scene, size, device=engine)
    if panel.shown == "shadow-error":
        light = shown_light(panel.scene, size, engine)
    return debug_picture(panel.shown, frame, reference, light)


def _headline_seconds(page: Page, scene: Scene, engine: Engine) -> float | None:
    return None if page.headline is None else seconds_of(scene, page.headline.size, engine)


def seconds_of(scene: Scene, size: tuple[int, int], engine: Engine) -> float:
    """Median seconds of `render` for a frame of one sample, after one frame to warm up."""
    times = []
    for _ in range(FRAMES + 1):
        before = time.perf_counter()
        render(scene, size=size, samples=1, device=engine)
        times.append(time.perf_counter() - before)
    return statistics.median(times[1:])
