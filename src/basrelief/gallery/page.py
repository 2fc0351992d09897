"""Records of the gallery: pages of pictures side by side, with texts."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from basrelief.material import Material
from basrelief.material import sample as drawn_sample
from basrelief.scene import Scene

SOURCES = {
    "catlike": "Catlike Coding, Rendering 20: Parallax",
    "wikibooks": "Cg Programming in Unity (Wikibooks): Projection of Bumpy Surfaces",
    "gamedev": "GameDev.net: A Closer Look at Parallax Occlusion Mapping",
    "halliwell": "S. Halliwell: Parallax Offset",
    "habrador": "Habrador, Advanced shaders in Unity: 3. Parallax mapping",
    "beyond": "Beyond the five articles, after the literature",
}
"""Titles of the articles by short name, in the order of the index, and of the pages beyond them."""


def heading(source: str) -> str:
    """Heading of the pages of a source."""
    return "Beyond the articles" if source == "beyond" else f"After {source}"


@dataclass(frozen=True, eq=False)
class Panel:
    """One picture of a page: a short caption and a scene.

    The settings in the caption are derived from the scene; `settings` adds others. `shown` is
    "color" or the name of a debug picture, as in `basrelief render --show`.
    """

    caption: str
    scene: Scene
    settings: str = ""
    shown: str = "color"


@dataclass(frozen=True)
class Headline:
    """A performance figure of an article, and the picture size at which its page is timed."""

    size: tuple[int, int]
    figure: str


@dataclass(frozen=True, eq=False)
class Page:
    """One comparison of an article.

    `rows` are the rows of docs/contributing/features.md that the page shows, with details; the
    first one sets the page's place within its source. `look` is one sentence on what to look at.
    `article` describes the article's pictures, `ours` these pictures and their differences.
    `panels` makes the panels, with procedural samples of a size in texels.
    """

    name: str
    title: str
    source: str
    rows: Mapping[str, str]
    look: str
    article: str
    ours: str
    panels: Callable[[int], Iterable[Panel]]
    headline: Headline | None = None


@functools.cache
def sample(name: str, texels: int) -> Material:
    """`basrelief.sample`, cached for all pages."""
    return drawn_sample(name, texels)
