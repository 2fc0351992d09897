"""Drawing the panels of a page, and measuring their costs."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
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
    """Draw the panels of a page; `progress` is called with the finished share.

    They are timed before the first one is yielded.
    """
    panels = [*page.panels(TEXELS)]
    scenes = [panel.scene for panel in panels]
    seconds = seconds_of(scenes, size, engine)
    headlines: list[float | None] = [None] * len(panels)
    if page.headline is not None:
        headlines = [*seconds_of(scenes, page.headline.size, engine)]
    progress(0.5)
    for number, panel in enumerate(panels):
        frame = render(panel.scene, size=size, samples=samples, device=engine)
        yield DrawnPanel(
            panel,
            frame,
            picture_of(panel, frame, engine),
            frame.mean_reads,
            seconds[number],
            headlines[number],
            command_of(panel, size, samples),
        )
        progress(0.5 + 0.5 * (number + 1) / len(panels))


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


def seconds_of(scenes: Sequence[Scene], size: tuple[int, int], engine: Engine) -> list[float]:
    """Median seconds of `render` for a frame of one sample, for each scene.

    They are drawn in turn, after one frame each to warm up, so that a busy machine slows all of
    them alike.
    """
    times: list[list[float]] = [[] for _ in scenes]
    for _ in range(FRAMES + 1):
        for scene, taken in zip(scenes, times, strict=True):
            before = time.perf_counter()
            render(scene, size=size, samples=1, device=engine)
            taken.append(time.perf_counter() - before)
    return [statistics.median(taken[1:]) for taken in times]
